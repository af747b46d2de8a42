//! What the user gives replaces one role; the rest stays what the profile says that fits the rest of the log best.

use std::fs;

use flightcam::{sample::Kind, source::Source};
use serde_json::json;

use crate::support::{folder::*, selecting::*, topics::*};

const GIVEN: (&str, &str) = ("--attitude", "/mine.q:frd-ned");

fn mine() -> Topic {
    attitude("/mine")
}

fn px4() -> [Topic; 2] {
    [
        attitude("/vehicle_attitude"),
        local_position("/vehicle_local_position"),
    ]
}

fn mavros() -> [Topic; 2] {
    let velocity = twist("/mavros/local_position/velocity_local");
    [pose("/mavros/local_position/pose"), velocity]
}

fn gimbal() -> Topic {
    let status = json!({ "q": [1, 0, 0, 0], "device_flags": 32, "gimbal_device_id": 1 });
    twice("/gimbal_device_attitude_status", status)
}

#[test]
fn a_given_attitude_keeps_the_velocity_of_the_profile() {
    let [px4_attitude, px4_velocity] = px4();
    let [mavros_pose, mavros_velocity] = mavros();
    for (others, profile, velocity) in [
        (
            vec![px4_attitude, px4_velocity.clone()],
            "px4-ulog",
            "/vehicle_local_position",
        ),
        // Where the log does not have the profile's own attitude, too.
        (vec![px4_velocity], "px4-ulog", "/vehicle_local_position"),
        (
            vec![mavros_pose, mavros_velocity.clone()],
            "mavros",
            "/mavros/local_position/velocity_local",
        ),
        (
            vec![mavros_velocity],
            "mavros",
            "/mavros/local_position/velocity_local",
        ),
        (vec![odometry("/odom")], "nav-msgs", "/odom"),
        (vec![flat("/state")], "flat", "/state"),
    ] {
        let topics = [&[mine()], &others[..]].concat();
        selects(&topics, &[GIVEN], (profile, "/mine", velocity));
    }
}

#[test]
fn the_velocity_of_the_given_attitudes_own_messages_goes_before_others_of_the_same_profile() {
    let twins = ["/left", "/right"].map(flat);
    let degrees = ("--attitude", "/right.roll,/right.pitch,/right.yaw:degrees");
    selects(&twins, &[degrees], ("flat", "/right", "/right"));
}

#[test]
fn a_profile_that_names_topics_goes_before_one_that_goes_by_types_but_a_velocity_before_that() {
    let [px4_attitude, px4_velocity] = px4();
    let odom = odometry("/odom");
    let both = [mine(), px4_velocity, odom.clone()];
    selects(
        &both,
        &[GIVEN],
        ("px4-ulog", "/mine", "/vehicle_local_position"),
    );
    let without = [mine(), px4_attitude, gimbal(), odom];
    selects(&without, &[GIVEN], ("nav-msgs", "/mine", "/odom"));
}

#[test]
fn profiles_that_add_velocities_equally_well_are_refused_with_where_they_are() {
    let topics = [&[mine()], &px4()[..], &mavros()[..]].concat();
    let words = "several profiles fit equally well … px4-ulog: /vehicle_local_position … mavros: \
                 /mavros/local_position/velocity_local";
    refuses(&topics, &[GIVEN], words);
    let chosen = [GIVEN, ("--profile", "mavros")];
    let mavros = ("mavros", "/mine", "/mavros/local_position/velocity_local");
    selects(&topics, &chosen, mavros);

    let twins = [mine(), flat("/left"), flat("/right")];
    refuses(&twins, &[GIVEN], "/left and /right fit equally well");
    selects(
        &twins,
        &[GIVEN, ("--velocity", "/left")],
        ("flat", "/mine", "/left"),
    );
    let folder = Folder::with(LOG, log(&twins));
    let arguments = format!("enrich {LOG} --depression 30 --attitude {}", GIVEN.1);
    folder.refuses(
        &arguments,
        1,
        "/left and /right fit equally well … choose one, for instance with --velocity /left",
    );
}

#[test]
fn an_attitude_alone_is_fine() {
    selects(&[mine()], &[GIVEN], ("command line", "/mine", ""));
    // What is of no profile is not used.
    let other = twice("/other", json!({ "speed": vector() }));
    selects(&[mine(), other], &[GIVEN], ("command line", "/mine", ""));
    // Nor are positions of which none is better than the others, because nothing is derived from them.
    let px4 = twice(
        "/vehicle_global_position",
        json!({ "lat": 47, "lon": 8, "alt": 400 }),
    );
    let mavros = twice(
        "/mavros/global_position/global",
        json!({ "latitude": 47, "longitude": 8, "altitude": 400 }),
    );
    selects(
        &[mine(), px4.clone(), mavros],
        &[GIVEN],
        ("command line", "/mine", ""),
    );
    let source = select_with(&[mine(), px4], &request(&[GIVEN])).expect("a source");
    assert_eq!(source.profile.name, "px4-ulog");
    assert!(source.role(Kind::Position).is_some());
}

