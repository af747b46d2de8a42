//! What each type of message says about its frames, and what marks its values as not valid, with the source of each rule.
//! docs/frames.md has the same as a table.

use crate::{
    decode::path::{FieldPath, PathStep},
    sample::DropReason,
    source::profile::convention::Convention,
};

/// What a type of message says about one of its fields.
#[derive(Debug)]
pub struct TypeRule {
    /// The types, without a `/msg/` within.
    types: &'static [&'static str],
    /// The end of the topic, if the rule is for one recorder's topic only.
    topic: &'static str,
    /// The field, or the message that has its parts; indexes of lists are left out.
    field: &'static str,
    /// Its frames.
    pub frames: Frames,
    /// Signs that a message's value is not valid.
    pub not_valid: &'static [NotValid],
}

/// What is known of a value's frames. Paths are written as [`TypeRule::field`] is.
#[derive(Debug, Clone, Copy)]
pub enum Frames {
    /// An orientation.
    Orientation {
        /// The field that names the frame into which it turns.
        world: Option<&'static str>,
        /// The field that names the frame out of which it turns.
        body: Option<&'static str>,
        /// Between which frames it turns if the names say nothing else.
        usual: Convention,
    },
    /// A vector.
    Vector {
        /// The field that names its frame.
        frame: &'static str,
        /// The field that names the frame of the pose beside it.
        world: Option<&'static str>,
    },
    /// A place.
    Place {
        /// The field that names its frame.
        world: &'static str,
    },
    /// The recorder is known to break the type's rule, in more than one way: what it writes cannot be told from the
    /// message.
    Broken,
    /// The type says nothing.
    Open,
}

/// A sign that a message's value is not valid. A message without the field does not have the sign.
#[derive(Debug)]
pub struct NotValid {
    /// The field.
    pub field: &'static str,
    /// What it holds then.
    pub holds: Holds,
    /// Why the value is dropped.
    pub reason: DropReason,
}

/// What a number may hold.
#[derive(Debug, Clone, Copy)]
pub enum Holds {
    /// This number.
    Exactly(f64),
    /// Any other number than this.
    OtherThan(f64),
    /// A number below this.
    Below(f64),
}

impl Holds {
    /// Whether it holds that.
    pub fn is_so(self, number: f64) -> bool {
        match self {
            Self::Exactly(wanted) => number == wanted,
            Self::OtherThan(wanted) => number != wanted,
            Self::Below(least) => number < least,
        }
    }
}

const ROS: Convention = Convention::FLU_ENU;
const PX4: Convention = Convention::FRD_NED;

const fn rule(types: &'static [&'static str], field: &'static str, frames: Frames) -> TypeRule {
    TypeRule {
        types,
        topic: "",
        field,
        frames,
        not_valid: &[],
    }
}

const fn orientation(
    world: Option<&'static str>,
    body: Option<&'static str>,
    usual: Convention,
) -> Frames {
    Frames::Orientation { world, body, usual }
}

const fn vector(frame: &'static str, world: Option<&'static str>) -> Frames {
    Frames::Vector { frame, world }
}

/// A rule for a field whose type says nothing about frames, but marks values.
const fn marked(
    types: &'static [&'static str],
    field: &'static str,
    not_valid: &'static [NotValid],
) -> TypeRule {
    TypeRule {
        not_valid,
        ..rule(types, field, Frames::Open)
    }
}

/// A field that marks a value as not valid by what it holds.
const fn mark(field: &'static str, holds: Holds) -> NotValid {
    NotValid {
        field,
        holds,
        reason: DropReason::MarkedInvalid,
    }
}

/// A flag that is set if the value is valid.
const fn flag(field: &'static str) -> NotValid {
    mark(field, Holds::Exactly(0.0))
}

/// A field whose value leaves the frame unknown.
const fn unknown_frame(field: &'static str, holds: Holds) -> NotValid {
    NotValid {
        field,
        holds,
        reason: DropReason::UnknownFrame,
    }
}

const HEADER: Option<&str> = Some("header.frame_id");

