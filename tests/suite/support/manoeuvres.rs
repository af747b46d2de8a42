//! Flights with manoeuvres, and what their sensors measure: simulated from forces, without flightcam.

use std::f64::consts::{PI, TAU};

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

const GRAVITY: f64 = 9.81;

/// The time from one state to the next, in seconds.
pub const STEP: f64 = 0.01;

/// What the drone is and does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Manoeuvre {
    /// A multicopter that stays where it is.
    Hover,
    /// A multicopter that flies straight to the north, without a stop.
    Line,
    /// A multicopter that flies lines to and fro, with its nose along them.
    Survey,
    /// A multicopter that is flown by hand: in all directions, up and down, its nose anywhere.
    Free,
    /// A multicopter that flies around a point with its nose towards it.
    Orbit,
    /// A plane that turns and climbs.
    Wing,
    /// A small multicopter that is raced: steep, fast, and it flips over now and then.
    Race,
    /// A tailsitter that flies about on its tail, its nose up.
    Tail,
}

/// Where the drone is and how it moves, in metres, seconds, NED and FRD.
#[derive(Debug, Clone, Copy)]
pub struct State {
    pub time: f64,
    pub position: Vector3<f64>,
    pub velocity: Vector3<f64>,
    pub attitude: Rotation3<f64>,
    /// Angular rates about the drone's axes.
    pub rates: Vector3<f64>,
    /// What an accelerometer feels, in the drone's axes.
    pub force: Vector3<f64>,
}

/// Random numbers that are the same every time.
#[derive(Debug, Clone)]
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    /// Evenly between 0 and 1.
    pub fn even(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn between(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * self.even()
    }

    /// Normally distributed about 0.
    pub fn normal(&mut self, deviation: f64) -> f64 {
        let radius = (-2.0 * self.even().max(1e-12).ln()).sqrt();
        deviation * radius * (TAU * self.even()).cos()
    }

    pub fn vector(&mut self, deviation: f64) -> Vector3<f64> {
        Vector3::from_fn(|_, _| self.normal(deviation))
    }
}

/// A flight of so many seconds, with a wind of up to so many m/s along north and east.
pub fn fly(manoeuvre: Manoeuvre, seconds: f64, strongest_wind: f64, seed: u64) -> Vec<State> {
    let mut random = Random::new(seed);
    let [north, east] = [0, 1].map(|_| random.between(-strongest_wind, strongest_wind));
    let wind = Vector3::new(north, east, 0.0);
    let count = (seconds / STEP) as usize;
    let mut states = match manoeuvre {
        Manoeuvre::Wing => wing(count, wind, &mut random),
        _ => multicopter(manoeuvre, count, wind, &mut random),
    };
    match manoeuvre {
        Manoeuvre::Race => flip(&mut states),
        Manoeuvre::Tail => stand_up(&mut states),
        _ => {}
    }
    with_rates(states)
}

/// Lets the drone roll over in half a second, every eight seconds.
fn flip(states: &mut [State]) {
    for state in states {
        let phase = (state.time % 8.0 - 5.0).clamp(0.0, 0.5) / 0.5;
        turn_airframe(state, Rotation3::new(Vector3::x() * (TAU * phase)));
    }
}

/// Has the nose where the rotors push to.
fn stand_up(states: &mut [State]) {
    for state in states {
        turn_airframe(state, Rotation3::new(Vector3::y() * (PI / 2.0)));
    }
}

fn turn_airframe(state: &mut State, turn: Rotation3<f64>) {
    state.attitude *= turn;
    state.force = turn.inverse() * state.force;
}

/// A velocity that is wanted, and where the nose is.
struct Target {
    velocity: Vector3<f64>,
    heading: f64,
}

