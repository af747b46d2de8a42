//! DJI's Onboard SDK in ROS 1 up to version 3.2, and its Payload SDK in ROS 2.

use std::f64::consts::FRAC_PI_2;

use super::{
    definition::Wanted,
    flight::{self, Flight},
    recorder::Recorder,
    recording::{Recording, Reference},
    ros::{Ros, ros1, ros2},
};

pub fn recordings() -> Vec<Recording> {
    vec![
        onboard("attitude on the globe", |mut log| {
            quaternion(&mut log);
            global_position(&mut log);
        })
        .with_geodetic(1e-4),
        onboard("odometry", |mut log| {
            odometry(&mut log);
            local_position(&mut log);
        })
        .with_local(1e-5),
        payload("attitude on the globe", |mut log| {
            log.quaternion("/psdk_ros2/attitude");
            log.fix("/psdk_ros2/gps_position_fused");
        })
        .with_geodetic(1e-9),
        payload("IMU", |mut log| {
            log.imu("/psdk_ros2/imu");
            fused_position(&mut log);
        })
        .with_local(1e-9),
    ]
}

fn onboard(name: &str, write: fn(Ros)) -> Recording {
    let write = move |flight: &Flight, log: &mut Recorder| {
        let mut log = Ros {
            flight,
            log,
            schema: ros1,
            pose_frame: "/world",
            drone_frame: "/world",
        };
        log.topic(
            "/dji_sdk/velocity",
            "dji_sdk/Velocity",
            &flight.velocity_times,
            |time| {
                let v = flight.velocity(time);
                Wanted::new()
                    .numbers(["vx", "vy", "vz"], [v.x, v.y, -v.z])
                    .number("health_flag", 1.0)
            },
        );
        log.topic(
            "/dji_sdk/velocity",
            "dji_sdk/Velocity",
            &flight.invalid_times,
            |_| {
                Wanted::new()
                    .numbers(["vx", "vy", "vz"], [1.5, 2.5, 3.5])
                    .number("health_flag", 0.0)
            },
        );
        log.topic(
            "/dji_sdk/gimbal",
            "dji_sdk/Gimbal",
            &flight.gimbal_times,
            |time| {
                let angles = flight.gimbal_angles(time).map(f64::to_degrees);
                Wanted::new().numbers(["roll", "pitch", "yaw"], angles)
            },
        );
        write(log);
    };
    Recording::new("dji-osdk-3.2", name, Flight::new(), write)
        .with_floats()
        .with_gimbal(Reference::Earth)
}

fn quaternion(log: &mut Ros) {
    let flight = log.flight;
    let message = "dji_sdk/AttitudeQuaternion";
    log.topic(
        "/dji_sdk/attitude_quaternion",
        message,
        &flight.attitude_times,
        |time| {
            let q = flight.attitude(time);
            let [rates, _] = flight.felt(time);
            Wanted::new()
                .numbers(["q0", "q1", "q2"], [q.w, q.i, q.j])
                .number("q3", q.k)
                .numbers(["wx", "wy", "wz"], rates.into())
        },
    );
}

fn global_position(log: &mut Ros) {
    let flight = log.flight;
    let message = "dji_sdk/GlobalPosition";
    log.topic(
        "/dji_sdk/global_position",
        message,
        &flight.position_times,
        |time| {
            let fields = ["latitude", "longitude", "altitude"];
            Wanted::new().numbers(fields, flight.geodetic(time))
        },
    );
}

/// The drone's quaternion and place as they are, in a type that has other axes elsewhere.
fn odometry(log: &mut Ros) {
    let flight = log.flight;
    log.topic(
        "/dji_sdk/odometry",
        "nav_msgs/Odometry",
        &flight.attitude_times,
        |time| {
            Wanted::new()
                .text("header.frame_id", "/world")
                .text("child_frame_id", "")
                .xyzw("pose.pose.orientation", flight.attitude(time))
        },
    );
}

fn local_position(log: &mut Ros) {
    let flight = log.flight;
    let message = "dji_sdk/LocalPosition";
    log.topic(
        "/dji_sdk/local_position",
        message,
        &flight.position_times,
        |time| {
            let local = flight.local(time);
            Wanted::new().numbers(["x", "y", "z"], [local.x, local.y, -local.z])
        },
    );
}

fn payload(name: &str, write: fn(Ros)) -> Recording {
    let write = move |flight: &Flight, log: &mut Recorder| {
        let mut log = Ros {
            flight,
            log,
            schema: ros2,
            pose_frame: "psdk_map_enu",
            drone_frame: "psdk_base_link",
        };
        log.world_velocity("/psdk_ros2/velocity_ground_fused");
        log.topic(
            "/psdk_ros2/gimbal_angles",
            "geometry_msgs/Vector3Stamped",
            &flight.gimbal_times,
            |time| {
                let [roll, pitch, yaw] = flight.gimbal_angles(time);
                Wanted::new()
                    .text("header.frame_id", "psdk_gimbal_link")
                    .numbers(
                        ["vector.x", "vector.y", "vector.z"],
                        [roll, -pitch, FRAC_PI_2 - yaw],
                    )
            },
        );
        write(log);
    };
    Recording::new("dji-psdk-ros2", name, Flight::new(), write).with_gimbal(Reference::Earth)
}

fn fused_position(log: &mut Ros) {
    let flight = log.flight;
    let message = "psdk_interfaces/PositionFused";
    log.topic(
        "/psdk_ros2/position_fused",
        message,
        &flight.position_times,
        |time| {
            Wanted::new()
                .xyz("position", flight::enu(flight.local(time)))
                .numbers(["x_health", "y_health", "z_health"], [1.0, 1.0, 0.0])
        },
    );
    let unhealthy = [[0.0, 1.0, 1.0], [1.0, 0.0, 1.0]];
    for (&time, health) in flight.invalid_times.iter().zip(unhealthy.iter().cycle()) {
        log.topic("/psdk_ros2/position_fused", message, &[time], |_| {
            Wanted::new()
                .numbers(["position.x", "position.y", "position.z"], [1.5, 2.5, 3.5])
                .numbers(["x_health", "y_health", "z_health"], *health)
        });
    }
}
