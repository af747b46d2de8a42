//! Files that are not MCAP: each is recognised by its content, in a file and in a pipe, and the error says what makes
//! MCAP of it.

use std::{collections::BTreeSet, io::Cursor};

use flightcam::{
    Error, Input, enrich,
    log::{ForeignFormat, ReadError},
};

use crate::support::{folder::*, markdown::read, *};

/// A beginning of each kind of file, and what the advice has.
fn kinds() -> Vec<(ForeignFormat, &'static str, Vec<u8>, &'static str)> {
    use ForeignFormat::*;
    let kind = |format, name, content: &[u8], advice| (format, name, content.to_vec(), advice);
    vec![
        kind(
            Ulog,
            "flight.ulg",
            b"ULog\x01\x12\x35\x01\0\0\0\0\0\0\0\0",
            "a PX4 ULog … `python convert.py flight.ulg flight.mcap` … foxglove/mcap",
        ),
        kind(
            Ros1Bag,
            "my flight.bag",
            b"#ROSBAG V2.0\n",
            "a ROS 1 bag … `mcap convert 'my flight.bag' 'my flight.mcap'` (https://mcap.dev",
        ),
        kind(
            Sqlite,
            "monday.db3",
            b"SQLite format 3\0",
            "an SQLite … `mcap convert monday.db3 monday.mcap` … `ros2 bag convert`",
        ),
        kind(
            BagMetadata,
            "metadata.yaml",
            b"rosbag2_bagfile_information:\n  version: 5\n",
            "the description of a ROS 2 bag … the .mcap file beside it",
        ),
        kind(
            DataFlash,
            "00000042.BIN",
            b"\xa3\x95\x80\x80\x59FMT\0BBnNZ",
            "DataFlash log … `arducap 00000042.BIN`",
        ),
        kind(
            DataFlashText,
            "flight.log",
            b"FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n",
            "DataFlash log in text form … `arducap flight.bin`",
        ),
        kind(
            Tlog,
            "flight.tlog",
            &tlog(0xfd),
            "MAVLink … `mavlogdump.py --format json flight.tlog`",
        ),
        kind(
            Tlog,
            "old",
            &tlog(0xfe),
            "MAVLink … `mavlogdump.py --format json flight.tlog`",
        ),
        kind(
            Zstd,
            "monday.mcap.zst",
            b"\x28\xb5\x2f\xfd\x04\x88",
            "compressed with zstd … `zstd -dc monday.mcap.zst > monday.mcap`",
        ),
        kind(
            Gzip,
            "monday.gz",
            b"\x1f\x8b\x08\x08",
            "compressed with gzip … `gzip -dc monday.gz > monday.mcap`",
        ),
        kind(
            Lz4,
            LOG,
            b"\x04\x22\x4d\x18\x64",
            "`lz4 -dc flight.mcap.lz4 > flight.mcap`",
        ),
        kind(
            Xz,
            LOG,
            b"\xfd7zXZ\0\0\x04",
            "`xz -dc flight.mcap.xz > flight.mcap`",
        ),
        kind(
            Bzip2,
            LOG,
            b"BZh91AY&SY",
            "`bzip2 -dc flight.mcap.bz2 > flight.mcap`",
        ),
        kind(
            Zip,
            "flights.zip",
            b"PK\x03\x04\x14\0",
            "a zip archive … `unzip flights.zip`",
        ),
        kind(Tar, LOG, &tar(), "a tar archive … `tar -xf flight.tar`"),
        kind(
            Video,
            LOG,
            b"\0\0\0\x20ftypisom\0\0\x02\0",
            "a video … give the flight log",
        ),
        kind(
            Video,
            LOG,
            b"\x1a\x45\xdf\xa3\x9f\x42",
            "a video … give the flight log",
        ),
        kind(
            Subtitles,
            LOG,
            b"\xef\xbb\xbf1\r\n00:00:00,000 --> 00:00:00,033\r\nFrameCnt: 1\r\n",
            "subtitles … give the flight log",
        ),
        kind(
            LfsPointer,
            LOG,
            b"version https://git-lfs.github.com/spec/v1\noid sha256:",
            "Git LFS pointer … `git lfs pull`",
        ),
        kind(
            WebPage,
            LOG,
            b"<!DOCTYPE html>\n<html>",
            "a web page … in a browser",
        ),
        kind(
            Xml,
            LOG,
            b"<?xml version=\"1.0\"?>\n<gpx>",
            "it is XML … the log you meant",
        ),
        kind(
            Json,
            LOG,
            b"{\"roll\": 0.1}\n{\"roll\": 0.2}\n",
            "it is JSON … the library mcap",
        ),
        kind(
            Csv,
            LOG,
            "time;roll;pitch\n\"1;0\";2;3 °\n1;2;3\n1;".as_bytes(),
            "a table as text … the library mcap … tabular2mcap",
        ),
        kind(Csv, LOG, b"roll,pitch,yaw\n", "a table as text"),
    ]
}

