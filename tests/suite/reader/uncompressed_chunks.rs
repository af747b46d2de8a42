//! Of uncompressed chunks only the telemetry is read, as far as their message indexes are true.

use flightcam::log::{
    Log,
    record::{parse, serialize},
};
use mcap::{
    Compression,
    records::{ChunkIndex, MessageIndex, op},
};

use crate::support::{
    Parts,
    folder::{Folder, LOG},
    numbered::*,
};

/// A log of which a small part is telemetry, in uncompressed chunks of a few messages each. Between some of them are
/// long frames, between some short ones, and after the last there is little else.
fn uncompressed_flight() -> (Vec<Message>, Vec<u8>) {
    let mut messages = flight(239, 30_000);
    for frame in messages.iter_mut().skip(3).step_by(8) {
        frame.padding = 500;
    }
    let log = write(chunks_of(200_000, None), &messages);
    assert!(chunk_indexes(&log).len() > 3);
    (messages, log)
}

/// Where the records of a channel's messages are in a chunk.
fn places(log: &[u8], chunk: &ChunkIndex, content: Content) -> Vec<usize> {
    let index = chunk.message_index_offsets[&content.channel_id()] as usize;
    let length = u64::from_le_bytes(log[index + 1..][..8].try_into().expect("a length"));
    let index: MessageIndex = parse(&log[index + 9..][..length as usize]).expect("an index");
    // Of the chunk's record before its content.
    let header = 9 + 8 + 8 + 8 + 4 + 4 + 8;
    let places = index.records.iter().map(|entry| entry.offset);
    places
        .map(|offset| (chunk.chunk_start_offset + header + offset) as usize)
        .collect()
}

/// The bytes of the n-th entry of a message index at the start of `record`: a time and an offset.
fn entry(record: &mut [u8], n: usize) -> &mut [u8] {
    &mut record[9 + 2 + 4 + 16 * n..][..16]
}

/// Spoils the frames of a log's chunks.
fn spoil_frames(log: &mut [u8], chunks: &[ChunkIndex]) {
    for chunk in chunks {
        for place in places(log, chunk, Content::Frame) {
            log[place..][..500].fill(0xc5);
        }
    }
}

#[test]
fn only_the_telemetry_of_an_uncompressed_chunk_is_read() {
    let (messages, mut log) = uncompressed_flight();
    let chunks = chunk_indexes(&log);
    spoil_frames(&mut log, &chunks);
    let (samples, outcome) = read(&log, PROFILE);
    outcome.expect("the frames are not read");
    assert_eq!(samples, sorted(&messages, LOGGED));
}

#[test]
fn a_chunk_of_mostly_telemetry_is_read_whole_and_checked() {
    let messages = flight(239, 600);
    let mut log = write(chunks_of(20_000, None), &messages);
    let chunks = chunk_indexes(&log);
    spoil_frames(&mut log, &chunks);
    let (_, outcome) = read(&log, PROFILE);
    let error = outcome.expect_err("damage").to_string();
    assert!(error.contains("checksum"), "{error}");
}

#[test]
fn the_first_messages_of_channels_are_those_of_the_file() {
    let contents = [Content::Attitude, Content::Velocity, Content::Frame];
    let messages = flight(60, 20_000);
    for compression in [None, Some(Compression::Zstd)] {
        let folder = Folder::with(LOG, write(chunks_of(100_000, compression), &messages));
        let log = Log::open(&folder.path(LOG)).expect("a log");
        let channel_ids = contents.map(Content::channel_id).into();
        let payloads = log.first_payloads(&channel_ids, 3).expect("messages");
        let expected = channel_ids.iter().map(|&id| {
            let of_channel = messages
                .iter()
                .enumerate()
                .filter(|(_, message)| message.content.channel_id() == id);
            let payloads = of_channel.map(|(n, message)| message.payload(n));
            (id, payloads.take(3).collect())
        });
        assert_eq!(payloads, expected.collect());
    }
}

