//! A log from a pipe is passed on byte for byte and understood as if it were a file, with memory and disk space that
//! do not depend on its length.

use std::{
    cell::RefCell,
    io::{self, ErrorKind, Read, Write},
    path::Path,
    rc::Rc,
};

use flightcam::{
    log::{
        Log, ReadError, ScanReason,
        record::{Records, push_record, serialize},
        stream::{Named, Streamed, pass_through},
    },
    source::{request::Request, stream_filter::StreamFilter},
};
use mcap::{
    WriteOptions,
    records::{AttachmentHeader, MessageHeader, op},
};
use proptest::prelude::*;

use crate::support::{piping::*, shapes::any_shape, *};

const MEBIBYTE: usize = 1024 * 1024;

proptest! {
    #![proptest_config(crate::support::cases(192))]

    #[test]
    fn a_streamed_log_of_any_shape_is_understood_as_from_a_file(shape in any_shape(), most in 1..100_000usize) {
        check(&shape.write(), &Request::default(), most);
    }

    #[test]
    fn a_truncated_streamed_log_is_understood_as_from_a_file(
        shape in any_shape(),
        at in 0.0..1.0,
        zeros in prop::sample::select(vec![0, 0, 7, 8, 9, 100_000]),
        most in 1..100_000usize,
    ) {
        let mut log = shape.write();
        log.truncate((at * log.len() as f64) as usize);
        log.resize(log.len() + zeros, 0);
        check(&log, &Request::default(), most);
    }

    #[test]
    fn damage_anywhere_causes_no_panic(
        shape in any_shape(),
        damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
        lengths in prop::collection::vec((any::<prop::sample::Index>(), any::<u64>(), 0..64u32), 0..2),
    ) {
        let mut log = shape.write();
        for (at, byte) in damage {
            let at = at.index(log.len());
            log[at] = byte;
        }
        // A length of any magnitude, where there may be one.
        for (at, length, shift) in lengths {
            let at = at.index(log.len() - 8);
            log[at..at + 8].copy_from_slice(&(length >> shift).to_le_bytes());
        }
        let request = Request::default();
        let mut filter = StreamFilter::new(&request);
        let (output, streamed) =
            pipe(Path::new("-"), &log[..], |passing| filter.include(passing));
        prop_assert!(log.starts_with(&output));
        if let Ok(Streamed { original, telemetry: followed }) = streamed {
            prop_assert_eq!(original.data_end, output.len() as u64);
            prop_assert_eq!(original.file.length(), log.len() as u64);
            let _ = telemetry(&followed, &request);
        }
    }
}

#[test]
fn a_log_may_come_byte_by_byte() {
    let shape = Shape {
        attachment_and_metadata: true,
        ..Shape::default()
    };
    check(&shape.write(), &Request::default(), 1);
    check(&mixed_log(), &Request::default(), 1);
    let flight = std::fs::read(repository("fixtures/survey_flight.mcap")).expect("the fixture");
    check(&flight, &Request::default(), 1);
}

#[test]
fn a_stream_that_is_not_a_log_is_refused_as_a_file_and_not_passed_on() {
    let log = Shape::default().write();
    let header_end = mcap::MAGIC.len() + 9 + 8 + "mcap-rs-".len();
    let other_record = [mcap::MAGIC, &[op::SCHEMA, 0, 0, 0, 0, 0, 0, 0, 0]].concat();
    let claims_much = [mcap::MAGIC, &[op::HEADER, 0, 0, 0, 0, 0, 0, 1, 0]].concat();
    for bytes in [
        &b""[..],
        &b"U"[..],
        &b"ULog\x01\x12\x35\x01"[..],
        &b"#ROSBAG V2.0\n"[..],
        &log[..3],
        &log[..8],
        &log[..header_end],
        &log[1..],
        &other_record[..],
        &claims_much[..],
    ] {
        assert!(check(bytes, &Request::default(), 5).is_none());
        let (output, _) = pipe(Path::new("-"), bytes, |_| true);
        assert!(output.is_empty());
    }
}

// ---- Time ----

/// An input and an output that share what was passed on. The input gives one record at a time, and fails if the
/// previous ones have not reached the output.
struct Live {
    records: Vec<Vec<u8>>,
    given: usize,
    passed: Rc<RefCell<Vec<u8>>>,
}