#[test]
fn a_given_profile_needs_nothing_beside_a_given_attitude() {
    let chosen = [GIVEN, ("--profile", "px4-ulog")];
    selects(&[mine()], &chosen, ("px4-ulog", "/mine", ""));
    let flat_by_name = [GIVEN, ("--profile", "flat")];
    selects(
        &[mine(), flat("/state")],
        &flat_by_name,
        ("flat", "/mine", "/state"),
    );
}

#[test]
fn a_gimbal_is_kept_too() {
    let [_, velocity] = px4();
    let topics = [mine(), velocity, gimbal()];
    let source = select_with(&topics, &request(&[GIVEN])).expect("a source");
    let topic =
        |source: &Source, kind| source.role(kind).map(|role| role.topic.as_str().to_owned());
    let status = Some("/gimbal_device_attitude_status".to_owned());
    assert_eq!(topic(&source, Kind::Gimbal), status);
    // And with the velocity given as well.
    let gps = twice("/gps", json!({ "v": vector() }));
    let topics = [mine(), gps, gimbal()];
    let given = [GIVEN, ("--velocity", "/gps.v:ned")];
    let source = select_with(&topics, &request(&given)).expect("a source");
    assert_eq!(used(&source), ("px4-ulog", "/mine", "/gps"));
    assert_eq!(topic(&source, Kind::Gimbal), status);
}

#[test]
fn any_other_role_that_is_given_keeps_the_rest_of_the_profile() {
    let [attitude, velocity] = px4();
    let other = twice(
        "/other",
        json!({ "v": vector(), "q": quaternion(), "p": vector() }),
    );
    let topics = [attitude, velocity, gimbal(), other];
    for (role, argument) in [
        (Kind::Velocity, "/other.v:ned"),
        (Kind::Gimbal, "/other.q:earth:frd-ned"),
        (Kind::Position, "/other.p:ned"),
    ] {
        let option = format!("--{}", role.name());
        let source = select_with(&topics, &request(&[(&option, argument)])).expect("a source");
        for kind in [Kind::Attitude, Kind::Velocity, Kind::Gimbal] {
            let topic = source.role(kind).map(|found| found.topic.as_str());
            let expected = match kind {
                kind if kind == role => "/other",
                Kind::Attitude => "/vehicle_attitude",
                Kind::Velocity => "/vehicle_local_position",
                _ => "/gimbal_device_attitude_status",
            };
            assert_eq!(topic, Some(expected), "{option}");
        }
    }
}

#[test]
fn the_report_says_what_is_whose_and_the_written_profile_reads_the_same() {
    let folder = Folder::with(LOG, log(&[mine(), flat("/state")]));
    let arguments = format!("enrich {LOG} --depression 30 --attitude {}", GIVEN.1);
    let report = folder.writes(RESULT, &arguments, 0);
    assert_reads(
        &report,
        "Profile     flat for what was not given, chosen because /state has vx, vy, vz … Attitude    /mine: 2 of 2 … \
         Velocity    /state: 2 of 2",
    );
    let json = folder.reports(&format!("{arguments} --force"), 0);
    assert_eq!(json["profile"]["beside"]["topic"], "/state");
    assert_eq!(json["profile"]["attitude"]["topic"], "/mine");
    // The profile in the result is as it was read.
    let result = folder.read(RESULT);
    let metadata = mcap::Summary::read(&result)
        .expect("a summary")
        .expect("one");
    let index = metadata.metadata_indexes.first().expect("how it was made");
    let record = mcap::read::metadata(&result, index).expect("metadata");
    folder.add("same.toml", &record.metadata["profile_toml"]);
    let again = folder.reports(
        &format!("enrich {LOG} --depression 30 --force --profile same.toml"),
        0,
    );
    assert_eq!(again["velocity"]["topic"], "/state");
    assert_eq!(again["attitude"]["topic"], "/mine");
    assert_eq!(
        fs::read_dir(folder.path("")).expect("the folder").count(),
        3
    );

    let alone = Folder::with(LOG, log(&[mine()]));
    let report = alone.writes(RESULT, &arguments, 0);
    assert_reads(
        &report,
        "Profile     command line, as asked for; /mine has q",
    );
}