fn multicopter(
    manoeuvre: Manoeuvre,
    count: usize,
    wind: Vector3<f64>,
    random: &mut Random,
) -> Vec<State> {
    const DRAG: f64 = 0.25;
    // How fast it flies by hand, how hard it accelerates, how soon, and how fast it turns.
    let (fastest, hardest, lag, fastest_turn) = match manoeuvre {
        Manoeuvre::Race => (20.0, 18.0, 0.1, 5.0),
        _ => (9.0, 4.5, 0.25, 1.2),
    };
    let start_heading = random.between(-PI, PI);
    let speed = random.between(4.0, 10.0);
    let mut free = Target {
        velocity: Vector3::zeros(),
        heading: start_heading,
    };
    let mut turning = 0.0;
    let mut next_change = 0.0;
    let mut state = State {
        time: 0.0,
        position: Vector3::new(0.0, 0.0, -30.0),
        velocity: Vector3::zeros(),
        attitude: Rotation3::identity(),
        rates: Vector3::zeros(),
        force: Vector3::zeros(),
    };
    let mut acceleration = Vector3::zeros();
    let mut heading = start_heading;
    let mut gust = Vector3::zeros();
    let mut states = Vec::new();
    for place in 0..count {
        let time = place as f64 * STEP;
        let target = match manoeuvre {
            Manoeuvre::Hover => Target {
                velocity: -0.3 * (state.position - Vector3::new(0.0, 0.0, -30.0)),
                heading: start_heading,
            },
            Manoeuvre::Line => Target {
                velocity: Vector3::new(speed, 0.0, 0.0),
                heading: start_heading,
            },
            Manoeuvre::Survey => {
                // Lines of 20 s, 4 s from one to the next, turned by a fixed angle from north.
                let (line, phase) = ((time / 24.0) as usize, time % 24.0);
                let along = if line.is_multiple_of(2) { 1.0 } else { -1.0 };
                let (along, across) = match phase < 20.0 {
                    true => (along * speed, 0.0),
                    false => (0.0, 0.7 * speed),
                };
                let lines = Rotation3::from_euler_angles(0.0, 0.0, start_heading);
                let velocity = lines * Vector3::new(along, across, 0.0);
                let heading = velocity.y.atan2(velocity.x);
                Target { velocity, heading }
            }
            Manoeuvre::Orbit => {
                let radius = 20.0;
                let angle = start_heading + speed / radius * time;
                Target {
                    velocity: speed * Vector3::new(-angle.sin(), angle.cos(), 0.0),
                    heading: angle + PI,
                }
            }
            Manoeuvre::Free | Manoeuvre::Race | Manoeuvre::Tail | Manoeuvre::Wing => {
                if time >= next_change {
                    next_change = time + random.between(2.0, 6.0);
                    free.velocity = Vector3::new(
                        random.between(-fastest, fastest),
                        random.between(-fastest, fastest),
                        random.between(-fastest / 3.0, fastest / 3.0),
                    );
                    turning = random.between(-1.0, 1.0) * fastest_turn / 1.2;
                }
                free.heading += turning * STEP;
                Target {
                    velocity: free.velocity,
                    heading: free.heading,
                }
            }
        };
        gust += (random.vector(0.3) - gust * 0.5) * STEP.sqrt() * 0.3;
        let wanted = (target.velocity - state.velocity) * 1.2;
        let wanted = wanted.cap_magnitude(hardest);
        acceleration += (wanted - acceleration) * (STEP / lag);
        let off = (target.heading - heading + PI).rem_euclid(TAU) - PI;
        heading += off.clamp(-fastest_turn * STEP, fastest_turn * STEP);
        let down = Vector3::z();
        let specific = acceleration - GRAVITY * down;
        let thrust = specific + DRAG * (state.velocity - wind - gust);
        let attitude = from_nose_and_down(
            Vector3::new(heading.cos(), heading.sin(), 0.0),
            -thrust.normalize(),
        );
        state.time = time;
        state.attitude = attitude;
        state.force = attitude.inverse() * specific;
        states.push(state);
        state.position += state.velocity * STEP + acceleration * (0.5 * STEP * STEP);
        state.velocity += acceleration * STEP;
    }
    states
}