impl Read for Live {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let before: Vec<u8> = self.records[..self.given].concat();
        // The magic bytes wait for the header.
        let expected = if self.given == 1 { &[] } else { &before[..] };
        assert!(*self.passed.borrow() == expected, "after {}", self.given);
        let Some(record) = self.records.get(self.given) else {
            return Ok(0);
        };
        self.given += 1;
        buffer[..record.len()].copy_from_slice(record);
        Ok(record.len())
    }
}

struct Passed(Rc<RefCell<Vec<u8>>>);

impl Write for Passed {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.borrow_mut().extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn each_record_is_passed_on_before_the_next_one_comes() {
    for use_chunks in [true, false] {
        let log = Shape::with(|options| options.use_chunks(use_chunks)).write();
        let mut records = vec![mcap::MAGIC.to_vec()];
        for record in Records::new(&log[8..log.len() - 8]) {
            let record = record.expect("a whole record");
            let mut whole = Vec::new();
            push_record(&mut whole, record.opcode, record.body);
            if record.opcode == op::DATA_END {
                break;
            }
            records.push(whole);
        }
        let passed = Rc::new(RefCell::new(Vec::new()));
        let input = Live {
            records,
            given: 0,
            passed: Rc::clone(&passed),
        };
        let name = Path::new("-");
        let streamed = pass_through(
            Named {
                name,
                stream: input,
            },
            Named {
                name,
                stream: Passed(Rc::clone(&passed)),
            },
            |_| true,
        );
        let Streamed { original, .. } = streamed.expect("a readable log");
        assert_eq!(original.data_end, passed.borrow().len() as u64);
    }
}

// ---- Disk space ----

/// A record without its body.
fn frame(opcode: u8, length: usize) -> Vec<u8> {
    let mut frame = vec![opcode];
    frame.extend_from_slice(&(length as u64).to_le_bytes());
    frame
}

/// A log with these records in the middle of its telemetry.
fn with_records(records: Vec<(u8, Vec<u8>)>) -> Vec<u8> {
    let mut parts = Parts::of(&Shape::default().write());
    let middle = parts.data.len() / 2;
    let chunk = (parts.data[middle..].iter()).position(|(opcode, _)| *opcode == op::CHUNK);
    let place = middle + chunk.expect("a chunk");
    parts.data.splice(place..place, records);
    parts.data_section_crc = 0;
    parts.summary.clear();
    parts.join()
}

fn attachment(length: usize) -> Vec<u8> {
    let header = AttachmentHeader {
        log_time: 1,
        create_time: 2,
        name: "video.mp4".into(),
        media_type: "video/mp4".into(),
    };
    let mut body = serialize(&header);
    body.extend_from_slice(&(length as u64).to_le_bytes());
    body.extend((0..length).map(|i| (i / 3) as u8));
    body.extend_from_slice(&[0; 4]);
    body
}

/// The disk space of the parts of a log that are kept, on systems that report it.
#[cfg(unix)]
fn room(log: &Log) -> usize {
    let metadata = (log.file.as_file())
        .expect("a file")
        .metadata()
        .expect("metadata");
    512 * std::os::unix::fs::MetadataExt::blocks(&metadata) as usize
}

#[cfg(not(unix))]
fn room(_: &Log) -> usize {
    0
}

#[test]
fn a_long_attachment_is_passed_on_and_not_kept() {
    let log = with_records(vec![(op::ATTACHMENT, attachment(20 * MEBIBYTE))]);
    let streamed = check(&log, &Request::default(), 1_000_000).expect("a readable log");
    let attachments = &streamed.original.contents.attachments;
    assert_eq!(attachments[0].record.data_size, 20 * MEBIBYTE as u64);
    assert!(room(&streamed.original) < MEBIBYTE);
}

#[test]
fn a_truncated_long_record_is_held_back() {
    let whole = with_records(vec![(op::ATTACHMENT, attachment(20 * MEBIBYTE))]);
    for at in [whole.len() / 2, whole.len() / 3 * 2] {
        let streamed = check(&whole[..at], &Request::default(), 1_000_000);
        let original = streamed.expect("a readable log").original;
        assert!(original.data_end < 200_000);
        assert_eq!(original.breaks_off_at, Some(original.data_end));
    }
}

#[test]
fn a_metadata_record_is_kept_wherever_it_is() {
    for length in [17 * MEBIBYTE, 10] {
        let metadata = mcap::records::Metadata {
            name: "parameters".into(),
            metadata: [("all".into(), "x".repeat(length))].into(),
        };
        let around = (op::ATTACHMENT, attachment(100_000));
        let record = (op::METADATA, serialize(&metadata));
        let log = with_records(vec![around.clone(), record, around]);
        let streamed = check(&log, &Request::default(), 1_000_000).expect("a readable log");
        let kept = streamed.original.metadata("parameters");
        assert_eq!(kept.expect("it is kept"), [metadata]);
    }
}

#[test]
fn what_is_held_back_may_begin_with_a_long_record() {
    for opcode in [op::DATA_END, op::FOOTER] {
        let mut log = with_records(vec![(opcode, vec![0; 17 * MEBIBYTE])]);
        // The log goes on, but no whole record follows.
        let place = log
            .windows(9)
            .position(|window| window == frame(opcode, 17 * MEBIBYTE));
        log.truncate(place.expect("the record") + 9 + 17 * MEBIBYTE + 100);
        let streamed = check(&log, &Request::default(), 1_000_000).expect("a readable log");
        let original = streamed.original;
        assert!(original.file.length() - original.data_end > 17 * MEBIBYTE as u64);
    }
}

/// A log that is not closed, whose footer points into an attachment, to what looks like the data section's end.
#[test]
fn a_footer_that_points_into_the_data_is_not_believed() {
    let mut body = attachment(0);
    push_record(&mut body, op::DATA_END, &[0; 4]);
    let log = with_records(vec![(op::ATTACHMENT, body.clone())]);
    let looks_so = log.windows(body.len()).position(|window| window == body);
    let summary_start = (looks_so.expect("the attachment") + body.len()) as u64;
    let closing = log.len() - mcap::MAGIC.len() - 20;
    let mut log = log;
    log[closing..closing + 8].copy_from_slice(&summary_start.to_le_bytes());
    let (_, streamed) = pipe(Path::new("-"), &log[..], |_| true);
    let Streamed { original, .. } = streamed.expect("a readable log");
    assert_eq!(original.scanned, Some(ScanReason::NotClosed));
    assert!(original.data_end > summary_start);
}

#[test]
fn a_long_message_outside_chunks_is_followed_like_any_other() {
    let header = MessageHeader {
        channel_id: 2,
        sequence: 0,
        log_time: 2_000_000_000,
        publish_time: 0,
    };
    let payload: Vec<u8> = (0..17 * MEBIBYTE).map(|i| (i / 5) as u8).collect();
    let message = [&serialize(&header)[..], &payload].concat();
    let log = with_records(vec![(op::MESSAGE, message)]);
    let streamed = check(&log, &Request::default(), 1_000_000).expect("a readable log");
    assert!(streamed.telemetry.file.length() < MEBIBYTE as u64);
    assert!(room(&streamed.original) < MEBIBYTE);

    let (_, streamed) = pipe(Path::new("-"), &log[..], |passing| {
        passing.message.payload == payload
    });
    let Streamed { telemetry, .. } = streamed.expect("a readable log");
    let followed = telemetry.file.read(0, telemetry.file.length());
    assert!(followed.expect("the message").ends_with(&payload));
}

/// Chunks longer than what is kept in memory, with message indexes and without, the first one right before an
/// attachment that is long too.
#[test]
fn long_chunks_are_kept_where_they_are_not_indexed() {
    for is_indexed in [true, false] {
        let options = WriteOptions::new()
            .compression(None)
            .chunk_size(Some(18 * MEBIBYTE as u64))
            .emit_message_indexes(is_indexed);
        let mut writer = options
            .create(io::Cursor::new(Vec::new()))
            .expect("a writer");
        let channel = writer
            .add_channel(0, "/camera", "raw", &Default::default())
            .expect("a channel");
        for sequence in 0..40u32 {
            let header = MessageHeader {
                channel_id: channel,
                sequence,
                log_time: sequence.into(),
                publish_time: 0,
            };
            let frame = vec![sequence as u8; MEBIBYTE];
            writer
                .write_to_known_channel(&header, &frame)
                .expect("a message");
        }
        writer.finish().expect("the log is finished");
        let mut parts = Parts::of(&writer.into_inner().into_inner());
        let chunks: Vec<usize> = (0..parts.data.len())
            .filter(|&i| parts.data[i].0 == op::CHUNK)
            .collect();
        assert!(chunks.len() > 1);
        let attachment = (op::ATTACHMENT, attachment(17 * MEBIBYTE));
        parts.data.insert(chunks[1], attachment);
        parts.summary.clear();
        parts.data_section_crc = 0;
        let log = parts.join();
        let streamed = check(&log, &Request::default(), 1_000_000).expect("a readable log");
        assert_eq!(streamed.telemetry.file.length(), 0);
        let room = room(&streamed.original);
        match is_indexed {
            true => assert!(room < MEBIBYTE, "{room}"),
            false => assert!(cfg!(not(unix)) || room < 41 * MEBIBYTE, "{room}"),
        }
        // As if the recorder had been stopped right after the last chunk.
        let data_end = streamed.original.data_end as usize;
        check(&log[..data_end], &Request::default(), 1_000_000);
    }
}

/// A stream of a log that is too long to be held in memory.
fn endless(frames: u64) -> impl Read {
    let log = Shape::with(|options| options.use_chunks(false)).write();
    let end = Records::new(&log[8..log.len() - 8])
        .map(|record| record.expect("a whole record"))
        .find(|record| record.opcode == op::DATA_END)
        .expect("the end")
        .offset;
    let (data, tail) = log.split_at(8 + end);
    let (data, tail) = (data.to_vec(), tail.to_vec());
    let attachment = attachment(4096);
    let attachment = [
        frame(op::ATTACHMENT, attachment.len() + 64 * MEBIBYTE),
        attachment,
    ]
    .concat();
    let message = MessageHeader {
        channel_id: 2,
        sequence: 0,
        log_time: 2_000_000_000,
        publish_time: 0,
    };
    let message = serialize(&message);
    let message = [frame(op::MESSAGE, message.len() + 4 * MEBIBYTE), message].concat();
    let mut images: Box<dyn Read> = Box::new(io::empty());
    for _ in 0..frames {
        let image = io::Cursor::new(message.clone());
        images = Box::new(images.chain(image.chain(io::repeat(1).take(4 * MEBIBYTE as u64))));
    }
    io::Cursor::new(data)
        .chain(io::Cursor::new(attachment))
        .chain(io::repeat(7).take(64 * MEBIBYTE as u64))
        .chain(images)
        .chain(io::Cursor::new(tail))
}

#[test]
fn memory_and_disk_space_do_not_grow_with_the_log() {
    let mut filter = StreamFilter::new(&Request::default());
    let mut streamed = None;
    let allocations = allocation_counter::measure(|| {
        let name = Path::new("-");
        let input = Named {
            name,
            stream: endless(16),
        };
        let output = Named {
            name,
            stream: io::sink(),
        };
        streamed = Some(pass_through(input, output, |passing| {
            filter.include(passing)
        }));
    });
    let streamed = streamed.expect("it ran").expect("a readable log");
    assert!(streamed.original.file.length() > 128 * MEBIBYTE as u64);
    assert!(
        allocations.bytes_max < 16 * MEBIBYTE as u64,
        "{allocations:?}"
    );
    assert!(room(&streamed.original) < MEBIBYTE);
    assert!(streamed.telemetry.file.length() < MEBIBYTE as u64);
}

// ---- Streams that fail ----

struct Failing(ErrorKind);

impl Read for Failing {
    fn read(&mut self, _: &mut [u8]) -> io::Result<usize> {
        Err(self.0.into())
    }
}

impl Write for Failing {
    fn write(&mut self, _: &[u8]) -> io::Result<usize> {
        Err(self.0.into())
    }

    fn flush(&mut self) -> io::Result<()> {
        Err(self.0.into())
    }
}

#[test]
fn a_closed_output_is_an_error_that_names_it() {
    let log = Shape::default().write();
    let input = Named {
        name: Path::new("the input"),
        stream: &log[..],
    };
    let output = Named {
        name: Path::new("the output"),
        stream: Failing(ErrorKind::BrokenPipe),
    };
    let error = pass_through(input, output, |_| true).expect_err("an error");
    let text = error.to_string();
    assert!(text.starts_with("the output: cannot write: "), "{text}");
    assert!(
        matches!(error, ReadError::Io { source, .. } if source.kind() == ErrorKind::BrokenPipe)
    );
}

#[test]
fn an_input_that_fails_is_an_error_and_not_the_end_of_the_log() {
    let log = Shape::default().write();
    let input = log[..log.len() / 2].chain(Failing(ErrorKind::ConnectionReset));
    let (_, streamed) = pipe(Path::new("the input"), input, |_| true);
    let text = streamed.expect_err("an error").to_string();
    assert!(text.starts_with("the input: cannot read: "), "{text}");
}
