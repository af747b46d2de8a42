//! With little memory, no log makes the program abort, whatever it says about lengths, and nothing of it is lost.

use std::{
    fs::File,
    io::{Seek, SeekFrom, Write},
};

use flightcam::log::record::{FRAME_LENGTH, push_record, serialize};
use mcap::records::{AttachmentHeader, Channel, ChunkHeader, Metadata, op};

use crate::support::{folder::*, forging::*, topics::*, *};

/// How much memory the program may use, KiB.
const MEMORY: u64 = 2_000_000;

/// Longer than any memory here, and quick to read, because nothing is there.
const LONG: u64 = 6_000_000_000;

/// Checks that every command, within little memory, either succeeds or says where the log is damaged, and that nothing
/// of the log is lost.
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

// ---- Records that are as long as they say ----

/// A log with a record in its telemetry that starts like this and goes on with nothing for a long time. Returns the
/// record's offset.
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

const COMMANDS: [&str; 3] = [
    "inspect flight.mcap --depression 30",
    "enrich flight.mcap --depression 30 --in-place",
    "enrich flight.mcap --depression 30 --in-place --encoding json",
];

#[test]
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

/// Channels with so many map entries, of which each takes far more memory than bytes of the file.
fn channels_with_maps(channels: u16) -> Vec<u8> {
    let metadata = (0..20_000).map(|i| (format!("{i:x}"), String::new()));
    let channel = Channel {
        id: 0,
        schema_id: 0,
        topic: "/parameters".into(),
        message_encoding: "json".into(),
        metadata: metadata.collect(),
    };
    let mut body = serialize(&channel);
    let mut records = Vec::new();
    for id in 0..channels {
        body[..2].copy_from_slice(&(100 + id).to_le_bytes());
        push_record(&mut records, op::CHANNEL, &body);
    }
    records
}

#[test]
fn many_large_maps_do_not_fill_the_memory() {
    let channels = channels_with_maps(350);
    let compressed = zstd::encode_all(&channels[..], 1).expect("compressed");
    let mut chunk = serialize(&ChunkHeader {
        message_start_time: 0,
        message_end_time: 0,
        uncompressed_size: channels.len() as u64,
        uncompressed_crc: 0,
        compression: "zstd".into(),
        compressed_size: compressed.len() as u64,
    });
    chunk.extend_from_slice(&compressed);
    let mut chunk_record = Vec::new();
    push_record(&mut chunk_record, op::CHUNK, &chunk);

    let log = without_chunks();
    let data_end = log.len() - mcap::MAGIC.len() - 20 - FRAME_LENGTH - 4 - FRAME_LENGTH;
    let in_data = |records: &[u8]| [&log[..data_end], records, &log[data_end..]].concat();
    let footer = log.len() - mcap::MAGIC.len() - 20 - FRAME_LENGTH;
    let mut in_summary = [&log[..footer], &channels, &log[footer..]].concat();
    let summary_start = in_summary.len() - mcap::MAGIC.len() - 20;
    in_summary[summary_start..summary_start + 8].copy_from_slice(&(footer as u64).to_le_bytes());

    for log in [in_data(&chunk_record), in_data(&channels), in_summary] {
        let folder = Folder::with(LOG, log);
        let command = "inspect flight.mcap --depression 30";
        let (code, _, err) = folder.run_within(MEMORY / 3, command, "/dev/null");
        assert_eq!(code, 1, "{err}");
        assert_reads(
            &err,
            "damaged at byte … would have to be kept of the log in memory is more than 256 MiB",
        );
    }
}

/// A small log without chunks, without a summary.
fn without_chunks() -> Vec<u8> {
    let shape = Shape {
        messages: 10,
        ..Shape::with(|options| options.use_chunks(false))
    };
    let mut parts = Parts::of(&shape.write());
    parts.summary.clear();
    parts.data_section_crc = 0;
    parts.join()
}

#[test]
fn chunks_that_claim_much_do_not_fill_the_memory_of_the_threads_that_read_them() {
    // So much telemetry that several threads read it, and so little of it repeated that a chunk could hold what it
    // claims.
    let mut state = topic("/drone/state", states(3000, 1.0));
    let mut noise = 1u64;
    for message in &mut state.messages {
        let mut digits = String::new();
        while digits.len() < 4000 {
            noise = noise
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            digits += &format!("{noise:x}");
        }
        let json = String::from_utf8(std::mem::take(message)).expect("JSON");
        *message = json
            .replacen('{', &format!("{{\"noise\":\"{digits}\","), 1)
            .into();
    }
    let mut log = log(&[state]);
    let records = flightcam::log::record::Records::new(&log[mcap::MAGIC.len()..]);
    let chunks: Vec<usize> = records
        .map_while(Result::ok)
        .filter(|record| record.opcode == op::CHUNK)
        .map(|record| mcap::MAGIC.len() + record.offset)
        .collect();
    assert!(chunks.len() > 3);
    for &chunk in &chunks {
        let size = chunk + FRAME_LENGTH + 8 + 8;
        let claimed = 250u64 * 1024 * 1024;
        log[size..size + 8].copy_from_slice(&claimed.to_le_bytes());
    }
    let folder = Folder::with(LOG, &log);
    let (code, _, err) = folder.run_within(MEMORY, "enrich flight.mcap --depression 30", LOG);
    assert_eq!(code, 1, "{err}");
    assert_reads(
        &err,
        &format!(
            "damaged at byte {}: the chunk there is unreadable",
            chunks[0]
        ),
    );
}
