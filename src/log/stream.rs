//! A log that is read once, from front to back, and passed on at the same time, because it comes through a pipe.
//!
//! What may be needed again is kept in temporary files: the selected messages, and of all other bytes only those that
//! appending needs. Memory holds one record at a time, and of a long one only a piece.

mod excerpt;
mod pipe;
mod spool;

use std::{
    io::{Read, Write},
    path::Path,
};

use mcap::records::{Channel, op};

use super::{
    Log, Stop,
    contents::Definitions,
    error::ReadError,
    record::RawMessage,
    scan::{Bodies, Collector},
    summary::Ending,
};
use excerpt::Excerpt;
use pipe::{Pipe, pass_on_the_rest};

/// A stream and its name in errors.
#[derive(Debug)]
pub struct Named<'a, T> {
    /// Its name.
    pub name: &'a Path,
    /// The stream itself.
    pub stream: T,
}

impl<'a, T> Named<'a, T> {
    /// A stream with this name.
    pub fn new(name: &'a Path, stream: T) -> Self {
        Self { name, stream }
    }
}

/// A message of a log that is passed on.
#[derive(Debug, Clone, Copy)]
pub struct Passing<'a> {
    /// The message.
    pub message: &'a RawMessage<'a>,
    /// Its channel.
    pub channel: &'a Channel,
    /// The number of its segment, counted from 0.
    pub segment: usize,
    /// What the log has defined so far.
    pub definitions: &'a Definitions,
}

/// A log that was read from a stream and passed on, up to the end of its data section.
#[derive(Debug)]
pub struct Streamed {
    /// The log as it arrived. Only the bytes that appending needs can be read, at their offsets: the first and the last
    /// 64 KiB of the data section, everything after that, Metadata records, and chunks that are not indexed.
    pub original: Log,
    /// The selected messages, as a log of their own. Everything else that it says is true of the original: which
    /// channels there are, and how many messages each segment has at which times, so that the same telemetry is found
    /// in it as in the original.
    pub telemetry: Log,
}

/// Passes a log on as it arrives, record by record, up to the end of its data section: a DataEnd record, a footer, or a
/// record that breaks off. The rest is held back, unless the log goes on after the record that ends its data: then all of
/// it is passed on, and that is an error. The messages that `select` selects are kept, and those of channels
/// that were not defined before them.
///
/// # Errors
/// The input cannot be read, is not an MCAP, or is damaged; the output cannot be written, perhaps because its
/// reader has gone away; or there is no room for temporary files.
pub fn pass_through(
    input: Named<impl Read>,
    output: Named<impl Write>,
    select: impl FnMut(Passing) -> bool,
) -> Result<Streamed, ReadError> {
    let name = input.name;
    let mut pipe = Pipe::new(input, output)?;
    let header = pipe.pass_on_header()?;
    let mut collector = Collector::default();
    let mut excerpt = Excerpt::new(select)?;
    let stop = loop {
        let offset = pipe.position();
        let Some(frame) = pipe.read_frame()? else {
            break Stop::Torn { offset };
        };
        if frame.opcode != op::MESSAGE_INDEX
            && let Some(is_indexed) = collector.close_chunk()
        {
            pipe.settle_chunk(is_indexed)?;
        }
        if !pipe.read_body(&frame)? {
            break Stop::Torn { offset };
        }
        let mut body = pipe.body(&frame)?;
        if let Some(stop) = Stop::at(&mut body, &frame)? {
            break stop;
        }

        let segment = collector.segments();
        collector.record_and_visit(&mut body, &frame, |definitions, message, record| {
            excerpt.consider(definitions, segment, message, record);
        })?;
        if frame.opcode == op::MESSAGE {
            let record = body.whole(&frame)?;
            if let Some(message) = RawMessage::parse(record) {
                let definitions = &collector.contents.definitions;
                let segment = collector.segments() - 1;
                excerpt.consider(definitions, segment, &message, record);
            }
        }
        excerpt.write_to(collector.segments())?;
        pipe.pass_on(&frame)?;
    };
    if collector.close_chunk() == Some(false) {
        pipe.settle_chunk(false)?;
    }
    let data_end = pipe.position();
    let (file, mut output) = pipe.hold_back_the_rest()?;
    let close = Ending::read(&file, data_end).and_then(|ending| stop.close(&file, ending));
    let close = match close {
        Ok(close) => close,
        // Nothing can be appended, so the next program in the pipe gets the log as it is.
        Err(damage) => {
            pass_on_the_rest(&file, data_end, &mut output)?;
            return Err(damage);
        }
    };
    let original = Log::read_to_end(file, header, close, stop, collector)?;
    Ok(Streamed {
        telemetry: excerpt.finish(name, &original)?,
        original,
    })
}
