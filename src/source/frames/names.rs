//! A frame's name → the axes that it stands for.
//!
//! ROS names coordinate frames, and leaves their axes to conventions: a frame of the world is east, north, up, and a
//! body's is front, left, up (REP 103, <https://www.ros.org/reps/rep-0103.html>), unless its name says `ned`, as for
//! IMUs in REP 145 (<https://www.ros.org/reps/rep-0145.html>). MAVROS (`odom_ned`, `base_link_frd`) and AirSim
//! (`world_ned`, `odom_local_ned`) name theirs in the same way. REP 105
//! (<https://www.ros.org/reps/rep-0105.html>) has the usual names: `map`, `odom`, `base_link`, and `earth`, which is
//! fixed to the planet's centre.

use crate::geometry::axes::{BodyAxes, WorldAxes};

/// What a frame's name says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FrameName {
    letters: Option<Letters>,
    /// Whose frame it is, if the name says.
    pub of: Option<Owner>,
}

/// Whose frame it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Owner {
    /// The drone's own.
    Drone,
    /// The world's, at the place where the drone is.
    World,
    /// The planet's: its axes point to the pole and the meridians, not north, east and down.
    Planet,
}

/// Axes that names mention.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Letters {
    Ned,
    Enu,
    Nwu,
    Frd,
    Flu,
}

const LETTERS: [(&str, Letters); 5] = [
    ("ned", Letters::Ned),
    ("enu", Letters::Enu),
    ("nwu", Letters::Nwu),
    ("frd", Letters::Frd),
    ("flu", Letters::Flu),
];

/// Words in the names of the world's frames.
const WORLD: [&str; 13] = [
    "world",
    "map",
    "odom",
    "local",
    "global",
    "origin",
    "inertial",
    "ground",
    "utm",
    "mocap",
    "vicon",
    "optitrack",
    "nav",
];

/// Words in the names of the drone's.
const DRONE: [&str; 9] = [
    "baselink",
    "body",
    "fcu",
    "imu",
    "airframe",
    "fuselage",
    "cog",
    "footprint",
    "stabilized",
];

/// Words in the names of the planet's.
const PLANET: [&str; 2] = ["ecef", "earth"];

/// Words that say nothing by themselves, but may stand before axes without anything between.
const OTHER: [&str; 4] = ["base", "link", "frame", "ref"];

impl FrameName {
    /// Reads a name. In a name with slashes, what comes before the last is the vehicle's.
    pub fn read(name: &str) -> Self {
        let name = name.trim_end_matches('/');
        let name = name.rsplit('/').next().unwrap_or(name);
        let words = words(name);
        let has_any = |known: &[&str]| words.iter().any(|word| known.contains(&word.as_str()));
        let is_base_link = words
            .windows(2)
            .any(|pair| pair[0] == "base" && pair[1] == "link");
        Self {
            letters: words.iter().find_map(|word| {
                let mut letters = LETTERS.iter();
                letters
                    .find(|(text, _)| word == text)
                    .map(|(_, letters)| *letters)
            }),
            of: match () {
                () if is_base_link || has_any(&DRONE) => Some(Owner::Drone),
                () if has_any(&WORLD) => Some(Owner::World),
                () if has_any(&PLANET) => Some(Owner::Planet),
                () => None,
            },
        }
    }

    /// The axes that the name says, of the world: those of a drone's frame that keeps level and does not turn are north,
    /// east, down (or north, west, up) except for where north is, which it leaves open.
    pub fn world(self) -> Option<WorldAxes> {
        Some(match self.letters? {
            Letters::Ned | Letters::Frd => WorldAxes::NED,
            Letters::Enu => WorldAxes::ENU,
            Letters::Nwu | Letters::Flu => WorldAxes::NWU,
        })
    }

    /// The axes that the name says, of the drone: `ned` stands for z down there, as in REP 145.
    pub fn body(self) -> Option<BodyAxes> {
        Some(match self.letters? {
            Letters::Ned | Letters::Frd => BodyAxes::FRD,
            Letters::Enu | Letters::Nwu | Letters::Flu => BodyAxes::FLU,
        })
    }

    /// Whether it is the drone's frame, going by the letters if the name says nothing else.
    pub fn is_drones(self) -> bool {
        let is_lettered = matches!(self.letters, Some(Letters::Frd | Letters::Flu));
        self.of == Some(Owner::Drone) || self.of.is_none() && is_lettered
    }

    /// Whether it is the world's frame, going by the letters if the name says nothing else.
    pub fn is_worlds(self) -> bool {
        let is_lettered = matches!(
            self.letters,
            Some(Letters::Ned | Letters::Enu | Letters::Nwu)
        );
        self.of == Some(Owner::World) || self.of.is_none() && is_lettered
    }
}

/// The words of a name, in lower case: `odom_NED`, `odomNed` and `odomned` have `odom` and `ned`.
fn words(name: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    let mut before = ' ';
    for letter in name.chars() {
        let begins_word = !before.is_alphabetic() || before.is_lowercase() && letter.is_uppercase();
        if letter.is_alphabetic() {
            if begins_word {
                words.push(String::new());
            }
            let word = words.last_mut();
            word.expect("a word has begun")
                .extend(letter.to_lowercase());
        }
        before = letter;
    }
    words.into_iter().flat_map(|word| unglue(&word)).collect()
}

/// Separates axes from a known word before them: `aligned` is one word, `mapned` is two.
fn unglue(word: &str) -> Vec<String> {
    let is_known = |word: &str| {
        [&WORLD[..], &DRONE, &PLANET, &OTHER]
            .iter()
            .any(|known| known.contains(&word))
    };
    let parts = LETTERS.iter().find_map(|(letters, _)| {
        let before = word
            .strip_suffix(letters)
            .filter(|before| is_known(before))?;
        Some(vec![before.to_owned(), (*letters).to_owned()])
    });
    parts.unwrap_or_else(|| vec![word.to_owned()])
}
