//! The flight itself: the mission, the vehicle that flies it, its battery and its camera.
//!
//! The mission is a list of phases that move a set-point. The vehicle follows the set-point through
//! a smooth filter whose states are position, velocity, acceleration and jerk, so that each is the
//! derivative of the one before. The attitude is the one that a multirotor needs for this motion:
//! its thrust makes up for gravity, drag and acceleration, and acts along the body's z axis.

use std::f64::consts::{PI, TAU};

use nalgebra::{Rotation2, Vector2, Vector3, Vector4};

/// Length of one step of the simulation, in nanoseconds and in seconds.
pub const STEP_NANOS: u64 = 1_000_000;
const STEP: f64 = STEP_NANOS as f64 * 1e-9;

const LEGS: u32 = 4;
const LEG_HEADING: f64 = 20.0 * DEGREE;
const LEG_LENGTH: f64 = 36.0;
const LEG_SPACING: f64 = 10.0;
const SURVEY_HEIGHT: f64 = 40.0;
/// Distances along a leg from its start to its photos.
const PHOTOS: [f64; 5] = [2.0, 10.0, 18.0, 26.0, 34.0];

const DEGREE: f64 = PI / 180.0;
const GRAVITY: f64 = 9.80665;
/// Deceleration for each m/s of airspeed, 1/s.
const DRAG: f64 = 0.12;
const MEAN_WIND: Vector3<f64> = Vector3::new(-1.2, 1.8, 0.0);
/// Rate of each of the four poles with which the vehicle follows its set-point, 1/s.
const POLE: f64 = 2.5;
/// How the vehicle stands at home: the ground is never quite level.
const PARKED_ROLL: f64 = 0.6 * DEGREE;
const PARKED_PITCH: f64 = -0.4 * DEGREE;
const PARKED_HEADING: f64 = 75.0 * DEGREE;

/// North, east and down from home in metres, then the heading in radians, which is not wrapped.
type Pose = Vector4<f64>;

/// One part of the mission: where the set-point goes, and in what time.
pub struct Phase {
    pub name: String,
    pub duration: f64,
    start: f64,
    motors_on: bool,
    from: Pose,
    path: Path,
}

#[derive(Clone, Copy)]
enum Path {
    /// In a straight line by this difference, turning evenly.
    Straight(Pose),
    /// Half a circle of this radius, to the right (side 1.0) or to the left (side -1.0).
    HalfCircle { radius: f64, side: f64 },
}

impl Phase {
    /// Seconds from the start of the mission to the end of the phase.
    pub fn end(&self) -> f64 {
        self.start + self.duration
    }

    fn set_point(&self, time: f64) -> Pose {
        let progress = ((time - self.start) / self.duration).clamp(0.0, 1.0);
        match self.path {
            Path::Straight(difference) => self.from + difference * progress,
            Path::HalfCircle { radius, side } => {
                let turned = side * PI * progress;
                let to_centre = direction(self.from.w + side * PI / 2.0) * radius;
                let moved = to_centre - Rotation2::new(turned) * to_centre;
                self.from + Pose::new(moved.x, moved.y, 0.0, turned)
            }
        }
    }
}

/// Puts phases one after the other, each where and when the one before ends.
struct Planner {
    phases: Vec<Phase>,
    time: f64,
    at: Pose,
    motors_on: bool,
}

impl Planner {
    fn push(&mut self, name: &str, path: Path, duration: f64) {
        let (name, start, from, motors_on) = (name.to_owned(), self.time, self.at, self.motors_on);
        let phase = Phase {
            name,
            duration,
            start,
            motors_on,
            from,
            path,
        };
        self.time = phase.end();
        self.at = phase.set_point(self.time);
        self.phases.push(phase);
    }

    fn hold(&mut self, name: &str, duration: f64) {
        self.go_to(name, self.at, duration);
    }

    fn go_to(&mut self, name: &str, goal: Pose, duration: f64) {
        self.push(name, Path::Straight(goal - self.at), duration);
    }

    fn go_ahead(&mut self, name: &str, distance: f64, speed: f64) {
        let way = direction(self.at.w) * distance;
        self.go_to(
            name,
            self.at + Pose::new(way.x, way.y, 0.0, 0.0),
            distance / speed,
        );
    }
}

