//! What viewers such as Foxglove and Lichtblick have trouble with in a log.
//!
//! It is found in the log's summary, and in those message indexes that have the times in question. A chunk is opened
//! only where such an index is missing.

mod periods;

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;

use crate::{
    log::{Log, ReadError, contents::SegmentKind},
    text::Foreign,
};
use periods::{Period, periods};

/// How often viewers draw, per second. Lichtblick warns of topics with more messages.
const FRAMES_HZ: f64 = 60.0;

/// Shorter series are bursts, of which a rate says little, nanoseconds.
const SHORTEST_SERIES: u64 = 1_000_000_000;

/// The message types that 3D and image panels draw, without their packages.
const DRAWN: [&str; 27] = [
    "CompressedImage",
    "CompressedVideo",
    "FrameTransform",
    "FrameTransforms",
    "Grid",
    "GridCells",
    "Image",
    "ImageAnnotations",
    "LaserScan",
    "Marker",
    "MarkerArray",
    "OccupancyGrid",
    "Odometry",
    "Path",
    "PointCloud",
    "PointCloud2",
    "PolygonStamped",
    "PoseArray",
    "PoseInFrame",
    "PoseStamped",
    "PoseWithCovarianceStamped",
    "PosesInFrame",
    "RawImage",
    "SceneUpdate",
    "TFMessage",
    "TransformStamped",
    "VoxelGrid",
];

/// Something in a log that viewers have trouble with.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
#[non_exhaustive]
pub enum ViewerWarning {
    /// Messages are more than a day before the rest of the log, as those at time 0 are. A viewer's time axis begins
    /// with them, so the rest is squeezed into its end.
    EarlyMessages(FarMessages),
    /// Messages are more than a day after the rest of the log.
    LateMessages(FarMessages),
    /// Topics have more than 60 messages per second, which is as often as viewers draw.
    FastTopics {
        /// The topics: first those that 3D and image panels draw, then the others, each in the order of their rates.
        topics: Vec<FastTopic>,
    },
    /// The log has an index of its chunks, but some chunks do not have all of their message indexes. Readers that seek,
    /// such as Foxglove's, refuse those.
    UnindexedChunks {
        /// How many chunks.
        unindexed: u64,
        /// How many chunks the log has.
        chunks: u64,
    },
}

/// Messages that are more than a day from the rest of the log. A log is divided where it has no message for more than a
/// day; the rest is the part with the most messages.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct FarMessages {
    /// How many there are.
    pub messages: u64,
    /// How many there are on each topic.
    pub topics: BTreeMap<Foreign, u64>,
    /// Log times of the first and the last of them, nanoseconds.
    pub times: [u64; 2],
    /// Log times of the first and the last message of the rest, nanoseconds.
    pub rest: [u64; 2],
}

/// A topic that has more messages per second than viewers draw.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct FastTopic {
    /// Its name.
    pub topic: Foreign,
    /// Messages per second between the first and the last, without those that are far from the rest of the log.
    pub rate_hz: f64,
}

/// Finds what viewers have trouble with in a log.
///
/// # Errors
/// The log cannot be read or is damaged there.
pub(super) fn viewer_warnings(log: &Log) -> Result<Vec<ViewerWarning>, ReadError> {
    let periods = periods(log)?;
    let longest = (0..periods.len()).max_by_key(|&number| periods[number].count());
    let Some(longest) = longest else {
        return Ok(Vec::new());
    };
    let rest = &periods[longest];
    let early = FarMessages::of(log, &periods[..longest], rest);
    let late = FarMessages::of(log, &periods[longest + 1..], rest);
    let warnings = [
        early.map(ViewerWarning::EarlyMessages),
        late.map(ViewerWarning::LateMessages),
        fast_topics(log, rest)?,
        unindexed_chunks(log),
    ];
    Ok(warnings.into_iter().flatten().collect())
}

impl FarMessages {
    fn of(log: &Log, periods: &[Period], rest: &Period) -> Option<Self> {
        let times = [periods.first()?.times[0], periods.last()?.times[1]];
        let mut topics: BTreeMap<Foreign, u64> = BTreeMap::new();
        for (id, count) in periods.iter().flat_map(|period| &period.messages) {
            if let Some(channel) = log.contents.definitions.channels.get(id) {
                let topic = channel.record.topic.as_str();
                *topics.entry(topic.into()).or_default() += count;
            }
        }
        (!topics.is_empty()).then(|| Self {
            messages: topics.values().sum(),
            topics,
            times,
            rest: rest.times,
        })
    }
}

fn fast_topics(log: &Log, rest: &Period) -> Result<Option<ViewerWarning>, ReadError> {
    struct Series {
        is_drawn: bool,
        messages: u64,
        times: [u64; 2],
    }
    let ids: BTreeSet<u16> = rest.messages.keys().copied().collect();
    let ends = log.message_time_ends(&ids, rest.times)?;
    let mut by_topic: BTreeMap<&str, Series> = BTreeMap::new();
    for (channel, _) in log.contents.channels_with_messages() {
        let of_rest = rest.messages.get(&channel.id).zip(ends.get(&channel.id));
        let Some((messages, &times)) = of_rest else {
            continue;
        };
        let series = by_topic.entry(&channel.topic).or_insert(Series {
            is_drawn: false,
            messages: 0,
            times,
        });
        let schema = log.contents.schema_of(channel);
        series.is_drawn |= schema.is_some_and(|schema| is_drawn(&schema.name));
        series.messages += messages;
        let [start, end] = series.times;
        series.times = [start.min(times[0]), end.max(times[1])];
    }
    let fast = by_topic.into_iter().filter_map(|(topic, series)| {
        let span = series.times[1] - series.times[0];
        let rate_hz = (series.messages - 1) as f64 / (span as f64 / 1e9);
        // A camera of 60 frames per second has a few more or less.
        let is_fast = span >= SHORTEST_SERIES && rate_hz.round() > FRAMES_HZ;
        let topic = topic.into();
        is_fast.then_some((series.is_drawn, FastTopic { topic, rate_hz }))
    });
    let mut fast: Vec<(bool, FastTopic)> = fast.collect();
    fast.sort_by(|(is_drawn, a), (is_drawn_too, b)| {
        (is_drawn_too.cmp(is_drawn)).then(b.rate_hz.total_cmp(&a.rate_hz))
    });
    let topics: Vec<FastTopic> = fast.into_iter().map(|(_, topic)| topic).collect();
    Ok((!topics.is_empty()).then_some(ViewerWarning::FastTopics { topics }))
}

/// Whether messages of this type are drawn, whichever package it is of.
fn is_drawn(schema: &str) -> bool {
    let name = schema.rsplit(['.', '/']).next();
    name.is_some_and(|name| DRAWN.contains(&name))
}

fn unindexed_chunks(log: &Log) -> Option<ViewerWarning> {
    // Without an index of the chunks no reader seeks.
    if !log.contents.has_chunk_index {
        return None;
    }
    let segments = log.contents.segments.iter();
    let unindexed = segments.filter(|segment| match segment.kind {
        SegmentKind::Chunk { is_indexed, .. } => !is_indexed,
        SegmentKind::Loose => false,
    });
    let unindexed = unindexed.count() as u64;
    (unindexed > 0).then_some(ViewerWarning::UnindexedChunks {
        unindexed,
        chunks: log.contents.statistics.chunk_count.into(),
    })
}
