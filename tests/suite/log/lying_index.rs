//! A chunk index that says that something is a chunk and its message indexes, though there is something else, is not
//! believed: readers that look only where indexes point would never find that.

use std::collections::BTreeMap;

use flightcam::log::{
    Damage, Log, ReadError, RecordKind, ScanReason,
    record::{parse, push_record, serialize},
};
use mcap::records::{Channel, ChunkIndex, MessageHeader, Statistics, op};

use crate::support::{folder::*, forging::*, *};

/// What the index of one chunk says, and what else there is.
#[derive(Default)]
struct Lie<'a> {
    /// After the chunk; the index says that it is a part of the chunk.
    between: &'a [u8],
    /// After its message indexes; the index says that it is a part of the last one.
    tail: &'a [u8],
    change: Option<fn(&mut ChunkIndex)>,
    /// The topic of which there is no message index at all.
    omits: Option<&'a str>,
}

/// A log in which the index of the second chunk lies and everything else that the summary says agrees with it.
fn log_with(lie: &Lie) -> Vec<u8> {
    let mut parts = Parts::of(&Shape::default().write());
    let mut offset = mcap::MAGIC.len() as u64;
    let mut data = Vec::new();
    let mut indexes: Vec<ChunkIndex> = Vec::new();
    let mut records = std::mem::take(&mut parts.data);
    if let Some(topic) = lie.omits {
        let mut channels = parts
            .summary
            .iter()
            .filter(|(opcode, _)| *opcode == op::CHANNEL);
        let channel = channels.find_map(|(_, body)| {
            let channel: Channel = parse(body).expect("a channel");
            (channel.topic == topic).then_some(channel.id.to_le_bytes())
        });
        let channel = channel.expect("the topic");
        records.retain(|(opcode, body)| *opcode != op::MESSAGE_INDEX || body[..2] != channel);
    }
    for (place, (opcode, body)) in records.iter().enumerate() {
        let length = 9 + body.len() as u64;
        let ends_chunk = records.get(place + 1).map(|next| next.0) != Some(op::MESSAGE_INDEX);
        match *opcode {
            op::CHUNK => {
                let said = parts
                    .summary
                    .iter()
                    .filter(|(kind, _)| *kind == op::CHUNK_INDEX);
                let said = said.map(|(_, body)| parse::<ChunkIndex>(body).expect("an index"));
                indexes.push(ChunkIndex {
                    chunk_start_offset: offset,
                    chunk_length: length,
                    message_index_offsets: BTreeMap::new(),
                    message_index_length: 0,
                    ..said.clone().nth(indexes.len()).expect("its index")
                });
            }
            op::MESSAGE_INDEX => {
                let id = u16::from_le_bytes([body[0], body[1]]);
                let index = indexes.last_mut().expect("its chunk");
                index.message_index_offsets.insert(id, offset);
                index.message_index_length += length;
            }
            _ => {}
        }
        push_record(&mut data, *opcode, body);
        offset += length;
        if indexes.len() == 2 && *opcode == op::CHUNK {
            data.extend_from_slice(lie.between);
            offset += lie.between.len() as u64;
            indexes[1].chunk_length += lie.between.len() as u64;
        }
        if indexes.len() == 2 && *opcode == op::MESSAGE_INDEX && ends_chunk {
            data.extend_from_slice(lie.tail);
            offset += lie.tail.len() as u64;
            indexes[1].message_index_length += lie.tail.len() as u64;
        }
    }
    if let Some(change) = lie.change {
        change(&mut indexes[1]);
    }

    let mut summary = parts
        .summary
        .iter()
        .filter(|(kind, _)| *kind != op::CHUNK_INDEX);
    let statistics = agreeing(&indexes, summary.clone());
    let mut log = [mcap::MAGIC, &data].concat();
    push_record(&mut log, op::DATA_END, &[0; 4]);
    let start = log.len() as u64;
    for (opcode, body) in summary.by_ref() {
        match *opcode {
            op::STATISTICS => push_record(&mut log, op::STATISTICS, &serialize(&statistics)),
            opcode => push_record(&mut log, opcode, body),
        }
    }
    for index in &indexes {
        push_record(&mut log, op::CHUNK_INDEX, &serialize(index));
    }
    push_record(
        &mut log,
        op::FOOTER,
        &[&start.to_le_bytes()[..], &[0; 12]].concat(),
    );
    log.extend_from_slice(mcap::MAGIC);
    log
}