/// The rules. The first that is for a message's type, topic and field counts.
///
/// ROS: the definitions in <https://github.com/ros2/common_interfaces/tree/5283bd97>; where they leave axes open, REP 103
/// (<https://www.ros.org/reps/rep-0103.html>) says them. Foxglove: <https://github.com/foxglove/foxglove-sdk/tree/ca8a1ced/schemas>.
/// PX4: <https://github.com/PX4/px4_msgs/tree/a4a9864b/msg>.
const RULES: &[TypeRule] = &[
    // "The pose in this message should be specified in the coordinate frame given by header.frame_id"; "The twist in this
    // message should be specified in the coordinate frame given by the child_frame_id".
    rule(
        &["nav_msgs/Odometry"],
        "pose.pose.orientation",
        orientation(HEADER, Some("child_frame_id"), ROS),
    ),
    rule(
        &["nav_msgs/Odometry"],
        "pose.pose.position",
        Frames::Place {
            world: "header.frame_id",
        },
    ),
    // MAVROS writes east, north and, before June 2026, down; up since. The child_frame_id is base_link all the same.
    // Sources: https://github.com/mavlink/mavros/issues/2054, https://github.com/mavlink/mavros/pull/2226
    TypeRule {
        topic: "/global_position/local",
        ..rule(&["nav_msgs/Odometry"], "twist.twist.linear", Frames::Broken)
    },
    rule(
        &["nav_msgs/Odometry"],
        "twist.twist.linear",
        vector("child_frame_id", HEADER),
    ),
    // "orientation_covariance[0]: [...] if you have no estimate for one of the data elements (e.g. your IMU doesn't
    // produce an orientation estimate), please set element 0 of the associated covariance matrix to -1". The header
    // names the sensor's own frame; its axes are those of REP 145 (https://www.ros.org/reps/rep-0145.html).
    TypeRule {
        not_valid: &[NotValid {
            field: "orientation_covariance[0]",
            holds: Holds::Exactly(-1.0),
            reason: DropReason::NoOrientation,
        }],
        ..rule(
            &["sensor_msgs/Imu"],
            "orientation",
            orientation(None, HEADER, ROS),
        )
    },
    // The same of its other values.
    marked(
        &["sensor_msgs/Imu"],
        "angular_velocity",
        &[mark("angular_velocity_covariance[0]", Holds::Exactly(-1.0))],
    ),
    marked(
        &["sensor_msgs/Imu"],
        "linear_acceleration",
        &[mark(
            "linear_acceleration_covariance[0]",
            Holds::Exactly(-1.0),
        )],
    ),
    rule(
        &[
            "geometry_msgs/PoseStamped",
            "geographic_msgs/GeoPoseStamped",
        ],
        "pose.orientation",
        orientation(HEADER, None, ROS),
    ),
    rule(
        &["geometry_msgs/PoseStamped"],
        "pose.position",
        Frames::Place {
            world: "header.frame_id",
        },
    ),
    rule(
        &["geometry_msgs/PoseWithCovarianceStamped"],
        "pose.pose.orientation",
        orientation(HEADER, None, ROS),
    ),
    rule(
        &["geometry_msgs/PoseWithCovarianceStamped"],
        "pose.pose.position",
        Frames::Place {
            world: "header.frame_id",
        },
    ),
    rule(
        &["geometry_msgs/QuaternionStamped"],
        "quaternion",
        orientation(HEADER, None, ROS),
    ),
    // A transform turns coordinates in child_frame_id into those in header.frame_id.
    rule(
        &["geometry_msgs/TransformStamped"],
        "transform.rotation",
        orientation(HEADER, Some("child_frame_id"), ROS),
    ),
    rule(
        &["tf2_msgs/TFMessage", "tf/tfMessage"],
        "transforms.transform.rotation",
        orientation(
            Some("transforms.header.frame_id"),
            Some("transforms.child_frame_id"),
            ROS,
        ),
    ),
    rule(
        &["geometry_msgs/Pose"],
        "orientation",
        orientation(None, None, ROS),
    ),
    rule(
        &["geometry_msgs/Transform"],
        "rotation",
        orientation(None, None, ROS),
    ),
    rule(
        &["geometry_msgs/TwistStamped"],
        "twist.linear",
        vector("header.frame_id", None),
    ),
    rule(
        &["geometry_msgs/TwistWithCovarianceStamped"],
        "twist.twist.linear",
        vector("header.frame_id", None),
    ),
    rule(
        &["geometry_msgs/Vector3Stamped"],
        "vector",
        vector("header.frame_id", None),
    ),
    // "STATUS_NO_FIX = -1".
    marked(
        &["sensor_msgs/NavSatFix"],
        "latitude",
        &[mark("status.status", Holds::Exactly(-1.0))],
    ),
    // "Position and orientation of body_frame_id in frame_id"; "Linear velocity in m/s in body_frame_id"; "following
    // conventions from ROS `nav_msgs/Odometry`" (https://github.com/foxglove/foxglove-sdk/pull/1041).
    rule(
        &["foxglove.Odometry", "foxglove_msgs/Odometry"],
        "pose.orientation",
        orientation(Some("frame_id"), Some("body_frame_id"), ROS),
    ),
    rule(
        &["foxglove.Odometry", "foxglove_msgs/Odometry"],
        "pose.position",
        Frames::Place { world: "frame_id" },
    ),
    rule(
        &["foxglove.Odometry", "foxglove_msgs/Odometry"],
        "linear_velocity",
        vector("body_frame_id", Some("frame_id")),
    ),
    rule(
        &["foxglove.PoseInFrame", "foxglove_msgs/PoseInFrame"],
        "pose.orientation",
        orientation(Some("frame_id"), None, ROS),
    ),
    rule(
        &["foxglove.PoseInFrame", "foxglove_msgs/PoseInFrame"],
        "pose.position",
        Frames::Place { world: "frame_id" },
    ),
    // "Rotation from parent_frame_id to child_frame_id", as ROS's transforms.
    rule(
        &["foxglove.FrameTransform", "foxglove_msgs/FrameTransform"],
        "rotation",
        orientation(Some("parent_frame_id"), Some("child_frame_id"), ROS),
    ),
    rule(
        &["foxglove.FrameTransforms", "foxglove_msgs/FrameTransforms"],
        "transforms.rotation",
        orientation(
            Some("transforms.parent_frame_id"),
            Some("transforms.child_frame_id"),
            ROS,
        ),
    ),
    // "Quaternion rotation from the FRD body frame to the NED earth frame".
    rule(
        &["px4_msgs/VehicleAttitude", "vehicle_attitude"],
        "q",
        orientation(None, None, PX4),
    ),
    // "POSE_FRAME_NED = 1"; UNKNOWN = 0, and FRD = 2 has a "constant arbitrary heading offset from True North".
    TypeRule {
        not_valid: &[unknown_frame("pose_frame", Holds::OtherThan(1.0))],
        ..rule(
            &["px4_msgs/VehicleOdometry", "vehicle_odometry"],
            "q",
            orientation(None, None, PX4),
        )
    },
    // "VELOCITY_FRAME_UNKNOWN = 0".
    marked(
        &["px4_msgs/VehicleOdometry", "vehicle_odometry"],
        "velocity",
        &[unknown_frame("velocity_frame", Holds::Exactly(0.0))],
    ),
    // "v_xy_valid: true if vx and vy are valid", and the like.
    marked(
        &["px4_msgs/VehicleLocalPosition", "vehicle_local_position"],
        "vx",
        &[flag("v_xy_valid"), flag("v_z_valid")],
    ),
    marked(
        &["px4_msgs/VehicleLocalPosition", "vehicle_local_position"],
        "x",
        &[flag("xy_valid"), flag("z_valid")],
    ),
    marked(
        &["px4_msgs/VehicleGlobalPosition", "vehicle_global_position"],
        "lat",
        &[flag("lat_lon_valid"), flag("alt_valid")],
    ),
    // "fix_type: 0-1: no fix, 2: 2D fix, 3: 3D fix", "vel_ned_valid: True if NED velocity is valid".
    marked(
        &["px4_msgs/SensorGps", "vehicle_gps_position", "sensor_gps"],
        "vel_n_m_s",
        &[flag("vel_ned_valid"), mark("fix_type", Holds::Below(2.0))],
    ),
    marked(
        &["px4_msgs/SensorGps", "vehicle_gps_position", "sensor_gps"],
        "latitude_deg",
        &[mark("fix_type", Holds::Below(2.0))],
    ),
    marked(
        &["px4_msgs/SensorGps", "vehicle_gps_position", "sensor_gps"],
        "lat",
        &[mark("fix_type", Holds::Below(2.0))],
    ),
    // "Quaternion components, w, x, y, z", in the axes of NED.
    // Source: https://github.com/mavlink/mavlink/blob/de1e078a/message_definitions/v1.0/common.xml#L7580
    rule(
        &[
            "px4_msgs/GimbalDeviceAttitudeStatus",
            "gimbal_device_attitude_status",
            "mavros_msgs/GimbalDeviceAttitudeStatus",
        ],
        "q",
        orientation(None, None, PX4),
    ),
];

