//! In which axes samples were read, and why, in words.

use flightcam::{
    sample::GimbalReference,
    source::{
        Because, NamedFrame, ReadAs, Reading, RefusedFrames,
        profile::convention::{AccelerationUnit, EulerOrder, LengthUnit, RateUnit, SpeedUnit},
    },
    text,
};

/// How samples were read, and why.
pub fn read_as(read_as: &ReadAs) -> String {
    let because = match read_as.because {
        Because::Given => "as given",
        Because::Profile => "as the profile says",
        Because::Type => "the axes of its type",
        Because::FrameNames => {
            return format!(
                "{}, because {}",
                reading(read_as.reading),
                named(&read_as.frames)
            );
        }
        Because::Assumed => "axes assumed",
        _ => "",
    };
    let although = match read_as.frames.is_empty() {
        true => String::new(),
        false => format!(", although {}", named(&read_as.frames)),
    };
    format!("{}, {because}{although}", reading(read_as.reading))
}

/// Frames for which samples were dropped.
pub fn refused_frames(refused: &RefusedFrames) -> String {
    format!(
        "{}: {refused}, and the profile says {}",
        refused.reason,
        reading(refused.said)
    )
}

fn named(frames: &[NamedFrame]) -> String {
    let frames = frames
        .iter()
        .map(|NamedFrame { field, name, .. }| format!("{field} is {name}"));
    text::join(frames, " and ")
}

fn reading(reading: Reading) -> String {
    match reading {
        Reading::Quaternion { axes, reference } => {
            format!("quaternion in {axes}{}", from(reference))
        }
        Reading::Angles {
            axes,
            unit,
            order,
            reference,
        } => {
            let turned = match order {
                EulerOrder::YawPitchRoll => String::new(),
                order => format!(" turned {}", order.name()),
            };
            format!(
                "roll, pitch, yaw in {}{turned}, in {axes}{}",
                unit.name(),
                from(reference)
            )
        }
        Reading::Pitch {
            unit,
            is_positive_down,
            reference,
        } => {
            let positive = if is_positive_down { "down" } else { "up" };
            format!(
                "pitch in {}, positive {positive}{}",
                unit.name(),
                from(Some(reference))
            )
        }
        Reading::Velocity { axes, unit } => format!("{} in {axes}", speed(unit)),
        Reading::AngularRate { axes, unit } => {
            let unit = match unit {
                RateUnit::RadiansPerSecond => "rad/s",
                RateUnit::DegreesPerSecond => "deg/s",
            };
            format!("{unit} in {axes}")
        }
        Reading::Acceleration { axes, unit } => {
            let unit = match unit {
                AccelerationUnit::MetresPerSecondSquared => "m/s²",
                AccelerationUnit::Gravities => "g",
            };
            format!("{unit} in {axes}")
        }
        Reading::Local { axes, unit } => format!("{} in {axes}", length(unit)),
        Reading::Geodetic {
            unit,
            altitude_unit,
        } => format!(
            "latitude and longitude in {}, altitude in {}",
            unit.name(),
            length(altitude_unit)
        ),
        Reading::Height { unit } => format!("{} above the ground", length(unit)),
        other => format!("{other:?}"),
    }
}

fn from(reference: Option<GimbalReference>) -> &'static str {
    match reference {
        None => "",
        Some(GimbalReference::Earth) => ", from the horizon and north",
        Some(GimbalReference::Heading) => ", from the horizon and the drone's heading",
        Some(GimbalReference::Airframe) => ", from the airframe",
    }
}

fn speed(unit: SpeedUnit) -> &'static str {
    match unit {
        SpeedUnit::MetresPerSecond => "m/s",
        SpeedUnit::CentimetresPerSecond => "cm/s",
        SpeedUnit::MillimetresPerSecond => "mm/s",
    }
}

fn length(unit: LengthUnit) -> &'static str {
    match unit {
        LengthUnit::Metres => "m",
        LengthUnit::Centimetres => "cm",
        LengthUnit::Millimetres => "mm",
    }
}
