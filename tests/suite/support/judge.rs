//! Checks of results with the official reader.

use std::collections::BTreeMap;

use flightcam::messages::v1::OriginalTail;
use mcap::{
    Summary,
    records::{Record, Statistics, op},
    sans_io::{
        IndexedReadEvent, IndexedReader, LinearReadEvent, LinearReader, LinearReaderOptions,
    },
};
use prost::Message as _;
use sha2::{Digest, Sha256};

use super::{Parts, ReadMessage, Shape, enrich_bytes};

/// The topics that enriching adds.
pub const DERIVED: [&str; 3] = [
    "/camera/relative_rpy",
    "/camera/orientation",
    "/camera/velocity",
];

/// Every message in the order of the file, read as a stream, with all checksums checked.
pub fn stream(log: &[u8], torn: bool) -> Vec<ReadMessage> {
    let mut channels = BTreeMap::new();
    let mut messages = Vec::new();
    each_record(log, torn, |record| match record {
        Record::Channel(channel) => {
            channels.insert(channel.id, (channel.topic, channel.message_encoding));
        }
        Record::Message { header, data } => {
            let (topic, encoding) = &channels[&header.channel_id];
            messages.push(ReadMessage::new(topic, encoding, &header, &data));
        }
        _ => {}
    });
    messages
}

/// Every record, those inside chunks included.
pub fn each_record(log: &[u8], torn: bool, mut take: impl FnMut(Record)) {
    let mut reader = LinearReader::new_with_options(
        LinearReaderOptions::default()
            .with_validate_chunk_crcs(true)
            .with_validate_data_section_crc(true)
            .with_validate_summary_section_crc(true)
            .with_check_finishes_after_end_magic(true),
    );
    let mut rest = log;
    while let Some(event) = reader.next_event() {
        match event {
            Ok(LinearReadEvent::ReadRequest(wanted)) => {
                let (head, tail) = rest.split_at(wanted.min(rest.len()));
                reader.insert(head.len()).copy_from_slice(head);
                reader.notify_read(head.len());
                rest = tail;
            }
            Ok(LinearReadEvent::Record { data, opcode }) => {
                take(mcap::parse_record(opcode, data).expect("a record that parses"));
            }
            Err(_) if torn => return,
            Err(error) => panic!("the official reader refuses the log: {error}"),
        }
    }
}

/// Every message in time order, read through the index.
pub fn indexed(log: &[u8]) -> Vec<ReadMessage> {
    let summary = Summary::read(log)
        .expect("a readable summary")
        .expect("a summary");
    let mut reader = IndexedReader::new(&summary).expect("an index");
    let mut messages = Vec::new();
    while let Some(event) = reader.next_event() {
        match event.expect("a readable log") {
            IndexedReadEvent::ReadChunkRequest { offset, length } => {
                let chunk = &log[offset as usize..][..length];
                reader
                    .insert_chunk_record_data(offset, chunk)
                    .expect("a readable chunk");
            }
            IndexedReadEvent::Message { header, data } => {
                let channel = &summary.channels[&header.channel_id];
                let (topic, encoding) = (&channel.topic, &channel.message_encoding);
                messages.push(ReadMessage::new(topic, encoding, &header, data));
            }
        }
    }
    messages
}

/// Statistics counted over the data section.
pub fn recount(log: &[u8]) -> Statistics {
    let mut count = Statistics::default();
    let (mut schemas, mut channels) = (BTreeMap::new(), BTreeMap::new());
    let mut times: Option<(u64, u64)> = None;
    let mut ended = false;
    each_record(log, false, |record| match record {
        Record::DataEnd(_) => ended = true,
        _ if ended => {}
        Record::Schema { header, .. } => {
            schemas.insert(header.id, ());
        }
        Record::Channel(channel) => {
            channels.insert(channel.id, ());
        }
        Record::Message { header, .. } => {
            count.message_count += 1;
            *count
                .channel_message_counts
                .entry(header.channel_id)
                .or_default() += 1;
            let (start, end) = times.unwrap_or((header.log_time, header.log_time));
            times = Some((start.min(header.log_time), end.max(header.log_time)));
        }
        Record::Attachment { .. } => count.attachment_count += 1,
        Record::Metadata(_) => count.metadata_count += 1,
        _ => {}
    });
    count.schema_count = schemas.len() as u16;
    count.channel_count = channels.len() as u32;
    (count.message_start_time, count.message_end_time) = times.unwrap_or_default();
    count.chunk_count = Parts::of(log)
        .data
        .iter()
        .filter(|(opcode, _)| *opcode == op::CHUNK)
        .count() as u32;
    count
}

