//! The interleaved layout, and a judge of results in it.

use flightcam::{Options, Report, writer::Layout};
use mcap::{
    Summary,
    records::{ChunkIndex, MessageIndexEntry, op},
};

use super::{
    DERIVED, Parts, ReadMessage, check_index_leads_to, enrich_bytes, enrich_bytes_with, judge,
    options, original_tail, recount, stream,
};

/// The interleaved layout, all else by default.
pub fn interleaved() -> Options {
    options().layout(Layout::Interleaved)
}

/// Interleaves a log in memory.
pub fn interleave(log: &[u8]) -> (Vec<u8>, Report) {
    enrich_bytes_with(log, &interleaved()).expect("a result")
}

pub fn summary_of(log: &[u8]) -> Summary {
    let summary = Summary::read(log).expect("a readable summary");
    summary.expect("a summary")
}

/// A chunk of a result.
pub struct Chunk {
    pub index: ChunkIndex,
    messages: Vec<Held>,
}

struct Held {
    topic: String,
    channel_id: u16,
    log_time: u64,
}

impl Chunk {
    /// Whether flightcam's messages are in it.
    pub fn is_derived(&self) -> bool {
        let is_derived = |topic: &str| DERIVED.contains(&topic);
        let derived = (self.messages.iter()).filter(|message| is_derived(&message.topic));
        let count = derived.count();
        assert!(count == 0 || count == self.messages.len());
        count > 0
    }

    /// The earliest log time in it.
    fn start(&self) -> Option<u64> {
        self.messages.iter().map(|message| message.log_time).min()
    }
}

/// The chunks of a result, in the order of the file.
pub fn chunks(result: &[u8]) -> Vec<Chunk> {
    let summary = summary_of(result);
    let mut indexes = summary.chunk_indexes.clone();
    assert!(indexes.is_sorted_by_key(|index| index.chunk_start_offset));
    indexes.sort_by_key(|index| index.chunk_start_offset);
    let chunks = indexes.into_iter().map(|index| {
        let messages = summary.stream_chunk(result, &index).expect("a chunk");
        let messages = messages.map(|message| {
            let message = message.expect("a message");
            Held {
                topic: message.channel.topic.clone(),
                channel_id: message.channel.id,
                log_time: message.log_time,
            }
        });
        Chunk {
            messages: messages.collect(),
            index,
        }
    });
    chunks.collect()
}

/// Checks all that an interleaved result promises. The log up to its data section's end is `data`.
pub fn judge_interleaved(log: &[u8], torn: bool, result: &[u8], report: &Report) {
    let (appended, _) = enrich_bytes(log).expect("the same log in the other layout");
    let expected = judge(log, &appended, torn);
    let data = &log[..original_tail(&appended).data_end as usize];

    // Both are read with all checksums checked.
    let original = stream(if torn { data } else { log }, torn);
    let all = stream(result, false);
    let is_derived = |message: &ReadMessage| DERIVED.contains(&message.topic.as_str());
    let (derived, kept): (Vec<ReadMessage>, Vec<ReadMessage>) =
        all.iter().cloned().partition(is_derived);
    assert!(
        kept == original,
        "every original message is there, in its order"
    );
    assert!(
        derived == expected,
        "what is derived does not depend on the layout"
    );

    let summary = summary_of(result);
    assert_eq!(summary.stats.as_ref(), Some(&recount(result)));
    check_index_leads_to(all, result);

    let chunks = chunks(result);
    check_indexes(&summary, result, &chunks);
    check_places(&chunks);
    check_records(data, result, report);
    assert_eq!(report.bytes_added, result.len() as i64 - log.len() as i64);
    check_attachments(data, &summary, result);
    if !torn {
        let checksums = [log, result].map(|log| Parts::of(log).data_section_crc != 0);
        assert_eq!(checksums[0], checksums[1]);
    }
}

/// Every message is in a message index, right after its chunk.
fn check_indexes(summary: &Summary, result: &[u8], chunks: &[Chunk]) {
    for Chunk { index, messages } in chunks {
        if messages.is_empty() {
            assert!(index.message_index_offsets.is_empty());
            continue;
        }
        let indexes = summary.read_message_indexes(result, index);
        let mut indexed: Vec<(u16, u64)> = (indexes.expect("message indexes").into_iter())
            .flat_map(|(channel, entries)| {
                let of_channel = move |entry: MessageIndexEntry| (channel.id, entry.log_time);
                entries.into_iter().map(of_channel)
            })
            .collect();
        let mut held: Vec<(u16, u64)> = (messages.iter())
            .map(|message| (message.channel_id, message.log_time))
            .collect();
        indexed.sort_unstable();
        held.sort_unstable();
        assert!(indexed == held);
        let first = index.message_index_offsets.values().min();
        let end = index.chunk_start_offset + index.chunk_length;
        assert!(first.is_none_or(|&first| first == end));
    }
}

/// A derived message comes after every chunk that has anything as early, and before all others.
fn check_places(chunks: &[Chunk]) {
    for (place, chunk) in chunks.iter().enumerate() {
        if !chunk.is_derived() {
            continue;
        }
        let others = |chunks: &[Chunk]| -> Vec<u64> {
            let others = chunks.iter().filter(|chunk| !chunk.is_derived());
            others.filter_map(Chunk::start).collect()
        };
        let before = others(&chunks[..place]);
        let after = others(&chunks[place + 1..]);
        for message in &chunk.messages {
            let time = message.log_time;
            assert!(after.iter().all(|&start| start > time));
            assert!(before.last().is_none_or(|&start| start <= time));
        }
    }
}

/// The records of the log's data, with the messages outside chunks left out, are those of the result, in their
/// order, and verbatim; besides there are only chunks, their indexes, and what says how they were made.
fn check_records(data: &[u8], result: &[u8], report: &Report) {
    let is_kept = |(opcode, _): &(u8, &[u8])| *opcode != op::MESSAGE;
    let mut kept = Parts::records(data).filter(is_kept).peekable();
    let mut bytes = mcap::MAGIC.len();
    for (opcode, body) in &Parts::of(result).data {
        if (kept.next_if(|next| *next == (*opcode, &body[..]))).is_some() {
            bytes += 9 + body.len();
            continue;
        }
        match *opcode {
            op::CHUNK | op::MESSAGE_INDEX => {}
            op::METADATA => assert!(kept.peek().is_none(), "it comes last"),
            other => panic!("a record with opcode {other:#x} was added"),
        }
    }
    assert!(kept.next().is_none(), "every record is there");
    assert_eq!(report.bytes_kept, bytes as u64);
}

/// The result's index leads to the log's attachments and Metadata records.
fn check_attachments(data: &[u8], summary: &Summary, result: &[u8]) {
    let count = |opcode| {
        Parts::records(data)
            .filter(|record| record.0 == opcode)
            .count()
    };
    assert_eq!(summary.attachment_indexes.len(), count(op::ATTACHMENT));
    assert_eq!(summary.metadata_indexes.len(), count(op::METADATA) + 1);
    let mut attachments = Parts::records(data).filter(|record| record.0 == op::ATTACHMENT);
    for index in &summary.attachment_indexes {
        let attachment = mcap::read::attachment(result, index).expect("an attachment");
        assert_eq!(attachment.name, index.name);
        let (_, body) = attachments.next().expect("they are as many");
        let found = &result[index.offset as usize..][..index.length as usize];
        assert_eq!(&found[9..], body);
    }
    for index in &summary.metadata_indexes {
        let metadata = mcap::read::metadata(result, index).expect("a Metadata record");
        assert_eq!(metadata.name, index.name);
    }
}
