//! Protobuf messages of any schema.
//!
//! The wanted fields are resolved against the channel's schema once. A message is then read straight from its bytes
//! by field numbers (<https://protobuf.dev/programming-guides/encoding/>), without building it.

mod decoder;
mod fault;
mod schema;

pub use decoder::ProtobufDecoder;
pub use schema::ProtobufSchema;
