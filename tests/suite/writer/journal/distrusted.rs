//! Whatever a journal is that an interruption does not leave, and whatever has become of the log, nothing is lost.

use std::fs;

use flightcam::{
    Output, enrich,
    log::record::{FRAME_LENGTH, push_record},
    writer::journal::JournalStep,
};
use mcap::records::op;
use sha2::{Digest, Sha256};

use super::{is_found_whole, is_refused};
use crate::support::{folder::*, interrupted::*, rewriting::with_attachment, shapes::*, *};

/// A journal as flightcam writes it, of anything.
struct Forged {
    prefix: Vec<u8>,
    /// What is said of the length of the prefix.
    start: u64,
    old_length: u64,
    new_length: u64,
    old_end: Vec<u8>,
    new_end: Vec<u8>,
    /// What is said of the length of the compressed old end, less the right one.
    saved: i64,
    /// What is said of the length of the trailer, less the right one.
    trailer: u32,
}

impl Forged {
    /// That of a log whose end from `start` on is being replaced.
    fn of(before: &[u8], after: &[u8], start: usize) -> Self {
        Self {
            prefix: before[..start].to_vec(),
            start: start as u64,
            old_length: before.len() as u64,
            new_length: after.len() as u64,
            old_end: before[start..].to_vec(),
            new_end: after[start..].to_vec(),
            saved: 0,
            trailer: 0,
        }
    }

    fn write(&self) -> Vec<u8> {
        let mut journal = b"flightcam journal 2\n".to_vec();
        journal.extend(&self.new_end);
        let saved = zstd::encode_all(&*self.old_end, 1).expect("a frame");
        journal.extend(&saved);
        let hashed = self.prefix.len().min(64 * 1024);
        let mut trailer = self.start.to_le_bytes().to_vec();
        trailer.extend(Sha256::digest(&self.prefix[..hashed]));
        trailer.extend(Sha256::digest(&self.prefix[self.prefix.len() - hashed..]));
        trailer.extend(self.old_length.to_le_bytes());
        trailer.extend(self.new_length.to_le_bytes());
        trailer.extend((saved.len() as i64 + self.saved).to_le_bytes());
        trailer.extend(b"/logs/flight.mcap");
        journal.extend(&trailer);
        journal.extend((trailer.len() as u32 + self.trailer).to_le_bytes());
        let crc = crc32fast::hash(&journal);
        journal.extend(crc.to_le_bytes());
        journal
    }
}

#[test]
fn a_journal_that_is_forged_as_flightcam_writes_it_is_believed() {
    // If it were not, the tests below would prove nothing.
    for change in CHANGES {
        let ends = Ends::of(&Shape::default().write(), change);
        let folder = Folder::with(LOG, &ends.after);
        folder.add(
            JOURNAL,
            Forged::of(&ends.before, &ends.after, ends.start).write(),
        );
        is_found_whole(&folder, &ends.before);
    }
}

/// Logs that an interrupted change does not leave, by what has happened to them.
fn changed_since(ends: &Ends) -> Vec<(&'static str, Vec<u8>)> {
    let Ends {
        before,
        after,
        start,
    } = ends;
    let mut message = Vec::new();
    push_record(&mut message, op::MESSAGE, &[1; 40]);
    let added = |log: &[u8]| [log, &message].concat();
    let longest = if before.len() > after.len() {
        before
    } else {
        after
    };
    let half = (start + after.len()) / 2;
    let mut flipped = before.clone();
    flipped[start + FRAME_LENGTH] ^= 0x55;
    let mut changed = vec![
        ("added to, old", added(longest)),
        ("zeros added", [longest, &[0; 1000][..]].concat()),
        (
            "added to, half",
            [&after[..half], &message, &[0xa5; 100]].concat(),
        ),
        (
            "added to at the start",
            [&before[..*start], &message].concat(),
        ),
        ("one byte", flipped),
        (
            "other bytes",
            [&before[..*start], &[0xa5; 100][..]].concat(),
        ),
        (
            "enriched otherwise",
            enrich_bytes_with(before, &options_at(45.0))
                .expect("a result")
                .0,
        ),
    ];
    if before.ends_with(mcap::MAGIC) {
        changed.push(("rewritten", with_attachment(before)));
    }
    changed
}

