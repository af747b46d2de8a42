//! A log that claims records of others as flightcam's: undoing would lose them, so it is refused, and left as it is.

use flightcam::{
    Output, Watch,
    log::record::{FRAME_LENGTH, parse, push_record, serialize},
    restore,
};
use mcap::records::{
    Channel, ChunkHeader, ChunkIndex, MessageHeader, MessageIndex, MessageIndexEntry, op,
};

use crate::support::{folder::*, forging::*, rewriting::*, shapes::*, *};

/// Checks that neither restoring nor enriching changes a log or makes another of it.
#[track_caller]
fn is_refused(log: impl AsRef<[u8]>) {
    is_refused_with(
        log,
        "another program has rewritten it since, or it is damaged",
    );
}

#[track_caller]
fn is_refused_with(log: impl AsRef<[u8]>, message: &str) {
    let folder = Folder::with(LOG, log);
    for command in [
        "restore",
        "restore -o original.mcap",
        "enrich --depression 60",
        "enrich --depression 60 --in-place",
    ] {
        folder.refuses(&format!("{command} {LOG}"), 1, message);
    }
}

/// Logs of each kind as enriching leaves them: with messages in chunks, in chunks that were not indexed, and outside.
fn enriched_logs() -> Vec<(Vec<u8>, Vec<u8>)> {
    let shapes = [
        Shape::default(),
        Shape::with(|options| options.emit_message_indexes(false)),
        Shape::with(|options| options.use_chunks(false)),
    ];
    let logs = shapes.map(|shape| {
        Shape {
            messages: 40,
            attachment_and_metadata: true,
            ..shape
        }
        .write()
    });
    logs.into_iter()
        .map(|log| {
            let (enriched, _) = enrich_bytes(&log).expect("a result");
            (log, enriched)
        })
        .collect()
}

/// The enriched log with other records after the original's data, whose last one stays the attachment. It is cut short
/// there, because a summary would not be that of these records.
fn with_added(enriched: &[u8], change: impl FnOnce(&mut Vec<(u8, Vec<u8>)>)) -> Vec<u8> {
    let start = original_tail(enriched).data_end as usize;
    let mut parts = Parts::of(enriched);
    let mut position = mcap::MAGIC.len();
    let own = parts.data.iter().take_while(|(_, body)| {
        let is_before = position < start;
        position += FRAME_LENGTH + body.len();
        is_before
    });
    let own = own.count();
    let mut added = parts.data.split_off(own);
    change(&mut added);
    let mut log = mcap::MAGIC.to_vec();
    for (opcode, body) in parts.data.iter().chain(&added) {
        push_record(&mut log, *opcode, body);
    }
    log
}

#[test]
fn a_log_whose_added_records_are_as_they_were_is_restored() {
    for (log, enriched) in enriched_logs() {
        let folder = Folder::with(LOG, with_added(&enriched, |_| {}));
        let restored = restore(folder.path(LOG), Output::InPlace, &Watch::default());
        restored.expect("the original");
        assert!(folder.read(LOG) == log);
    }
}

#[test]
fn a_run_of_foreign_messages_across_the_claimed_start_is_refused() {
    if let Some(log) = hostile_log("forged-tail.mcap") {
        is_refused(log);
    }
}

#[test]
fn a_start_that_claims_messages_of_others_is_refused() {
    for (log, enriched) in enriched_logs() {
        let data_end = original_tail(&enriched).data_end as usize;
        let mut starts = Vec::new();
        let mut position = mcap::MAGIC.len();
        for (opcode, body) in Parts::records(&enriched[..data_end]) {
            if matches!(opcode, op::MESSAGE | op::CHUNK | op::ATTACHMENT) {
                starts.push(position);
                // In the middle of a record.
                starts.push(position + FRAME_LENGTH + body.len() / 2);
            }
            position += FRAME_LENGTH + body.len();
        }
        for start in starts.iter().rev().take(6).chain(&starts[..2]) {
            is_refused(with_end(&enriched, *start, &log[data_end..]));
        }
    }
}

