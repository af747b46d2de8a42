//! Samples come in time order, all of them, whatever holds them and however many threads read it.

use flightcam::{
    Error,
    camera::CameraError,
    log::{Log, ReadError},
    reader::Reader,
    sample::{DropReason, Kind},
    source::Source,
};
use mcap::Compression;
use proptest::prelude::*;

use crate::support::{
    folder::{Folder, LOG},
    logbook::request,
    numbered::*,
    shapes::any_shape,
};

/// Longer than what one thread reads.
fn long_flight() -> Vec<Message> {
    flight(2000, 12_000)
}

/// In any order, at times of which many are equal, with a frame here and there. The length of the frames makes the log
/// a long one or a short one.
fn any_messages() -> impl Strategy<Value = Vec<Message>> {
    let contents = [
        Content::Attitude,
        Content::Attitude,
        Content::Velocity,
        Content::Velocity,
        Content::Incomplete,
        Content::Frame,
    ];
    let message = (
        prop::sample::select(contents.to_vec()),
        0..100_u64,
        prop::sample::select(vec![0, 0, 0, 5, 3000, 9000]),
    );
    let slope = prop::sample::select(vec![0, 1, 10]);
    let frame = prop::sample::select(vec![0, 500, 200_000]);
    let messages = prop::collection::vec(message, 1..400);
    (messages, slope, frame).prop_map(|(messages, slope, frame)| {
        let first = [Content::Attitude, Content::Velocity].map(|content| (content, 0, 0));
        let messages = first.into_iter().chain(messages).enumerate();
        messages
            .map(|(n, (content, time, padding))| Message {
                content,
                time: 1000 + n as u64 * slope + time,
                padding: if content == Content::Frame {
                    frame
                } else {
                    padding
                },
            })
            .collect()
    })
}

proptest! {
    #![proptest_config(crate::support::cases(48))]

    #[test]
    fn all_samples_come_sorted_by_time(
        messages in any_messages(),
        shape in any_shape(),
        by_log_time in any::<bool>(),
    ) {
        let log = write(shape.options, &messages);
        let (time_of, time): (_, fn(&Message) -> u64) = match by_log_time {
            true => ("", LOGGED),
            false => (MEASURED, Message::measured),
        };
        let (samples, outcome) = read(&log, &format!("{time_of}{PROFILE}"));
        prop_assert_eq!(samples, sorted(&messages, time));
        let (_, dropped) = outcome.expect("a readable log");
        let incomplete = messages.iter().filter(|message| message.content == Content::Incomplete);
        let missing = dropped[Kind::Velocity].dropped.get(&DropReason::MissingField);
        prop_assert_eq!(missing.copied().unwrap_or(0), incomplete.count() as u64);
    }
}

// ---- Long logs ----

#[test]
fn progress_grows_to_the_total() {
    let log = write(chunks_of(100_000, Some(Compression::Zstd)), &long_flight());
    let folder = Folder::with(LOG, log);
    let log = Log::open(&folder.path(LOG)).expect("a log");
    let source = Source::select(&log, &request(PROFILE)).expect("a source");
    let reader = Reader::new(&log, source).expect("a reader");
    let total = reader.bytes_total();
    assert!(total > 5_000_000);
    let mut progress = Vec::new();
    let outcome = reader.for_each(|arrival| {
        progress.push(arrival.bytes_read);
        Ok::<_, ReadError>(())
    });
    outcome.expect("a readable log");
    assert!(
        progress.is_sorted() && progress[0] < total / 10,
        "{progress:?}"
    );
    assert_eq!(progress.last(), Some(&total));
}

#[test]
fn every_thread_notices_suspicious_values() {
    let suspicion = |messages| {
        let log = write(chunks_of(100_000, None), &flight(messages, 4000));
        let (_, outcome) = read(&log, PROFILE);
        let (source, _) = outcome.expect("a readable log");
        assert_eq!(source.attitude().topic, "/attitude");
        source.oversized_angle()
    };
    // The yaw of the last messages is more than a turn.
    assert_eq!(suspicion(6000), None);
    let (_, found) = suspicion(6600).expect("a suspicion");
    assert!((6.55..6.65).contains(&found.angle), "{found:?}");
    assert!(!found.is_certain, "a yaw may go on counting");
}

#[test]
fn the_first_of_several_damaged_chunks_is_always_the_error() {
    let messages = long_flight();
    let mut log = write(chunks_of(100_000, Some(Compression::Zstd)), &messages);
    let chunks = chunk_indexes(&log);
    for chunk in [20, 21, 22, 23, 40].map(|n| &chunks[n]) {
        let middle = chunk.chunk_start_offset + chunk.chunk_length / 2;
        log[middle as usize..][..100].fill(0xc5);
    }
    let first = &chunks[20];
    let mut before = sorted(&messages, LOGGED);
    before.retain(|(time, ..)| *time < first.message_start_time);
    for _ in 0..20 {
        let (samples, outcome) = read(&log, PROFILE);
        match outcome {
            Err(Error::Read(ReadError::Damaged { offset, .. })) => {
                assert_eq!(offset, first.chunk_start_offset)
            }
            other => panic!("{other:?}"),
        }
        assert_eq!(samples, before);
    }
}

#[test]
fn reading_stops_when_the_consumer_fails() {
    for messages in [long_flight(), flight(2000, 0)] {
        let log = write(chunks_of(100_000, None), &messages);
        for stop in [1, 500, 1000] {
            let mut taken = 0;
            let outcome = read_with(&log, PROFILE, |_, _| {
                taken += 1;
                match taken == stop {
                    true => Err(Error::Camera(CameraError::Unknown)),
                    false => Ok(()),
                }
            });
            assert!(matches!(outcome, Err(Error::Camera(CameraError::Unknown))));
            assert_eq!(taken, stop);
        }
    }
}