#[test]
fn a_log_that_was_changed_since_the_interruption_is_refused() {
    for original in [Shape::default().write(), with_zeros_at_the_end()] {
        for change in CHANGES {
            let ends = Ends::of(&original, change);
            let folder = before_the_first_write(&ends, change);
            for (what, log) in changed_since(&ends) {
                println!("{change:?}, {what}");
                folder.add(LOG, log);
                is_refused(
                    &folder,
                    &format!(
                        "error: {LOG}: … {JOURNAL} beside it looks like that of an interrupted change, but the log… \
                         Both are left as they are\nhint: copy both somewhere safe. …"
                    ),
                );
            }
        }
    }
}

#[test]
fn a_journal_that_is_not_whole_is_refused_whatever_the_log_is() {
    let ends = Ends::of(&Shape::default().write(), Change::Enrich);
    let folder = before_the_first_write(&ends, Change::Enrich);
    let journal = folder.read(JOURNAL);
    let zeros = vec![0; journal.len()];
    let mut torn: Vec<(&str, Vec<u8>)> = vec![
        ("it is empty", Vec::new()),
        ("it is not a journal", zeros.clone()),
        ("it is not a journal", b"a note".to_vec()),
        (
            "it was written by another version of flightcam",
            b"flightcam journal 1\nof which nothing is known".to_vec(),
        ),
        ("it is incomplete or damaged", [&journal[..], &[0]].concat()),
    ];
    for place in (1..journal.len()).step_by(journal.len() / 40) {
        torn.push(("it is incomplete or damaged", journal[..place].to_vec()));
        let mut flipped = journal.clone();
        flipped[place] ^= 1 << (place % 8);
        let is_magic = place < 20;
        let fault = if is_magic {
            "it "
        } else {
            "it is incomplete or damaged"
        };
        torn.push((fault, flipped));
        if !is_magic {
            let zeroed = [&journal[..place], &zeros[place..]].concat();
            torn.push(("it is incomplete or damaged", zeroed));
        }
    }
    let half = [
        &ends.after[..ends.start + 100],
        &ends.before[ends.start + 100..],
    ]
    .concat();
    for (turn, (fault, torn)) in torn.into_iter().enumerate() {
        folder.add(JOURNAL, torn);
        let log = [&ends.before, &ends.after, &half][turn % 3];
        folder.add(LOG, log);
        let message = format!("error: {LOG}: … {JOURNAL} beside it … but {fault}…Both are left");
        let command = [
            "inspect flight.mcap",
            "enrich flight.mcap --depression 30 --in-place",
        ];
        folder.refuses(command[turn % 2], 1, &message);
    }
    is_refused(&folder, "Both are left as they are");
}

/// Changes a journal of a log of that length.
type Forge = fn(&mut Forged, u64);

#[test]
fn a_journal_whose_lengths_are_forged_is_refused_before_the_first_write() {
    let ends = Ends::of(&Shape::default().write(), Change::Enrich);
    let forged = || Forged::of(&ends.before, &ends.after, ends.start);
    let length = ends.before.len() as u64;
    let cases: [(&str, Forge); 12] = [
        ("old length", |forged, _| forged.old_length -= 1),
        ("old length", |forged, _| forged.old_length += 1),
        ("old length", |forged, _| forged.old_length = u64::MAX),
        ("old length", |forged, _| forged.old_length = forged.start),
        ("old length", |forged, _| {
            forged.old_length = forged.start - 1
        }),
        ("new length", |forged, _| forged.new_length -= 1),
        ("new length", |forged, _| forged.new_length = u64::MAX),
        ("new length", |forged, length| forged.new_length = length),
        ("trailer", |forged, _| forged.trailer = 1),
        ("trailer", |forged, _| forged.trailer = 1 << 30),
        ("saved", |forged, _| forged.saved = -1),
        ("saved", |forged, _| forged.saved = i64::MAX / 2),
    ];
    for (what, forge) in cases {
        for log in [&ends.before, &ends.after] {
            let folder = Folder::with(LOG, log);
            let mut forged = forged();
            forge(&mut forged, length);
            folder.add(JOURNAL, forged.write());
            println!("{what}");
            is_refused(
                &folder,
                &format!("{JOURNAL} beside it … Both are left as they are"),
            );
        }
    }
}

