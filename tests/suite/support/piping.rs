//! Logs from a pipe, against the same logs in files.

use std::{
    fmt::Debug,
    io::{self, Read},
    path::Path,
};

use flightcam::{
    log::{
        Log, ReadError, SegmentReader,
        contents::{Contents, SegmentKind},
        stream::{Named, Passing, Streamed, pass_through},
    },
    reader::Reader,
    source::{Source, request::Request, stream_filter::StreamFilter},
};
use mcap::{WriteOptions, records::MessageHeader};

use super::folder::*;

/// A stream that gives at most that many bytes at a time.
pub struct Pieces<'a> {
    pub rest: &'a [u8],
    pub most: usize,
}

impl Read for Pieces<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let most = self.most.min(buffer.len());
        self.rest.take(most as u64).read(buffer).inspect(|&read| {
            self.rest = &self.rest[read..];
        })
    }
}

/// What is passed on of a stream, and what is then known about it.
pub fn pipe(
    name: &Path,
    input: impl Read,
    follow: impl FnMut(Passing) -> bool,
) -> (Vec<u8>, Result<Streamed, ReadError>) {
    let mut output = Vec::new();
    let streamed = pass_through(
        Named {
            name,
            stream: input,
        },
        Named {
            name: Path::new("the output"),
            stream: &mut output,
        },
        follow,
    );
    (output, streamed)
}

/// What is selected as a log's telemetry, and every sample of it, as text.
pub fn telemetry(log: &Log, request: &Request) -> Result<(String, Vec<String>), String> {
    let source = Source::compare(log, request).map_err(|error| error.to_string())?;
    let selected = format!(
        "{:?} {:?} {:#?} {:#?} {:#?} {:?}",
        source.profile.name,
        source.namespace(),
        source.roles(),
        source.runners_up,
        source.passed_over,
        source.channel_ids(),
    );
    let mut samples = Vec::new();
    let read = Reader::new(log, source).and_then(|reader| {
        reader.for_each(|arrival| {
            samples.push(format!("{:?}", arrival.sample));
            Ok::<_, ReadError>(())
        })
    });
    let dropped = read.map_err(|error| error.to_string())?.dropped;
    samples.push(format!("{dropped:?}"));
    Ok((selected, samples))
}

/// Checks that a log in pieces of at most that many bytes is passed on completely and understood as if it were
/// opened as a file. Returns what is known about it.
#[track_caller]
pub fn check(log: &[u8], request: &Request, most: usize) -> Option<Streamed> {
    let folder = Folder::with(LOG, log);
    let path = folder.path(LOG);
    let mut filter = StreamFilter::new(request);
    let input = Pieces { rest: log, most };
    let (output, streamed) = pipe(&path, input, |passing| filter.include(passing));
    assert!(log.starts_with(&output), "nothing else is passed on");
    match (Log::open(&path), streamed) {
        (Ok(opened), Ok(streamed)) => {
            assert_eq!(output.len() as u64, streamed.original.data_end);
            check_original(log, &streamed.original, &opened);
            let (from_stream, from_file) = (
                telemetry(&streamed.telemetry, request),
                telemetry(&opened, request),
            );
            assert!(
                from_stream == from_file,
                "streamed: {from_stream:#?}\nopened: {from_file:#?}"
            );
            Some(streamed)
        }
        (Err(opened), Err(streamed)) => {
            assert_eq!(streamed.to_string(), opened.to_string());
            None
        }
        (opened, streamed) => panic!("opened: {opened:#?}\nstreamed: {streamed:#?}"),
    }
}

#[track_caller]
fn check_original(log: &[u8], streamed: &Log, opened: &Log) {
    same(&streamed.header, &opened.header);
    same(&streamed.data_end, &opened.data_end);
    same(&streamed.data_crc, &opened.data_crc);
    same(&streamed.scanned, &opened.scanned);
    same(&streamed.breaks_off_at, &opened.breaks_off_at);
    same_contents(&streamed.contents, &opened.contents);

    let data_end = streamed.data_end as usize;
    let ends = data_end.min(64 * 1024);
    for kept in [0..ends, data_end - ends..data_end, data_end..log.len()] {
        let length = kept.len() as u64;
        let read = streamed.file.read(kept.start as u64, length);
        assert!(read.expect("the end is kept") == log[kept]);
    }
    assert_eq!(streamed.file.length(), log.len() as u64);
    for metadata in &opened.contents.metadata {
        let name = &metadata.record.name;
        // What is in one is read only here, so it may be damaged.
        let [kept, read] =
            [streamed, opened].map(|log| log.metadata(name).map_err(|error| error.to_string()));
        assert_eq!(kept, read, "metadata records are kept");
    }
    let (mut kept, mut all) = (SegmentReader::new(streamed), SegmentReader::new(opened));
    for segment in &opened.contents.segments {
        if let SegmentKind::Chunk {
            is_indexed: false, ..
        } = segment.kind
        {
            let indexes = kept.message_indexes(segment).expect("the chunk is kept");
            assert_eq!(indexes, all.message_indexes(segment).expect("readable"));
        }
    }
}

#[track_caller]
fn same_contents(streamed: &Contents, opened: &Contents) {
    same(&streamed.definitions, &opened.definitions);
    same(&streamed.segments, &opened.segments);
    same(&streamed.attachments, &opened.attachments);
    same(&streamed.metadata, &opened.metadata);
    same(&streamed.statistics, &opened.statistics);
    same(
        &streamed.mentioned_channel_ids,
        &opened.mentioned_channel_ids,
    );
    same(&streamed.unknown_summary, &opened.unknown_summary);
}

#[track_caller]
fn same(streamed: &impl Debug, opened: &impl Debug) {
    let (streamed, opened) = (format!("{streamed:#?}"), format!("{opened:#?}"));
    assert!(streamed == opened, "streamed: {streamed}\nopened: {opened}");
}

/// The messages of a log, written with other options.
pub fn rewritten(log: &[u8], options: WriteOptions) -> Vec<u8> {
    let mut writer = options
        .create(io::Cursor::new(Vec::new()))
        .expect("a writer");
    let mut schemas = std::collections::BTreeMap::new();
    let mut channels = std::collections::BTreeMap::new();
    for message in mcap::MessageStream::new(log).expect("a log") {
        let message = message.expect("a message");
        let channel = &message.channel;
        let channel_id = *channels.entry(channel.id).or_insert_with(|| {
            let schema_id = channel.schema.as_ref().map_or(0, |schema| {
                *schemas.entry(schema.id).or_insert_with(|| {
                    writer
                        .add_schema(&schema.name, &schema.encoding, &schema.data)
                        .expect("a schema")
                })
            });
            let (topic, encoding) = (&channel.topic, &channel.message_encoding);
            writer
                .add_channel(schema_id, topic, encoding, &channel.metadata)
                .expect("a channel")
        });
        let header = MessageHeader {
            channel_id,
            sequence: message.sequence,
            log_time: message.log_time,
            publish_time: message.publish_time,
        };
        writer
            .write_to_known_channel(&header, &message.data)
            .expect("a message");
    }
    writer.finish().expect("the log is finished");
    writer.into_inner().into_inner()
}
