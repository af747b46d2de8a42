//! A simulated flight, written into a log in some way and read as NED, FRD, metres, radians and scalar first.

use flightcam::{
    check::{
        Claims, Findings, Outcome, Recorder, Verdict,
        reading::{
            ACCELERATION_UNITS, AttitudeReading, Form, RATE_UNITS, SPEED_UNITS, VectorReading,
        },
        verdict::{Reading, Subject, Witness},
    },
    geometry::axes::{Axes, BodyAxes, WorldAxes},
    sample::{
        AccelerationSample, AngularRateSample, AttitudeSample, Position, PositionSample, Sample,
        Stamp, Velocity, VelocitySample,
    },
};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::manoeuvres::{Manoeuvre, Measured, Sensors, fly, measure};

/// How a flight is written into its log, and what of it.
#[derive(Debug, Clone)]
pub struct Written {
    /// The axes of the velocity.
    pub velocity: Axes,
    /// How many of its units are one metre per second.
    pub per_metre_per_second: f64,
    /// By how much the velocity is stamped too late, in seconds.
    pub late_by: f64,
    /// The attitude that is read where another one is.
    pub attitude: fn(UnitQuaternion<f64>) -> UnitQuaternion<f64>,
    /// Whether the attitude is angles.
    pub in_angles: bool,
    /// The axes of the angular rates and of the accelerations; without them, the log does not have any.
    pub imu: Option<[BodyAxes; 2]>,
    /// Whether positions are latitude, longitude and height.
    pub is_geodetic: bool,
    /// Whether there are positions.
    pub has_positions: bool,
    /// Whether the velocity is read as the drone's front, right, down.
    pub read_as_body: bool,
    /// How late positions may be by nature.
    pub lag_s: f64,
    /// See [`fly`].
    pub strongest_wind: f64,
    pub sensors: Sensors,
}

impl Default for Written {
    fn default() -> Self {
        Self {
            velocity: Axes::World(WorldAxes::NED),
            per_metre_per_second: 1.0,
            late_by: 0.0,
            attitude: |attitude| attitude,
            in_angles: false,
            imu: Some([BodyAxes::FRD; 2]),
            is_geodetic: true,
            has_positions: true,
            read_as_body: false,
            lag_s: 0.3,
            strongest_wind: 4.0,
            sensors: Sensors::default(),
        }
    }
}

/// The time at which flights begin, in nanoseconds.
const START: u64 = 1_700_000_000_000_000_000;

fn at(seconds: f64) -> u64 {
    START + (seconds * 1e9).round() as u64
}

fn stamp(seconds: f64) -> Stamp {
    Stamp {
        log_time: at(seconds),
        publish_time: at(seconds),
    }
}

impl Written {
    /// Records a flight.
    pub fn record(&self, manoeuvre: Manoeuvre, seconds: f64, seed: u64) -> Recorder {
        let sensors = match self.imu {
            Some(_) => self.sensors,
            None => Sensors {
                imu_hz: 0.0,
                ..self.sensors
            },
        };
        let states = fly(manoeuvre, seconds, self.strongest_wind, seed);
        let measured = measure(&states, sensors, seed);
        let mut samples = self.samples(&measured);
        samples.sort_by(|(a, ..), (b, ..)| a.total_cmp(b));
        let mut recorder = Recorder::default();
        for (_, sample) in samples {
            recorder.push(&sample);
        }
        recorder
    }

    /// Records a flight and judges it.
    pub fn judge(&self, manoeuvre: Manoeuvre, seconds: f64, seed: u64) -> Findings {
        self.record(manoeuvre, seconds, seed).judge(&self.claims())
    }

    /// How the log is read, whatever it is.
    pub fn claims(&self) -> Claims {
        let form = match self.in_angles {
            true => AttitudeReading::ANGLES,
            false => AttitudeReading::WXYZ,
        };
        let axes = match self.read_as_body {
            true => Axes::Body(BodyAxes::FRD),
            false => Axes::World(WorldAxes::NED),
        };
        let body = Axes::Body(BodyAxes::FRD);
        Claims {
            velocity: Some(VectorReading {
                axes,
                unit: SPEED_UNITS[0],
            }),
            attitude: Some(AttitudeReading::new(form, BodyAxes::FRD, WorldAxes::NED)),
            angular_rate: self.imu.map(|_| VectorReading {
                axes: body,
                unit: RATE_UNITS[0],
            }),
            acceleration: self.imu.map(|_| VectorReading {
                axes: body,
                unit: ACCELERATION_UNITS[0],
            }),
            lag_s: self.lag_s,
            ..Claims::default()
        }
    }