/// What may be wrong with the message index of the attitude, given that of the frames.
type Lie = fn(attitude: &mut [u8], frames: &mut [u8], chunk: &ChunkIndex);

const LIES: [(&str, Lie); 10] = [
    ("far outside the chunk", |index, _, _| {
        entry(index, 1)[8..].fill(0xff);
    }),
    ("at the end of the chunk", |index, _, chunk| {
        entry(index, 1)[8..].copy_from_slice(&chunk.uncompressed_size.to_le_bytes());
    }),
    ("after the start of a record", |index, _, _| {
        entry(index, 1)[8] ^= 1;
    }),
    ("at a message of another channel", |index, frames, _| {
        entry(index, 1).copy_from_slice(entry(frames, 1));
    }),
    ("at another time", |index, _, _| entry(index, 1)[0] ^= 1),
    ("twice the same message", |index, _, _| {
        let first = entry(index, 0).to_vec();
        entry(index, 1).copy_from_slice(&first);
    }),
    ("of another channel", |index, _, _| {
        index[9..11].copy_from_slice(&Content::Frame.channel_id().to_le_bytes());
    }),
    ("shorter than the record", |index, _, _| index[11] -= 16),
    ("longer than the record", |index, _, _| index[11] += 16),
    ("not a message index", |index, _, _| {
        index[0] = op::CHUNK_INDEX
    }),
];

#[test]
fn a_false_message_index_is_not_believed() {
    let (messages, honest) = uncompressed_flight();
    let chunks = chunk_indexes(&honest);
    for (lie, tell) in LIES {
        let mut log = honest.clone();
        for chunk in &chunks {
            let [attitude, frames] = [Content::Attitude, Content::Frame]
                .map(|content| chunk.message_index_offsets[&content.channel_id()] as usize);
            let mut index_of_frames = log[frames..].to_vec();
            tell(&mut log[attitude..], &mut index_of_frames, chunk);
        }
        let (samples, outcome) = read(&log, PROFILE);
        outcome.unwrap_or_else(|error| panic!("{lie}: {error}"));
        assert_eq!(samples, sorted(&messages, LOGGED), "{lie}");

        // All of the chunk is read then, and its checksum shows what else is wrong.
        spoil_frames(&mut log, &chunks);
        let (_, outcome) = read(&log, PROFILE);
        let error = outcome.expect_err(lie).to_string();
        assert!(error.contains("checksum"), "{lie}: {error}");
    }
}

#[test]
fn an_incomplete_message_is_an_error() {
    let (_, honest) = uncompressed_flight();
    let chunk = &chunk_indexes(&honest)[0];
    let last = *places(&honest, chunk, Content::Attitude)
        .last()
        .expect("one");
    let no_message = (last..last + 1, 0x90);
    let longer_than_the_chunk = (last + 3..last + 4, 0xff);
    for (bytes, value) in [no_message, longer_than_the_chunk] {
        let mut log = honest.clone();
        log[bytes].fill(value);
        let (_, outcome) = read(&log, PROFILE);
        let error = outcome.expect_err("damage").to_string();
        assert!(error.contains("checksum"), "{error}");
    }
}

#[test]
fn a_summary_that_hides_the_compression_is_not_believed() {
    let messages = flight(120, 30_000);
    for compression in [Compression::Zstd, Compression::Lz4] {
        let mut parts = Parts::of(&write(chunks_of(200_000, Some(compression)), &messages));
        for (opcode, body) in &mut parts.summary {
            if *opcode == op::CHUNK_INDEX {
                let index: ChunkIndex = parse(body).expect("a chunk index");
                let compression = String::new();
                *body = serialize(&ChunkIndex {
                    compression,
                    ..index
                });
            }
        }
        let (samples, outcome) = read(&parts.join(), PROFILE);
        outcome.expect("a readable log");
        assert_eq!(samples, sorted(&messages, LOGGED));
    }
}
