//! Logs as changed by other programs or by bad disks.

use std::{collections::BTreeMap, io::Cursor};

use flightcam::{
    log::record::{parse, push_record, serialize},
    messages::v1::OriginalTail,
};
use mcap::{
    MessageStream, Summary, WriteOptions,
    records::{AttachmentHeader, AttachmentIndex, Metadata, MetadataIndex, Statistics, op},
};
use prost::Message as _;
use sha2::{Digest, Sha256};

use super::{Parts, original_tail};

/// All that a log has, written anew by the official writer.
pub fn written_anew(log: &[u8]) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    let options = WriteOptions::new().compression_threads(0);
    let mut writer = options.create(&mut file).expect("a writer");
    for message in MessageStream::new(log).expect("a readable log") {
        let message = message.expect("a message");
        writer.write(&message).expect("it is written");
    }
    let summary = Summary::read(log).expect("readable").expect("a summary");
    for index in &summary.metadata_indexes {
        let metadata = mcap::read::metadata(log, index).expect("a metadata record");
        writer.write_metadata(&metadata).expect("it is written");
    }
    for index in &summary.attachment_indexes {
        let attachment = mcap::read::attachment(log, index).expect("an attachment");
        writer.attach(&attachment).expect("it is written");
    }
    writer.finish().expect("the log is finished");
    drop(writer);
    file.into_inner()
}

/// As `mcap add attachment` leaves a log: all data stays, one record follows it, and the summary is new.
pub fn with_attachment(log: &[u8]) -> Vec<u8> {
    let header = AttachmentHeader {
        log_time: 1,
        create_time: 2,
        name: "notes.txt".into(),
        media_type: "text/plain".into(),
    };
    let mut parts = Parts::of(log);
    attach(&mut parts, header, b"windy");
    count(&mut parts, |statistics| statistics.attachment_count += 1);
    parts.join()
}

/// As `mcap add metadata` leaves a log.
pub fn with_metadata(log: &[u8]) -> Vec<u8> {
    let metadata = Metadata {
        name: "pilot".into(),
        metadata: BTreeMap::from([("name".into(), "Amelia".into())]),
    };
    let mut parts = Parts::of(log);
    let (offset, length) = add(&mut parts, op::METADATA, serialize(&metadata));
    let index = MetadataIndex {
        offset,
        length,
        name: metadata.name,
    };
    parts.summary.push((op::METADATA_INDEX, serialize(&index)));
    count(&mut parts, |statistics| statistics.metadata_count += 1);
    parts.join()
}

/// An enriched log with something wrong about its original. All else is right, checksums and summary too.
pub fn with_tail(enriched: &[u8], change: impl FnOnce(&mut OriginalTail)) -> Vec<u8> {
    let mut tail = original_tail(enriched);
    change(&mut tail);
    with_last_attachment(enriched, |_| {}, &tail)
}

/// The end of a log, in an attachment that says that the log's data ends at `start`.
pub fn with_end(enriched: &[u8], start: usize, end: &[u8]) -> Vec<u8> {
    with_tail(enriched, |tail| {
        let data = &enriched[..start];
        tail.data_end = start as u64;
        tail.tail_length = end.len() as u64;
        tail.head_sha256 = Sha256::digest(&data[..start.min(65536)]).to_vec();
        tail.foot_sha256 = Sha256::digest(&data[start.saturating_sub(65536)..]).to_vec();
        tail.tail_sha256 = Sha256::digest(end).to_vec();
        tail.tail_zstd = zstd::encode_all(end, 1).expect("compressed");
    })
}

/// An enriched log into which something else was put, before the record that ends what flightcam added.
pub fn with_record_inside(enriched: &[u8], opcode: u8, body: Vec<u8>) -> Vec<u8> {
    let put = |parts: &mut Parts| {
        add(parts, opcode, body);
    };
    with_last_attachment(enriched, put, &original_tail(enriched))
}

/// With the attachment at the end of the data written anew, after other records.
fn with_last_attachment(
    enriched: &[u8],
    put_before: impl FnOnce(&mut Parts),
    tail: &OriginalTail,
) -> Vec<u8> {
    let mut parts = Parts::of(enriched);
    let (opcode, attachment) = parts.data.pop().expect("a record");
    assert_eq!(opcode, op::ATTACHMENT);
    let index = (parts.summary.iter()).rposition(|(opcode, _)| *opcode == op::ATTACHMENT_INDEX);
    parts.summary.remove(index.expect("its index"));
    put_before(&mut parts);
    let header = parse(&attachment).expect("an attachment");
    attach(&mut parts, header, &tail.encode_to_vec());
    parts.join()
}

fn attach(parts: &mut Parts, header: AttachmentHeader, content: &[u8]) {
    let mut body = serialize(&header);
    body.extend_from_slice(&(content.len() as u64).to_le_bytes());
    body.extend_from_slice(content);
    let crc = crc32fast::hash(&body);
    body.extend_from_slice(&crc.to_le_bytes());
    let (offset, length) = add(parts, op::ATTACHMENT, body);
    let index = AttachmentIndex {
        offset,
        length,
        log_time: header.log_time,
        create_time: header.create_time,
        data_size: content.len() as u64,
        name: header.name,
        media_type: header.media_type,
    };
    parts
        .summary
        .push((op::ATTACHMENT_INDEX, serialize(&index)));
}

/// Adds a record to the data; returns its offset.
fn add(parts: &mut Parts, opcode: u8, body: Vec<u8>) -> (u64, u64) {
    let mut data = mcap::MAGIC.to_vec();
    for (opcode, body) in &parts.data {
        push_record(&mut data, *opcode, body);
    }
    let offset = data.len();
    push_record(&mut data, opcode, &body);
    parts.data.push((opcode, body));
    parts.data_section_crc = 0;
    (offset as u64, (data.len() - offset) as u64)
}

fn count(parts: &mut Parts, change: impl FnOnce(&mut Statistics)) {
    let mut records = parts.summary.iter_mut();
    let statistics = records.find(|(opcode, _)| *opcode == op::STATISTICS);
    let (_, body) = statistics.expect("statistics");
    let mut counted = parse(body).expect("statistics");
    change(&mut counted);
    *body = serialize(&counted);
}
