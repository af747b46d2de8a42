//! Flights as viewers are shown them, without a log.

use flightcam::{
    camera::Camera,
    camera::FieldOfView,
    derived::{
        Derived,
        visual::{
            Calibration, Frame, Pose, Scene, Shape, Shown, Transform as FrameTransform, Visual,
        },
    },
    geometry::RollPitchYaw,
    sample::{
        AttitudeSample, HeightSample, Position, PositionSample, Sample, Stamp, Velocity,
        VelocitySample,
    },
    transform::{MaxGap, Transform},
    visuals::{FlightRecorder, Show, StagedFlight, VisualOptions, VisualRate},
};
use nalgebra::{Isometry3, Point3, Translation3, Vector3};

/// Nanoseconds of so many seconds.
pub fn nanoseconds(seconds: f64) -> u64 {
    (seconds * 1e9).round() as u64
}

pub fn at(seconds: f64) -> Stamp {
    let log_time = nanoseconds(seconds);
    Stamp {
        log_time,
        publish_time: log_time,
    }
}

/// An attitude by roll, pitch and yaw in degrees.
pub fn attitude(seconds: f64, degrees: [f64; 3]) -> Sample {
    let [roll, pitch, yaw] = degrees.map(f64::to_radians);
    Sample::Attitude(AttitudeSample {
        stamp: at(seconds),
        orientation: RollPitchYaw { roll, pitch, yaw }.to_quaternion(),
        reset_counter: None,
    })
}

/// A velocity north, east, down.
pub fn velocity(seconds: f64, ned: [f64; 3]) -> Sample {
    Sample::Velocity(VelocitySample {
        stamp: at(seconds),
        velocity: Velocity::Ned(ned.into()),
    })
}

/// A position in degrees and metres.
pub fn geodetic(seconds: f64, [latitude, longitude, altitude]: [f64; 3]) -> Sample {
    Sample::Position(PositionSample {
        stamp: at(seconds),
        position: Position::Geodetic {
            latitude,
            longitude,
            altitude,
        },
        resets: None,
    })
}

/// A position north, east, down of the log's own origin.
pub fn local(seconds: f64, ned: [f64; 3]) -> Sample {
    Sample::Position(PositionSample {
        stamp: at(seconds),
        position: Position::Local(ned.into()),
        resets: None,
    })
}

/// A height above the ground in metres.
pub fn height(seconds: f64, metres: f64) -> Sample {
    Sample::Height(HeightSample {
        stamp: at(seconds),
        metres,
    })
}

/// 70° by 50°, and everything ten times a second.
pub fn with_field_of_view() -> VisualOptions {
    let seen = FieldOfView::from_degrees(70.0, 50.0).expect("it is in range");
    let rate = VisualRate::from_hertz(10.0).expect("it is in range");
    VisualOptions::new().rate(rate).field_of_view(seen)
}

/// A flight and all that is made of it.
pub struct Showing {
    pub flight: StagedFlight,
    pub derived: Vec<Derived>,
    pub shown: Vec<Shown>,
}

/// Shows samples, which are given in the order of their times.
pub fn show(samples: &[Sample], camera: Camera, options: &VisualOptions) -> Showing {
    show_epochs(&[samples], camera, options)
}

/// The same for a log whose clock was set back between them.
pub fn show_epochs(epochs: &[&[Sample]], camera: Camera, options: &VisualOptions) -> Showing {
    let max_gap = MaxGap::default();
    let mut transform = Transform::new(camera, max_gap).with_moments();
    let mut recorder = FlightRecorder::new(options, max_gap);
    let mut derived = Vec::new();
    for (number, samples) in epochs.iter().enumerate() {
        if number > 0 {
            transform.begin_epoch(&mut derived);
            transform
                .take_moments()
                .for_each(|moment| recorder.take(moment));
            recorder.begin_epoch();
        }
        for &sample in *samples {
            recorder.go_to(sample.stamp().log_time, |time| transform.ask(time));
            match &sample {
                Sample::Position(position) => recorder.take_position(position),
                Sample::Height(height) => recorder.take_height(height),
                _ => {}
            }
            transform.push(sample, &mut derived);
            transform
                .take_moments()
                .for_each(|moment| recorder.take(moment));
        }
    }
    transform.finish(&mut derived);
    transform
        .take_moments()
        .for_each(|moment| recorder.take(moment));
    let flight = StagedFlight::new(recorder.finish(), options, None);
    let mut shown = Vec::new();
    let taken: Result<(), ()> = Show::new(&flight).each(|_, one| {
        shown.push(one);
        Ok(())
    });
    taken.expect("nothing goes wrong");
    Showing {
        flight,
        derived,
        shown,
    }
}