#[test]
fn a_start_after_the_first_of_what_was_added_is_refused() {
    for (log, enriched) in enriched_logs() {
        let data_end = original_tail(&enriched).data_end as usize;
        let mut position = data_end;
        for record in flightcam::log::record::Records::new(&enriched[data_end..]) {
            let record = record.expect("a whole record");
            position += FRAME_LENGTH + record.body.len();
            // A log may have the schema without the topic.
            if matches!(record.opcode, op::CHANNEL | op::CHUNK) {
                is_refused(with_end(&enriched, position, &log[data_end..]));
            }
            if matches!(record.opcode, op::CHUNK | op::METADATA) {
                break;
            }
        }
    }
}

fn foreign_message() -> Vec<u8> {
    let mut body = serialize(&MessageHeader {
        channel_id: 2,
        sequence: 0,
        log_time: 1_000_000_000,
        publish_time: 0,
    });
    body.extend_from_slice(b"{}");
    body
}

/// The records of a chunk.
fn records_of(chunk: &[u8]) -> (ChunkHeader, Vec<(u8, Vec<u8>)>) {
    let header: ChunkHeader = parse(chunk).expect("a chunk");
    let compressed = &chunk[chunk.len() - header.compressed_size as usize..];
    let content = zstd::decode_all(compressed).expect("its content");
    let records = flightcam::log::record::Records::new(&content);
    let records = records.map(|record| record.expect("a whole record"));
    let records = records.map(|record| (record.opcode, record.body.to_vec()));
    (header, records.collect())
}

/// A chunk of these records, and its message indexes.
fn chunk_with_indexes(header: ChunkHeader, records: &[(u8, Vec<u8>)]) -> Vec<(u8, Vec<u8>)> {
    let mut content = Vec::new();
    let mut entries: std::collections::BTreeMap<u16, Vec<MessageIndexEntry>> = Default::default();
    for (opcode, body) in records {
        if *opcode == op::MESSAGE {
            let message: MessageHeader = parse(body).expect("a message");
            let of_channel = entries.entry(message.channel_id).or_default();
            let (log_time, offset) = (message.log_time, content.len() as u64);
            of_channel.push(MessageIndexEntry { log_time, offset });
        }
        push_record(&mut content, *opcode, body);
    }
    let chunk = (op::CHUNK, chunk_of(header, &content));
    let indexes = entries.into_iter().map(|(channel_id, records)| {
        (
            op::MESSAGE_INDEX,
            serialize(&MessageIndex {
                channel_id,
                records,
            }),
        )
    });
    std::iter::once(chunk).chain(indexes).collect()
}

/// An enriched log whose first new chunk has other records.
fn with_records_of_our_chunk(
    enriched: &[u8],
    change: impl FnOnce(&mut Vec<(u8, Vec<u8>)>),
) -> Vec<u8> {
    with_added(enriched, |added| {
        let chunk = added
            .iter()
            .position(|(opcode, _)| *opcode == op::CHUNK)
            .expect("a chunk");
        let (header, mut records) = records_of(&added[chunk].1);
        change(&mut records);
        let indexes = added[chunk + 1..]
            .iter()
            .take_while(|(opcode, _)| *opcode == op::MESSAGE_INDEX);
        let end = chunk + 1 + indexes.count();
        added.splice(chunk..end, chunk_with_indexes(header, &records));
    })
}

