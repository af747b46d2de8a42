//! The library's reports, which are data, in words for the terminal.

pub mod advice;
mod angles;
pub mod as_argument;
mod camera;
pub mod checked;
mod frames;
mod missing;
mod note;
mod passed_over;
mod sample;
mod viewers;

pub use angles::other_unit;
pub use camera::camera;
pub use frames::{read_as, refused_frames};
pub use missing::{missing, velocity_from_position};
pub use note::note;
use passed_over::passed_over;
pub use sample::{first_sample, label};
pub use viewers::viewer_warning;

use std::fmt::Display;

use flightcam::{
    report::{Chosen, ProfileReport},
    text,
};
use indicatif::HumanCount;

/// The profile, and why it was chosen.
pub fn profile(profile: &ProfileReport) -> String {
    let ProfileReport {
        name,
        attitude,
        beside,
        ..
    } = profile;
    match (profile.chosen, beside) {
        (Chosen::Automatically, Some(beside)) => {
            format!("{name} for what was not given, chosen because {beside}")
        }
        (_, None) if profile.fallback => format!(
            "{name}, because no other fits; {attitude}, assumed to be the drone's and in the axes below"
        ),
        (Chosen::Automatically, None) => format!("{name}, chosen because {attitude}"),
        (Chosen::ByRequest, _) => format!("{name}, as asked for; {attitude}"),
    }
}

/// A count of things, with the noun in the plural unless the count is one.
pub fn plural(count: u64, thing: &str) -> String {
    let ending = if count == 1 { "" } else { "s" };
    format!("{} {thing}{ending}", HumanCount(count))
}

/// The first few of some names, and how many more there are.
pub fn first_few<T: Display>(names: impl ExactSizeIterator<Item = T>) -> String {
    const NAMED: usize = 4;
    let more = match names.len().saturating_sub(NAMED) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    format!("{}{more}", text::join(names.take(NAMED), ", "))
}

/// Things as a sentence lists them: "this, that and another".
pub fn list(things: &[String]) -> String {
    match things {
        [] => String::new(),
        [only] => only.clone(),
        [others @ .., last] => format!("{} and {last}", others.join(", ")),
    }
}