impl Showing {
    /// What is shown of one kind, with its times.
    pub fn all<T>(&self, of: impl Fn(&Visual) -> Option<T>) -> Vec<(u64, T)> {
        let shown = self.shown.iter();
        shown
            .filter_map(|one| Some((one.time, of(&one.visual)?)))
            .collect()
    }

    /// The one of its kind.
    pub fn only<T>(&self, of: impl Fn(&Visual) -> Option<T>) -> T {
        let mut all = self.all(of);
        assert_eq!(all.len(), 1);
        all.remove(0).1
    }

    pub fn calibration(&self) -> Calibration {
        self.only(|visual| match visual {
            Visual::Calibration(calibration) => Some(*calibration),
            _ => None,
        })
    }

    pub fn scenes(&self) -> Vec<(u64, Scene)> {
        self.all(|visual| match visual {
            Visual::Scene(scene) => Some(scene.clone()),
            _ => None,
        })
    }

    /// The states, each with the time when it began.
    pub fn states(&self) -> Vec<(u64, &'static str)> {
        let mut states = self.all(|visual| match visual {
            Visual::State(state) => Some(state.name),
            _ => None,
        });
        // The last one is said again at the end.
        let is_said_again = |states: &[(u64, &str)]| matches!(states, [.., (_, before), (_, last)] if before == last);
        if is_said_again(&states) {
            states.pop();
        }
        states
    }

    /// How coordinates of a frame become those of the map at a time, composed of the transforms that are shown.
    pub fn map_from(&self, frame: Frame, time: u64) -> Option<Isometry3<f64>> {
        let of = |visual: &Visual| match visual {
            Visual::Transforms(transforms) | Visual::StaticTransforms(transforms) => {
                Some(transforms.clone())
            }
            _ => None,
        };
        let known: Vec<FrameTransform> = (self.all(of).into_iter())
            .filter(|(its, _)| *its <= time)
            .flat_map(|(_, transforms)| transforms)
            .collect();
        let mut composed = Isometry3::identity();
        let mut child = frame;
        while child != Frame::Map {
            let last = known.iter().rfind(|transform| transform.child == child)?;
            composed = isometry(&last.pose) * composed;
            child = last.parent;
        }
        Some(composed)
    }
}

pub fn isometry(pose: &Pose) -> Isometry3<f64> {
    Isometry3::from_parts(Translation3::from(pose.position), pose.orientation)
}

/// A vector north, east, down in the map's east, north, up.
pub fn in_map(ned: Vector3<f64>) -> Vector3<f64> {
    Vector3::new(ned.y, ned.x, -ned.z)
}

/// The pixel at which a camera sees a point that is given in its optical frame.
pub fn pixel(calibration: &Calibration, point: Point3<f64>) -> [f64; 2] {
    let [fx, fy] = calibration.focal;
    let [cx, cy] = calibration.centre;
    [cx + fx * point.x / point.z, cy + fy * point.y / point.z]
}

/// The points of the closed line in what is drawn under a name.
pub fn outline(scene: &Scene, id: &str) -> Option<Vec<Vector3<f64>>> {
    let entity = scene.entities.iter().find(|entity| entity.id == id)?;
    entity.shapes.iter().find_map(|shape| match shape {
        Shape::Lines { points, .. } => Some(points.clone()),
        _ => None,
    })
}