/// The statistics of a log that is as these chunk indexes say.
fn agreeing<'a>(
    indexes: &[ChunkIndex],
    mut summary: impl Iterator<Item = &'a (u8, Vec<u8>)>,
) -> Statistics {
    let said = summary.find(|(opcode, _)| *opcode == op::STATISTICS);
    let mut statistics: Statistics = parse(&said.expect("statistics").1).expect("statistics");
    let mut counts: BTreeMap<u16, u64> = BTreeMap::new();
    for index in indexes {
        let end = index.chunk_start_offset + index.chunk_length + index.message_index_length;
        let mut starts: Vec<(u64, u16)> = index
            .message_index_offsets
            .iter()
            .map(|(&id, &offset)| (offset, id))
            .collect();
        starts.sort_unstable();
        let ends = starts
            .iter()
            .skip(1)
            .map(|(offset, _)| *offset)
            .chain([end]);
        for (&(start, id), end) in starts.iter().zip(ends) {
            *counts.entry(id).or_default() += (end - start - 15) / 16;
        }
    }
    statistics.message_count = counts.values().sum();
    statistics.channel_message_counts = counts;
    let times = || {
        indexes
            .iter()
            .map(|index| (index.message_start_time, index.message_end_time))
    };
    statistics.message_start_time = times().map(|(start, _)| start).min().expect("a chunk");
    statistics.message_end_time = times().map(|(_, end)| end).max().expect("a chunk");
    statistics
}

/// As long as whole entries of a message index, with a record that readers skip.
fn padded(mut bytes: Vec<u8>) -> Vec<u8> {
    let missing = (16 - (bytes.len() + 9) % 16) % 16;
    push_record(&mut bytes, 0x80, &vec![0; missing]);
    bytes
}

/// Messages outside chunks.
fn messages() -> Vec<u8> {
    let mut bytes = Vec::new();
    for i in 0..7 {
        let mut body = serialize(&MessageHeader {
            channel_id: 2,
            sequence: 1000 + i,
            log_time: 1_500_000_000,
            publish_time: 0,
        });
        body.extend_from_slice(b"{}");
        push_record(&mut bytes, op::MESSAGE, &body);
    }
    bytes
}

/// The second chunk of the log, perhaps with its message indexes, and an attachment.
fn swallowed(with_indexes: bool) -> Vec<u8> {
    let parts = Parts::of(&Shape::default().write());
    let mut records = parts
        .data
        .iter()
        .skip_while(|(opcode, _)| *opcode != op::CHUNK)
        .skip(1);
    let mut bytes = Vec::new();
    let chunk = records.by_ref().find(|(opcode, _)| *opcode == op::CHUNK);
    push_record(&mut bytes, op::CHUNK, &chunk.expect("a chunk").1);
    for (opcode, body) in records.take_while(|(opcode, _)| *opcode == op::MESSAGE_INDEX) {
        if with_indexes {
            push_record(&mut bytes, *opcode, body);
        }
    }
    for record in one_of_each() {
        if record.opcode == op::ATTACHMENT {
            push_record(&mut bytes, record.opcode, &record.body);
        }
    }
    bytes
}

fn end_of_data(with_footer: bool) -> Vec<u8> {
    let mut bytes = Vec::new();
    push_record(&mut bytes, op::DATA_END, &[0; 4]);
    if with_footer {
        push_record(&mut bytes, op::FOOTER, &[0; 20]);
        bytes.extend_from_slice(mcap::MAGIC);
    }
    bytes
}

/// Checks that the log is read from start to end, and that the index of the result leads to all of its messages.
#[track_caller]
fn is_scanned(lie: &Lie) {
    let log = log_with(lie);
    let folder = Folder::with(LOG, &log);
    let opened = Log::open(&folder.path(LOG)).expect("a readable log");
    assert_eq!(opened.scanned, Some(ScanReason::IncompleteSummary));
    let (result, _) = enrich_bytes(&log).expect("a readable log");
    judge(&log, &result, false);
}

