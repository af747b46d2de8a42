//! Each type of message that says something about its frames, or marks values as not valid, is heeded.

use flightcam::{
    log::{Log, ReadError},
    reader::Reader,
    sample::{DropReason, Kind, Tallies},
    source::{
        Because, Reading, Source,
        profile::{Profile, ProfileChoice},
        request::Request,
    },
};
use serde_json::{Value, json};

use crate::support::{folder::*, selecting::request, topics::*};

/// Reads all samples of a log. Returns what was learnt of it, and what was dropped.
fn read(topics: &[Topic], request: &Request) -> (Source, Tallies) {
    let folder = Folder::with(LOG, log(topics));
    let log = Log::open(&folder.path(LOG)).expect("a log");
    let source = Source::select_for_check(&log, request).expect("telemetry");
    let reader = Reader::new(&log, source).expect("a log");
    let read = reader
        .for_each(|_| Ok::<_, ReadError>(()))
        .expect("samples");
    (read.source, read.dropped)
}

/// A message with these values at these paths.
fn message(values: &[(&str, Value)]) -> Value {
    let mut message = json!({});
    for (path, value) in values {
        let place = path
            .split('.')
            .fold(&mut message, |place, name| match name.split_once('[') {
                None => &mut place[name],
                Some((list, _)) => {
                    if place[list].is_null() {
                        place[list] = json!([null]);
                    }
                    &mut place[list][0]
                }
            });
        *place = value.clone();
    }
    message
}

/// A type that has an orientation: its name, the path of that, and of the names of the frames that it turns into and out
/// of.
type OrientationType = (
    &'static str,
    &'static str,
    Option<&'static str>,
    Option<&'static str>,
);

const ORIENTATIONS: [OrientationType; 17] = [
    (
        "nav_msgs/msg/Odometry",
        "pose.pose.orientation",
        Some("header.frame_id"),
        Some("child_frame_id"),
    ),
    (
        "sensor_msgs/Imu",
        "orientation",
        None,
        Some("header.frame_id"),
    ),
    (
        "geometry_msgs/msg/PoseStamped",
        "pose.orientation",
        Some("header.frame_id"),
        None,
    ),
    (
        "geographic_msgs/GeoPoseStamped",
        "pose.orientation",
        Some("header.frame_id"),
        None,
    ),
    (
        "geometry_msgs/PoseWithCovarianceStamped",
        "pose.pose.orientation",
        Some("header.frame_id"),
        None,
    ),
    (
        "geometry_msgs/msg/QuaternionStamped",
        "quaternion",
        Some("header.frame_id"),
        None,
    ),
    (
        "geometry_msgs/TransformStamped",
        "transform.rotation",
        Some("header.frame_id"),
        Some("child_frame_id"),
    ),
    (
        "tf2_msgs/msg/TFMessage",
        "transforms[0].transform.rotation",
        Some("transforms[0].header.frame_id"),
        Some("transforms[0].child_frame_id"),
    ),
    (
        "tf/tfMessage",
        "transforms[0].transform.rotation",
        Some("transforms[0].header.frame_id"),
        Some("transforms[0].child_frame_id"),
    ),
    ("geometry_msgs/msg/Pose", "orientation", None, None),
    ("geometry_msgs/msg/Transform", "rotation", None, None),
    (
        "foxglove.Odometry",
        "pose.orientation",
        Some("frame_id"),
        Some("body_frame_id"),
    ),
    (
        "foxglove.PoseInFrame",
        "pose.orientation",
        Some("frame_id"),
        None,
    ),
    (
        "foxglove_msgs/msg/PoseInFrame",
        "pose.orientation",
        Some("frame_id"),
        None,
    ),
    (
        "foxglove.FrameTransform",
        "rotation",
        Some("parent_frame_id"),
        Some("child_frame_id"),
    ),
    (
        "foxglove.FrameTransforms",
        "transforms[0].rotation",
        Some("transforms[0].parent_frame_id"),
        Some("transforms[0].child_frame_id"),
    ),
    (
        "foxglove_msgs/msg/Odometry",
        "pose.orientation",
        Some("frame_id"),
        Some("body_frame_id"),
    ),
];

