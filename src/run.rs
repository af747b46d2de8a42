//! What every run has, whether it enriches a log or restores one.

mod error;

pub use error::{Left, RunError};
