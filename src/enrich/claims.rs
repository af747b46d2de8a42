//! How a log was read, as the checks want to know it.

use crate::{
    check::{
        Claims, ESTIMATE_LAG, RECEIVER_LAG,
        reading::{
            ACCELERATION_UNITS, ANGLE_UNITS, AttitudeReading, Form, RATE_UNITS, SPEED_UNITS, Unit,
            VectorReading,
        },
    },
    geometry::axes::Axes,
    log::Log,
    sample::Kind,
    source::{ReadAs, Reading, Source, WrittenQuaternion, profile::convention::EulerOrder},
};

/// Types of message whose values are an estimator's, for the time of the message: the estimator has made up for the
/// receiver's lag.
///
/// Source: <https://github.com/PX4/PX4-Autopilot/blob/0401fd29/docs/en/advanced_config/tuning_the_ecl_ekf.md>, "output
/// predictor".
const ESTIMATES: [&str; 6] = [
    "vehicle_global_position",
    "vehicle_local_position",
    "vehicle_odometry",
    "VehicleGlobalPosition",
    "VehicleLocalPosition",
    "VehicleOdometry",
];

/// How the samples of a source were read. A kind whose messages were read in several ways is not claimed.
pub fn claims(log: &Log, source: &Source) -> Claims {
    let read_as = |kind: Kind| match source.read_as(kind).as_slice() {
        [ReadAs { reading, .. }] => Some(*reading),
        _ => None,
    };
    let velocity = read_as(Kind::Velocity).and_then(|reading| match reading {
        Reading::Velocity { axes, unit } => vector(axes, &SPEED_UNITS, unit.per_metre_per_second()),
        _ => None,
    });
    let angular_rate = read_as(Kind::AngularRate).and_then(|reading| match reading {
        Reading::AngularRate { axes, unit } => {
            vector(Axes::Body(axes), &RATE_UNITS, unit.per_radian_per_second())
        }
        _ => None,
    });
    let acceleration = read_as(Kind::Acceleration).and_then(|reading| match reading {
        Reading::Acceleration { axes, unit } => {
            let per_own = unit.per_metre_per_second_squared();
            vector(Axes::Body(axes), &ACCELERATION_UNITS, per_own)
        }
        _ => None,
    });
    let are_estimates = [Kind::Velocity, Kind::Position].into_iter().all(|kind| {
        let schemas = source.schemas(log, kind);
        let is_estimate = |schema: &str| {
            let name = schema.rsplit(['.', '/']).next().unwrap_or(schema);
            ESTIMATES.contains(&name)
        };
        !schemas.is_empty() && schemas.iter().all(|schema| is_estimate(schema))
    });
    Claims {
        velocity,
        attitude: read_as(Kind::Attitude).and_then(|reading| attitude(source, reading)),
        angular_rate,
        acceleration,
        depression: None,
        lag_s: match are_estimates {
            true => ESTIMATE_LAG,
            false => RECEIVER_LAG,
        },
        velocity_late_by_s: 0.0,
    }
}

fn vector(axes: Axes, units: &[Unit], per_own: f64) -> Option<VectorReading> {
    let unit = units.iter().find(|unit| unit.per_own == per_own)?;
    Some(VectorReading { axes, unit: *unit })
}

fn attitude(source: &Source, reading: Reading) -> Option<AttitudeReading> {
    let (form, axes) = match reading {
        Reading::Quaternion { axes, .. } => {
            let written = source.quaternion(Kind::Attitude);
            let scalar_last = written.is_some_and(WrittenQuaternion::is_scalar_last);
            (Form::Quaternion { scalar_last }, axes)
        }
        Reading::Angles {
            axes, unit, order, ..
        } => {
            let per_radian = unit.turn() / std::f64::consts::TAU;
            let mut units = ANGLE_UNITS.iter();
            let unit = units.find(|known| known.per_own == per_radian)?;
            match order {
                EulerOrder::YawPitchRoll => (AttitudeReading::angles_in(*unit), axes),
                _ => (Form::OtherAngles, axes),
            }
        }
        _ => return None,
    };
    Some(AttitudeReading::new(form, axes.body(), axes.world()))
}
