//! What to do where angles are of another unit, by how they were asked for.

use flightcam::{
    sample::Kind,
    source::{profile::convention::AngleUnit, request::HowAsked},
};

/// Says how to read a kind's angles in the next smaller unit.
pub fn other_unit(sample: Kind, read_as: AngleUnit, asked: &HowAsked) -> String {
    let (unit, word, key) = match read_as {
        AngleUnit::Radians => ("degrees", "degrees", "degrees"),
        _ => ("hundredths of a degree", "centidegrees", "centidegrees"),
    };
    let role = sample.name();
    let how = match asked {
        HowAsked::Argument => format!("put :{word} after the fields of --{role}"),
        HowAsked::OwnProfile { profile } => {
            format!("write unit = \"{key}\" for the {role} in the profile {profile}")
        }
        HowAsked::BuiltIn { profile } if *profile == "flat" && word == "degrees" => {
            "use --profile flat-deg".to_owned()
        }
        _ => format!("name them with --{role}, and put :{word} after the fields"),
    };
    format!("if they are {unit}, {how}")
}