/// Reads the orientation of a type whose frames are named so, without axes given. Returns the axes and why, or why it
/// was dropped.
fn orientation_of(
    (name, path, world, body): OrientationType,
    frames: [&str; 2],
) -> Result<(String, Because), DropReason> {
    let mut values = vec![(path, quaternion())];
    values.extend(world.map(|field| (field, json!(frames[0]))));
    values.extend(body.map(|field| (field, json!(frames[1]))));
    let topic = twice("/topic", message(&values)).of_type(name);
    let given = request(&[("--attitude", &format!("/topic.{path}"))]);
    let (source, dropped) = read(&[topic], &given);
    if let Some(&reason) = dropped[Kind::Attitude].dropped.keys().next() {
        return Err(reason);
    }
    match &source.read_as(Kind::Attitude)[..] {
        [one] => match one.reading {
            Reading::Quaternion { axes, .. } => Ok((axes.to_string(), one.because)),
            other => panic!("{name}: {other:?}"),
        },
        other => panic!("{name}: {other:?}"),
    }
}

#[test]
fn an_orientation_is_in_the_frames_that_its_type_names() {
    for of_type in ORIENTATIONS {
        let (name, _, world, body) = of_type;
        let usual = orientation_of(of_type, ["map", "base_link"]);
        assert_eq!(usual, Ok(("flu-enu".to_owned(), Because::Type)), "{name}");
        if let Some(body) = body {
            let of_body = orientation_of((name, of_type.1, None, Some(body)), ["", "link_frd"]);
            assert_eq!(
                of_body,
                Err(DropReason::UnknownFrame),
                "{name}: only the drone's"
            );
        }
        if world.is_none() {
            continue;
        }
        for (frames, axes) in [
            (["odom_ned", "base_link_frd"], "frd-ned"),
            (["world_nwu", "body"], "flu-nwu"),
        ] {
            let read = orientation_of(of_type, frames);
            assert_eq!(read, Ok((axes.to_owned(), Because::FrameNames)), "{name}");
        }
        let own = orientation_of(of_type, ["base_link", "base_link"]);
        assert_eq!(own, Err(DropReason::OwnFrame), "{name}");
    }
}

#[test]
fn an_orientation_of_px4_or_mavlink_is_front_right_down_in_ned() {
    for name in [
        "px4_msgs/msg/VehicleAttitude",
        "vehicle_attitude",
        "px4_msgs/msg/GimbalDeviceAttitudeStatus",
        "gimbal_device_attitude_status",
        "mavros_msgs/msg/GimbalDeviceAttitudeStatus",
    ] {
        let topic = twice("/topic", json!({ "q": [1, 0, 0, 0] })).of_type(name);
        let (source, _) = read(&[topic], &request(&[("--attitude", "/topic.q")]));
        let read_as = source.read_as(Kind::Attitude);
        assert_eq!(read_as[0].because, Because::Type, "{name}");
        let Reading::Quaternion { axes, .. } = read_as[0].reading else {
            panic!("{name}");
        };
        assert_eq!(axes.to_string(), "frd-ned", "{name}");
    }
    let unknown = twice("/topic", json!({ "q": [1, 0, 0, 0] })).of_type("my_msgs/Attitude");
    refuses_quaternion(&unknown);
}

#[track_caller]
fn refuses_quaternion(topic: &Topic) {
    let words =
        "/topic: nothing says in which axes its quaternion `q` is, such as frd-ned or flu-enu";
    crate::support::selecting::refuses(
        std::slice::from_ref(topic),
        &[("--attitude", "/topic.q")],
        words,
    );
    for given in ["/topic.q:frd-ned", "/topic.q:flu-enu", "/topic.q:flu-nwu"] {
        read(
            std::slice::from_ref(topic),
            &request(&[("--attitude", given)]),
        );
    }
}

