//! What certainly contradicts, in the words of an error.

use std::fmt;

use super::{
    jumps::ToAndFro,
    oddity::Oddity,
    reading::{AttitudeReading, Form, VectorReading},
    verdict::{Findings, Reading, Subject, Verdict, Witness},
};
use crate::sample::Kind;

impl fmt::Display for Findings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for oddity in self.oddities.iter().filter(|oddity| oddity.is_certain()) {
            write!(f, "\n  {oddity}")?;
        }
        for verdict in self
            .verdicts
            .iter()
            .filter(|verdict| verdict.is_contradicted())
        {
            write!(f, "\n  {verdict}")?;
        }
        for explanation in &self.explanations {
            let readings: Vec<String> = explanation.iter().map(Reading::to_string).collect();
            write!(f, "\n  what would fit: {}", readings.join(", and "))?;
        }
        Ok(())
    }
}

impl fmt::Display for Oddity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OneTime { of, samples } => {
                let of = of.name();
                write!(
                    f,
                    "all {samples} {of} samples are at one time: their messages were not stamped"
                )
            }
            Self::ToAndFro { of, jumps } => {
                let largest = jumps.largest_of(*of);
                write!(
                    f,
                    "the {} jumps to and fro by up to {largest}, {} times in {} steps, as where several sources write to one \
                     topic, and no field is known that tells them apart",
                    of.name(),
                    jumps.jumps,
                    jumps.steps
                )
            }
            Self::ScalarElsewhere { level, .. } => write!(
                f,
                "the attitude's quaternion has its scalar part in the other place: read so, the drone is level in {:.0} % of \
                 the samples",
                level * 100.0
            ),
            Self::NotAtDepression { share, median_deg } => write!(
                f,
                "the gimbal holds the camera more than 10° from the depression angle that was given in {:.0} % of the \
                 samples; its median is {median_deg:.0}° below the horizon",
                share * 100.0
            ),
            Self::OnItsSide { share } => {
                write!(
                    f,
                    "the drone leans by more than 60° in {:.0} % of the samples",
                    share * 100.0
                )
            }
            Self::GimbalUp { share } => {
                write!(
                    f,
                    "the gimbal points up in {:.0} % of the samples",
                    share * 100.0
                )
            }
        }
    }
}

impl ToAndFro {
    /// The largest jump of a series of samples of this kind, with its unit.
    pub fn largest_of(&self, kind: Kind) -> String {
        match kind {
            Kind::Velocity => format!("{:.1} m/s", self.largest),
            _ => format!("{:.0}°", self.largest.to_degrees()),
        }
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let subject = match self.subject {
            Subject::VelocityHorizontal => "the horizontal velocity",
            Subject::VelocityVertical => "the vertical velocity",
            Subject::VelocityTime => "the time of the velocity",
            Subject::AttitudeTurns => "how the attitude turns",
            Subject::AttitudeTilt => "the tilt of the attitude",
            Subject::AttitudeAndVelocity => "the attitude together with the velocity",
            Subject::GimbalTilt => "the tilt of the gimbal",
            Subject::GimbalYaw => "the yaw of the gimbal",
        };
        let witness = match self.witness {
            Witness::GeodeticPosition => "the positions on the globe",
            Witness::LocalPosition => "the positions",
            Witness::AngularRates => "the angular rates",
            Witness::Inertia => "the accelerations",
            Witness::Gravity => "gravity",
            Witness::Lean => "how a drone leans where it accelerates",
            Witness::Attitude => "the attitude of the drone",
        };
        write!(f, "{subject} contradicts {witness}")
    }
}

impl fmt::Display for Reading {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let vector = |f: &mut fmt::Formatter<'_>, of: &str, reading: &VectorReading| {
            write!(
                f,
                "the {of} read as {} in {}",
                reading.unit.name, reading.axes
            )
        };
        match self {
            Self::Velocity(reading) => vector(f, "velocity", reading),
            Self::AngularRate(reading) => vector(f, "angular rate", reading),
            Self::Acceleration(reading) => vector(f, "acceleration", reading),
            Self::Attitude(reading) => write!(f, "the attitude read as {reading}"),
            Self::Gimbal { reference, flipped } => {
                let signs = if *flipped {
                    ", with the opposite signs"
                } else {
                    ""
                };
                write!(
                    f,
                    "the gimbal measured from the {}{signs}",
                    reference.name()
                )
            }
            Self::ShiftedVelocity { late_by_s } => {
                write!(f, "the velocity taken {late_by_s:.2} s earlier")
            }
        }
    }
}

impl fmt::Display for AttitudeReading {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.form {
            Form::Quaternion { scalar_last: false } | Form::OtherAngles => {}
            Form::Quaternion { scalar_last: true } => f.write_str("scalar-last ")?,
            Form::Angles {
                unit,
                swapped,
                opposite,
            } => {
                write!(f, "{} ", unit.name)?;
                if swapped {
                    f.write_str("pitch, roll, yaw ")?;
                }
                let names = ["roll", "pitch", "yaw"].into_iter().zip(opposite);
                for (name, _) in names.filter(|(_, is_opposite)| *is_opposite) {
                    write!(f, "−{name} ")?;
                }
            }
        }
        write!(f, "{}-{}", self.body, self.world)?;
        if self.inverse {
            f.write_str(", inverse")?;
        }
        if self.north_deg != 0.0 {
            write!(f, ", north turned by {}°", self.north_deg)?;
        }
        Ok(())
    }
}
