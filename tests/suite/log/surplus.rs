//! What follows the closing magic of a log is not a part of it, and could not be read: that is said, and it is kept.

use flightcam::{
    log::{Log, record::push_record},
    source::request::Request,
};
use mcap::records::op;

use crate::support::{folder::*, piping::check, *};

/// Logs that were closed, with chunks and without, with a summary and without.
fn logs() -> Vec<Vec<u8>> {
    let mut logs = Vec::new();
    for chunks in [true, false] {
        let log = Shape::with(|options| options.use_chunks(chunks)).write();
        let mut parts = Parts::of(&log);
        parts.summary.clear();
        logs.extend([log, parts.join()]);
    }
    logs
}

/// Another log than those.
fn another() -> Vec<u8> {
    Shape {
        messages: 50,
        ..Shape::default()
    }
    .write()
}

/// Checks that a log that ends at `end`, before its file does, is understood up to there, and that nothing is lost.
#[track_caller]
fn ends_at(end: usize, file: &[u8]) {
    for most in [1000, 1_000_000] {
        let streamed = check(file, &Request::default(), most).expect("a readable log");
        assert_eq!(streamed.original.breaks_off_at, Some(end as u64));
        assert!(!streamed.original.is_readable_to_its_end());
    }
    let folder = Folder::with(LOG, file);
    let alone = Folder::with(LOG, &file[..end]);
    let messages = |folder: &Folder| {
        let log = Log::open(&folder.path(LOG)).expect("a readable log");
        log.contents.statistics
    };
    assert_eq!(messages(&folder), messages(&alone));

    let said = format!(
        "breaks off at byte {end}; the {} bytes from there on are not readable",
        file.len() - end
    );
    let (out, _) = folder.run("inspect flight.mcap --depression 30", 0);
    let words: Vec<&str> = out.split_whitespace().collect();
    assert_reads(&words.join(" "), &said);
    let report = folder.reports("enrich flight.mcap --depression 30", 3);
    assert_eq!(report["complete"], false);
    let kept = Log::open(&folder.path(RESULT)).expect("a readable result");
    assert!(kept.is_readable_to_its_end());
    judge_alone(file, end, &folder.read(RESULT));
    folder.run("restore flight.enriched.mcap -o original.mcap", 0);
    assert!(
        folder.read("original.mcap") == file,
        "all of it is given back"
    );
    folder.run("enrich flight.mcap --depression 30 --in-place", 3);
    folder.run("restore flight.mcap", 0);
    assert!(folder.read(LOG) == file, "all of it is given back");
}

/// Checks a result against the log without what follows it.
fn judge_alone(file: &[u8], end: usize, result: &[u8]) {
    let derived = |topic: &str| DERIVED.contains(&topic);
    let mut messages = stream(result, false);
    messages.retain(|message| !derived(&message.topic));
    assert!(
        messages == stream(&file[..end], false),
        "every message is there"
    );
}

#[test]
fn another_log_after_a_log_is_said() {
    for log in logs() {
        let end = log.len();
        let mut followers = logs();
        followers.extend([another(), another()[..2000].to_vec(), mcap::MAGIC.to_vec()]);
        for follower in followers {
            ends_at(end, &[&log[..], &follower].concat());
        }
        // The closing magic of one is the opening magic of the other.
        ends_at(end, &[&log[..end - mcap::MAGIC.len()], &another()].concat());
    }
}

#[test]
fn other_bytes_after_a_log_are_said() {
    for log in logs() {
        let mut zeros_and_text = vec![0; 5000];
        zeros_and_text.extend_from_slice(b"x");
        let followers: [&[u8]; 4] = [
            b"x",
            b"some text after the end",
            &zeros_and_text,
            &[0xff; 100],
        ];
        for follower in followers {
            ends_at(log.len(), &[&log[..], follower].concat());
        }
    }
}

/// The same where the data ends with a footer.
#[test]
fn bytes_after_a_log_without_an_end_of_its_data_are_said() {
    let log = Shape::default().write();
    let records = flightcam::log::record::Records::new(&log[mcap::MAGIC.len()..]);
    let data_end = records
        .flatten()
        .find(|record| record.opcode == op::DATA_END);
    let mut log = log[..mcap::MAGIC.len() + data_end.expect("the end").offset].to_vec();
    push_record(&mut log, op::FOOTER, &[0; 20]);
    log.extend_from_slice(mcap::MAGIC);
    let file = [&log[..], b"text"].concat();
    let streamed = check(&file, &Request::default(), 1000).expect("a readable log");
    assert_eq!(streamed.original.breaks_off_at, Some(log.len() as u64));
}

/// The same where the log was not closed, so that its end is not known.
#[test]
fn bytes_where_a_summary_should_be_are_said() {
    let log = Shape::default().write();
    let mut parts = Parts::of(&log);
    parts.summary.clear();
    let bare = parts.join();
    // Without the footer and the closing magic.
    let data_end = bare.len() - mcap::MAGIC.len() - 20 - 9;
    let mut message = Vec::new();
    push_record(&mut message, op::MESSAGE, &[1; 40]);
    let with = |kept: usize, more: &[u8]| [&log[..kept], more].concat();
    let text = b"some text after the end";
    let magic = log.len() - mcap::MAGIC.len();
    let mut cases = vec![
        (Some(data_end), with(data_end, text)),
        (
            Some(data_end + 4095),
            with(data_end, &[&[0; 4096], &message[..]].concat()),
        ),
        (Some(magic), with(magic, text)),
    ];
    for missing in [1, 20, 300] {
        cases.push((None, with(log.len() - missing, &another())));
    }
    for (end, file) in cases {
        let streamed = check(&file, &Request::default(), 1000).expect("a readable log");
        assert!(!streamed.original.is_readable_to_its_end());
        let found = streamed.original.breaks_off_at;
        assert!(end.is_none() || found == end.map(|end| end as u64));
        let folder = Folder::with(LOG, &file);
        folder.run("enrich flight.mcap --depression 30 --in-place", 3);
        folder.run("restore flight.mcap", 0);
        assert!(folder.read(LOG) == file, "all of it is given back");
    }
}

#[test]
fn nothing_is_said_of_zeros_after_a_log_or_of_a_summary_that_is_cut() {
    let log = Shape::default().write();
    let mut zeros = log.clone();
    zeros.resize(log.len() + 100_000, 0);
    let cut = |missing| log[..log.len() - missing].to_vec();
    for file in [zeros, cut(1), cut(8), cut(20), cut(200)] {
        let streamed = check(&file, &Request::default(), 1000).expect("a readable log");
        assert_eq!(streamed.original.breaks_off_at, None);
        let folder = Folder::with(LOG, &file);
        folder.writes(RESULT, "enrich flight.mcap --depression 30", 0);
    }
}

/// The end of the file says where the data ends, and it goes on to there.
#[test]
fn records_after_a_closing_magic_are_data_if_the_end_of_the_file_says_so() {
    let log = Shape::default().write();
    let mut parts = Parts::of(&another());
    parts.summary.clear();
    let rest = &parts.join()[mcap::MAGIC.len()..];
    let folder = Folder::with(LOG, [&log[..], rest].concat());
    folder.refuses(
        "enrich flight.mcap --depression 30",
        1,
        "ends the log's data, but the log goes on after it",
    );
}
