//! `flightcam inspect` as a user meets it: words, JSON and exit codes. It leaves no trace in any case.

use std::fs;

use serde_json::{Value, json};

use crate::support::{folder::*, topics::*, *};

/// Inspects [`LOG`], which must be possible: with this exit code, nothing on standard error, and no file changed.
/// Returns what was printed.
#[track_caller]
fn prints(folder: &Folder, arguments: &str, code: i32) -> String {
    let before = folder.contents();
    let (out, err) = folder.run(&format!("inspect {LOG} {arguments}"), code);
    assert_eq!(err, "", "standard error of `inspect {arguments}`");
    assert_eq!(folder.contents(), before, "the folder after it");
    assert!(!out.contains('\x1b'), "{out:?}");
    out
}

/// The same with `--json`, which must agree with the words about whether there is a problem.
#[track_caller]
fn reports(folder: &Folder, arguments: &str, code: i32) -> Value {
    let words = prints(folder, arguments, code);
    assert_eq!(words.contains("enrich would fail: "), code == 1, "{words}");
    let json = prints(folder, &format!("{arguments} --json"), code);
    let json: Value = serde_json::from_str(&json).expect("one JSON document");
    assert_eq!(json["problem"].is_string(), code == 1);
    json
}

/// Checks that enriching would fail for this reason.
#[track_caller]
fn finds_a_problem(log: &[u8], arguments: &str, problem: &str) -> Value {
    let report = reports(&Folder::with(LOG, log), arguments, 1);
    let reported = report["problem"].as_str().expect("a problem");
    assert!(reported.starts_with(&format!("{LOG}: ")), "{reported}");
    let printed = prints(&Folder::with(LOG, log), arguments, 1);
    assert_reads(&printed, &format!("enrich would fail: … {problem}"));
    report
}

#[test]
fn the_findings_fit_a_narrow_terminal() {
    let printed = prints(&Folder::with_flight(), "", 0);
    let expected = "\
Log         flight.mcap: 210.26 KiB, 3,416 messages on 4 topics
Profile     flat, chosen because /drone/state has roll, pitch, yaw
Camera      not known from the log; give enrich --depression or --mount
Attitude    /drone/state (demo.DroneState, protobuf): roll, pitch, yaw
            roll, pitch, yaw in radians, in frd-ned, as the profile says
            at first roll 0.6°, pitch -0.4°, yaw 75.0°
Velocity    /drone/state (demo.DroneState, protobuf): vx, vy, vz
            m/s in ned, as the profile says
            at first north 0.00, east 0.00, down 0.00 m/s
Gimbal      none: the profile `flat` has no gimbal
Position    /drone/state (demo.DroneState, protobuf): latitude, longitude, altitude
            latitude and longitude in degrees, altitude in m, as the profile says
            at first 47.397742° N, 8.545594° E, 535.3 m

          messages     rate  largest gap  invalid    from       to
Attitude     3,310  50.0 Hz      0.023 s      0 %  0.00 s  66.18 s
Velocity     3,310  50.0 Hz      0.023 s      0 %  0.00 s  66.18 s
Position     3,310  50.0 Hz      0.023 s      0 %  0.00 s  66.18 s
Times count from the first of these messages, at 1778751000.002 s in log time.

Other topics
  demo (json): 87 messages on 2 topics
    /camera/trigger, /drone/battery
  foxglove (json): 19 messages on /drone/log

enrich would write
  /camera/relative_rpy (flightcam.v1.RelativeRpy, protobuf): up to 3,309 messages
  /camera/orientation (flightcam.v1.CameraOrientation, protobuf): up to 3,310 messages
  /camera/velocity (flightcam.v1.CameraVelocity, protobuf): up to 3,310 messages
";
    assert_eq!(printed, expected);
}

/// Five readings, the fourth without a yaw, and two topics besides.
fn small_log() -> Folder {
    let mut state = topic("/drone/state", states(5, 1.0)).of_type("mine.State");
    state.messages[3] = json!({ "roll": 0, "pitch": 0, "vx": 1, "vy": 2, "vz": 3 })
        .to_string()
        .into();
    let note = |name| topic(name, [json!({ "text": "hello" })]).of_type("mine.Note");
    Folder::with(LOG, log(&[state, note("/notes"), note("/more/notes")]))
}

