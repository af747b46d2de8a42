//! What flightcam derives from a recorded flight, against what it must derive.

pub mod mutation;

use std::{collections::BTreeMap, f64::consts::TAU, io::Write as _};

use flightcam::{
    camera::{Camera, Mount},
    derived::{Derived, Value},
    geometry::DepressionAngle,
    log::{Log, ReadError},
    reader::Reader,
    sample::{Kind, Position, Sample, Tallies},
    source::{
        Source,
        profile::{Profile, ProfileChoice},
        request::Request,
    },
    transform::{MaxGap, Transform},
};
use nalgebra::{Matrix3, Rotation3, Vector3};

use crate::support::flights::{
    self, Recording,
    flight::Flight,
    recording::{self, Reference},
};

/// How far a convention error must throw a result off, at least: a thousandth of a radian or a m/s.
const CLEARLY_WRONG: f64 = 1e-3;

/// Three numbers at each of some times.
type Series = BTreeMap<u64, [f64; 3]>;

/// What was read from a log.
pub struct Readings {
    /// The profile that was chosen.
    pub profile: String,
    pub samples: Vec<Sample>,
    pub dropped: Tallies,
}

/// Reads all of a log's samples; the error is flightcam's.
pub fn read(log: &[u8], request: &Request) -> Result<Readings, String> {
    let mut file = tempfile::NamedTempFile::new().expect("a temporary file");
    file.write_all(log).expect("written");
    let log = Log::open(file.path()).map_err(|error| error.to_string())?;
    let source = Source::select_to_show(&log, request, &[Kind::Height]);
    let source = source.map_err(|error| error.to_string())?;
    let profile = source.profile.name.clone();
    let mut samples = Vec::new();
    let read = Reader::new(&log, source).and_then(|reader| {
        reader.for_each(|arrival| {
            samples.push(arrival.sample);
            Ok::<_, ReadError>(())
        })
    });
    let dropped = read.map_err(|error| error.to_string())?.dropped;
    Ok(Readings {
        profile,
        samples,
        dropped,
    })
}

/// With this profile, or with the one that is chosen automatically.
pub fn request(profile: Option<Profile>) -> Request {
    Request {
        profile: profile.map_or(ProfileChoice::Automatic, |profile| {
            ProfileChoice::Given(Box::new(profile))
        }),
        ..Request::default()
    }
}

/// What follows for a camera: its turns, its orientations as angles, and velocities in its axes.
#[derive(Debug, Clone, Default)]
pub struct Motion {
    pub turns: Series,
    pub orientations: Series,
    pub velocities: Series,
}

impl Motion {
    /// As flightcam derives it.
    pub fn derived(samples: &[Sample], camera: Camera) -> Self {
        let mut transform = Transform::new(camera, MaxGap::default());
        let mut derived = Vec::new();
        for &sample in samples {
            transform.push(sample, &mut derived);
        }
        transform.finish(&mut derived);
        let mut motion = Self::default();
        for Derived { stamp, value } in derived {
            match value {
                Value::RelativeRpy { rpy, .. } => motion
                    .turns
                    .insert(stamp.log_time, [rpy.roll, rpy.pitch, rpy.yaw]),
                Value::Orientation(r_ned_camera) => motion
                    .orientations
                    .insert(stamp.log_time, angles(r_ned_camera.matrix())),
                Value::CameraVelocity(velocity) => {
                    motion.velocities.insert(stamp.log_time, velocity.into())
                }
                other => panic!("a value of a new kind: {other:?}"),
            };
        }
        motion
    }

    /// By the design's formulas for a camera on a gimbal, `R_ned_camera = R_ned_reference R_reference_camera`.
    pub fn of_gimbal(flight: &Flight, reference: Reference) -> Self {
        let camera = |time: u64| -> Matrix3<f64> {
            let reference = match reference {
                Reference::Earth => Rotation3::identity(),
                Reference::Heading => {
                    let nose = flight.attitude(time) * Vector3::x();
                    Rotation3::from_axis_angle(&Vector3::z_axis(), nose.y.atan2(nose.x))
                }
                Reference::Airframe => flight.attitude(time).to_rotation_matrix(),
            };
            (reference * flight.gimbal(time).to_rotation_matrix()).into_inner()
        };
        let turns = flight.attitude_times.windows(2).map(|times| {
            let turn = camera(times[0]).transpose() * camera(times[1]);
            (times[1], angles(&turn))
        });
        let orientations = flight.attitude_times.iter();
        let orientations = orientations.map(|&time| (time, angles(&camera(time))));
        let velocities = flight.velocity_times.iter().map(|&time| {
            let velocity = camera(time).transpose() * flight.velocity(time);
            (time, velocity.into())
        });
        Self {
            turns: turns.collect(),
            orientations: orientations.collect(),
            velocities: velocities.collect(),
        }
    }

    /// By how much another differs at most; infinitely where it has other times.
    pub fn distance(&self, other: &Self) -> f64 {
        let between_angles = |a: f64, b: f64| {
            let difference = (a - b).abs() % TAU;
            difference.min(TAU - difference)
        };
        [
            distance(&self.turns, &other.turns, between_angles),
            distance(&self.orientations, &other.orientations, between_angles),
            distance(&self.velocities, &other.velocities, |a, b| (a - b).abs()),
        ]
        .into_iter()
        .fold(0.0, f64::max)
    }
}