/// The original's end, as a result carries it.
pub fn original_tail(result: &[u8]) -> OriginalTail {
    let summary = Summary::read(result)
        .expect("a readable summary")
        .expect("a summary");
    let index = summary
        .attachment_indexes
        .iter()
        .find(|index| index.name == "flightcam/original_tail")
        .expect("the attachment");
    let attachment = mcap::read::attachment(result, index).expect("a readable attachment");
    OriginalTail::decode(&attachment.data[..]).expect("an OriginalTail")
}

/// Checks all that a result promises, whatever the log's shape; returns the derived messages.
pub fn judge(log: &[u8], result: &[u8], torn: bool) -> Vec<ReadMessage> {
    let tail = original_tail(result);
    let data_end = tail.data_end as usize;
    assert!(
        result[..data_end] == log[..data_end],
        "the original bytes are unchanged"
    );

    let restored_tail = zstd::decode_all(&tail.tail_zstd[..]).expect("a zstd frame");
    assert_eq!(restored_tail.len() as u64, tail.tail_length);
    let restored = [&result[..data_end], &restored_tail].concat();
    assert!(
        restored == log,
        "the original can be given back byte for byte"
    );
    let hashed = data_end.min(64 * 1024);
    assert_eq!(tail.head_sha256, Sha256::digest(&log[..hashed]).to_vec());
    assert_eq!(
        tail.foot_sha256,
        Sha256::digest(&log[data_end - hashed..data_end]).to_vec()
    );
    assert_eq!(tail.tail_sha256, Sha256::digest(&restored_tail).to_vec());

    // What can still be read of a torn chunk is in the original's end, not among the records.
    let original = stream(&log[..if torn { data_end } else { log.len() }], torn);
    let all = stream(result, false);
    let (derived, kept): (Vec<ReadMessage>, Vec<ReadMessage>) = all
        .iter()
        .cloned()
        .partition(|message| DERIVED.contains(&message.topic.as_str()));
    assert!(
        kept == original,
        "every original message is there, in its order"
    );
    // Where the clock of the log was set back, so are the times of what is derived.
    let is_in_order = derived.is_sorted_by_key(|message| message.log_time);
    assert!(is_in_order || goes_back(&original));
    for topic in DERIVED {
        let of_topic = derived.iter().filter(|message| message.topic == topic);
        assert!(
            of_topic
                .map(|message| message.sequence)
                .eq(0..count(&derived, topic))
        );
    }

    let summary = Summary::read(result)
        .expect("a readable summary")
        .expect("a summary");
    assert_eq!(summary.stats.as_ref(), Some(&recount(result)));
    let loose = Parts::of(result)
        .data
        .iter()
        .any(|(opcode, _)| *opcode == op::MESSAGE);
    assert_eq!(
        summary.chunk_indexes.is_empty(),
        loose,
        "an index, unless it would hide messages outside chunks"
    );
    if !loose {
        check_index_leads_to(all, result);
    }
    derived
}

fn count(messages: &[ReadMessage], topic: &str) -> u32 {
    messages
        .iter()
        .filter(|message| message.topic == topic)
        .count() as u32
}

/// The derived messages of the messages that every [`Shape`] has.
pub fn expected_of_any_shape() -> Vec<ReadMessage> {
    let log = Shape::default().write();
    let (result, _) = enrich_bytes(&log).expect("a log of the usual shape");
    judge(&log, &result, false)
}

/// Checks that the index of a log leads to all of its messages, in the order of their times.
#[track_caller]
pub fn check_index_leads_to(mut all: Vec<ReadMessage>, log: &[u8]) {
    let mut by_index = indexed(log);
    assert!(by_index.is_sorted_by_key(|message| message.log_time));
    by_index.sort();
    all.sort();
    assert!(by_index == all, "the index leads to every message");
}

/// Whether the times on a topic go back, in the order of the file.
fn goes_back(messages: &[ReadMessage]) -> bool {
    let topics: std::collections::BTreeSet<&str> = messages
        .iter()
        .map(|message| message.topic.as_str())
        .collect();
    topics.into_iter().any(|topic| {
        let of_topic = messages.iter().filter(|message| message.topic == topic);
        !of_topic.is_sorted_by_key(|message| message.log_time)
    })
}