impl TypeRule {
    /// The rule for a field of a type of message on a topic.
    pub fn find(schema_name: &str, topic: &str, field: &FieldPath) -> Option<&'static Self> {
        let name = schema_name.replace("/msg/", "/");
        RULES.iter().find(|rule| {
            rule.types.contains(&name.as_str())
                && topic.ends_with(rule.topic)
                && begins_with(field, rule.field)
        })
    }

    /// The path that the rule means, beside the field as it was found: within the same elements of lists.
    pub fn beside(&self, found: &FieldPath, meant: &str) -> Option<FieldPath> {
        let same = (self.field.split('.').zip(meant.split('.')))
            .take_while(|(field, meant)| field == meant)
            .count();
        match same {
            0 => meant.parse().ok(),
            _ => {
                let shared = found.first(steps_of_names(found, same));
                let rest = meant.split('.').skip(same);
                Some(rest.fold(shared, |path, name| path.child(name)))
            }
        }
    }
}

/// Whether a path begins with these names, whatever the elements of lists between them.
fn begins_with(path: &FieldPath, names: &str) -> bool {
    let mut in_path = path.steps().iter().filter_map(|step| match step {
        PathStep::Name(name) => Some(name.as_str()),
        PathStep::Index(_) | PathStep::First(_) => None,
    });
    names.split('.').all(|name| in_path.next() == Some(name))
}

/// How many steps of a path its first names take, with the elements of lists that follow them.
fn steps_of_names(path: &FieldPath, names: usize) -> usize {
    let mut passed = 0;
    let beyond = path.steps().iter().position(|step| {
        passed += usize::from(matches!(step, PathStep::Name(_)));
        passed > names
    });
    beyond.unwrap_or(path.steps().len())
}
