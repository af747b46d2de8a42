//! Lengths that lie: nothing is allocated for them, and nothing of the log is lost.

use std::{
    fs::File,
    io::{Seek, SeekFrom, Write},
};

use flightcam::log::record::{FRAME_LENGTH, parse, push_record, serialize};
use mcap::records::{
    AttachmentHeader, AttachmentIndex, Channel, ChunkHeader, ChunkIndex, Footer, Header,
    MessageHeader, MessageIndex, Metadata, MetadataIndex, Statistics, op,
};

use crate::support::{folder::*, forging::*, *};

/// How much memory the program may use, KiB.
const MEMORY: u64 = 2_000_000;

/// Longer than any memory here, and quick to read, because nothing is there.
const LONG: u64 = 6_000_000_000;

/// Checks that every command, within little memory, either succeeds or says where the log is damaged, and that nothing
/// of the log is lost.
#[cfg(unix)]
#[track_caller]
fn nothing_goes_wrong(log: &[u8], what: &str) {
    let folder = Folder::with(LOG, log);
    let run = |arguments: &str| {
        let (code, out, err) = folder.run_within(MEMORY, arguments, LOG);
        let is_said = err.contains("at byte ") || err.contains("it has nothing from flightcam");
        assert!(
            matches!(code, 0 | 3) || (code == 1 && is_said),
            "{what}: {arguments}: {code}\n{err}"
        );
        (code, out)
    };
    run(&format!("inspect {LOG} --depression 30"));
    run(&format!("restore {LOG}"));
    let (code, _) = run(&format!("enrich {LOG} --depression 30"));
    assert!(folder.read(LOG) == log, "{what}: the log is as it was");
    let (streamed, passed_on) = run("enrich - -o - --depression 30");
    if streamed == 1 {
        assert!(log.starts_with(&passed_on), "{what}: passed on");
    }
    if code == 1 {
        folder.read_only_one(LOG);
        return;
    }
    folder.run(&format!("restore {RESULT} -o original.mcap"), 0);
    assert!(folder.read("original.mcap") == log, "{what}: restored");
}

#[test]
#[cfg(unix)]
fn a_length_in_a_record_that_lies_is_not_believed() {
    for place in Place::ALL {
        for record in one_of_each() {
            for (field, lie) in record.lies().enumerate() {
                let log = place.put(lie.opcode, &lie.body);
                nothing_goes_wrong(&log, &format!("{place:?}: {}, length {field}", lie.name));
            }
        }
    }
}

#[test]
#[cfg(unix)]
fn a_length_of_a_record_that_lies_is_not_believed() {
    for place in Place::ALL {
        for record in one_of_each() {
            for lie in [1 << 62, u64::MAX, 200_000_000] {
                let mut log = place.put(record.opcode, &record.body);
                let mut whole = vec![record.opcode];
                whole.extend_from_slice(&(record.body.len() as u64).to_le_bytes());
                whole.extend_from_slice(&record.body);
                let found = log.windows(whole.len()).rposition(|window| window == whole);
                let length = found.expect("the record") + 1;
                log[length..length + 8].copy_from_slice(&u64::to_le_bytes(lie));
                nothing_goes_wrong(&log, &format!("{place:?}: {} of {lie} bytes", record.name));
            }
        }
    }
}

/// The records whose lengths are lies cannot be read, whatever reads them; all others can.
#[test]
fn every_kind_of_record_has_its_lengths_checked() {
    fn is_readable(record: &Forgery) -> bool {
        let body = &record.body;
        match record.opcode {
            op::HEADER => parse::<Header>(body).is_ok(),
            op::FOOTER => parse::<Footer>(body).is_ok(),
            op::CHANNEL => parse::<Channel>(body).is_ok(),
            op::MESSAGE => parse::<MessageHeader>(body).is_ok(),
            op::CHUNK => parse::<ChunkHeader>(body).is_ok(),
            op::MESSAGE_INDEX => parse::<MessageIndex>(body).is_ok(),
            op::CHUNK_INDEX => parse::<ChunkIndex>(body).is_ok(),
            op::ATTACHMENT => parse::<AttachmentHeader>(body).is_ok(),
            op::ATTACHMENT_INDEX => parse::<AttachmentIndex>(body).is_ok(),
            op::STATISTICS => parse::<Statistics>(body).is_ok(),
            op::METADATA => parse::<Metadata>(body).is_ok(),
            op::METADATA_INDEX => parse::<MetadataIndex>(body).is_ok(),
            op::SCHEMA => flightcam::log::contents::SchemaRecord::parse(body).is_some(),
            _ => true,
        }
    }
    for record in one_of_each() {
        assert!(is_readable(&record), "{}", record.name);
        // Eight bytes are never the length of what follows in the same record, but of an attachment's content.
        let texts = record.lengths.iter().filter(|(_, width)| *width == 4);
        let lies = record.lies().zip(&record.lengths);
        let refused = lies.filter(|(lie, (_, width))| *width == 4 && !is_readable(lie));
        assert_eq!(refused.count(), texts.count(), "{}", record.name);
    }
}

/// What is allocated for a lie is what is there.
#[test]
fn nothing_is_allocated_for_a_length_that_lies() {
    for place in Place::ALL {
        for record in one_of_each() {
            for lie in record.lies() {
                let log = place.put(lie.opcode, &lie.body);
                let folder = Folder::with(LOG, &log);
                let path = folder.path(LOG);
                let allocations = allocation_counter::measure(|| {
                    let _ = flightcam::log::Log::open(&path);
                });
                let limit = 2 * 1024 * 1024;
                assert!(allocations.bytes_max < limit, "{place:?}: {}", lie.name);
            }
        }
    }
}

// ---- Records that are as long as they say ----