/// The mission: take-off, survey legs joined by half circles, a hover, and back home to land.
pub fn plan_mission() -> Vec<Phase> {
    let at = Pose::new(0.0, 0.0, 0.0, PARKED_HEADING);
    let mut plan = Planner {
        phases: Vec::new(),
        time: 0.0,
        at,
        motors_on: false,
    };
    plan.hold("Ready", 1.0);
    plan.motors_on = true;
    plan.hold("Armed", 1.0);
    plan.go_to(
        "Take-off",
        Pose::new(0.0, 0.0, -SURVEY_HEIGHT, LEG_HEADING),
        6.5,
    );
    plan.go_ahead("Fly to survey area", 10.0, 4.0);
    for leg in 1..=LEGS {
        plan.go_ahead(&format!("Leg {leg} of {LEGS}"), LEG_LENGTH, 8.0);
        if leg < LEGS {
            // Right and left in turn, so that the legs lie side by side.
            let side = if leg % 2 == 1 { 1.0 } else { -1.0 };
            let radius = LEG_SPACING / 2.0;
            plan.push("Turn", Path::HalfCircle { radius, side }, PI * radius / 3.8);
        }
    }
    plan.go_ahead("Slow down", 4.0, 4.0);
    plan.hold("Hover", 2.0);
    let home = -plan.at.xy();
    let turn = wrap_angle(home.y.atan2(home.x) - plan.at.w);
    plan.go_to(
        "Turn towards home",
        plan.at + Pose::new(0.0, 0.0, 0.0, turn),
        2.5,
    );
    let heading = plan.at.w;
    plan.go_to(
        "Return to home",
        Pose::new(0.0, 0.0, -15.0, heading),
        home.norm() / 4.5,
    );
    plan.go_to("Landing", Pose::new(0.0, 0.0, -3.0, heading), 4.0);
    plan.go_to("Final descent", Pose::new(0.0, 0.0, 0.0, heading), 3.0);
    // The vehicle reaches the ground a little after its set-point.
    plan.hold("Touch-down", 4.5);
    plan.motors_on = false;
    plan.hold("Disarmed", 1.0);
    plan.phases
}

/// The drone in flight.
pub struct Vehicle {
    time: f64,
    pose: Pose,
    velocity: Pose,
    acceleration: Pose,
    jerk: Pose,
}

impl Vehicle {
    /// The vehicle where the mission begins, at rest.
    pub fn parked(mission: &[Phase]) -> Self {
        let pose = mission.first().map_or_else(Pose::zeros, |phase| phase.from);
        let [velocity, acceleration, jerk] = [Pose::zeros(); 3];
        Self {
            time: 0.0,
            pose,
            velocity,
            acceleration,
            jerk,
        }
    }

    /// Follows the phase's set-point for one step.
    pub fn step(&mut self, phase: &Phase) {
        let set_point = phase.set_point(self.time) + self.drift() * self.airborne();
        let snap = (set_point - self.pose) * POLE.powi(4)
            - self.velocity * (4.0 * POLE.powi(3))
            - self.acceleration * (6.0 * POLE.powi(2))
            - self.jerk * (4.0 * POLE);
        self.pose += (self.velocity + self.acceleration * (STEP / 2.0)) * STEP;
        self.velocity += (self.acceleration + self.jerk * (STEP / 2.0)) * STEP;
        self.acceleration += self.jerk * STEP;
        self.jerk += snap * STEP;
        self.time += STEP;
    }

    /// Seconds since the start of the mission.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// NED position from home, in metres.
    pub fn position(&self) -> Vector3<f64> {
        self.pose.xyz()
    }

    /// NED velocity over ground, in m/s.
    pub fn velocity(&self) -> Vector3<f64> {
        self.velocity.xyz()
    }

    /// Roll, pitch and yaw of the body (FRD) in NED, as intrinsic ZYX angles, yaw not wrapped.
    pub fn attitude(&self) -> Vector3<f64> {
        let heading = self.pose.w;
        // The body's z axis, in a frame that is level but has the vehicle's heading.
        let down = -self.thrust().normalize();
        let across = Rotation2::new(-heading) * down.xy();
        let roll = (-across.y).asin();
        let pitch = across.x.atan2(down.z);
        let flying = Vector3::new(roll, pitch, heading) + self.vibration();
        Vector3::new(PARKED_ROLL, PARKED_PITCH, heading).lerp(&flying, self.airborne())
    }

