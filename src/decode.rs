//! How messages are encoded: a schema and a path → where the field lies, and its value in each message.
//!
//! Protobuf, JSON, and ROS 2 and ROS 1 messages are read straight from their bytes; nothing here knows what the
//! numbers mean.

pub mod path;

pub(crate) mod error;
pub(crate) mod examples;
pub(crate) mod field;
mod json;
mod protobuf;
mod ros;
pub(crate) mod schema;
mod tree;
pub(crate) mod value;
