//! Samples come epoch by epoch, each in time order, however many threads read them.

use flightcam::{
    log::{Log, ReadError},
    reader::{Arrival, Reader},
    source::Source,
};
use mcap::Compression;

use crate::support::{
    folder::{Folder, LOG},
    logbook::request,
    numbered::*,
};

const MILLISECOND: u64 = 1_000_000;

fn read_epochs(log: &[u8]) -> (Vec<(u32, ReadSample)>, Vec<usize>) {
    let folder = Folder::with(LOG, log);
    let log = Log::open(&folder.path(LOG)).expect("a log");
    let source = Source::select(&log, &request(PROFILE)).expect("a source");
    let reader = Reader::new(&log, source).expect("a reader");
    let starts = reader.epoch_starts();
    let mut samples = Vec::new();
    let read = reader.for_each(|Arrival { epoch, sample, .. }| {
        samples.push((epoch, describe(sample)));
        Ok::<_, ReadError>(())
    });
    read.expect("a readable log");
    (samples, starts)
}

/// A long flight; its clock is set back before some messages, by so many seconds.
fn flight_with(settings: &[(usize, u64)]) -> Vec<Message> {
    let mut messages = flight(3000, 10_000);
    for (n, message) in messages.iter_mut().enumerate() {
        let back: u64 = settings
            .iter()
            .filter(|(at, _)| n >= *at)
            .map(|(_, s)| s)
            .sum();
        // Messages of each kind come at 25 Hz.
        message.time = (100_000 + n as u64 * 10 - back * 1000) * MILLISECOND;
    }
    messages
}

#[test]
fn the_samples_of_an_epoch_come_before_those_of_the_next() {
    for settings in [&[(1502, 3)][..], &[(1001, 30), (2199, 2)], &[]] {
        let messages = flight_with(settings);
        let mut expected: Vec<(u32, ReadSample)> = sorted(&messages, LOGGED)
            .into_iter()
            .map(|sample| {
                let epoch = settings.iter().filter(|(at, _)| sample.2 >= *at).count();
                (epoch as u32, sample)
            })
            .collect();
        expected.sort_unstable();
        for size in [20_000, 100_000, 5_000_000] {
            let log = write(chunks_of(size, Some(Compression::Zstd)), &messages);
            let (samples, starts) = read_epochs(&log);
            assert!(samples == expected, "{settings:?}, {size}");
            assert_eq!(starts.len(), settings.len());
            let chunks = chunk_indexes(&log);
            let mut first = 0;
            for (&start, (at, _)) in starts.iter().zip(settings) {
                // The messages before it are in earlier chunks, or in the same.
                let of_chunk = |n: usize| chunks[n].message_end_time;
                assert!(start >= first && of_chunk(start) >= messages[*at].time);
                first = start;
            }
        }
    }
}

#[test]
fn an_epoch_may_begin_in_each_of_two_recordings() {
    // One topic after the other, and each goes back.
    let messages = flight_with(&[(1500, 5)]);
    let of = |content| {
        messages
            .iter()
            .filter(move |message| message.content == content)
    };
    let by_topic: Vec<Message> = [Content::Velocity, Content::Attitude]
        .into_iter()
        .flat_map(|content| of(content).copied())
        .collect();
    let (samples, starts) = read_epochs(&write(chunks_of(20_000, None), &by_topic));
    assert!(samples.is_sorted_by_key(|(epoch, (time, kind, _))| (*epoch, *time, *kind)));
    let later = samples.iter().filter(|(epoch, _)| *epoch == 1);
    assert_eq!((samples.len(), later.count()), (1500, 750));
    assert!(starts.is_empty(), "no place divides the file");
}
