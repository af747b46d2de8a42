//! What a flight's own numbers say about how its log was read.
//!
//! A [`Recorder`] keeps what is needed of the samples, in little memory. With the [`Claims`], how they were read, it
//! compares the series with each other: the velocity with the positions (`displacement`) and with what the
//! accelerometer felt (`inertia`); the attitude with the angular rates (`turning`), with gravity (`gravity`) and
//! with how the drone leans where it accelerates (`lean`); the gimbal's angles with the drone's (`gimbal`). Each
//! comparison is made under all sensible readings, and `residual` states what it takes to prove one and to condemn one.
//! What a series shows by itself, as one that jumps to and fro (`jumps`) or has only one time (`times`), is an
//! [`Oddity`].
//!
//! # Tolerances
//!
//! A comparison is made over windows, of which the 40 % that move most are judged, along and across the direction of
//! flight each by themselves. A residual is the median error of those windows as a share of their motion.
//!
//! | compared | window | least motion |
//! | --- | --- | --- |
//! | velocity and positions | 2 s | 1 m horizontally, 0.5 m vertically |
//! | velocity and accelerations | 2 s | a change by 1 m/s, 0.8 m/s |
//! | attitude and velocity: lean | 1 s | 4° |
//! | attitude and angular rates | 0.4 s | 3° |
//! | attitude and gravity | 5 s | none |
//! | gimbal and attitude | 1 s | a tilt by 3°, a turn by 20° |
//!
//! A reading is condemned if its residual is at least 0.5 (0.75 for lean) and another one's is below 0.35, better than
//! half of it, and better in both halves of the flight; with fewer than 32 windows, 0.35 becomes less in proportion, and
//! with fewer than 12 (24 for lean) nothing is condemned. A time is, if the shift is beyond the lag that is allowed by
//! more than twice what it is measured to, and by more than half the time between samples. The tolerances of single
//! series are in `docs/report.md`.

pub mod reading;
pub mod verdict;

mod alternatives;
mod claims;
mod displacement;
mod gimbal;
mod gravity;
mod inertia;
mod judge;
mod jumps;
mod lean;
mod oddity;
mod recorder;
mod residual;
mod shift;
mod times;
mod track;
mod turning;
mod words;

pub use claims::{Claims, ESTIMATE_LAG, RECEIVER_LAG};
pub use oddity::Oddity;
pub use recorder::Recorder;
pub use verdict::{Findings, Outcome, Verdict};
