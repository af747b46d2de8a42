//! Adds the camera's motion to drone flight logs in MCAP: where it looked, how it moved.
//!
//! ```no_run
//! use flightcam::{DepressionAngle, Options};
//!
//! let options = Options::new().depression(DepressionAngle::from_degrees(30.0)?);
//! let report = flightcam::enrich("flight.mcap", "result.mcap", &options)?;
//! println!("{} rotations", report.written[0].messages);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`enrich`] reads an [`Input`] and writes to an [`Output`]; a path is either of them. [`derive()`] gives the values
//! without writing them. [`check()`] says whether a log's own numbers bear out how it is read, [`inspect`] what a log file
//! contains, [`topics`] lists its topics, [`layout`] makes the layout in which a viewer shows an enriched one, and
//! [`restore`] undoes what `enrich` did to one.
//! [`Options`] say how the camera is mounted and, with a [`Request`] or a [`profile::Profile`], where the log has its
//! telemetry.
//!
//! What is listed here is the interface. The modules that are not shown are internal: they are public only for
//! flightcam's own tests and benchmarks, and change without notice.
//!
//! # Units and frames
//!
//! Angles are radians, except where a name says degrees (`from_degrees`, `depression_deg`) and in profiles, which name
//! their unit. Velocities are metres per second over ground. Times are nanoseconds of log time; spans that people
//! choose, such as the maximum gap, are seconds. Frames are explained in [`geometry`].
//!
//! # The map, for those who change the code
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
//! | `text` | text that flightcam did not write, as people get to read it | nothing |
//! | `similar` | names that were likely meant, where one is not there | nothing |
//! | `geometry` | frames and rotations: pure functions | nothing |
//! | `sample` | what flows from reader to transform | geometry |
//! | `derived` | what flows from transform to writer | geometry, sample |
//! | `camera` | how the camera is mounted on the drone | geometry, sample, derived |
//! | `transform` | samples → derived values, a state machine without I/O | the four above |
//! | `check` | samples → what a flight's own numbers say about how its log was read, without I/O | geometry, sample |
//! | `visuals` | samples and what the transform knows of them → what viewers are shown, without I/O | geometry, sample, derived, camera, transform |
//! | `fs` | locks, reading and writing by position, durability: what `std::fs` lacks | nothing |
//! | `log` | the MCAP container: what a log contains and where, its messages | fs, text |
//! | `decode` | how messages are encoded: a schema and a path → a value, in protobuf, JSON, ROS 2 and ROS 1 | log, similar |
//! | `source` | what messages mean: profiles, the one that fits, its fields bound to the log's channels | decode, log, sample, geometry, camera, similar; messages, to leave out what flightcam wrote |
//! | `clock` | where the time of a log's messages goes back for good: its epochs | log, source, sample |
//! | `reader` | log + source → samples in time order, epoch by epoch | log, source, sample, clock |
//! | `messages` | how derived values and what viewers are shown are written: a file for each message type, in protobuf, JSON and ROS 2 | geometry, derived |
//! | `writer` | derived values → channels added to a log; the journal of a change in place; the original that an enriched log carries | fs, log, derived, messages |
//! | `watch` | progress and cancellation | writer |
//! | `options` | what the caller decides about a run | camera, source, transform, messages, writer, watch |
//! | `report` | what a run found and did, as data | what it reports on |
//! | `run` | what all runs share: an input, an output, a watcher, an outcome | fs, log, watch, writer, report |
//! | `enrich` | the main run: input → job (a thread that sends batches) → sink → report | all of the above |
//! | `examine` | a log's telemetry → what `check` says about how it was read | log, source, reader, check, enrich, report |
//! | `restore` | an enriched log → the original | log, writer, run |
//! | `inspect` | what a log contains and what `enrich` would produce | all but transform, reader and enrich |
//! | `layout` | an enriched log → the layout in which a viewer shows it | text, log, decode, source, derived, visuals, messages, writer, report, run |
//! | `error` | the errors of all layers, joined; what runs end with | their errors |
//! | `cli` | in the binary: arguments → options → run → words | the interface |
//!
//! Reader and writer never know each other. Only the command line, in the binary, prints, and only it names options.
//! CONTRIBUTING.md says where a change goes.
#![forbid(unsafe_code)]
#![deny(clippy::disallowed_methods, clippy::print_stdout, clippy::print_stderr)]
#![warn(missing_docs)]

