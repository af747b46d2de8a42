//! The flight: a multirotor that swings over its area without end, and turns while it does.
//!
//! Everything is a sum of sine waves of the time, so that velocity and acceleration are exact derivatives and a
//! flight can be of any length. The attitude is the one that a multirotor needs for this acceleration.

use std::f64::consts::{PI, TAU};

const GRAVITY: f64 = 9.80665;
const METRES_PER_DEGREE: f64 = 111_200.0;
const HOME: [f64; 3] = [47.397_742, 8.545_594, 575.0];

/// Amplitudes and periods (m, s). No two periods have a small common multiple, so that nothing repeats.
const NORTH: [(f64, f64); 2] = [(80.0, 67.0), (25.0, 23.0)];
const EAST: [(f64, f64); 2] = [(95.0, 83.0), (20.0, 19.0)];
const DOWN: [(f64, f64); 2] = [(12.0, 59.0), (1.5, 7.0)];
/// The heading goes around once in this time (s), and swings meanwhile (rad, s), so that it passes ±180° in both
/// directions.
const TURN: f64 = 89.0;
const YAW: [(f64, f64); 2] = [(1.5, 31.0), (0.01, 1.3)];
/// What turbulence does to roll and pitch (rad, s).
const ROLL: [(f64, f64); 2] = [(0.004, 0.9), (0.001, 0.13)];
const PITCH: [(f64, f64); 2] = [(0.004, 1.1), (0.001, 0.17)];

/// What the drone reports, as drone_state.proto describes it.
#[derive(Clone, PartialEq, prost::Message)]
pub struct DroneState {
    #[prost(double, tag = "1")]
    roll: f64,
    #[prost(double, tag = "2")]
    pitch: f64,
    #[prost(double, tag = "3")]
    yaw: f64,
    #[prost(double, tag = "4")]
    vx: f64,
    #[prost(double, tag = "5")]
    vy: f64,
    #[prost(double, tag = "6")]
    vz: f64,
    #[prost(double, tag = "7")]
    lat: f64,
    #[prost(double, tag = "8")]
    lon: f64,
    #[prost(double, tag = "9")]
    alt: f64,
}

impl DroneState {
    /// The state so many seconds after the start.
    pub fn at(time: f64) -> Self {
        let [north, vx, north_acceleration] = swing(&NORTH, time);
        let [east, vy, east_acceleration] = swing(&EAST, time);
        let [down, vz, _] = swing(&DOWN, time);
        let yaw = wrap_angle(TAU * time / TURN + swing(&YAW, time)[0]);
        let (sin, cos) = yaw.sin_cos();
        let ahead = cos * north_acceleration + sin * east_acceleration;
        let right = cos * east_acceleration - sin * north_acceleration;
        let [home_lat, home_lon, home_alt] = HOME;
        let metres_per_degree_east = METRES_PER_DEGREE * home_lat.to_radians().cos();
        Self {
            roll: round_to_bits((right / GRAVITY).atan() + swing(&ROLL, time)[0], 24),
            pitch: round_to_bits((-ahead / GRAVITY).atan() + swing(&PITCH, time)[0], 24),
            yaw: round_to_bits(yaw, 24),
            vx: round_to_bits(vx, 20),
            vy: round_to_bits(vy, 20),
            vz: round_to_bits(vz, 20),
            lat: round_to_bits(home_lat + north / METRES_PER_DEGREE, 34),
            lon: round_to_bits(home_lon + east / metres_per_degree_east, 34),
            alt: round_to_bits(home_alt - down, 16),
        }
    }
}

/// A sum of sine waves, given by amplitude and period, and its first and second derivative.
fn swing(waves: &[(f64, f64)], time: f64) -> [f64; 3] {
    waves
        .iter()
        .fold([0.0; 3], |[value, first, second], (amplitude, period)| {
            let rate = TAU / period;
            let (sin, cos) = (rate * time).sin_cos();
            [
                value + amplitude * sin,
                first + amplitude * rate * cos,
                second - amplitude * rate * rate * sin,
            ]
        })
}

/// The angle in [-pi, pi) that differs from `angle` by whole turns.
fn wrap_angle(angle: f64) -> f64 {
    (angle + PI).rem_euclid(TAU) - PI
}

/// Keeps this many binary digits after the point: no sensor has 53 significant bits, and the last bit of a sine
/// may differ between platforms.
fn round_to_bits(value: f64, bits: i32) -> f64 {
    let scale = 2_f64.powi(bits);
    (value * scale).round() / scale
}