/// Roll, pitch and yaw of a rotation.
fn angles(r: &Matrix3<f64>) -> [f64; 3] {
    let roll = r[(2, 1)].atan2(r[(2, 2)]);
    let pitch = (-r[(2, 0)]).atan2(r[(2, 1)].hypot(r[(2, 2)]));
    let yaw = r[(1, 0)].atan2(r[(0, 0)]);
    [roll, pitch, yaw]
}

fn distance<const N: usize>(
    one: &BTreeMap<u64, [f64; N]>,
    other: &BTreeMap<u64, [f64; N]>,
    distance: impl Fn(f64, f64) -> f64,
) -> f64 {
    if !one.keys().eq(other.keys()) {
        return f64::INFINITY;
    }
    let pairs = one.values().flatten().zip(other.values().flatten());
    pairs.map(|(&a, &b)| distance(a, b)).fold(0.0, f64::max)
}

/// A camera 30° below the horizon, to which heading and velocity matter.
pub fn stabilised() -> Camera {
    Camera::Stabilised {
        depression: DepressionAngle::from_degrees(30.0).expect("30° is in range"),
        yaw_offset: 0.0,
    }
}

/// A camera bolted to the airframe, to which all of the attitude matters.
fn fixed() -> Camera {
    Camera::Fixed(Mount::from_degrees(10.0, -20.0, 35.0).expect("angles in range"))
}

/// What must come out of a recording.
pub struct Expectation {
    /// What each camera must do, and how exactly.
    cameras: Vec<(&'static str, Camera, Motion, f64)>,
    positions: Option<(Series, f64)>,
    heights: Option<(BTreeMap<u64, [f64; 1]>, f64)>,
}

impl Expectation {
    /// Of the same flight in the profile `flat`, and for what `flat` does not have, of formulas.
    pub fn of(recording: &Recording) -> Self {
        let flight = &recording.flight;
        let reference = read(&flights::reference(flight), &request(None)).expect("the reference");
        assert_eq!(reference.profile, "flat");
        let tolerance = recording.precision.tolerance();
        let like_reference = |camera| Motion::derived(&reference.samples, camera);
        let mut cameras = vec![
            (
                "stabilised",
                stabilised(),
                like_reference(stabilised()),
                tolerance,
            ),
            ("fixed", fixed(), like_reference(fixed()), tolerance),
        ];
        if let Some(reference) = recording.gimbal {
            let motion = Motion::of_gimbal(flight, reference);
            cameras.push(("gimbal", Camera::Gimbal, motion, tolerance));
        }
        let positions = recording.position.map(|position| {
            let times = flight.position_times.iter();
            match position {
                recording::Position::Geodetic { tolerance } => (
                    times.map(|&time| (time, flight.geodetic(time))).collect(),
                    tolerance,
                ),
                recording::Position::Local { tolerance } => (
                    times
                        .map(|&time| (time, flight.local(time).into()))
                        .collect(),
                    tolerance,
                ),
            }
        });
        let heights = recording.height.map(|tolerance| {
            let times = flight.position_times.iter();
            let heights = times.map(|&time| (time, [flight.height(time)]));
            (heights.collect(), tolerance)
        });
        Self {
            cameras,
            positions,
            heights,
        }
    }

    /// How far off each result is.
    fn differences(&self, samples: &[Sample]) -> Vec<Difference> {
        let of_camera =
            |(what, camera, expected, tolerance): &(&'static str, Camera, Motion, f64)| {
                Difference {
                    what,
                    amount: expected.distance(&Motion::derived(samples, *camera)),
                    tolerance: *tolerance,
                }
            };
        let of_positions = |(expected, tolerance): &(Series, f64)| Difference {
            what: "position",
            amount: distance(expected, &positions(samples), |a, b| (a - b).abs()),
            tolerance: *tolerance,
        };
        let of_heights = |(expected, tolerance): &(BTreeMap<u64, [f64; 1]>, f64)| Difference {
            what: "height",
            amount: distance(expected, &heights(samples), |a, b| (a - b).abs()),
            tolerance: *tolerance,
        };
        let cameras = self.cameras.iter().map(of_camera);
        cameras
            .chain(self.positions.iter().map(of_positions))
            .chain(self.heights.iter().map(of_heights))
            .collect()
    }

    /// Fails unless every result is as expected.
    pub fn check(&self, name: &str, samples: &[Sample]) {
        for Difference {
            what,
            amount,
            tolerance,
        } in self.differences(samples)
        {
            assert!(amount < tolerance, "{name}: {what} differs by {amount:e}");
        }
    }

    /// Whether some result is clearly wrong.
    pub fn is_missed(&self, samples: &[Sample]) -> bool {
        let differences = self.differences(samples);
        differences
            .iter()
            .any(|difference| difference.amount > CLEARLY_WRONG.max(10.0 * difference.tolerance))
    }
}

struct Difference {
    what: &'static str,
    amount: f64,
    tolerance: f64,
}

/// Degrees, degrees, metres; or metres to north, east, down.
fn positions(samples: &[Sample]) -> Series {
    let positions = samples.iter().filter_map(|sample| match sample {
        Sample::Position(sample) => Some((
            sample.stamp.log_time,
            match sample.position {
                Position::Geodetic {
                    latitude,
                    longitude,
                    altitude,
                } => [latitude, longitude, altitude],
                Position::Local(place) => place.into(),
            },
        )),
        _ => None,
    });
    positions.collect()
}

/// Heights above the ground in metres.
fn heights(samples: &[Sample]) -> BTreeMap<u64, [f64; 1]> {
    let heights = samples.iter().filter_map(|sample| match sample {
        Sample::Height(sample) => Some((sample.stamp.log_time, [sample.metres])),
        _ => None,
    });
    heights.collect()
}