#[test]
fn the_json_has_every_number_under_names_that_scripts_rely_on() {
    let mut report = reports(&small_log(), "--profile flat --depression 30", 0);
    let length = small_log().read(LOG).len();
    let role = |fields: [&str; 3], used: u64, dropped: Value, read_as: Value, first: Value| {
        json!({
            "topic": "/drone/state",
            "fields": fields,
            "encoding": "json",
            "schema": "mine.State",
            "messages": 5,
            "times": [time(0), time(4)],
            "rate_hz": 50.0,
            "largest_gap_s": 0.02,
            "read": 5,
            "used": used,
            "dropped": dropped,
            "read_as": [read_as],
            "first_undecodable": null,
            "share_invalid": (5 - used) as f64 / 5.0,
            "first": first,
        })
    };
    let position = report["telemetry"]["roles"]["position"].take();
    assert_eq!(position.as_object().map(|position| position.len()), Some(1));
    assert_eq!(position["missing"]["kind"], "messages");
    let pitch = report["telemetry"]["roles"]["attitude"]["first"]["pitch_deg"].take();
    assert!((pitch.as_f64().unwrap() + 5.7296).abs() < 1e-4);
    let attitude = json!({
        "kind": "attitude",
        "roll_deg": 0.0,
        "pitch_deg": null,
        "yaw_deg": 0.0,
    });
    let angles = json!({
        "kind": "angles",
        "axes": "frd-ned",
        "unit": "radians",
        "order": "yaw-pitch-roll",
        "because": "profile",
    });
    let vector = json!({ "kind": "velocity", "axes": "ned", "unit": "m/s", "because": "profile" });
    let velocity = json!({ "kind": "velocity_ned", "north": 3.0, "east": -1.0, "down": 0.2 });
    let expected = json!({
        "input": LOG,
        "bytes": length,
        "messages": 7,
        "topics": 3,
        "times": [time(0), time(4)],
        "scanned": false,
        "telemetry": {
            "profile": {
                "name": "flat",
                "chosen": "by_request",
                "attitude": { "topic": "/drone/state", "fields": ["roll", "pitch", "yaw"] },
            },
            "namespace": "",
            "runners_up": [],
            "camera": { "kind": "stabilised", "depression_deg": 30.0, "yaw_offset_deg": 0.0 },
            "roles": {
                "gimbal": { "missing": { "kind": "not_in_profile", "profile": "flat", "role": "gimbal" } },
                "attitude": role(["roll", "pitch", "yaw"], 4, json!({ "missing_field": 1 }), angles, attitude),
                "velocity": role(["vx", "vy", "vz"], 5, json!({}), vector, velocity),
                "position": null,
            },
            "velocity_from": "messages",
            "would_write": [
                {
                    "topic": "/camera/relative_rpy",
                    "schema": "flightcam.v1.RelativeRpy",
                    "encoding": "json",
                    "at_most": 3,
                },
                {
                    "topic": "/camera/orientation",
                    "schema": "flightcam.v1.CameraOrientation",
                    "encoding": "json",
                    "at_most": 4,
                },
                {
                    "topic": "/camera/velocity",
                    "schema": "flightcam.v1.CameraVelocity",
                    "encoding": "json",
                    "at_most": 5,
                },
            ],
            "would_not_write": [],
        },
        "problem": null,
        "other_topics": [
            { "schemas": "mine", "encoding": "json", "messages": 2, "topics": ["/more/notes", "/notes"] },
        ],
        "viewer_warnings": [],
        "notes": [],
    });
    assert_eq!(report, expected);
}

#[test]
fn the_camera_is_described_in_words_and_in_json() {
    let flight = Folder::with_flight();
    assert_eq!(reports(&flight, "", 0)["telemetry"]["camera"], Value::Null);
    for (arguments, kind, words) in [
        (
            "--depression 30",
            "stabilised",
            "looks 30° below the horizon",
        ),
        (
            "--mount 0,-30,5",
            "fixed",
            "bolted to the airframe at roll 0°, pitch -30°, yaw 5°",
        ),
        (
            "--gimbal /drone/state.pitch:radians:down",
            "gimbal",
            "follows the gimbal",
        ),
    ] {
        let report = reports(&flight, arguments, 0);
        assert_eq!(report["telemetry"]["camera"]["kind"], kind);
        let words = format!("Camera {words}");
        let printed = prints(&flight, arguments, 0).replace("Camera      ", "Camera ");
        assert_reads(&printed, &words);
    }
    let message =
        "mount with roll or pitch contradicts a depression angle … --depression … --mount";
    flight.refuses(
        &format!("inspect {LOG} --depression 3 --mount 1,2,3"),
        2,
        message,
    );
}