#[test]
fn three_angles_without_axes_are_assumed_to_be_front_right_down_in_ned() {
    let topic = twice("/topic", json!({ "r": 1, "p": 2, "y": 3 })).of_type("my_msgs/Attitude");
    let given = request(&[("--attitude", "/topic.r,/topic.p,/topic.y:degrees")]);
    let (source, _) = read(&[topic], &given);
    assert_eq!(source.read_as(Kind::Attitude)[0].because, Because::Assumed);
}

/// A profile for one recorder that reads an attitude, and a velocity or a position in NED.
fn in_ned(role: &str, fields: &str) -> Request {
    let toml = format!(
        r#"name = "recorder"
        [attitude]
        topics = ["/attitude"]
        orientation.euler = {{ roll = "r", pitch = "p", yaw = "y", unit = "radians" }}
        [{role}]
        topics = ["/topic"]
        {fields}"#
    );
    let profile = Profile::parse(&toml).expect("a profile");
    Request {
        profile: ProfileChoice::Given(profile.into()),
        ..Request::default()
    }
}

/// How many of two messages of a type are dropped, and why.
fn dropped(
    name: &'static str,
    message: Value,
    request: &Request,
    kind: Kind,
) -> Vec<(DropReason, u64)> {
    let attitude = twice("/attitude", json!({ "r": 0, "p": 0, "y": 0 }));
    let topic = twice("/topic", message).of_type(name);
    let (_, dropped) = read(&[attitude, topic], request);
    let dropped = dropped[kind].dropped.iter();
    dropped.map(|(&reason, &count)| (reason, count)).collect()
}

#[test]
fn a_vector_is_in_the_frame_that_its_type_names() {
    for (name, path, frame, world) in [
        (
            "nav_msgs/Odometry",
            "twist.twist.linear",
            "child_frame_id",
            Some("header.frame_id"),
        ),
        (
            "geometry_msgs/msg/TwistStamped",
            "twist.linear",
            "header.frame_id",
            None,
        ),
        (
            "geometry_msgs/TwistWithCovarianceStamped",
            "twist.twist.linear",
            "header.frame_id",
            None,
        ),
        (
            "geometry_msgs/msg/Vector3Stamped",
            "vector",
            "header.frame_id",
            None,
        ),
        (
            "foxglove.Odometry",
            "linear_velocity",
            "body_frame_id",
            Some("frame_id"),
        ),
        (
            "foxglove_msgs/msg/Odometry",
            "linear_velocity",
            "body_frame_id",
            Some("frame_id"),
        ),
    ] {
        let request = in_ned("velocity", &format!("vector = \"{path}\"\nframe = \"ned\""));
        let reasons = |frames: [&str; 2]| {
            let mut values = vec![(path, vector()), (frame, json!(frames[0]))];
            values.extend(world.map(|field| (field, json!(frames[1]))));
            dropped(name, message(&values), &request, Kind::Velocity)
        };
        let other = [(DropReason::OtherFrame, 2)];
        assert_eq!(reasons(["base_link", "odom_ned"]), other, "{name}");
        assert_eq!(reasons(["world_enu", "world"]), other, "{name}");
        assert_eq!(reasons(["world_ned", "world"]), [], "{name}");
        if world.is_some() {
            assert_eq!(reasons(["frame", "frame"]), [], "{name}: of the world");
            let request = in_ned(
                "velocity",
                &format!("vector = \"{path}\"\nframe = \"body-frd\""),
            );
            let values = [
                (path, vector()),
                (frame, json!("it")),
                (world.unwrap_or_default(), json!("it")),
            ];
            let dropped = dropped(name, message(&values), &request, Kind::Velocity);
            assert_eq!(dropped, other, "{name}: equal names are not the drone's");
        }
    }
}

