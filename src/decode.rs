//! How messages are encoded: a schema and a path → where the field is, and its value in each message.
//!
//! Nothing here knows what the numbers mean.

pub mod path;

pub(crate) mod error;
pub(crate) mod field;
pub(crate) mod json;
mod protobuf;
mod resolve;
mod ros;
pub(crate) mod schema;
mod tree;
pub(crate) mod value;