#[test]
fn invalid_samples_and_underivable_topics_are_explained() {
    let mut px4 = local_position("/fmu/out/vehicle_local_position");
    let invalid = json!({ "vx": 1, "vy": 0, "vz": 0, "v_xy_valid": false, "v_z_valid": true });
    px4.messages[0] = invalid.to_string().into();
    let attitude = attitude("/fmu/out/vehicle_attitude");
    let folder = Folder::with(LOG, log(&[attitude.clone(), px4.clone()]));
    assert_reads(
        &prints(&folder, "", 0),
        "Velocity … 1 marked invalid by the log … Velocity         2  50.0 Hz      0.020 s   50.0 %",
    );
    px4.messages.truncate(1);
    let folder = Folder::with(LOG, log(&[attitude, px4]));
    assert_reads(
        &prints(&folder, "", 0),
        "Velocity         1        –            –    100 % … \
         enrich would write … /camera/relative_rpy … up to 1 message … \
         /camera/orientation … up to 2 messages … \
         but not … /camera/velocity: at least one usable velocity sample is needed, and … has 0 of 1 usable, 1 marked invalid",
    );
}

#[test]
fn an_angle_that_cannot_be_is_why_enrich_would_fail() {
    let degrees = log(&[topic("/state", states(50, std::f64::consts::PI / 180.0))]);
    let folder = Folder::with(LOG, degrees);
    let problem = "enrich would fail: … /state has an angle of … which cannot be radians … use --profile flat-deg";
    assert_reads(&prints(&folder, "", 1), problem);
    let report = reports(&folder, "--profile flat-deg", 0);
    assert_eq!(
        (&report["notes"], &report["problem"]),
        (&json!([]), &Value::Null)
    );
}

#[test]
fn truncation_is_noted() {
    let whole = fs::read(repository("fixtures/survey_flight.mcap")).unwrap();
    let folder = Folder::with(LOG, &whole[..whole.len() * 6 / 10]);
    assert_reads(
        &prints(&folder, "", 0),
        "the whole log was read, because it has no complete summary … Note … the log breaks off at byte",
    );
    let report = reports(&folder, "", 0);
    let (bytes, messages) = (
        report["bytes"].as_u64().unwrap(),
        report["messages"].as_u64().unwrap(),
    );
    assert_eq!(
        (bytes, report["scanned"].clone()),
        (whole.len() as u64 * 6 / 10, json!(true))
    );
    assert!((1000..3416).contains(&messages));
}

#[test]
fn the_profile_and_its_runners_up_are_named() {
    let topics = [
        odometry("/odom"),
        flat("/state"),
        pose("/drone1/mavros/local_position/pose"),
        twist("/drone1/mavros/local_position/velocity_local"),
    ];
    let folder = Folder::with(LOG, log(&topics));
    assert_reads(
        &prints(&folder, "", 0),
        "Profile     mavros, chosen because /drone1/mavros/local_position/pose has … \
         nav-msgs fits less well: /odom has … flat fits less well: /state has … \
         Vehicle     /drone1 … Other topics … nav_msgs (json): 2 messages on /odom",
    );
    let telemetry = &reports(&folder, "", 0)["telemetry"];
    assert_eq!(telemetry["namespace"], "/drone1");
    let runners_up = telemetry["runners_up"].as_array().expect("a list");
    let names = runners_up
        .iter()
        .map(|other| other["profile"].as_str().unwrap());
    let names: Vec<&str> = names.collect();
    assert_eq!(names[..2], ["nav-msgs", "flat"]);
    let mut fits = runners_up.iter().map(|other| &other["fits"]);
    assert!(fits.by_ref().take(2).all(|fits| fits == true));
    assert!(fits.all(|fits| fits == false));
}