#[test]
fn a_place_is_in_the_frame_that_its_type_names() {
    for (name, path, frame) in [
        ("nav_msgs/Odometry", "pose.pose.position", "header.frame_id"),
        (
            "geometry_msgs/msg/PoseStamped",
            "pose.position",
            "header.frame_id",
        ),
        (
            "geometry_msgs/PoseWithCovarianceStamped",
            "pose.pose.position",
            "header.frame_id",
        ),
        ("foxglove.Odometry", "pose.position", "frame_id"),
        ("foxglove_msgs/Odometry", "pose.position", "frame_id"),
        ("foxglove.PoseInFrame", "pose.position", "frame_id"),
        ("foxglove_msgs/msg/PoseInFrame", "pose.position", "frame_id"),
    ] {
        let request = in_ned(
            "position",
            &format!("local = {{ vector = \"{path}\", frame = \"ned\" }}"),
        );
        for (named, expected) in [
            ("map_enu", &[(DropReason::OtherFrame, 2)][..]),
            ("base_link", &[(DropReason::OwnFrame, 2)]),
            ("map_ned", &[]),
            ("map", &[]),
        ] {
            let values = [(path, vector()), (frame, json!(named))];
            let dropped = dropped(name, message(&values), &request, Kind::Position);
            assert_eq!(dropped, expected, "{name}: {named}");
        }
    }
}