#[test]
fn a_foreign_record_in_a_new_chunk_is_refused() {
    let (log, enriched) = &enriched_logs()[0];
    let folder = Folder::with(LOG, with_records_of_our_chunk(enriched, |_| {}));
    folder.run(&format!("restore {LOG}"), 0);
    assert!(folder.read(LOG) == *log, "a chunk is judged by its content");

    is_refused(with_records_of_our_chunk(enriched, |records| {
        records.push((op::MESSAGE, foreign_message()));
    }));
    is_refused(with_records_of_our_chunk(enriched, |records| {
        records.push((0x80, b"private".to_vec()));
    }));
    let channel = |id, topic: &str| Channel {
        id,
        schema_id: 0,
        topic: topic.into(),
        message_encoding: "json".into(),
        metadata: Default::default(),
    };
    // A topic of another program; one of ours, defined twice; one of ours, with an id of the log's own.
    for channel in [
        channel(77, "/other"),
        channel(77, "/camera/velocity"),
        channel(2, "/camera/velocity"),
    ] {
        is_refused(with_records_of_our_chunk(enriched, |records| {
            records.push((op::CHANNEL, serialize(&channel)));
        }));
    }
    // A schema that none of the channels has.
    is_refused(with_records_of_our_chunk(enriched, |records| {
        let (_, schema) = records
            .iter()
            .find(|(opcode, _)| *opcode == op::SCHEMA)
            .expect("a schema");
        let mut schema = schema.clone();
        schema[..2].copy_from_slice(&99u16.to_le_bytes());
        records.push((op::SCHEMA, schema));
    }));
}

#[test]
fn a_channel_whose_id_the_log_uses_otherwise_is_refused() {
    for (_, enriched) in enriched_logs() {
        let with_the_id = |records: &mut Vec<(u8, Vec<u8>)>| {
            let new = records
                .iter()
                .find(|(opcode, _)| *opcode == op::CHANNEL)
                .expect("a channel")
                .1[..2]
                .to_vec();
            for (opcode, body) in records {
                if matches!(*opcode, op::CHANNEL | op::MESSAGE) && body[..2] == new {
                    body[..2].copy_from_slice(&2u16.to_le_bytes());
                }
            }
        };
        let is_loose = Parts::of(&enriched)
            .data
            .iter()
            .any(|(opcode, _)| *opcode == op::MESSAGE);
        is_refused(match is_loose {
            true => with_added(&enriched, with_the_id),
            false => with_records_of_our_chunk(&enriched, with_the_id),
        });
    }
}

#[test]
fn a_foreign_record_anywhere_among_the_new_ones_is_refused() {
    let metadata = |name: &str| {
        let metadata = mcap::records::Metadata {
            name: name.into(),
            metadata: Default::default(),
        };
        (op::METADATA, serialize(&metadata))
    };
    for (_, enriched) in enriched_logs() {
        let own = Parts::of(&enriched).data;
        let attachment = own
            .iter()
            .find(|(opcode, _)| *opcode == op::ATTACHMENT)
            .expect("an attachment")
            .clone();
        let index = MessageIndex {
            channel_id: 2,
            records: vec![MessageIndexEntry {
                log_time: 1,
                offset: 1,
            }],
        };
        let statistics = (op::STATISTICS, vec![0; 46]);
        let chunk_index = serialize(&ChunkIndex {
            message_start_time: 0,
            message_end_time: 0,
            chunk_start_offset: 0,
            chunk_length: 0,
            message_index_offsets: Default::default(),
            message_index_length: 0,
            compression: String::new(),
            compressed_size: 0,
            uncompressed_size: 0,
        });
        let foreign = [
            (op::MESSAGE, foreign_message()),
            attachment,
            metadata("pilot"),
            metadata("flightcam"),
            (0x80, b"private".to_vec()),
            (0x10, b"of a later version".to_vec()),
            (op::MESSAGE_INDEX, serialize(&index)),
            (op::HEADER, vec![0; 8]),
            (op::CHUNK_INDEX, chunk_index),
            statistics,
        ];
        let places = {
            let mut count = 0;
            with_added(&enriched, |added| count = added.len());
            [0, 1, 2, count - 2, count - 1]
        };
        for record in foreign {
            for place in places {
                is_refused(with_added(&enriched, |added| {
                    added.insert(place, record.clone())
                }));
            }
        }
        // Without one that belongs there. Then nothing says who wrote the topics.
        let undescribed = with_added(&enriched, |added| {
            added.retain(|(opcode, _)| *opcode != op::METADATA);
        });
        let folder = Folder::with(LOG, undescribed);
        folder.refuses(
            &format!("restore {LOG}"),
            1,
            "cannot be restored: another program",
        );
        let taken = "has a topic /camera/relative_rpy, which flightcam did not write";
        folder.refuses(
            &format!("enrich {LOG} --depression 60 --in-place"),
            1,
            taken,
        );
        if own.iter().any(|(opcode, _)| *opcode == op::MESSAGE_INDEX) {
            is_refused(with_added(&enriched, |added| {
                let index = added
                    .iter()
                    .position(|(opcode, _)| *opcode == op::MESSAGE_INDEX);
                added.remove(index.expect("a message index"));
            }));
        }
    }
}