/// Two packets of MAVLink, each after its time: the first is signed if that is possible.
fn tlog(start: u8) -> Vec<u8> {
    let time = 1_700_000_000_000_000_u64.to_be_bytes();
    let payload = [7; 28];
    let packet = |is_signed: u8| match start {
        0xfd => {
            let head = [start, 28, is_signed, 0, 0, 1, 1, 30, 0, 0];
            let signature = vec![1; 13 * usize::from(is_signed)];
            [&head[..], &payload, &[0xab, 0xcd], &signature].concat()
        }
        _ => [&[start, 28, 0, 1, 1, 30][..], &payload, &[0xab, 0xcd]].concat(),
    };
    [&time[..], &packet(1), &time, &packet(0)].concat()
}

fn tar() -> Vec<u8> {
    let mut tar = vec![0; 512];
    tar[..8].copy_from_slice(b"log.mcap");
    tar[257..262].copy_from_slice(b"ustar");
    tar
}

#[test]
fn a_file_of_another_kind_is_recognised_and_told_what_converts_it() {
    for (_, name, content, advice) in kinds() {
        let folder = Folder::with(name, content);
        let before = folder.contents();
        let (code, out, err) = folder.run_with(&["enrich", name, "--depression", "30"]);
        assert_eq!((code, out.as_str()), (1, ""), "{err}");
        assert_reads(
            &err,
            &format!("error: {name}: not an MCAP file: … {advice}"),
        );
        assert_eq!(folder.contents(), before);
    }
}

#[test]
fn what_comes_through_a_pipe_is_recognised_too() {
    let mut recognised = BTreeSet::new();
    for (format, name, content, _) in kinds() {
        let input = Input::stream("a pipe", Cursor::new(content));
        let folder = tempfile::tempdir().expect("a folder");
        let output = folder.path().join("result.mcap");
        match enrich(input, &output, &options()) {
            Err(Error::Read(ReadError::NotMcap { format: found, .. })) => {
                assert_eq!(found, Some(format), "{name}");
                recognised.insert(format!("{format:?}"));
            }
            other => panic!("{name}: {other:?}"),
        }
        assert!(!output.exists());
    }
    assert_eq!(recognised.len(), 21, "every kind is tried: {recognised:?}");
}

#[test]
fn text_or_bytes_that_mean_nothing_are_not_given_a_name() {
    let cases: [&[u8]; 6] = [
        b"a,b\n",
        b"one, two, three\nfour\n",
        b"\0\0\0\0\0\0\0\0\0\0",
        // A packet of MAVLink that nothing follows.
        &tlog(0xfe)[..40],
        b"\x89MCAP0\r",
        b"a,b,c\x07\n",
    ];
    for content in cases {
        let message = format!("{LOG}: not an MCAP file: … magic bytes … the log you meant");
        let arguments = format!("enrich {LOG} --depression 30");
        Folder::with(LOG, content).refuses(&arguments, 1, &message);
    }
}

/// The commands of an advice.
fn commands(advice: &str) -> impl Iterator<Item = &str> {
    advice.split('`').skip(1).step_by(2)
}

#[test]
fn the_documentation_has_the_same_commands() {
    let page = read("docs/encodings.md");
    for (format, _, content, _) in kinds() {
        let (_, err) = Folder::with("-x", &content).run("enrich ./-x --depression 30", 1);
        for command in commands(&err) {
            let program = command.split(' ').next().expect("a program");
            if !matches!(program, "git" | "pip" | "cargo") {
                assert!(page.contains(program), "{format:?}: {command}");
            }
        }
    }
}
