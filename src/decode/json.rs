//! JSON messages, with a JSON Schema or without one.
//!
//! A JSON Schema need not list every field, and a string may hold a number, so the channel's first messages say what
//! the schema leaves open. A message is then read by a streaming parser, without building it.

mod decoder;
mod fault;
mod first_messages;
mod non_finite;
mod schema;

pub use decoder::JsonDecoder;
pub use first_messages::FirstMessages;
pub use schema::{JsonSchema, Proof};