#[test]
fn a_private_record_that_was_added_to_the_summary_is_refused() {
    let (_, enriched) = &enriched_logs()[0];
    let mut parts = Parts::of(enriched);
    parts.summary.push((0x80, b"private".to_vec()));
    is_refused(parts.join());
    let mut parts = Parts::of(enriched);
    let channel = Channel {
        id: 99,
        schema_id: 0,
        topic: "/later".into(),
        message_encoding: "json".into(),
        metadata: Default::default(),
    };
    parts.summary.push((op::CHANNEL, serialize(&channel)));
    is_refused(parts.join());

    // The log's own are restored.
    let mut parts = Parts::of(&Shape::default().write());
    for (opcode, body) in [(0x81, b"one"), (0x80, b"two"), (0x81, b"six")] {
        parts.summary.push((opcode, body.to_vec()));
    }
    let log = parts.join();
    let (enriched, _) = enrich_bytes(&log).expect("a result");
    let folder = Folder::with(LOG, enriched);
    folder.run(&format!("restore {LOG}"), 0);
    assert!(folder.read(LOG) == log);
}

/// What is after the attachment with the original's end is replaced by something else.
#[test]
fn what_is_after_the_data_and_not_from_flightcam_is_not_cut_off() {
    for (log, enriched) in enriched_logs() {
        let whole = Parts::of(&enriched);
        let data: usize = (whole.data.iter())
            .map(|(_, body)| FRAME_LENGTH + body.len())
            .sum();
        let end = mcap::MAGIC.len() + data;
        let data_end = end + FRAME_LENGTH + 4;
        let record = |opcode, body: &[u8]| {
            let mut record = Vec::new();
            push_record(&mut record, opcode, body);
            record
        };
        let message = record(op::MESSAGE, &foreign_message());
        let with = |kept: usize, more: &[&[u8]]| [&enriched[..kept], &more.concat()[..]].concat();
        let private = record(0x80, b"private");
        let definition = record(op::CHANNEL, &whole.summary[0].1);
        for (what, changed) in [
            ("text after the end", with(enriched.len(), &[b"a note"])),
            ("a byte after the end", with(enriched.len(), &[&[0]])),
            ("another log after the end", with(enriched.len(), &[&log])),
            (
                "text after the data",
                with(end, &[b"a note that is longer than a frame"]),
            ),
            (
                "text after DataEnd",
                with(data_end, &[b"a note that is longer than a frame"]),
            ),
            (
                "a definition, then text",
                with(data_end, &[&definition, b"a note that is long"]),
            ),
            ("a private record", with(data_end, &[&private])),
            (
                "a private record, cut short",
                with(data_end, &[&private[..12]]),
            ),
            (
                "a longer DataEnd",
                with(end, &[&record(op::DATA_END, &[0; 40])]),
            ),
        ] {
            println!("{what}");
            is_refused(changed);
        }
        let message_after_zeros = with(data_end, &[&[0; 9], &message]);
        is_refused_with(message_after_zeros, "the log goes on after it");
        for opcode in [op::STATISTICS, op::CHANNEL, op::METADATA_INDEX] {
            let mut parts = Parts::of(&enriched);
            let summary = parts.summary.iter_mut();
            let mut bodies = summary.filter(|(kind, _)| *kind == opcode);
            bodies.next().expect("one").1.extend(b"appended");
            is_refused(parts.join());
        }
        let mut parts = Parts::of(&enriched);
        let mut index = parts
            .summary
            .iter()
            .filter(|(kind, _)| *kind == op::METADATA_INDEX);
        let another = index.next().expect("one").clone();
        parts.summary.push(another);
        is_refused(parts.join());
    }
}
