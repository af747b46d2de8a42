//! Kinds of sample, and samples, in words.

use flightcam::{
    inspect::FirstSample,
    sample::{GimbalReference, Kind},
};

/// The name of a kind of sample in a sentence.
pub fn name(kind: Kind) -> String {
    kind.name().replace('_', " ")
}

/// A kind of sample as the label of a line.
pub fn label(kind: Kind) -> String {
    let name = name(kind);
    let (initial, rest) = name.split_at(1);
    initial.to_uppercase() + rest
}

/// What a gimbal's angles are measured from.
pub fn reference(reference: GimbalReference) -> &'static str {
    match reference {
        GimbalReference::Earth => "horizon and north",
        GimbalReference::Heading => "horizon and the drone's heading",
        GimbalReference::Airframe => "airframe",
    }
}

pub fn first_sample(sample: &FirstSample) -> String {
    match *sample {
        FirstSample::Attitude {
            roll_deg,
            pitch_deg,
            yaw_deg,
        } => angles(roll_deg, pitch_deg, yaw_deg),
        FirstSample::Gimbal {
            roll_deg,
            pitch_deg,
            yaw_deg,
            reference,
        } => {
            let angles = angles(roll_deg, pitch_deg, yaw_deg);
            format!("{angles} from the {}", self::reference(reference))
        }
        FirstSample::VelocityNed { north, east, down } => {
            format!("north {north:.2}, east {east:.2}, down {down:.2} m/s")
        }
        FirstSample::VelocityFrd { front, right, down } => {
            format!("front {front:.2}, right {right:.2}, down {down:.2} m/s")
        }
        FirstSample::PositionGeodetic {
            latitude,
            longitude,
            altitude,
        } => format!("{latitude:.6}° N, {longitude:.6}° E, {altitude:.1} m"),
        FirstSample::PositionLocal { north, east, down } => {
            format!("north {north:.1}, east {east:.1}, down {down:.1} m")
        }
        FirstSample::Height { metres } => format!("{metres:.1} m above the ground"),
        FirstSample::AngularRate { front, right, down } => {
            format!("front {front:.2}, right {right:.2}, down {down:.2} rad/s")
        }
        FirstSample::Acceleration { front, right, down } => {
            format!("front {front:.2}, right {right:.2}, down {down:.2} m/s²")
        }
        ref other => format!("{other:?}"),
    }
}

fn angles(roll: f64, pitch: f64, yaw: f64) -> String {
    format!("roll {roll:.1}°, pitch {pitch:.1}°, yaw {yaw:.1}°")
}