#[test]
fn a_log_whose_indexes_are_true_is_not_scanned() {
    let log = log_with(&Lie::default());
    let folder = Folder::with(LOG, &log);
    assert_eq!(
        Log::open(&folder.path(LOG)).expect("readable").scanned,
        None
    );
    folder.run("enrich flight.mcap --depression 30", 0);
    assert_eq!(
        Log::open(&folder.path(RESULT)).expect("readable").scanned,
        None
    );
}

#[test]
fn what_is_said_to_be_a_part_of_a_chunk_is_found() {
    for between in [messages(), swallowed(false), swallowed(true)] {
        is_scanned(&Lie {
            between: &between,
            ..Lie::default()
        });
    }
}

#[test]
fn what_is_said_to_be_a_part_of_a_message_index_is_found() {
    for tail in [messages(), swallowed(false), swallowed(true)] {
        is_scanned(&Lie {
            tail: &padded(tail),
            ..Lie::default()
        });
    }
    // A message index that is longer than the entries in it.
    is_scanned(&Lie {
        tail: &padded(Vec::new()),
        ..Lie::default()
    });
}

#[test]
fn an_end_of_the_data_that_an_index_hides_is_reported() {
    for with_footer in [true, false] {
        for rest in [Vec::new(), messages()] {
            let hidden = padded([end_of_data(with_footer), rest].concat());
            let lies = [
                Lie {
                    between: &hidden,
                    ..Lie::default()
                },
                Lie {
                    tail: &hidden,
                    ..Lie::default()
                },
            ];
            for lie in lies {
                let log = log_with(&lie);
                let place = log.windows(hidden.len()).position(|bytes| bytes == hidden);
                let folder = Folder::with(LOG, &log);
                let error = Log::open(&folder.path(LOG)).expect_err("it is damaged");
                assert!(
                    matches!(
                        error,
                        ReadError::Damaged {
                            offset,
                            damage: Damage::EarlyEnd(RecordKind::DataEnd),
                            ..
                        } if Some(offset as usize) == place
                    ),
                    "{error}"
                );
            }
        }
    }
}

#[test]
fn a_channel_that_an_index_omits_is_found() {
    let omit_last = |index: &mut ChunkIndex| {
        let last = index
            .message_index_offsets
            .iter()
            .max_by_key(|(_, offset)| **offset);
        let (id, offset) = last
            .map(|(&id, &offset)| (id, offset))
            .expect("two channels");
        index.message_index_offsets.remove(&id);
        let start = index.chunk_start_offset + index.chunk_length;
        index.message_index_length = offset - start;
    };
    is_scanned(&Lie {
        change: Some(omit_last),
        ..Lie::default()
    });
}

#[test]
fn other_channels_and_times_than_those_of_the_chunk_are_not_believed() {
    let changes: [fn(&mut ChunkIndex); 4] = [
        |index| index.message_end_time = index.message_start_time,
        |index| index.message_start_time += 1,
        // Both channels have as many messages.
        |index| {
            let offsets: Vec<u64> = index.message_index_offsets.values().copied().collect();
            for (place, offset) in index
                .message_index_offsets
                .values_mut()
                .zip(offsets.iter().rev())
            {
                *place = *offset;
            }
        },
        // Where message indexes are, there is no chunk.
        |index| {
            let first = index.message_index_offsets.values().min().copied();
            index.chunk_length = 15 + 16;
            index.chunk_start_offset = first.expect("an index") - index.chunk_length;
        },
    ];
    for change in changes {
        is_scanned(&Lie {
            change: Some(change),
            ..Lie::default()
        });
    }
}

/// Nothing outside the chunks says that there is such a channel. Its id could be taken for a new one.
#[test]
fn a_channel_of_which_there_is_no_message_index_is_an_error_where_its_chunk_is_read() {
    let log = log_with(&Lie {
        omits: Some("/other"),
        ..Lie::default()
    });
    let folder = Folder::with(LOG, &log);
    let scanned = Log::open(&folder.path(LOG)).expect("a log").scanned;
    assert_eq!(scanned, None);
    for command in ["enrich", "enrich --in-place", "enrich --layout interleaved"] {
        folder.refuses(
            &format!("{command} --depression 30 flight.mcap"),
            1,
            "damaged at byte … which its index leaves out",
        );
    }
}