#[test]
fn profiles_that_come_near_are_named_with_what_they_lack() {
    let topics = [
        flat("/state"),
        twist("/drone1/mavros/local_position/velocity_local"),
    ];
    let folder = Folder::with(LOG, log(&topics));
    assert_reads(
        &prints(&folder, "", 0),
        "Profile     flat, chosen because /state has … \
         mavros: velocity on /drone1/mavros/local_position/velocity_local, but no attitude: there is no message on …\
         Camera",
    );
    let runners_up = &reports(&folder, "", 0)["telemetry"]["runners_up"];
    let mavros = runners_up.as_array().expect("a list").iter();
    let mut mavros = mavros.filter(|other| other["profile"] == "mavros");
    assert_eq!(
        mavros.next().expect("it was tried")["others"],
        json!({ "velocity": "/drone1/mavros/local_position/velocity_local" })
    );

    let folder = Folder::with(LOG, log(&topics[1..]));
    let (_, err) = folder.run(&format!("enrich {LOG}"), 1);
    assert_reads(
        &err,
        "no usable telemetry … profiles that were tried: … \
         mavros: velocity on … but no attitude: … others, of whose topics, types and fields the log has none: px4-ulog, …",
    );
}

#[test]
fn ambiguous_telemetry_is_a_problem_that_says_how_to_choose() {
    let vehicles = ["/a/mavros/imu/data", "/b/mavros/imu/data"].map(|name| {
        twice(name, json!({ "orientation": quaternion() })).of_type("sensor_msgs/msg/Imu")
    });
    let profiles = [
        attitude("/vehicle_attitude"),
        attitude("/fmu/out/vehicle_attitude"),
    ];
    for (topics, words, choice) in [
        (
            ["/a", "/b"].map(flat),
            "/a and /b fit equally well … ",
            "--attitude /a",
        ),
        (
            vehicles,
            "several vehicles, in the namespaces /a, /b … ",
            "--namespace /a",
        ),
        (
            profiles,
            "several profiles fit equally well … ",
            "--profile px4-ulog",
        ),
    ] {
        let log = log(&topics);
        let report = finds_a_problem(&log, "", &format!("{words}{choice}"));
        assert_eq!(report["telemetry"], Value::Null);
        assert_eq!(report["messages"], 4);
        reports(&Folder::with(LOG, log), choice, 0);
    }
}

#[test]
fn a_log_without_telemetry_is_described_all_the_same() {
    let battery = topic("/battery", [json!({ "voltage": 15.9 })]);
    let battery = log(&[battery]);
    let report = finds_a_problem(
        &battery,
        "",
        "no usable telemetry … the log has none: px4-ulog, … topics of the log: … /battery",
    );
    assert_eq!(report["other_topics"][0]["topics"], json!(["/battery"]));
    let printed = prints(&Folder::with(LOG, battery), "", 1);
    assert_reads(
        &printed,
        "1 message on 1 topic … enrich would fail: … topics of the log: … /battery (json, no schema)",
    );

    let report = finds_a_problem(
        &log(&[]),
        "",
        "no usable telemetry … the log has no messages",
    );
    assert_eq!(
        (&report["messages"], &report["times"]),
        (&json!(0), &Value::Null)
    );

    let flight = Folder::with_flight().read(LOG);
    finds_a_problem(&flight, "--profile mavros", "`mavros` does not fit");
    finds_a_problem(
        &flight,
        "--namespace /d",
        "no topic in the namespace /d … --namespace",
    );
    finds_a_problem(
        &flight,
        "--attitude /drone/state.q",
        "attitude does not fit: … `q` … --attitude",
    );
}

#[test]
fn the_original_of_an_enriched_log_is_inspected() {
    let folder = Folder::with_flight();
    let original = reports(&folder, "", 0);
    folder.writes(RESULT, &format!("enrich {LOG} --depression 30"), 0);
    let enriched = Folder::with(LOG, folder.read(RESULT));
    let mut report = reports(&enriched, "", 0);
    let note = &report["notes"][0];
    assert_eq!(note["kind"], "original_inspected");
    assert_reads(note["earlier"]["camera"].as_str().unwrap(), "30° below");
    report["notes"] = json!([]);
    assert_eq!(report, original);
}

#[test]
fn a_log_with_foreign_topics_named_like_the_results_cannot_be_enriched() {
    let foreign = topic("/camera/velocity", [json!({ "x": 1.0 })]);
    let log = log(&[flat("/state"), foreign]);
    finds_a_problem(&log, "", "/camera/velocity, which flightcam did not write");
}

