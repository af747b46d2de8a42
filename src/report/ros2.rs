//! What somebody who uses ROS 2 should know of a result.

use std::{
    fs::{self, File},
    io::Read,
    path::{Path, PathBuf},
};

use mcap::records::Channel;

use crate::{
    log::Log,
    messages::{Encoding, EncodingChoice, LAST_SECOND},
};

pub(super) fn notes(
    log: &Log,
    output: &Path,
    choice: EncodingChoice,
    used: Encoding,
) -> impl Iterator<Item = String> {
    let mixture = match choice {
        // The telemetry's own encoding adds nothing to a mixture.
        EncodingChoice::Automatic => None,
        EncodingChoice::Given(_) => mixture(log, used),
    };
    let late = (used == Encoding::Ros2
        && log.contents.statistics.message_end_time / 1_000_000_000 > LAST_SECOND)
        .then(|| {
            "the log goes on beyond 2038-01-19T03:14:07Z, the last second that a ROS 2 stamp can say: \
             stamps stay there, but log times are right"
                .to_owned()
        });
    let outdated = [log.file.path(), output].into_iter().find_map(bag_metadata);
    let outdated = outdated.map(|metadata| {
        format!(
            "{} does not list the result with its new topics; to use the result as a ROS 2 bag, put it into a \
             folder of its own under a name that ends in _0.mcap, and run \
             `ros2 bag reindex -s mcap FOLDER`",
            metadata.display()
        )
    });
    [mixture, late, outdated].into_iter().flatten()
}

/// What the new channels are to ROS 2 tools, which read a file only if all of its channels are ROS 2.
fn mixture(log: &Log, used: Encoding) -> Option<String> {
    let channels = log.contents.definitions.channels.values();
    let mut foreign = channels
        .map(|channel| &channel.record)
        .filter(|channel| !is_ros2(log, channel));
    match (foreign.next(), used) {
        (None, Encoding::Protobuf | Encoding::Json) => Some(
            "ROS 2 tools such as rosbags refuse a file in which one channel is not ROS 2, \
             as now the new ones; use --encoding ros2"
                .to_owned(),
        ),
        (Some(channel), Encoding::Ros2) => Some(format!(
            "ROS 2 tools such as rosbags refuse a file in which one channel is not ROS 2, \
             as {} of the log ({})",
            channel.topic, channel.message_encoding
        )),
        (None, Encoding::Ros2) | (Some(_), Encoding::Protobuf | Encoding::Json) => None,
    }
}

fn is_ros2(log: &Log, channel: &Channel) -> bool {
    let schema = log.contents.schema_of(channel);
    channel.message_encoding == Encoding::Ros2.message_encoding()
        && schema.is_some_and(|schema| ["ros2msg", "ros2idl"].contains(&schema.encoding.as_str()))
}

/// The description of the ROS 2 bag that a file lies in the folder of, if it does.
fn bag_metadata(file: &Path) -> Option<PathBuf> {
    /// rosbag2 writes it first of all.
    const KEY: &[u8] = b"rosbag2_bagfile_information:";
    let path = file.parent()?.join("metadata.yaml");
    // Anything else, such as a pipe, might keep the reader waiting.
    let is_file = fs::metadata(&path).is_ok_and(|metadata| metadata.is_file());
    let mut start = Vec::new();
    let file = is_file.then(|| File::open(&path).ok())??;
    file.take(64 * 1024).read_to_end(&mut start).ok()?;
    let mut lines = start.split(|&byte| byte == b'\n');
    lines.any(|line| line.starts_with(KEY)).then_some(path)
}
