//! What ROS 2 users should know about a result.

use std::{
    fs::{self, File},
    io::Read,
    path::{Path, PathBuf},
};

use mcap::records::Channel;

use super::Note;
use crate::{
    log::Log,
    messages::{Encoding, EncodingChoice, LAST_SECOND},
};

pub(super) fn notes(
    log: &Log,
    output: &Path,
    choice: EncodingChoice,
    used: Encoding,
) -> impl Iterator<Item = Note> {
    let mixture = match choice {
        // The telemetry's own encoding adds nothing to a mixture.
        EncodingChoice::Automatic => None,
        EncodingChoice::Given(_) => mixture(log, used),
    };
    let last_second = log.contents.statistics.message_end_time / 1_000_000_000;
    let overflows = used == Encoding::Ros2 && last_second > LAST_SECOND;
    let outdated = [log.file.path(), output].into_iter().find_map(bag_metadata);
    let notes = [
        mixture,
        overflows.then_some(Note::Ros2StampOverflow),
        outdated.map(|path| Note::BagMetadataOutdated { path }),
    ];
    notes.into_iter().flatten()
}

/// What the new channels are to ROS 2 tools, which read a file only if all of its channels are ROS 2.
fn mixture(log: &Log, used: Encoding) -> Option<Note> {
    let channels = log.contents.definitions.channels.values();
    let mut foreign = channels
        .map(|channel| &channel.record)
        .filter(|channel| !is_ros2(log, channel));
    match (foreign.next(), used == Encoding::Ros2) {
        (None, false) => Some(Note::NewChannelsNotRos2),
        (Some(channel), true) => Some(Note::ChannelNotRos2 {
            topic: (&channel.topic).into(),
            message_encoding: (&channel.message_encoding).into(),
        }),
        (None, true) | (Some(_), false) => None,
    }
}

fn is_ros2(log: &Log, channel: &Channel) -> bool {
    let schema = log.contents.schema_of(channel);
    channel.message_encoding == Encoding::Ros2.message_encoding()
        && schema.is_some_and(|schema| ["ros2msg", "ros2idl"].contains(&schema.encoding.as_str()))
}

/// The description of the ROS 2 bag in whose folder a file is, if it is in one.
fn bag_metadata(file: &Path) -> Option<PathBuf> {
    /// rosbag2 writes it first of all.
    const KEY: &[u8] = b"rosbag2_bagfile_information:";
    let path = file.parent()?.join("metadata.yaml");
    // Anything else, such as a pipe, might block the reader.
    let is_file = fs::metadata(&path).is_ok_and(|metadata| metadata.is_file());
    let mut start = Vec::new();
    let file = is_file.then(|| File::open(&path).ok())??;
    file.take(64 * 1024).read_to_end(&mut start).ok()?;
    let mut lines = start.split(|&byte| byte == b'\n');
    lines.any(|line| line.starts_with(KEY)).then_some(path)
}
