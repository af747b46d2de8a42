//! Adds the camera's motion to drone flight logs in MCAP: where it looked, how it moved.
//!
//! ```no_run
//! use flightcam::{Options, enrich, geometry::DepressionAngle};
//!
//! let options = Options::new().depression(DepressionAngle::from_degrees(30.0)?);
//! let report = enrich("flight.mcap", "result.mcap", &options)?;
//! println!("{} rotations", report.written[0].messages);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # The map
//!
//! Data flows one way:
//!
//! ```text
//! reader ──samples──▶ transform ──derived──▶ writer
//! (a log in)          (pure mathematics)     (the same log, new channels appended)
//! ```
//!
//! | module | subject | knows |
//! | --- | --- | --- |
//! | [`geometry`] | frames and rotations: pure functions | nobody |
//! | [`sample`] | what flows from reader to transform | nobody |
//! | [`camera`] | how the camera hangs on the drone | geometry, sample |
//! | [`derived`] | what flows from transform to writer | geometry, sample |
//! | [`transform`] | samples → derived values, a state machine without I/O | the four above |
//! | [`log`] | the MCAP container: what a log holds, where its bytes lie; its file, locked and changed under a journal | nobody |
//! | [`decode`] | how messages are encoded: a schema and a path → a value, in protobuf, JSON, ROS 2 and ROS 1 | log |
//! | [`source`] | how a log says it: profiles, and their fields bound to the log's channels | decode, log, sample, geometry |
//! | [`reader`] | log + source → samples in time order | log, source, sample |
//! | [`messages`] | how derived values are written: one file for each message type, with its protobuf, JSON and ROS 2; from `proto/` and `schemas/` | derived |
//! | [`writer`] | derived values → channels added to a log; the original that an enriched log carries; destinations | log, derived, messages |
//! | [`mod@enrich`] | the pipeline: reading, deriving and writing at the same time | all of the above |
//! | [`mod@restore`] | an enriched log → the original | log, writer |
//! | [`mod@inspect`] | what a log has and what would come of it | all but transform and reader |
//! | [`options`] | what the user decides about a run | camera, source, transform, messages, writer |
//! | [`run`] | what every run has: input, output, somebody who watches it, an end | log, writer |
//! | [`report`] | what a run found and did | what it reports on |
//! | [`error`] | what can go wrong, said so that the user knows what to do | |
//!
//! Reader and writer never know each other, and only the command line, in the binary, prints.
//!
//! Where a change goes: a new autopilot is a file in `profiles/`; a new encoding is a decoder in [`decode`] and,
//! if it is to be written too, an [`Encoding`](messages::Encoding); a new derived channel is an arm in [`derived`]
//! and a file in [`messages`], with its definitions in `proto/` and `schemas/`. The compiler leads on from there.
//!
//! # Units and frames
//!
//! Angles are radians, except in the command line and in profiles, which say so. Velocities are metres per
//! second over ground, times nanoseconds of log time. Frames are in [`geometry`].
#![forbid(unsafe_code)]
#![warn(missing_docs)]

pub mod camera;
pub mod decode;
pub mod derived;
pub mod enrich;
pub mod error;
mod fs;
pub mod geometry;
pub mod inspect;
pub mod log;
pub mod messages;
pub mod options;
pub mod reader;
pub mod report;
pub mod restore;
pub mod run;
pub mod sample;
pub mod source;
pub mod transform;
pub mod writer;

#[doc(inline)]
pub use enrich::{derive, enrich};
#[doc(inline)]
pub use error::Error;
pub use fs::ReadAt;
#[doc(inline)]
pub use inspect::inspect;
#[doc(inline)]
pub use options::Options;
#[doc(inline)]
pub use report::Report;
#[doc(inline)]
pub use restore::restore;
#[doc(inline)]
pub use run::{Input, Output, Progress, Watch};