fn wing(count: usize, wind: Vector3<f64>, random: &mut Random) -> Vec<State> {
    let mut course = random.between(-PI, PI);
    let (mut turn, mut climb, mut speed) = (0.0, 0.0, 17.0);
    let (mut wanted_turn, mut wanted_climb, mut wanted_speed) = (0.0, 0.0, 17.0);
    let mut next_change = 0.0;
    let mut position = Vector3::new(0.0, 0.0, -100.0);
    let mut air = Vec::new();
    for place in 0..count + 1 {
        let time = place as f64 * STEP;
        if time >= next_change {
            next_change = time + random.between(4.0, 12.0);
            let straight = random.even() < 0.3;
            wanted_turn = if straight {
                0.0
            } else {
                random.between(-0.45, 0.45)
            };
            wanted_climb = random.between(-0.2, 0.2);
            wanted_speed = random.between(14.0, 20.0);
        }
        turn += (wanted_turn - turn) * (STEP / 0.6);
        climb += (wanted_climb - climb) * (STEP / 1.5);
        speed += (wanted_speed - speed) * (STEP / 4.0);
        course += turn * STEP;
        air.push(
            speed
                * Vector3::new(
                    course.cos() * climb.cos(),
                    course.sin() * climb.cos(),
                    -climb.sin(),
                ),
        );
    }
    let mut states = Vec::new();
    for (place, pair) in air.windows(2).enumerate() {
        let acceleration = (pair[1] - pair[0]) / STEP;
        let specific = acceleration - GRAVITY * Vector3::z();
        let along = pair[0].normalize();
        let lift = specific - along * specific.dot(&along);
        let down = -lift.normalize();
        // The wing meets the air at a small angle.
        let attack = 0.05;
        let nose = along * f64::cos(attack) - down * f64::sin(attack);
        let attitude = from_nose_and_down(nose, down * f64::cos(attack) + along * f64::sin(attack));
        states.push(State {
            time: place as f64 * STEP,
            position,
            velocity: pair[0] + wind,
            attitude,
            rates: Vector3::zeros(),
            force: attitude.inverse() * specific,
        });
        position += (pair[0] + wind) * STEP;
    }
    states
}

/// An attitude whose z axis is `down`, and whose x axis is as near to `nose` as can be.
fn from_nose_and_down(nose: Vector3<f64>, down: Vector3<f64>) -> Rotation3<f64> {
    let right = down.cross(&nose).normalize();
    let front = right.cross(&down);
    Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[front, right, down]))
}

fn with_rates(mut states: Vec<State>) -> Vec<State> {
    for place in 1..states.len() {
        let turn = states[place - 1].attitude.inverse() * states[place].attitude;
        states[place - 1].rates = turn.scaled_axis() / STEP;
    }
    states
}

/// Latitude and longitude in degrees and height in metres of a place north, east and down of another one: by way of
/// coordinates whose origin is the earth's centre (WGS 84).
pub fn geodetic(origin: [f64; 3], ned: Vector3<f64>) -> [f64; 3] {
    let (a, f) = (6_378_137.0_f64, 1.0 / 298.257_223_563);
    let e2 = f * (2.0 - f);
    let (lat, lon) = (origin[0].to_radians(), origin[1].to_radians());
    let radius = |lat: f64| a / (1.0 - e2 * lat.sin() * lat.sin()).sqrt();
    let n = radius(lat);
    let centre = Vector3::new(
        (n + origin[2]) * lat.cos() * lon.cos(),
        (n + origin[2]) * lat.cos() * lon.sin(),
        (n * (1.0 - e2) + origin[2]) * lat.sin(),
    );
    let north = Vector3::new(-lat.sin() * lon.cos(), -lat.sin() * lon.sin(), lat.cos());
    let east = Vector3::new(-lon.sin(), lon.cos(), 0.0);
    let up = Vector3::new(lat.cos() * lon.cos(), lat.cos() * lon.sin(), lat.sin());
    let place = centre + north * ned.x + east * ned.y - up * ned.z;
    let across = place.x.hypot(place.y);
    let mut latitude = (place.z / (across * (1.0 - e2))).atan();
    let mut height = 0.0;
    for _ in 0..10 {
        let n = radius(latitude);
        height = across / latitude.cos() - n;
        latitude = (place.z / (across * (1.0 - e2 * n / (n + height)))).atan();
    }
    [
        latitude.to_degrees(),
        place.y.atan2(place.x).to_degrees(),
        height,
    ]
}