#[test]
fn an_unreadable_log_is_an_error() {
    for (content, message) in [
        (&b"roll,pitch,yaw\n"[..], "not an MCAP file"),
        (b"", "the file is empty"),
        (mcap::MAGIC, "damaged at byte 8"),
    ] {
        for json in ["", "--json"] {
            let message = format!("{LOG}: {message}");
            Folder::with(LOG, content).refuses(&format!("inspect {LOG} {json}"), 1, &message);
        }
    }
    Folder::new().refuses(&format!("inspect {LOG}"), 1, "flight.mcap: cannot open");
    let mut flight = Folder::with_flight().read(LOG);
    flight[100_000..100_100].fill(0xff);
    Folder::with(LOG, flight).refuses(&format!("inspect {LOG}"), 1, "damaged at byte");
    // Here already the search for the telemetry fails, which looks into JSON messages.
    let mut states = log(&[flat("/state")]);
    let zstd = states
        .windows(4)
        .position(|bytes| bytes == b"\x28\xb5\x2f\xfd");
    let zstd = zstd.expect("a compressed chunk");
    states[zstd..zstd + 40].fill(0xff);
    Folder::with(LOG, states).refuses(&format!("inspect {LOG}"), 1, "damaged at byte");
    let message = "`px4` … px4-ulog, px4-ros2";
    Folder::with_flight().refuses(&format!("inspect {LOG} --profile px4"), 2, message);
}

#[test]
fn all_topics_are_listed_where_that_is_asked_for() {
    let printed = prints(&Folder::with_flight(), "--topics", 0);
    assert!(
        printed.starts_with("messages     rate  topic            type\n"),
        "{printed}"
    );
    assert_eq!(printed.lines().count(), 5, "{printed}");
    assert_reads(
        &printed,
        "3,310  50.0 Hz  /drone/state … demo.DroneState, protobuf",
    );

    let json = prints(&small_log(), "--topics --json", 0);
    let json: Value = serde_json::from_str(&json).expect("one JSON document");
    let row = |topic, schema, messages, rate_hz: Value| json!({ "topic": topic, "encoding": "json", "schema": schema, "messages": messages, "rate_hz": rate_hz });
    let expected = json!({
        "input": LOG,
        "topics": [
            row("/drone/state", "mine.State", 5, json!(50.0)),
            row("/more/notes", "mine.Note", 1, Value::Null),
            row("/notes", "mine.Note", 1, Value::Null),
        ],
    });
    assert_eq!(json, expected);
}

#[test]
fn topics_are_listed_of_a_log_whose_telemetry_is_not_found_and_an_error_says_how() {
    let names = ["/a", "/b", "/c", "/d", "/e", "/f", "/g", "/h", "/i"];
    let folder = Folder::with(
        LOG,
        log(&names.map(|name| topic(name, [json!({ "n": 1 })]))),
    );
    let (_, err) = folder.run(&format!("enrich {LOG} --depression 30"), 1);
    assert_reads(
        &err,
        "the log has 9 topics … `flightcam inspect flight.mcap --topics` lists all topics",
    );
    let printed = prints(&folder, "--topics", 0);
    assert!(names.iter().all(|name| printed.contains(name)), "{printed}");
}

#[test]
fn a_lone_pose_is_taken_only_if_nothing_else_fits_and_the_report_says_what_is_assumed() {
    let lone = log(&[pose("/vrpn/drone/pose")]);
    let folder = Folder::with(LOG, lone);
    let assumed = "ros-pose, because no other fits; /vrpn/drone/pose has pose.orientation, assumed to be the drone's and in \
                   the axes below";
    assert_reads(&prints(&folder, "", 0), assumed);
    assert_eq!(
        reports(&folder, "", 0)["telemetry"]["profile"]["fallback"],
        true
    );
    // Who asks for it says so.
    let asked = prints(&folder, "--profile ros-pose", 0);
    assert_reads(
        &asked,
        "ros-pose, as asked for; /vrpn/drone/pose has pose.orientation\n",
    );

    let flown = log(&[pose("/vrpn/drone/pose"), odometry("/odom")]);
    let report = reports(&Folder::with(LOG, flown), "", 0);
    assert_eq!(report["telemetry"]["profile"]["name"], "nav-msgs");

    // Those who say where the drone's topics are do not mean any pose.
    let namespaced = log(&[pose("/drone1/pose")]);
    finds_a_problem(&namespaced, "--namespace /drone1", "no usable telemetry");
}