    /// Thrust per mass, NED: the acceleration, less what gravity and drag contribute to it.
    fn thrust(&self) -> Vector3<f64> {
        let gust = |phase| 0.9 * waves(self.time, [0.21, 0.47, 0.93], phase);
        let wind = MEAN_WIND + Vector3::new(gust(0.3), gust(1.9), 0.3 * gust(4.0));
        let gravity = Vector3::new(0.0, 0.0, GRAVITY);
        self.acceleration.xyz() - gravity + (self.velocity.xyz() - wind) * DRAG
    }

    /// 0 on the ground, 1 in free flight, smooth between.
    fn airborne(&self) -> f64 {
        let share = (-self.pose.z / 1.5).clamp(0.0, 1.0);
        share * share * (3.0 - 2.0 * share)
    }

    /// Slow errors of the drone's own estimate of its pose, which it corrects by moving.
    fn drift(&self) -> Pose {
        let drift = |phase| waves(self.time, [0.11, 0.23, 0.37], phase);
        Pose::new(
            0.2 * drift(0.5),
            0.2 * drift(2.2),
            0.1 * drift(3.7),
            DEGREE * drift(5.1),
        )
    }

    /// What turbulence and propellers do to roll, pitch and yaw.
    fn vibration(&self) -> Vector3<f64> {
        Vector3::new(0.1, 2.7, 4.9).map(|phase| {
            let turbulence = 0.20 * waves(self.time, [0.83, 1.37, 2.11], phase);
            let propellers = 0.03 * waves(self.time, [6.7, 9.1, 12.3], phase);
            (turbulence + propellers) * DEGREE
        })
    }
}

/// A four-cell lithium battery: current in amperes, charge in ampere seconds.
pub struct Battery {
    pub current: f64,
    charge: f64,
}

impl Battery {
    const CAPACITY: f64 = 5.0 * 3600.0;
    const RESISTANCE: f64 = 0.025;

    pub fn charged() -> Self {
        Self {
            current: 0.0,
            charge: 0.97 * Self::CAPACITY,
        }
    }

    /// Feeds the vehicle for one step.
    pub fn step(&mut self, vehicle: &Vehicle, phase: &Phase) {
        // By momentum theory, power grows with thrust to the power of 1.5.
        let load = vehicle.airborne() * (vehicle.thrust().norm() / GRAVITY).powf(1.5);
        let motors = if phase.motors_on {
            2.3 + 16.0 * load
        } else {
            0.0
        };
        let electronics = 0.7;
        self.current = electronics + motors;
        self.charge -= self.current * STEP;
    }

    pub fn percentage(&self) -> f64 {
        100.0 * self.charge / Self::CAPACITY
    }

    pub fn voltage(&self) -> f64 {
        let cell = 3.5 + 0.007 * self.percentage();
        4.0 * cell - self.current * Self::RESISTANCE
    }
}

/// Takes a photo whenever the vehicle passes the next of the planned places.
pub struct Camera {
    /// North and east of each photo, and the course there.
    plan: Vec<(Vector2<f64>, Vector2<f64>)>,
    taken: usize,
}

impl Camera {
    pub fn for_mission(mission: &[Phase]) -> Self {
        let legs = mission
            .iter()
            .filter(|phase| phase.name.starts_with("Leg "));
        let plan = legs.flat_map(|leg| {
            let course = direction(leg.from.w);
            PHOTOS.map(|distance| (leg.from.xy() + course * distance, course))
        });
        Self {
            plan: plan.collect(),
            taken: 0,
        }
    }

    /// The number of the photo to take now, from 0, if one is due.
    pub fn trigger(&mut self, vehicle: &Vehicle) -> Option<usize> {
        let (place, course) = self.plan.get(self.taken)?;
        if (vehicle.pose.xy() - place).dot(course) < 0.0 {
            return None;
        }
        self.taken += 1;
        Some(self.taken - 1)
    }
}

/// The angle in [-pi, pi) that differs from `angle` by whole turns.
pub fn wrap_angle(angle: f64) -> f64 {
    (angle + PI).rem_euclid(TAU) - PI
}

/// North and east of the unit vector in the direction of a heading.
fn direction(heading: f64) -> Vector2<f64> {
    Vector2::new(heading.cos(), heading.sin())
}

/// A sum of sine waves, which stands in for noise: smooth, within [-1, 1] and always the same.
fn waves(time: f64, frequencies: [f64; 3], phase: f64) -> f64 {
    let wave = |frequency: f64| (TAU * frequency * time + 9.0 * phase * frequency.sqrt()).sin();
    frequencies.map(wave).iter().sum::<f64>() / 3.0
}
