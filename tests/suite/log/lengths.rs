//! Lengths that lie: nothing is allocated for them.

use flightcam::log::record::{parse, serialize};
use mcap::records::{
    AttachmentHeader, AttachmentIndex, Channel, ChunkHeader, ChunkIndex, Footer, Header,
    MessageHeader, MessageIndex, Metadata, MetadataIndex, Statistics, op,
};

use crate::support::{folder::*, forging::*};

/// The records whose lengths are lies cannot be read, whatever reads them; all others can.
#[test]
fn every_kind_of_record_has_its_lengths_checked() {
    fn is_readable(record: &Forgery) -> bool {
        let body = &record.body;
        match record.opcode {
            op::HEADER => parse::<Header>(body).is_ok(),
            op::FOOTER => parse::<Footer>(body).is_ok(),
            op::CHANNEL => parse::<Channel>(body).is_ok(),
            op::MESSAGE => parse::<MessageHeader>(body).is_ok(),
            op::CHUNK => parse::<ChunkHeader>(body).is_ok(),
            op::MESSAGE_INDEX => parse::<MessageIndex>(body).is_ok(),
            op::CHUNK_INDEX => parse::<ChunkIndex>(body).is_ok(),
            op::ATTACHMENT => parse::<AttachmentHeader>(body).is_ok(),
            op::ATTACHMENT_INDEX => parse::<AttachmentIndex>(body).is_ok(),
            op::STATISTICS => parse::<Statistics>(body).is_ok(),
            op::METADATA => parse::<Metadata>(body).is_ok(),
            op::METADATA_INDEX => parse::<MetadataIndex>(body).is_ok(),
            op::SCHEMA => flightcam::log::contents::SchemaRecord::parse(body).is_some(),
            _ => true,
        }
    }
    for record in one_of_each() {
        assert!(is_readable(&record), "{}", record.name);
        // Eight bytes are never the length of what follows in the same record, but of an attachment's content.
        let texts = record.lengths.iter().filter(|(_, width)| *width == 4);
        let lies = record.lies().zip(&record.lengths);
        let refused = lies.filter(|(lie, (_, width))| *width == 4 && !is_readable(lie));
        assert_eq!(refused.count(), texts.count(), "{}", record.name);
    }
}

/// What is allocated for a lie is what is there.
#[test]
fn nothing_is_allocated_for_a_length_that_lies() {
    for place in Place::ALL {
        for record in one_of_each() {
            for lie in record.lies() {
                let log = place.put(lie.opcode, &lie.body);
                let folder = Folder::with(LOG, &log);
                let path = folder.path(LOG);
                let allocations = allocation_counter::measure(|| {
                    let _ = flightcam::log::Log::open(&path);
                });
                let limit = 2 * 1024 * 1024;
                assert!(allocations.bytes_max < limit, "{place:?}: {}", lie.name);
            }
        }
    }
}

#[test]
fn a_chunk_cannot_hold_more_than_its_compressed_bytes_can_become() {
    for compression in ["zstd", "lz4"] {
        let header = ChunkHeader {
            message_start_time: 0,
            message_end_time: 0,
            uncompressed_size: 250 * 1024 * 1024,
            uncompressed_crc: 0,
            compression: compression.to_owned(),
            compressed_size: 10,
        };
        let chunk = [serialize(&header), vec![0; 10]].concat();
        let log = Place::Data.put(op::CHUNK, &chunk);
        let folder = Folder::with(LOG, log);
        let message = "the chunk there is unreadable: it is said to hold 262144000 bytes, which cannot come from 10";
        folder.refuses(&format!("enrich {LOG} --depression 30"), 1, message);
    }
}