/// A log with a record in its telemetry that starts like this and goes on with nothing for a long time. Returns the
/// record's offset.
#[cfg(unix)]
fn write_sparse(folder: &Folder, opcode: u8, start: &[u8], is_in_summary: bool) -> u64 {
    let shape = Shape {
        messages: 10,
        ..Shape::default()
    };
    let mut parts = Parts::of(&shape.write());
    if !is_in_summary {
        parts.summary.clear();
    }
    let log = parts.join();
    let place = match is_in_summary {
        // Before the footer.
        true => log.len() - mcap::MAGIC.len() - 20 - FRAME_LENGTH,
        // Before DataEnd.
        false => log.len() - mcap::MAGIC.len() - 20 - FRAME_LENGTH - 4 - FRAME_LENGTH,
    };
    let mut file = File::create(folder.path(LOG)).expect("a file");
    let mut put = |bytes: &[u8]| file.write_all(bytes).expect("written");
    put(&log[..place]);
    put(&[opcode]);
    put(&LONG.to_le_bytes());
    put(start);
    let end = place as u64 + FRAME_LENGTH as u64 + LONG;
    file.seek(SeekFrom::Start(end)).expect("it is sparse");
    file.write_all(&log[place..]).expect("written");
    place as u64
}

#[cfg(unix)]
const COMMANDS: [&str; 3] = [
    "inspect flight.mcap --depression 30",
    "enrich flight.mcap --depression 30 --in-place",
    "enrich flight.mcap --depression 30 --in-place --encoding json",
];

#[test]
#[cfg(unix)]
fn long_records_that_are_not_needed_are_not_read() {
    let metadata = serialize(&Metadata {
        name: "parameters".into(),
        metadata: Default::default(),
    });
    let attachment = serialize(&AttachmentHeader {
        log_time: 1,
        create_time: 2,
        name: "video.mp4".into(),
        media_type: "video/mp4".into(),
    });
    let records = [
        (op::METADATA, metadata, false),
        (op::ATTACHMENT, attachment, false),
        (0x80, Vec::new(), false),
        (op::SUMMARY_OFFSET, Vec::new(), true),
    ];
    for (opcode, start, is_in_summary) in records {
        let folder = Folder::new();
        write_sparse(&folder, opcode, &start, is_in_summary);
        let commands = match is_in_summary {
            // In place, all of the summary is saved first.
            true => &COMMANDS[..1],
            false => &COMMANDS[..],
        };
        for command in commands {
            let (code, _, err) = folder.run_within(MEMORY, command, "/dev/null");
            assert_eq!(code, 0, "{opcode:#x}: {command}: {err}");
        }
    }
}

#[test]
#[cfg(unix)]
fn long_records_that_are_needed_are_refused_before_they_are_read() {
    let name = b"\x09\0\0\0flightcam\0\0\0\0";
    let records: [(u8, &[u8], bool); 7] = [
        (op::SCHEMA, b"\x09\0", false),
        (op::CHANNEL, b"\x09\0", false),
        (op::MESSAGE, b"\x01\0", false),
        (op::CHUNK, b"", false),
        (op::METADATA, name, false),
        (op::SCHEMA, b"\x09\0", true),
        (0x80, b"", true),
    ];
    for (opcode, start, is_in_summary) in records {
        let folder = Folder::new();
        let place = write_sparse(&folder, opcode, start, is_in_summary);
        let message = format!(
            "error: {LOG}: damaged at byte {place}: the record there is {LONG} bytes long; at most 256 MiB is read"
        );
        // Only what adds to a log asks what earlier runs have left in it.
        let commands = match opcode {
            op::METADATA => &["restore flight.mcap"][..],
            _ => &COMMANDS[..],
        };
        for command in commands {
            let (code, _, err) = folder.run_within(MEMORY, command, "/dev/null");
            assert_eq!(code, 1, "{opcode:#x}: {command}: {err}");
            assert_reads(&err, &message);
        }
    }
}

#[test]
#[cfg(unix)]
fn many_long_records_do_not_fill_the_memory() {
    // Schemas that are as long as may be, and hardly take room on the disk.
    let folder = Folder::new();
    let length = 200u64 * 1024 * 1024;
    let mut file = File::create(folder.path(LOG)).expect("a file");
    let mut start = mcap::MAGIC.to_vec();
    push_record(&mut start, op::HEADER, &[0; 8]);
    file.write_all(&start).expect("written");
    for id in 1..30u16 {
        file.write_all(&[op::SCHEMA]).expect("written");
        file.write_all(&length.to_le_bytes()).expect("written");
        file.write_all(&id.to_le_bytes()).expect("written");
        file.seek(SeekFrom::Current(length as i64 - 2))
            .expect("it is sparse");
    }
    file.write_all(&[0]).expect("written");
    let (code, _, err) = folder.run_within(MEMORY, "inspect flight.mcap", "/dev/null");
    assert_eq!(code, 1, "{err}");
    assert_reads(
        &err,
        "damaged at byte … would have to be kept of the log in memory is more than 256 MiB",
    );
}

#[test]
fn a_chunk_cannot_hold_more_than_its_compressed_bytes_can_become() {
    for compression in ["zstd", "lz4"] {
        let header = ChunkHeader {
            message_start_time: 0,
            message_end_time: 0,
            uncompressed_size: 250 * 1024 * 1024,
            uncompressed_crc: 0,
            compression: compression.to_owned(),
            compressed_size: 10,
        };
        let chunk = [serialize(&header), vec![0; 10]].concat();
        let log = Place::Data.put(op::CHUNK, &chunk);
        let folder = Folder::with(LOG, log);
        let message = "the chunk there is unreadable: it is said to hold 262144000 bytes, which cannot come from 10";
        folder.refuses(&format!("enrich {LOG} --depression 30"), 1, message);
    }
}