    fn samples(&self, measured: &Measured) -> Vec<(f64, Sample)> {
        let mut samples = Vec::new();
        for &(time, attitude) in &measured.attitudes {
            samples.push((
                time,
                Sample::Attitude(AttitudeSample {
                    stamp: stamp(time),
                    orientation: (self.attitude)(attitude),
                    reset_counter: None,
                }),
            ));
        }
        for &(time, velocity) in &measured.velocities {
            let next = measured.attitudes.partition_point(|(at, _)| *at <= time);
            let attitude = measured.attitudes[next - 1].1;
            let numbers = match self.velocity {
                Axes::World(axes) => axes.components_of(velocity),
                Axes::Body(axes) => axes.components_of(attitude.inverse() * velocity),
            };
            let read = numbers * self.per_metre_per_second;
            let late = time + self.late_by;
            samples.push((
                late,
                Sample::Velocity(VelocitySample {
                    stamp: stamp(late),
                    velocity: match self.read_as_body {
                        true => Velocity::Frd(read),
                        false => Velocity::Ned(read),
                    },
                }),
            ));
        }
        let places = measured.places.iter().filter(|_| self.has_positions);
        for &(time, [latitude, longitude, altitude]) in places {
            let position = match self.is_geodetic {
                true => Position::Geodetic {
                    latitude,
                    longitude,
                    altitude,
                },
                false => Position::Local(self.in_metres([latitude, longitude, altitude], measured)),
            };
            let stamp = stamp(time);
            let resets = Default::default();
            let position = PositionSample {
                stamp,
                position,
                resets,
            };
            samples.push((time, Sample::Position(position)));
        }
        if let Some([rates, forces]) = self.imu {
            let rate = |&(time, rate)| {
                let (stamp, rate) = (stamp(time), rates.components_of(rate));
                (time, Sample::AngularRate(AngularRateSample { stamp, rate }))
            };
            let force = |&(time, force)| {
                let (stamp, force) = (stamp(time), forces.components_of(force));
                (
                    time,
                    Sample::Acceleration(AccelerationSample { stamp, force }),
                )
            };
            samples.extend(measured.rates.iter().map(rate));
            samples.extend(measured.forces.iter().map(force));
        }
        samples
    }

    /// A position in metres, in the same axes as the velocity.
    fn in_metres(
        &self,
        [latitude, longitude, altitude]: [f64; 3],
        measured: &Measured,
    ) -> Vector3<f64> {
        let origin = measured.places[0].1;
        let metres = 111_200.0;
        let ned = Vector3::new(
            (latitude - origin[0]) * metres,
            (longitude - origin[1]) * metres * origin[0].to_radians().cos(),
            origin[2] - altitude,
        );
        match self.velocity {
            Axes::World(axes) => axes.components_of(ned),
            Axes::Body(_) => ned,
        }
    }
}

/// An attitude that turns front, left, up into east, north, up, read as FRD in NED.
pub fn ros_read_as_aerospace(attitude: UnitQuaternion<f64>) -> UnitQuaternion<f64> {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let world = UnitQuaternion::new_normalize(Quaternion::new(0.0, half, half, 0.0));
    let body = UnitQuaternion::new_normalize(Quaternion::new(0.0, 1.0, 0.0, 0.0));
    world * attitude * body
}

/// One whose scalar part is the last number, read as the first.
pub fn scalar_last_read_as_first(attitude: UnitQuaternion<f64>) -> UnitQuaternion<f64> {
    let [x, y, z, w]: [f64; 4] = attitude.coords.into();
    UnitQuaternion::new_normalize(Quaternion::new(x, y, z, w))
}

/// One that is given the wrong way round.
pub fn inverse(attitude: UnitQuaternion<f64>) -> UnitQuaternion<f64> {
    attitude.inverse()
}

/// One whose yaw counts from east.
pub fn yaw_from_east(attitude: UnitQuaternion<f64>) -> UnitQuaternion<f64> {
    UnitQuaternion::from_axis_angle(&Vector3::z_axis(), -std::f64::consts::FRAC_PI_2) * attitude
}

/// Angles of which one has the opposite sign, or two are in each other's place.
pub fn angles_read_wrongly<const WHICH: usize>(
    attitude: UnitQuaternion<f64>,
) -> UnitQuaternion<f64> {
    let (roll, pitch, yaw) = attitude.euler_angles();
    let (roll, pitch, yaw) = match WHICH {
        0 => (-roll, pitch, yaw),
        1 => (roll, -pitch, yaw),
        2 => (roll, pitch, -yaw),
        _ => (pitch, roll, yaw),
    };
    UnitQuaternion::from_euler_angles(roll, pitch, yaw)
}

/// The reading of an attitude with other numbers.
pub fn attitude_reading(form: Form, body: BodyAxes, world: WorldAxes) -> Reading {
    Reading::Attitude(AttitudeReading::new(form, body, world))
}

/// The verdict on a subject by a witness.
pub fn verdict(findings: &Findings, subject: Subject, witness: Witness) -> &Verdict {
    let wanted = |verdict: &&Verdict| verdict.subject == subject && verdict.witness == witness;
    let found = findings.verdicts.iter().find(wanted);
    found.unwrap_or_else(|| panic!("no verdict on {subject:?} by {witness:?} in {findings:#?}"))
}

/// The first explanation, which must be a single reading.
pub fn only_explanation(findings: &Findings) -> Reading {
    match findings.explanations.first().map(Vec::as_slice) {
        Some(&[reading]) => reading,
        other => panic!("{other:?} in {findings:#?}"),
    }
}

/// Whether a verdict says that a reading is right.
pub fn is_proven(verdict: &Verdict) -> bool {
    verdict.outcome == Outcome::Proven
}
