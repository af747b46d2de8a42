//! Adds the camera's motion to drone flight logs in MCAP: where it looked, how it moved.
#![forbid(unsafe_code)]

pub mod derived;
pub mod enrich;
pub mod error;
pub mod geometry;
pub mod log;
pub mod messages;
pub mod reader;
pub mod sample;
pub mod source;
pub mod transform;
pub mod writer;

pub use enrich::{Options, Progress, Report, enrich};
pub use error::Error;