#[test]
fn a_sign_that_a_value_is_not_valid_is_heeded_for_every_type_that_has_one() {
    let velocity =
        |fields: &str| in_ned("velocity", &format!("vector = {fields}\nframe = \"ned\""));
    let globe = |fields: [&str; 3]| {
        let [latitude, longitude, altitude] = fields;
        let fields = format!(
            "geodetic = {{ latitude = \"{latitude}\", longitude = \"{longitude}\", altitude = \"{altitude}\", unit = \"degrees\" }}"
        );
        (in_ned("position", &fields), Kind::Position)
    };
    let vxyz = || (velocity(r#"["vx", "vy", "vz"]"#), Kind::Velocity);
    let xyz = || {
        let fields = r#"local = { vector = ["x", "y", "z"], frame = "ned" }"#;
        (in_ned("position", fields), Kind::Position)
    };
    let gps_velocity = || {
        (
            velocity(r#"["vel_n_m_s", "vel_e_m_s", "vel_d_m_s"]"#),
            Kind::Velocity,
        )
    };
    let degrees = || globe(["latitude_deg", "longitude_deg", "altitude_msl_m"]);
    let short = || globe(["lat", "lon", "alt"]);
    let inertial = |role: &str, vector: &str, unit: &str, kind| {
        let fields = format!("vector = \"{vector}\"\nframe = \"flu\"\nunit = \"{unit}\"");
        (in_ned(role, &fields), kind)
    };
    let rate = || {
        inertial(
            "angular_rate",
            "angular_velocity",
            "rad/s",
            Kind::AngularRate,
        )
    };
    let force = || {
        inertial(
            "acceleration",
            "linear_acceleration",
            "m/s2",
            Kind::Acceleration,
        )
    };
    let invalid = DropReason::MarkedInvalid;
    let numbers = json!({
        "angular_velocity": { "x": 0, "y": 0, "z": 1 }, "angular_velocity_covariance": [0, 0, 0],
        "linear_acceleration": { "x": 0, "y": 0, "z": 9.8 }, "linear_acceleration_covariance": [0, 0, 0],
        "vx": 1, "vy": 0, "vz": 0, "x": 1, "y": 2, "z": 3, "vel_n_m_s": 1, "vel_e_m_s": 0, "vel_d_m_s": 0,
        "latitude": 47, "longitude": 8, "altitude": 500, "latitude_deg": 47, "longitude_deg": 8,
        "altitude_msl_m": 500, "lat": 47, "lon": 8, "alt": 500, "velocity": [1, 0, 0],
        "status": { "status": 0 }, "fix_type": 3, "vel_ned_valid": true,
        "v_xy_valid": true, "v_z_valid": true, "xy_valid": true, "z_valid": true,
        "lat_lon_valid": true, "alt_valid": true, "pose_frame": 1, "velocity_frame": 1,
    });
    let local = "px4_msgs/msg/VehicleLocalPosition";
    let global = "px4_msgs/VehicleGlobalPosition";
    let gps = "px4_msgs/msg/SensorGps";
    let odometry = "px4_msgs/msg/VehicleOdometry";
    for (name, (request, kind), field, sign, reason) in [
        (
            "sensor_msgs/NavSatFix",
            globe(["latitude", "longitude", "altitude"]),
            "status.status",
            json!(-1),
            invalid,
        ),
        (
            "sensor_msgs/msg/Imu",
            rate(),
            "angular_velocity_covariance",
            json!([-1, 0, 0]),
            invalid,
        ),
        (
            "sensor_msgs/Imu",
            force(),
            "linear_acceleration_covariance",
            json!([-1, 0, 0]),
            invalid,
        ),
        (local, vxyz(), "v_xy_valid", json!(false), invalid),
        (local, vxyz(), "v_z_valid", json!(false), invalid),
        (
            "vehicle_local_position",
            vxyz(),
            "v_z_valid",
            json!(0),
            invalid,
        ),
        (local, xyz(), "xy_valid", json!(false), invalid),
        (local, xyz(), "z_valid", json!(false), invalid),
        (global, short(), "lat_lon_valid", json!(false), invalid),
        (global, short(), "alt_valid", json!(false), invalid),
        (
            "vehicle_global_position",
            short(),
            "alt_valid",
            json!(0),
            invalid,
        ),
        (gps, gps_velocity(), "vel_ned_valid", json!(false), invalid),
        (gps, gps_velocity(), "fix_type", json!(1), invalid),
        (gps, degrees(), "fix_type", json!(0), invalid),
        (
            "vehicle_gps_position",
            short(),
            "fix_type",
            json!(1),
            invalid,
        ),
        (
            odometry,
            (velocity("\"velocity\""), Kind::Velocity),
            "velocity_frame",
            json!(0),
            DropReason::UnknownFrame,
        ),
    ] {
        assert_eq!(dropped(name, numbers.clone(), &request, kind), [], "{name}");
        let mut marked = numbers.clone();
        *field
            .split('.')
            .fold(&mut marked, |place, name| &mut place[name]) = sign;
        let dropped = dropped(name, marked, &request, kind);
        assert_eq!(dropped, [(reason, 2)], "{name}: {field}");
    }
}

#[test]
fn an_odometry_of_px4_that_is_not_in_ned_is_no_attitude() {
    for (frame, expected) in [
        (1, &[][..]),
        (0, &[(DropReason::UnknownFrame, 2)]),
        (2, &[(DropReason::UnknownFrame, 2)]),
    ] {
        let message = json!({ "q": [1, 0, 0, 0], "pose_frame": frame });
        let topic = twice("/topic", message).of_type("px4_msgs/msg/VehicleOdometry");
        let (_, dropped) = read(&[topic], &request(&[("--attitude", "/topic.q")]));
        let dropped: Vec<_> = dropped[Kind::Attitude]
            .dropped
            .iter()
            .map(|(&a, &b)| (a, b))
            .collect();
        assert_eq!(dropped, expected, "{frame}");
    }
}

/// MAVROS broke the rule of its type in two ways.
#[test]
fn the_velocity_on_mavros_global_position_local_is_used_only_in_given_axes() {
    let message = message(&[
        ("pose.pose.orientation", quaternion()),
        ("twist.twist.linear", vector()),
        ("header.frame_id", json!("map")),
        ("child_frame_id", json!("base_link")),
    ]);
    let topics = [twice("/mavros/global_position/local", message).of_type("nav_msgs/msg/Odometry")];
    let (source, _) = read(&topics, &request(&[]));
    assert!(source.role(Kind::Attitude).is_some());
    let missing = source
        .why_missing(Kind::Velocity)
        .expect("no velocity")
        .to_string();
    assert_reads(
        &missing,
        "MAVROS writes this velocity in east, north and down",
    );
    for axes in ["end", "enu"] {
        let velocity = format!("/mavros/global_position/local.twist.twist.linear:{axes}");
        let (source, dropped) = read(&topics, &request(&[("--velocity", &velocity)]));
        assert!(source.role(Kind::Velocity).is_some(), "{axes}");
        assert_eq!(dropped[Kind::Velocity].total(), 0, "{axes}");
    }
}