/// What a drone's sensors and estimator report of a flight.
#[derive(Debug, Clone, Default)]
pub struct Measured {
    pub attitudes: Vec<(f64, UnitQuaternion<f64>)>,
    /// In NED.
    pub velocities: Vec<(f64, Vector3<f64>)>,
    /// Degrees, degrees, metres.
    pub places: Vec<(f64, [f64; 3])>,
    /// In FRD.
    pub rates: Vec<(f64, Vector3<f64>)>,
    /// In FRD.
    pub forces: Vec<(f64, Vector3<f64>)>,
}

/// How good the sensors are, and how often they report.
#[derive(Debug, Clone, Copy)]
pub struct Sensors {
    /// The standard deviation of positions in metres; half of it wanders, half is new each time.
    pub position_noise: f64,
    pub position_hz: f64,
    /// How late positions are, in seconds.
    pub position_late_by: f64,
    /// How far positions wander in a minute or so besides, in metres.
    pub position_drift: f64,
    /// In m/s.
    pub velocity_noise: f64,
    pub velocity_hz: f64,
    pub attitude_hz: f64,
    /// Of angular rates and accelerations; 0 without these.
    pub imu_hz: f64,
    /// How far the compass is wrong, in radians.
    pub heading_error: f64,
}

impl Default for Sensors {
    fn default() -> Self {
        Self {
            position_noise: 0.1,
            position_hz: 5.0,
            position_late_by: 0.0,
            position_drift: 0.0,
            velocity_noise: 0.1,
            velocity_hz: 10.0,
            attitude_hz: 20.0,
            imu_hz: 50.0,
            heading_error: 0.0,
        }
    }
}

/// Measures a flight.
pub fn measure(states: &[State], sensors: Sensors, seed: u64) -> Measured {
    let mut random = Random::new(seed ^ 0x5EED);
    let origin = [
        random.between(-60.0, 65.0),
        random.between(-179.0, 179.0),
        random.between(0.0, 800.0),
    ];
    let every = |hz: f64| ((1.0 / hz / STEP).round() as usize).max(1);
    let mut measured = Measured::default();
    let (mut wandering, mut drift) = (Vector3::zeros(), Vector3::zeros());
    let compass = Rotation3::new(Vector3::z() * sensors.heading_error);
    let tilt_error = random.vector(0.01);
    let force_bias = random.vector(0.08);
    let rate_bias = random.vector(0.005);
    for (place, state) in states.iter().enumerate() {
        let time = state.time;
        if place.is_multiple_of(every(sensors.attitude_hz)) {
            let error = compass * Rotation3::new(tilt_error + random.vector(0.003));
            let attitude = UnitQuaternion::from_rotation_matrix(&(error * state.attitude));
            measured.attitudes.push((time, attitude));
        }
        if place.is_multiple_of(every(sensors.velocity_hz)) {
            let velocity = state.velocity + random.vector(sensors.velocity_noise);
            measured.velocities.push((time, velocity));
        }
        if place.is_multiple_of(every(sensors.position_hz)) {
            let noise = sensors.position_noise / 2.0;
            wandering += random.vector(noise * 0.2) - wandering * 0.02;
            if sensors.position_drift > 0.0 {
                let minutes = 1.0 / sensors.position_hz / 60.0;
                let step = random.vector(sensors.position_drift * (2.0 * minutes).sqrt());
                drift += step - drift * minutes;
            }
            let seen = state.position + wandering + drift + random.vector(noise);
            let time = time + sensors.position_late_by;
            let [latitude, longitude, height] = geodetic(origin, seen);
            let rounded = |degrees: f64| (degrees * 1e7).round() / 1e7;
            measured.places.push((
                time,
                [
                    rounded(latitude),
                    rounded(longitude),
                    (height * 1e3).round() / 1e3,
                ],
            ));
        }
        if sensors.imu_hz > 0.0 && place.is_multiple_of(every(sensors.imu_hz)) {
            measured
                .rates
                .push((time, state.rates + rate_bias + random.vector(0.02)));
            measured
                .forces
                .push((time, state.force + force_bias + random.vector(0.4)));
        }
    }
    measured
}
