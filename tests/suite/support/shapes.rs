//! Logs of random and of awkward shapes.

use mcap::{Compression, WriteOptions, records::op};
use proptest::prelude::*;

use super::{Parts, Shape};

/// Any way to write a log that the official writer knows.
pub fn any_shape() -> impl Strategy<Value = Shape> {
    let flags = prop::collection::vec(any::<bool>(), 12);
    let compression =
        prop::sample::select(vec![None, Some(Compression::Zstd), Some(Compression::Lz4)]);
    let ids = prop::sample::select(vec![[1, 2], [0, 1], [65535, 7], [65534, 65535], [9, 0]]);
    let schema_id = prop::sample::select(vec![1, 2, 65535]);
    (flags, compression, 200..20_000u64, ids, schema_id).prop_map(
        |(flags, compression, chunk_size, channel_ids, schema_id)| Shape {
            options: WriteOptions::new()
                .compression_threads(0)
                .compression(compression)
                .chunk_size(Some(chunk_size))
                // Logs without chunks are rarer than one in two.
                .use_chunks(flags[0] || flags[1])
                .emit_message_indexes(flags[2])
                .emit_chunk_indexes(flags[3])
                .emit_statistics(flags[4])
                .emit_summary_offsets(flags[5])
                .repeat_channels(flags[6])
                .repeat_schemas(flags[6])
                .calculate_chunk_crcs(flags[7])
                // Without the chunks' checksums mcap 0.26 writes a wrong one for the data section.
                .calculate_data_section_crc(flags[7] && flags[8])
                .calculate_summary_section_crc(flags[9])
                .emit_attachment_indexes(flags[2])
                .emit_metadata_indexes(flags[4]),
            topic_after_topic: flags[10],
            attachment_and_metadata: flags[11],
            channel_ids,
            schema_id,
            ..Shape::default()
        },
    )
}

/// A log whose summary says the same many times. What replaces it says it once, so that the file gets shorter.
pub fn with_repeated_schemas() -> Vec<u8> {
    let mut parts = Parts::of(&Shape::default().write());
    let schema = parts
        .summary
        .iter()
        .find(|(opcode, _)| *opcode == op::SCHEMA);
    let schema = schema.expect("a schema").clone();
    parts.summary.extend(std::iter::repeat_n(schema, 2000));
    parts.join()
}

/// A log as a recorder leaves it that reserved more room than it came to use.
pub fn with_zeros_at_the_end() -> Vec<u8> {
    let log = Shape::default().write();
    let mut torn = log[..log.len() * 9 / 10].to_vec();
    torn.resize(log.len() + 3_000_000, 0);
    torn
}

/// A log so long that what is derived from it makes several chunks.
pub fn long_log() -> Vec<u8> {
    let shape = Shape::with(|options| options.chunk_size(Some(1024 * 1024)));
    Shape {
        messages: 5000,
        ..shape
    }
    .write()
}
