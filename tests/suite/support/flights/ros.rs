//! ROS's common messages, in ROS 1 and ROS 2.

use nalgebra::{UnitQuaternion, Vector3};

use super::{
    definition::Wanted,
    flight::{self, Flight},
    recorder::{Recorder, Schema},
};

/// A log of ROS messages.
pub struct Ros<'a> {
    pub flight: &'a Flight,
    pub log: &'a mut Recorder,
    /// The type of a message, `geometry_msgs/PoseStamped`.
    pub schema: fn(&str) -> Schema,
    /// What the frame of a pose is called.
    pub pose_frame: &'static str,
    /// What the drone's frame is called.
    pub drone_frame: &'static str,
}

pub fn ros1(message: &str) -> Schema {
    Schema::ros1("ros1", message)
}

pub fn ros2(message: &str) -> Schema {
    Schema::ros2("ros2", message)
}

pub fn ros2_big_endian(message: &str) -> Schema {
    ros2(message).big_endian()
}

impl Ros<'_> {
    /// Messages of any type at any times.
    pub fn topic(
        &mut self,
        topic: &str,
        message: &str,
        times: &[u64],
        wanted: impl Fn(u64) -> Wanted,
    ) -> &mut Self {
        let messages = times.iter().map(|&time| (time, wanted(time)));
        self.log.topic(topic, &(self.schema)(message), messages);
        self
    }

    /// `PoseStamped`: attitude and position in ENU.
    pub fn pose(&mut self, topic: &str) -> &mut Self {
        let (flight, frame) = (self.flight, self.pose_frame);
        self.topic(
            topic,
            "geometry_msgs/PoseStamped",
            &flight.attitude_times,
            |time| {
                Wanted::new()
                    .text("header.frame_id", frame)
                    .xyzw("pose.orientation", attitude(flight, time))
                    .xyz("pose.position", flight::enu(flight.local(time)))
            },
        )
    }

    /// `GeoPoseStamped`: attitude in ENU, position on the globe.
    pub fn geopose(&mut self, topic: &str) -> &mut Self {
        let (flight, frame) = (self.flight, self.pose_frame);
        let position =
            ["latitude", "longitude", "altitude"].map(|name| format!("pose.position.{name}"));
        let position = position.each_ref().map(String::as_str);
        self.topic(
            topic,
            "geographic_msgs/GeoPoseStamped",
            &flight.attitude_times,
            |time| {
                Wanted::new()
                    .text("header.frame_id", frame)
                    .xyzw("pose.orientation", attitude(flight, time))
                    .numbers(position, flight.geodetic(time))
            },
        )
    }

    /// `Imu`: attitude in ENU, rates and accelerations in FLU.
    pub fn imu(&mut self, topic: &str) -> &mut Self {
        self.imu_in(topic, flight::flu)
    }

    /// `Imu`: attitude in ENU, rates and accelerations in other axes of the drone.
    pub fn imu_in(&mut self, topic: &str, axes: fn(Vector3<f64>) -> Vector3<f64>) -> &mut Self {
        let (flight, frame) = (self.flight, self.drone_frame);
        self.topic(topic, "sensor_msgs/Imu", &flight.attitude_times, |time| {
            let [rates, forces] = flight.felt(time).map(axes);
            Wanted::new()
                .text("header.frame_id", frame)
                .xyzw("orientation", attitude(flight, time))
                .xyz("angular_velocity", rates)
                .xyz("linear_acceleration", forces)
        })
    }

    /// `QuaternionStamped`: attitude in ENU.
    pub fn quaternion(&mut self, topic: &str) -> &mut Self {
        let (flight, frame) = (self.flight, self.drone_frame);
        let message = "geometry_msgs/QuaternionStamped";
        self.topic(topic, message, &flight.attitude_times, |time| {
            Wanted::new()
                .text("header.frame_id", frame)
                .xyzw("quaternion", attitude(flight, time))
        })
    }

    /// `Vector3Stamped` with the velocity in ENU.
    pub fn world_velocity(&mut self, topic: &str) -> &mut Self {
        let (flight, frame) = (self.flight, self.pose_frame);
        let message = "geometry_msgs/Vector3Stamped";
        self.topic(topic, message, &flight.velocity_times, |time| {
            Wanted::new()
                .text("header.frame_id", frame)
                .xyz("vector", flight::enu(flight.velocity(time)))
        })
    }

    /// `TwistStamped` with the velocity in ENU.
    pub fn world_twist(&mut self, topic: &str) -> &mut Self {
        let (flight, frame) = (self.flight, self.drone_frame);
        self.topic(
            topic,
            "geometry_msgs/TwistStamped",
            &flight.velocity_times,
            |time| {
                Wanted::new()
                    .text("header.frame_id", frame)
                    .xyz("twist.linear", flight::enu(flight.velocity(time)))
            },
        )
    }

    /// `TwistStamped` with the velocity in body FLU.
    pub fn body_twist(&mut self, topic: &str) -> &mut Self {
        let (flight, frame) = (self.flight, self.drone_frame);
        self.topic(
            topic,
            "geometry_msgs/TwistStamped",
            &flight.velocity_times,
            |time| {
                Wanted::new()
                    .text("header.frame_id", frame)
                    .xyz("twist.linear", flight::flu(flight.body_velocity(time)))
            },
        )
    }

    /// `Odometry`: attitude and position in ENU, velocity in body FLU.
    pub fn odometry(&mut self, topic: &str) -> &mut Self {
        let (flight, frame, child) = (self.flight, self.pose_frame, self.drone_frame);
        self.topic(topic, "nav_msgs/Odometry", &flight.attitude_times, |time| {
            Wanted::new()
                .text("header.frame_id", frame)
                .text("child_frame_id", child)
                .xyzw("pose.pose.orientation", attitude(flight, time))
                .xyz("pose.pose.position", flight::enu(flight.local(time)))
                .xyz(
                    "twist.twist.linear",
                    flight::flu(flight.body_velocity(time)),
                )
        })
    }

    /// `NavSatFix`: the position on the globe.
    pub fn fix(&mut self, topic: &str) -> &mut Self {
        let flight = self.flight;
        let fields = ["latitude", "longitude", "altitude"];
        self.topic(
            topic,
            "sensor_msgs/NavSatFix",
            &flight.position_times,
            |time| Wanted::new().numbers(fields, flight.geodetic(time)),
        )
    }
}

/// The attitude from FLU to ENU.
pub fn attitude(flight: &Flight, time: u64) -> UnitQuaternion<f64> {
    flight::flu_in_enu(flight.attitude(time))
}