#[test]
fn a_forged_journal_that_would_cut_a_log_is_refused() {
    let log = Shape::default().write();
    let Ends {
        before,
        after,
        start,
    } = Ends::of(&log, Change::Enrich);
    let (_, header) = Parts::records(&before).next().expect("a header");
    let first_record = mcap::MAGIC.len() + FRAME_LENGTH + header.len();
    let mut other_end = before.clone();
    other_end[start + FRAME_LENGTH] ^= 1;
    for (what, left, forged) in [
        ("to nothing", &before, Forged::of(&[], &before, 0)),
        (
            "to its magic bytes",
            &before,
            Forged::of(&before[..8], &before, 8),
        ),
        (
            "to an empty log",
            &before,
            Forged::of(&before[..first_record], &before, first_record),
        ),
        (
            "its summary",
            &before,
            Forged::of(&before[..start], &before, start),
        ),
        (
            "its last byte",
            &before,
            Forged::of(&before[..before.len() - 1], &before, start),
        ),
        (
            "the result to a part of it",
            &after,
            Forged::of(&before[..start], &after, start),
        ),
        (
            "the result from an earlier place",
            &after,
            Forged::of(&before, &after, start - 100),
        ),
        (
            "another original",
            &after,
            Forged::of(&other_end, &after, start),
        ),
    ] {
        println!("{what}");
        let folder = Folder::with(LOG, left);
        folder.add(JOURNAL, forged.write());
        is_refused(
            &folder,
            &format!("{JOURNAL} beside it … Both are left as they are"),
        );
    }
}

#[test]
fn the_journal_of_another_log_changes_nothing() {
    let ends = Ends::of(&Shape::default().write(), Change::Enrich);
    let folder = before_the_first_write(&ends, Change::Enrich);
    let other = Shape {
        topic_after_topic: true,
        ..Shape::default()
    }
    .write();
    let mut changed_at_the_start = ends.before.clone();
    changed_at_the_start[30] ^= 1;
    let mut changed_at_the_end = ends.before.clone();
    changed_at_the_end[ends.start - 1] ^= 1;
    let shorter = ends.before[..ends.start - 1].to_vec();
    let place = folder.path(LOG).canonicalize().expect("the log");
    let message = format!(
        "error: {LOG}: … {JOURNAL} beside it is left from an interrupted change of another log ({}) … put that log \
         back in its place, or remove the journal if that log is lost",
        place.display()
    );
    for log in [other, changed_at_the_start, changed_at_the_end, shorter] {
        folder.add(LOG, log);
        is_refused(&folder, &message);
    }
}

#[test]
#[cfg(unix)]
fn something_else_in_the_place_of_a_journal_is_refused() {
    let folder = Folder::with(LOG, Shape::default().write());
    folder.add(&format!("{JOURNAL}/.keep"), "");
    is_refused(
        &folder,
        &format!("{JOURNAL} beside it … it is not a journal"),
    );
    fs::remove_dir_all(folder.path(JOURNAL)).expect("removed");
    std::os::unix::fs::symlink(LOG, folder.path(JOURNAL)).expect("a link");
    is_refused(
        &folder,
        &format!("{JOURNAL} beside it … it is not a journal"),
    );
}

#[test]
fn a_journal_whose_log_is_gone_is_kept() {
    let ends = Ends::of(&Shape::default().write(), Change::Enrich);
    let folder = before_the_first_write(&ends, Change::Enrich);
    fs::remove_file(folder.path(LOG)).expect("removed");
    is_refused(&folder, &format!("error: {LOG}: cannot open the log"));
    // When it comes back, everything is as it should be.
    folder.add(LOG, &ends.after);
    is_found_whole(&folder, &ends.before);
}

#[test]
fn a_journal_that_appears_during_a_run_is_not_replaced() {
    let log = Shape::default().write();
    let folder = Folder::with(LOG, &log);
    let journal = folder.path(JOURNAL);
    let options = options().on_step(move |step| {
        assert_eq!(step, JournalStep::JournalWritten);
        fs::write(&journal, "of somebody else").expect("written");
    });
    let result = enrich(folder.path(LOG), Output::InPlace, &options);
    assert!(result.is_err());
    assert!(folder.read(LOG) == log);
    assert_eq!(folder.read(JOURNAL), b"of somebody else");
}
