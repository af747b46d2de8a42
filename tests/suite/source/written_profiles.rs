//! The text that a profile is written as. Enriched logs carry it, so it stays what it is, byte for byte.
//!
//! The texts were written before roles were data; `tests/written_profiles` has one for each profile here.

use std::{fs, path::Path};

use flightcam::{
    sample::Kind,
    source::{
        profile::{Profile, ProfileChoice},
        request::{Request, RoleArgument},
    },
};

use crate::support::selecting::parsed;

/// Checks what a profile is written as, against the text of that name, and that it reads as the same profile.
#[track_caller]
fn is_written_as(profile: &Profile, name: &str) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/written_profiles");
    let written = toml::to_string(profile).expect("TOML");
    let path = folder.join(format!("{name}.toml"));
    let expected = fs::read_to_string(&path).expect("the text of that name");
    assert_eq!(written, expected, "{name}");
    assert_eq!(Profile::parse(&written).as_ref(), Ok(profile), "{name}");
}

#[test]
fn every_built_in_profile_is_written_as_before() {
    for profile in Profile::built_in() {
        is_written_as(&profile, &profile.name);
    }
}

const EVERYTHING: &str = r#"
    name = "everything"
    description = "all there is"
    automatic = false
    namespaced = true
    time.field = { path = "stamp", unit = "us" }

    [[attitude]]
    topics = ["/a_{n}", "/v{vehicle}/a"]
    schemas = ["A", "B"]
    when = { field = "frame", is = -1 }
    valid = ["ok[0]", "fix.ok"]
    time = "publish_time"
    orientation.quaternion = { fields = ["x", "y", "z", "w"], order = "xyzw" }
    convention = "flu-enu"
    reset_counter = { field = "resets", optional = true }

    [[attitude]]
    topics = ["/a"]
    when = { field = "frame", says = "/world" }
    time.field = { path = "header.stamp" }
    orientation.euler = { roll = "r", pitch = "p", yaw = "y", unit = "centidegrees" }

    [velocity]
    vector = "v"
    frame = "body-frd"
    unit = "cm/s"
    required = true

    [[gimbal]]
    when = { field = "flags", has_bits = 80 }
    orientation.pitch = { field = "tilt", unit = "degrees", positive = "down" }
    reference = "airframe"

    [[gimbal]]
    time = "log_time"
    orientation.quaternion = "q"
    reference = "earth"
    convention = "flu-enu"

    [[gimbal]]
    orientation.euler = { roll = "g[0]", pitch = "g[1]", yaw = "g[2]", unit = "radians" }
    reference = "heading"

    [[position]]
    geodetic = { latitude = "a", longitude = "b", altitude = "c", unit = "degE7", altitude_unit = "mm" }

    [[position]]
    local = { vector = ["x", "y", "z"], frame = "enu", unit = "cm" }
"#;

const LEAST: &str = r#"name = "least"
attitude.orientation.quaternion = "q""#;

const ONE_OF_EACH: &str = r#"
    name = "one-of-each"
    time = "publish_time"

    [position]
    geodetic = { latitude = "/gps.lat", longitude = "/gps.lon", altitude = "/gps.alt", unit = "degrees" }

    [gimbal]
    orientation.pitch = { field = '"/mount.1".pitch', unit = "radians" }
    reference = "heading"

    [velocity]
    vector = ["/gps.v[0]", "v[1]", "v[2]"]
    frame = "enu"
    unit = "mm/s"

    [attitude]
    orientation.quaternion = ["/imu.q0", "/imu.q1", "/imu.q2", "/imu.q3"]
    when = { field = "/imu.frame", says = "map \"1\"" }
    valid = ["/imu.ok"]
    reset_counter = { field = "/imu.resets" }
    time.field = { path = "/imu.stamp", unit = "s" }
"#;

const LOCAL: &str = r#"
    name = "local"
    attitude = [{ topics = ["a"], orientation.quaternion = ["q"] }, { topics = ["b"], orientation.quaternion = { fields = "q", order = "wxyz" } }]
    velocity = { vector = "twist.linear", frame = "body-flu" }
    position = { schemas = ["P"], local = { vector = "p", frame = "ned" } }
"#;

const HEIGHTS: &str = r#"
    name = "heights"
    attitude.orientation.quaternion = "q"
    height = [{ field = '/range."distance.cm"', unit = "cm", valid = ["/range.ok"] }, { field = "agl" }]
"#;

#[test]
fn a_users_profile_is_written_as_before() {
    for toml in [EVERYTHING, LEAST, ONE_OF_EACH, LOCAL, HEIGHTS] {
        let profile = parsed(toml);
        is_written_as(&profile, &profile.name);
    }
}

/// A request made of arguments.
fn request(arguments: &[(&str, &str)], profile: Option<&str>) -> Request {
    let mut request = Request::default();
    if let Some(toml) = profile {
        request.profile = ProfileChoice::Given(Box::new(parsed(toml)));
    }
    for &(option, value) in arguments {
        match option {
            "time" => request.time = Some(value.parse().expect("a time")),
            role => {
                let role = Kind::ALL.into_iter().find(|kind| kind.name() == role);
                let role = role.expect("a role");
                let argument = RoleArgument::parse(role, value).expect("an argument");
                request.roles.insert(role, argument);
            }
        }
    }
    request
}

#[test]
fn a_profile_that_the_user_has_changed_is_written_as_before() {
    let told = [
        ("attitude", "/imu.r,/imu.p,/imu.y:degrees:flu-enu"),
        ("velocity", "/gps.v:body-flu:cm/s"),
        ("gimbal", "/mount.pitch:radians:down"),
        ("position", "/gps.lat,/gps.lon,/gps.alt:degE7:mm"),
        ("time", "header.stamp"),
    ];
    let others = [
        ("attitude", "/imu.q:xyzw"),
        ("velocity", "/gps.n,/gps.e,/gps.d:ned"),
        ("gimbal", "/mount.q:earth:flu-enu"),
        ("position", "/gps.p:enu:cm"),
        ("time", "stamp:us"),
    ];
    let topics = [
        ("attitude", "/drone1/v2/a"),
        ("velocity", "/b"),
        ("gimbal", "/c"),
        ("position", "/d"),
        ("time", "log"),
    ];
    for (name, arguments, profile) in [
        ("told", told, None),
        ("others-told", others, None),
        ("told-of-everything", told, Some(EVERYTHING)),
        ("topics-of-everything", topics, Some(EVERYTHING)),
        ("topics-of-least", topics, Some(LEAST)),
    ] {
        let request = request(&arguments, profile);
        let adapted = request
            .without_profile()
            .or_else(|| request.profiles().pop());
        is_written_as(&adapted.expect("a profile").profile, name);
    }
    // Of the built-in ones, those that know the topic of an attitude.
    let arguments = [("attitude", "/drone1/mavros/local_position/pose")];
    let profiles = request(&arguments, None).profiles();
    assert_eq!(profiles.len(), 1);
    is_written_as(&profiles[0].profile, "topic-of-mavros");
}
