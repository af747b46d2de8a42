//! Derived values → channels appended to a log.
//!
//! The log's bytes up to the end of its data section are copied as they are. Behind them come the new
//! messages, a Metadata record that says how they were made, the log's original end as an attachment, and
//! one summary of the whole. Nothing that the log held is lost, and all of it can be undone.

pub mod destination;
pub mod provenance;

mod append;
mod region;
mod summary;
mod tail;

pub use append::{Appended, Appender};