pub mod error;
pub mod geometry;

mod fs;
mod similar;

#[doc(hidden)]
pub mod camera;
#[doc(hidden)]
pub mod check;
#[doc(hidden)]
pub mod clock;
#[doc(hidden)]
pub mod decode;
#[doc(hidden)]
pub mod derived;
#[doc(hidden)]
pub mod enrich;
#[doc(hidden)]
pub mod examine;
#[doc(hidden)]
pub mod inspect;
#[doc(hidden)]
pub mod layout;
#[doc(hidden)]
pub mod log;
#[doc(hidden)]
pub mod messages;
#[doc(hidden)]
pub mod options;
#[doc(hidden)]
pub mod reader;
#[doc(hidden)]
pub mod report;
#[doc(hidden)]
pub mod restore;
#[doc(hidden)]
pub mod run;
#[doc(hidden)]
pub mod sample;
#[doc(hidden)]
pub mod source;
#[doc(hidden)]
pub mod text;
#[doc(hidden)]
pub mod transform;
#[doc(hidden)]
pub mod visuals;
#[doc(hidden)]
pub mod watch;
#[doc(hidden)]
pub mod writer;

/// Profiles: how an autopilot or a logger names its telemetry, and in which conventions it writes it.
pub mod profile {
    pub use crate::source::profile::{
        AccelerationFields, Alternative, AngularRateFields, AttitudeFields, CameraSetup,
        Components, Condition, Coordinates, Euler, GimbalFields, HeightFields, Location,
        OptionalField, Orientation, Pitch, Primary, Profile, Quaternion, RoleFields, SampleTime,
        Test, TimeField, VelocityFields, Written,
        convention::{
            AccelerationUnit, AngleUnit, Axes, BodyAxes, Convention, EulerOrder, LengthUnit,
            NotAConvention, NotAxes, PositiveDirection, QuaternionOrder, RateUnit, SpeedUnit,
            TimeUnit, WorldAxes,
        },
    };
    pub use crate::{
        decode::{
            path::{Comparison, FieldPath, Filter, Literal},
            value::Number,
        },
        sample::GimbalReference,
    };
}

pub use camera::{FieldOfView, FieldOfViewOutOfRange, Mount, MountOutOfRange};
pub use clock::ClockStep;
pub use decode::trial::UnmetFilter;
pub use derived::{Derived, Quantity, Value};
pub use enrich::{derive, enrich};
pub use error::Error;
pub use examine::{CheckReport, check};
pub use fs::ReadAt;
pub use geometry::{DepressionAngle, DepressionOutOfRange};
pub use inspect::{
    FarMessages, FastTopic, FirstSample, FoundRole, Inspection, ListedTopic, Planned, Problem,
    RoleReport, Telemetry, TopicGroup, TopicList, ViewerWarning, inspect, topics,
};
pub use layout::{LayoutError, Viewer, ViewerLayout, layout};
pub use messages::{Encoding, EncodingChoice};
pub use options::Options;
pub use report::{
    CameraReport, Chosen, DeriveReport, EncodingReport, FieldOfViewReport, GroundBecause,
    GroundReport, Lack, MissingReason, MissingTopic, Note, ProfileReport, Report, SampleReport,
    VisualsReport, WrittenTopic,
};
pub use restore::{Restored, restore};
pub use run::{Input, Output};
pub use sample::{DropReason, Kind, Stamp, Tallies, Tally, VelocityFrom};
pub use source::{
    Because, FoundValue, NamedFrame, Origin, PassedOver, ReadAs, Reading, RefusedFrames, RunnerUp,
    SeenPlace, UnmetCondition, WrittenQuaternion,
    profile::ProfileChoice,
    request::{BadArgument, HowAsked, Request, RoleArgument},
    undecodable::UndecodableMessage,
};
pub use text::Foreign;
pub use transform::{
    Breaks, MaxGap, MaxGapOutOfRange, MinInterval, MinIntervalOutOfRange, Motion, Sighting,
};
pub use visuals::{
    Ground, Reach, ReachOutOfRange, VisualOptions, VisualRate, VisualRateOutOfRange,
};
pub use watch::{Progress, Watch};
pub use writer::{Layout, provenance::EarlierRun};
