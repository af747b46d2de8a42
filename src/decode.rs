//! How messages are encoded: a schema and a path → where the field is, and its value in each message.
//!
//! | file | subject |
//! | --- | --- |
//! | [`path`] | paths to fields, as users and profiles write them |
//! | `field` | what is wanted of a field, and what the schema says it is |
//! | `schema` | the schema and the decoder of a channel, in any encoding: what other modules use |
//! | `resolve` | a path → a place in a schema; all encodings share this walk |
//! | `tree` | the wanted fields of a message, resolved, as decoders walk them |
//! | `pick` | finding the first element of a list that satisfies filters |
//! | `trial` | why a filter never holds |
//! | `value` | the values of the wanted fields of one message |
//! | `error` | why fields cannot be read from a channel's messages |
//! | `fault` | what is wrong with a message that cannot be decoded |
//! | `protobuf`, `json`, `ros` | the encodings |
//!
//! Schemas are read once per channel. Messages are read straight from their bytes, without building them and without
//! allocating. Nothing here knows what the numbers mean.
//!
//! To add an encoding:
//!
//! 1. Write a module of its own modelled on `protobuf`: a schema, whose places implement `resolve::Node`, and
//!    a decoder, which walks `tree::FieldTree` beside the bytes of a message.
//! 2. List the module below.
//! 3. Add the schema and the decoder to the enums in `schema`, where [MCAP's names](https://mcap.dev/spec/registry)
//!    for the encoding select them.

pub mod path;

pub(crate) mod error;
pub(crate) mod fault;
pub(crate) mod field;
mod json;
mod pick;
mod protobuf;
mod resolve;
mod ros;
pub(crate) mod schema;
mod tree;
pub(crate) mod trial;
pub(crate) mod value;

pub(crate) use json::{FirstMessages, Proof};
