//! PX4's messages, however they get into a log.

use nalgebra::Vector3;

use super::{
    definition::Wanted,
    flight::Flight,
    recorder::{Recorder, Schema},
};

/// A log of PX4's messages.
pub struct Px4<'a> {
    pub flight: &'a Flight,
    pub log: &'a mut Recorder,
    /// The topic of a message, `vehicle_attitude`.
    pub topic: fn(&str) -> String,
    /// The type of a message: its release, its name in px4_msgs, and its name in uORB.
    pub schema: fn(&str, &str, &str) -> Schema,
}

/// In which frame a `VehicleOdometry` has the velocity.
#[derive(Clone, Copy)]
pub enum VelocityFrame {
    Ned,
    BodyFrd,
}

/// The content of a message that cannot be used.
const WRONG: Vector3<f64> = Vector3::new(77.0, -66.0, 55.0);
const WRONG_ATTITUDE: [f64; 4] = [0.5, 0.5, -0.5, 0.5];

impl Px4<'_> {
    pub fn vehicle_attitude(&mut self, release: &str) -> &mut Self {
        let flight = self.flight;
        let messages = flight.attitude_times.iter().map(|&time| {
            let wanted = Wanted::new()
                .wxyz("q", flight.attitude(time))
                .number("quat_reset_counter", 3.0);
            (time, wanted)
        });
        self.put(
            release,
            "VehicleAttitude",
            "vehicle_attitude",
            messages.collect(),
        )
    }

    /// Velocities at their times, positions and heights at theirs, and in between messages that are marked invalid.
    pub fn vehicle_local_position(&mut self, release: &str) -> &mut Self {
        let flight = self.flight;
        let message = |&time: &u64, has_velocity: bool, has_position: bool| {
            let velocity = if has_velocity {
                flight.velocity(time)
            } else {
                WRONG
            };
            let position = if has_position {
                flight.local(time)
            } else {
                WRONG
            };
            let wanted = Wanted::new()
                .numbers(["vx", "vy", "vz"], velocity.into())
                .numbers(["x", "y", "z"], position.into())
                .numbers(["v_xy_valid", "v_z_valid"], marks(has_velocity, time))
                .numbers(["xy_valid", "z_valid"], marks(has_position, time))
                .number(
                    "dist_bottom",
                    if has_position {
                        flight.height(time)
                    } else {
                        77.0
                    },
                )
                .number("dist_bottom_valid", f64::from(u8::from(has_position)));
            (time, wanted)
        };
        let velocities = flight
            .velocity_times
            .iter()
            .map(|time| message(time, true, false));
        let positions = flight
            .position_times
            .iter()
            .map(|time| message(time, false, true));
        let invalid = flight
            .invalid_times
            .iter()
            .map(|time| message(time, false, false));
        let messages = velocities.chain(positions).chain(invalid).collect();
        self.put(
            release,
            "VehicleLocalPosition",
            "vehicle_local_position",
            messages,
        )
    }

    /// Of PX4 1.14 and later, with the velocity of the n-th message in a frame of that number's choice, and in
    /// between messages in frames that cannot be placed in NED.
    pub fn vehicle_odometry(
        &mut self,
        release: &str,
        frame_of: fn(usize) -> VelocityFrame,
    ) -> &mut Self {
        let message = |attitude: &[f64], velocity: Vector3<f64>, position: Vector3<f64>, frames| {
            Wanted::new()
                .list("q", attitude)
                .list("position", position.as_slice())
                .list("velocity", velocity.as_slice())
                .numbers(["pose_frame", "velocity_frame"], frames)
                .number("reset_counter", 3.0)
        };
        self.odometry(release, [1.0, 3.0], frame_of, [0.0, 2.0], message)
    }

    /// As [`Px4::vehicle_odometry`], of PX4 1.13 and before.
    pub fn vehicle_odometry_1_13(&mut self, frame_of: fn(usize) -> VelocityFrame) -> &mut Self {
        let message = |attitude: &[f64], velocity: Vector3<f64>, position: Vector3<f64>, frames| {
            Wanted::new()
                .list("q", attitude)
                .numbers(["x", "y", "z"], position.into())
                .numbers(["vx", "vy", "vz"], velocity.into())
                .numbers(["local_frame", "velocity_frame"], frames)
                .number("reset_counter", 3.0)
        };
        self.odometry("1.13", [0.0, 3.0], frame_of, [1.0, 2.0], message)
    }

    fn odometry(
        &mut self,
        release: &str,
        [ned, body_frd]: [f64; 2],
        frame_of: fn(usize) -> VelocityFrame,
        unplaced: [f64; 2],
        message: impl Fn(&[f64], Vector3<f64>, Vector3<f64>, [f64; 2]) -> Wanted,
    ) -> &mut Self {
        let flight = self.flight;
        let usable = flight
            .attitude_times
            .iter()
            .enumerate()
            .map(|(place, &time)| {
                let (velocity, frame) = match frame_of(place) {
                    VelocityFrame::Ned => (flight.velocity(time), ned),
                    VelocityFrame::BodyFrd => (flight.body_velocity(time), body_frd),
                };
                let q = flight.attitude(time);
                let attitude = [q.w, q.i, q.j, q.k];
                (
                    time,
                    message(&attitude, velocity, flight.local(time), [ned, frame]),
                )
            });
        let unusable = flight
            .invalid_times
            .iter()
            .enumerate()
            .map(|(place, &time)| {
                let frame = unplaced[place % 2];
                (time, message(&WRONG_ATTITUDE, WRONG, WRONG, [frame, frame]))
            });
        let messages = usable.chain(unusable).collect();
        self.put(release, "VehicleOdometry", "vehicle_odometry", messages)
    }

    pub fn gimbal(&mut self, release: &str, flags: u16) -> &mut Self {
        let flight = self.flight;
        let messages = flight.gimbal_times.iter().map(|&time| {
            let wanted = Wanted::new()
                .wxyz("q", flight.gimbal(time))
                .number("device_flags", f64::from(flags));
            (time, wanted)
        });
        let name = "gimbal_device_attitude_status";
        self.put(
            release,
            "GimbalDeviceAttitudeStatus",
            name,
            messages.collect(),
        )
    }

    /// What the gyroscope and the accelerometer measure, at the times of attitudes.
    pub fn sensor_combined(&mut self, release: &str) -> &mut Self {
        let flight = self.flight;
        let messages = flight.attitude_times.iter().map(|&time| {
            let [rates, forces] = flight.felt(time);
            let wanted = Wanted::new()
                .list("gyro_rad", rates.as_slice())
                .list("accelerometer_m_s2", forces.as_slice());
            (time, wanted)
        });
        let messages = messages.collect();
        self.put(release, "SensorCombined", "sensor_combined", messages)
    }

    /// The same, filtered.
    pub fn filtered_imu(&mut self, release: &str) -> &mut Self {
        let flight = self.flight;
        let messages = |which: usize| -> Vec<(u64, Wanted)> {
            let times = flight.attitude_times.iter();
            let felt = |time: u64| Wanted::new().list("xyz", flight.felt(time)[which].as_slice());
            times.map(|&time| (time, felt(time))).collect()
        };
        let name = "vehicle_angular_velocity";
        self.put(release, "VehicleAngularVelocity", name, messages(0));
        let name = "vehicle_acceleration";
        self.put(release, "VehicleAcceleration", name, messages(1))
    }

    /// With validity flags, as since PX4 1.16.
    pub fn vehicle_global_position(&mut self, release: &str) -> &mut Self {
        let flight = self.flight;
        let flags = ["lat_lon_valid", "alt_valid"];
        let valid = flight.position_times.iter().map(|&time| {
            let wanted = Wanted::new().numbers(["lat", "lon", "alt"], flight.geodetic(time));
            (time, wanted.numbers(flags, [1.0, 1.0]))
        });
        let invalid = flight.invalid_times.iter().map(|&time| {
            let wanted = Wanted::new().numbers(["lat", "lon", "alt"], WRONG.into());
            (time, wanted.numbers(flags, marks(false, time)))
        });
        let messages = valid.chain(invalid).collect();
        self.put(
            release,
            "VehicleGlobalPosition",
            "vehicle_global_position",
            messages,
        )
    }

    /// Without them, as before.
    pub fn vehicle_global_position_1_15(&mut self) -> &mut Self {
        let flight = self.flight;
        let message = |time| Wanted::new().numbers(["lat", "lon", "alt"], flight.geodetic(time));
        let messages = self.positions(message);
        self.put(
            "1.15",
            "VehicleGlobalPosition",
            "vehicle_global_position",
            messages,
        )
    }

    /// In degrees and metres, as since PX4 1.15.
    pub fn vehicle_gps_position(&mut self, release: &str) -> &mut Self {
        let flight = self.flight;
        let fields = ["latitude_deg", "longitude_deg", "altitude_msl_m"];
        let message = |time| Wanted::new().numbers(fields, flight.geodetic(time));
        let messages = self.positions(message);
        self.put(release, "SensorGps", "vehicle_gps_position", messages)
    }

    /// In 1e-7 degrees and millimetres, as before.
    pub fn vehicle_gps_position_1_14(&mut self) -> &mut Self {
        let flight = self.flight;
        let message = |time| {
            let [latitude, longitude, altitude] = flight.geodetic(time);
            let numbers = [latitude * 1e7, longitude * 1e7, altitude * 1e3].map(f64::round);
            Wanted::new().numbers(["lat", "lon", "alt"], numbers)
        };
        let messages = self.positions(message);
        self.put("1.14", "SensorGps", "vehicle_gps_position", messages)
    }

    fn positions(&self, message: impl Fn(u64) -> Wanted) -> Vec<(u64, Wanted)> {
        let times = self.flight.position_times.iter();
        times.map(|&time| (time, message(time))).collect()
    }

    fn put(
        &mut self,
        release: &str,
        message: &str,
        name: &str,
        mut messages: Vec<(u64, Wanted)>,
    ) -> &mut Self {
        messages.sort_by_key(|(time, _)| *time);
        let schema = (self.schema)(release, message, name);
        self.log.topic(&(self.topic)(name), &schema, messages);
        self
    }
}

/// Two flags that are set if a message is valid. If not, one of them is not, now the one and now the other.
fn marks(valid: bool, time: u64) -> [f64; 2] {
    match (valid, time / 10_000_000 % 2) {
        (true, _) => [1.0, 1.0],
        (false, 0) => [0.0, 1.0],
        (false, _) => [1.0, 0.0],
    }
}
