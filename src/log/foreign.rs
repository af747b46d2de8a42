//! Files of other kinds, recognised by how they begin.

/// What a file is that is not MCAP, as its first bytes show.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, thiserror::Error)]
#[non_exhaustive]
// Each variant's message explains it.
#[allow(missing_docs)]
pub enum ForeignFormat {
    #[error("a PX4 ULog")]
    Ulog,
    #[error("a ROS 1 bag")]
    Ros1Bag,
    #[error("an SQLite database, perhaps a ROS 2 bag")]
    Sqlite,
    #[error("the description of a ROS 2 bag")]
    BagMetadata,
    #[error("an ArduPilot DataFlash log")]
    DataFlash,
    #[error("an ArduPilot DataFlash log in text form")]
    DataFlashText,
    #[error("a MAVLink telemetry log (tlog)")]
    Tlog,
    #[error("compressed with zstd")]
    Zstd,
    #[error("compressed with gzip")]
    Gzip,
    #[error("compressed with lz4")]
    Lz4,
    #[error("compressed with xz")]
    Xz,
    #[error("compressed with bzip2")]
    Bzip2,
    #[error("a zip archive")]
    Zip,
    #[error("a tar archive")]
    Tar,
    #[error("a video")]
    Video,
    #[error("subtitles (SRT)")]
    Subtitles,
    #[error("a Git LFS pointer, which stands for a file that was not fetched")]
    LfsPointer,
    #[error("a web page, perhaps instead of a download")]
    WebPage,
    #[error("XML")]
    Xml,
    #[error("JSON")]
    Json,
    #[error("a table as text (CSV)")]
    Csv,
}

use ForeignFormat::*;

/// What files of a kind have at an offset. Sources:
/// ULog <https://docs.px4.io/main/en/dev_log/ulog_file_format.html>, bags <https://wiki.ros.org/Bags/Format/2.0>, SQLite
/// <https://www.sqlite.org/fileformat2.html>, DataFlash's two head bytes
/// <https://github.com/ArduPilot/ardupilot/blob/003e46bb/libraries/AP_Logger/LogStructure.h>, the others
/// <https://en.wikipedia.org/wiki/List_of_file_signatures>.
const SIGNATURES: [(usize, &[u8], ForeignFormat); 20] = [
    (0, b"ULog", Ulog),
    (0, b"#ROSBAG V", Ros1Bag),
    (0, b"SQLite format 3", Sqlite),
    (0, b"rosbag2_bagfile_information:", BagMetadata),
    (0, &[0xa3, 0x95], DataFlash),
    (0, b"FMT, 128, 89, FMT,", DataFlashText),
    (0, &[0x28, 0xb5, 0x2f, 0xfd], Zstd),
    (0, &[0x1f, 0x8b], Gzip),
    (0, &[0x04, 0x22, 0x4d, 0x18], Lz4),
    (0, &[0xfd, b'7', b'z', b'X', b'Z', 0], Xz),
    (0, b"BZh", Bzip2),
    (0, b"PK\x03\x04", Zip),
    (257, b"ustar", Tar),
    // MP4, MOV.
    (4, b"ftyp", Video),
    // Matroska, WebM.
    (0, &[0x1a, 0x45, 0xdf, 0xa3], Video),
    (0, b"version https://git-lfs.github.com/spec/", LfsPointer),
    (0, b"<!DOCTYPE html", WebPage),
    (0, b"<!doctype html", WebPage),
    (0, b"<html", WebPage),
    (0, b"<?xml", Xml),
];

impl ForeignFormat {
    /// How many bytes of a file's start are looked at.
    pub(super) const EXAMINED: u64 = 4096;

    /// The format of a file that starts with these bytes.
    pub(super) fn of(start: &[u8]) -> Option<Self> {
        let has = |&&(offset, magic, _): &&(usize, &[u8], Self)| {
            start
                .get(offset..)
                .is_some_and(|rest| rest.starts_with(magic))
        };
        let text = || text(start);
        (SIGNATURES.iter().find(has).map(|(_, _, format)| *format))
            .or_else(|| is_tlog(start).then_some(Tlog))
            .or_else(|| of_text(text()?))
    }
}

/// The text that a file starts with, if it is text: without a byte order mark, and without what is cut off at its end.
fn text(start: &[u8]) -> Option<&str> {
    let start = start.strip_prefix(b"\xef\xbb\xbf").unwrap_or(start);
    let text = match std::str::from_utf8(start) {
        Ok(text) => text,
        Err(error) if error.error_len().is_none() => {
            std::str::from_utf8(&start[..error.valid_up_to()]).ok()?
        }
        Err(_) => return None,
    };
    let is_text = |c: char| !c.is_control() || matches!(c, '\n' | '\r' | '\t');
    text.chars().all(is_text).then_some(text)
}

fn of_text(text: &str) -> Option<ForeignFormat> {
    let mut lines = text.lines();
    match text.trim_start().chars().next()? {
        '{' | '[' => Some(Json),
        _ if lines.next() == Some("1")
            && lines.next().is_some_and(|line| line.contains(" --> ")) =>
        {
            Some(Subtitles)
        }
        _ => [',', ';', '\t']
            .iter()
            .any(|&separator| is_table(text, separator))
            .then_some(Csv),
    }
}

/// Whether all whole lines of a text have as many cells, and more than two.
fn is_table(text: &str, separator: char) -> bool {
    // What follows the last line break may be cut off.
    let whole = text.rfind('\n').map_or(text, |end| &text[..end]);
    let count = |line: &str| {
        let mut is_quoted = false;
        line.chars()
            .filter(|&c| {
                is_quoted ^= c == '"';
                c == separator && !is_quoted
            })
            .count()
    };
    let mut counts = whole.lines().filter(|line| !line.is_empty()).map(count);
    match counts.next() {
        Some(cells) => cells >= 2 && counts.all(|others| others == cells),
        None => false,
    }
}

/// Whether a file starts with MAVLink packets, each after its time in microseconds as eight bytes
/// (<https://docs.qgroundcontrol.com/master/en/qgc-dev-guide/file_formats/mavlink.html>,
/// <https://mavlink.io/en/guide/serialization.html>). Two in a row are enough; more may not have been read.
fn is_tlog(start: &[u8]) -> bool {
    const TIME: usize = 8;
    let packet = |at: usize| {
        let packet = start.get(at + TIME..)?;
        let payload = usize::from(*packet.get(1)?);
        Some(match packet[0] {
            0xfe => 6 + payload + 2,
            // A signature follows if the first incompatibility flag says so.
            0xfd if packet.get(2)? & 1 != 0 => 10 + payload + 2 + 13,
            0xfd => 10 + payload + 2,
            _ => return None,
        })
    };
    let first = packet(0).map(|length| TIME + length);
    first.is_some_and(|end| end == start.len() || packet(end).is_some())
}
