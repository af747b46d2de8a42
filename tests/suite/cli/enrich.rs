//! The command line as a user meets it: arguments in; exit code, words and files out.
//!
//! Each run is checked for more than its own test asks: see [`Folder::refuses`] and [`Folder::writes`].

use std::{collections::BTreeMap, f64::consts::PI, fs, path::Path};

use mcap::MessageStream;
use serde_json::{Value, json};

use crate::support::{folder::*, topics::*};

const FIXTURE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/survey_flight.mcap");

/// The arguments for [`LOG`], and more.
fn enrich(more: &str) -> String {
    format!("enrich {LOG} --depression 30 {more}")
}

/// Readings that lack a number.
fn states_without(count: i32, field: &str) -> impl Iterator<Item = Value> {
    states(count, 1.0).map(move |mut state| {
        state[field] = Value::Null;
        state
    })
}

/// A log of fifty readings.
fn state_log(unit: f64) -> Vec<u8> {
    log(&[topic("/drone/state", states(50, unit))])
}

/// A profile without velocity, for the topic `/drone/state` and with this name of the roll angle.
fn profile(roll: &str) -> String {
    let angles = format!(r#"roll = "{roll}", pitch = "pitch", yaw = "yaw", unit = "radians""#);
    let topics = r#"topics = ["/drone/state"]"#;
    format!("name = \"mine\"\n[attitude]\n{topics}\norientation.euler = {{ {angles} }}\n")
}

/// How many messages each topic has, counted by the official reader.
fn count_messages(log: &[u8]) -> BTreeMap<String, u64> {
    let mut counts = BTreeMap::new();
    for message in MessageStream::new(log).unwrap() {
        let topic = message.unwrap().channel.topic.clone();
        *counts.entry(topic).or_default() += 1;
    }
    counts
}

/// Roll, pitch and yaw of each relative rotation, one after the other, of a log in JSON.
fn rotations(log: &[u8]) -> Vec<f64> {
    let messages = MessageStream::new(log).unwrap().map(Result::unwrap);
    messages
        .filter(|message| message.channel.topic == "/camera/relative_rpy")
        .map(|message| serde_json::from_slice::<Value>(&message.data).unwrap())
        .flat_map(|rpy| ["roll", "pitch", "yaw"].map(|angle| rpy[angle].as_f64().unwrap()))
        .collect()
}

#[test]
fn help_and_version_are_printed_when_asked_for() {
    for (arguments, text) in [
        ("--help", "MCAP … Usage: flightcam … enrich"),
        ("enrich --help", "Usage: … --depression … --profile"),
        ("--version", env!("CARGO_PKG_VERSION")),
    ] {
        let (out, err) = Folder::new().run(arguments, 0);
        assert_reads(&out, text);
        assert_eq!(err, "");
    }
}

#[test]
fn a_file_that_is_no_log_is_refused_with_advice() {
    let garbage = [mcap::MAGIC, &[0xc5; 300]].concat();
    let cases: [(&[u8], &str); 8] = [
        (b"roll,pitch,yaw\n", "magic bytes … the log you meant"),
        (b"ULog\x01\x12\x35\x01", "PX4 ULog … convert it … Foxglove"),
        (b"#ROSBAG V2.0\n", "ROS 1 bag … mcap convert"),
        (b"SQLite format 3\0", "SQLite … ros2 bag convert"),
        (b"\xa3\x95\x80\x80", "DataFlash … convert it"),
        (b"", "empty … interrupted"),
        (mcap::MAGIC, "byte 8 … header … mcap recover"),
        (&garbage, "byte 8 … header … mcap recover"),
    ];
    for (content, message) in cases {
        let message = format!("{LOG}: … {message}");
        Folder::with(LOG, content).refuses(&enrich(""), 1, &message);
    }
}

#[test]
fn an_input_that_does_not_exist_is_refused() {
    let message = "flight.mcap: cannot open";
    Folder::new().refuses(&enrich(""), 1, message);
}

#[test]
#[cfg(unix)]
fn an_input_that_is_a_folder_is_refused() {
    let message = "flight.mcap: not a regular file … MCAP files";
    Folder::with("flight.mcap/monday.mcap", "").refuses(&enrich(""), 1, message);
}

#[test]
fn a_log_without_telemetry_is_refused_with_what_was_looked_for_and_what_there_is() {
    let battery = topic("/battery", [json!({ "voltage": 15.9 })]);
    let attitude = topic(
        "/imu",
        [json!({ "roll": 0, "pitch": 0, "yaw": 0, "vx": 0 })],
    );
    let fields = "`roll`, `pitch`, `yaw`, `vx`, `vy`, `vz`";
    let nearest = format!(
        "{fields}; /imu comes closest: it has no field `vy`, `vz`; … first messages has pitch, roll, vx, yaw"
    );
    let cases: [(&[Topic], &str, &str); 4] = [
        (&[battery], fields, "topics of the log: … /battery (json"),
        (&[attitude], &nearest, "/imu (json, no schema)"),
        (&[], "no topic", "the log has no messages"),
        (
            &[topic("/drone/state", [])],
            "no topic",
            "the log has no messages",
        ),
    ];
    for (topics, looked_for, present) in cases {
        let message = format!(
            "{LOG}: no usable telemetry … px4-ulog: there is no message on /vehicle_attitude … \
             flat: … {looked_for} … {present} … --profile FILE.toml"
        );
        Folder::with(LOG, log(topics)).refuses(&enrich(""), 1, &message);
    }
}

#[test]
fn of_topics_that_fit_equally_well_the_user_chooses() {
    let twins = ["/left", "/right"].map(|name| topic(name, states(5, 1.0)));
    let message = "flight.mcap: /left and /right fit equally well … --attitude /left";
    Folder::with(LOG, log(&twins)).refuses(&enrich(""), 1, message);
}

#[test]
fn what_the_log_does_not_have_is_refused_with_the_option_that_asked_for_it() {
    let folder = Folder::with(LOG, log(&[topic("/state", states(5, 1.0))]));
    for (arguments, message) in [
        (
            "--namespace /drone1",
            "no topic in the namespace /drone1 … /state … correct --namespace",
        ),
        (
            "--velocity /gps.v:ned",
            "velocity does not fit: there is no message on /gps … /state … correct --velocity",
        ),
        (
            "--position /state.p:ned",
            "position does not fit: /state: it has no field `p` … /state … correct --position",
        ),
        (
            "--gimbal /state --profile flat",
            "only a topic … gimbal … /state … give --gimbal fields",
        ),
        (
            "--velocity /state --attitude /state.roll,/state.pitch,/state.yaw:radians",
            "only a topic … velocity … /state … give --velocity fields",
        ),
    ] {
        folder.refuses(&enrich(arguments), 1, message);
    }
}

#[test]
fn a_profile_that_does_not_fit_says_where_and_what_is_there_instead() {
    let flight = || fs::read(FIXTURE).unwrap();
    let schema = json!({ "type": "object", "properties": { "roll_deg": {} } });
    let state = topic("/drone/state", states(5, 1.0));
    let listed = (state.clone()).with_schema("State", "jsonschema", schema.to_string());
    let foreign = Topic {
        encoding: "flatbuffer",
        ..state.with_schema("State", "flatbuffer", "table State {}")
    };
    let elsewhere = topic("/drone/status", states(5, 1.0));
    let cases = [
        (flight(), "rol", "`rol`; demo.DroneState has … yaw"),
        (flight(), "timestamp", "`timestamp` is not a number"),
        (state_log(1.0), "rol", "`rol`; … has pitch, roll, vx"),
        (
            log(&[listed]),
            "roll",
            "`roll`, `pitch`, `yaw`; … has roll_deg",
        ),
        (
            log(&[foreign]),
            "roll",
            "`flatbuffer` … reads protobuf, JSON, ROS 2",
        ),
        (log(&[elsewhere]), "roll", "/drone/status (json"),
    ];
    for (log, roll, problem) in cases {
        let folder = Folder::with(LOG, log);
        folder.add("mine.toml", profile(roll));
        let message = format!("{LOG}: … `mine` does not fit: … /drone/state … {problem}");
        folder.refuses(&enrich("--profile mine.toml"), 1, &message);
    }
}

#[test]
fn a_profile_that_is_none_is_refused_with_the_place_and_the_choice() {
    let folder = Folder::with_flight();
    folder.add("torn.toml", "name = \"torn\"\n[attitude\n");
    folder.add("typo.toml", profile("roll").replace("topics", "topic"));
    for (profile, code, message) in [
        (
            "px4",
            2,
            "`px4` … px4-ulog, px4-ros2, mavros … flat, flat-deg … .toml",
        ),
        ("torn.toml", 2, "torn.toml: not a profile … line 2"),
        (
            "typo.toml",
            2,
            "typo.toml: … unknown key `attitude.topic` … docs/profiles.md",
        ),
        ("gone.toml", 2, "gone.toml: not a profile"),
    ] {
        folder.refuses(&enrich(&format!("--profile {profile}")), code, message);
    }
}

#[test]
fn a_missing_depression_is_explained_by_examples() {
    let message = "does not say where the camera looks … --depression DEG … optical axis below the horizon … \
                   --depression 0 … ahead … \
                   --depression 30 … gimbal pitch of -30° … \
                   --depression 90 … straight down";
    Folder::with_flight().refuses("enrich flight.mcap", 2, message);
}

#[test]
fn numbers_out_of_range_are_wrong_arguments() {
    let folder = Folder::with_flight();
    for (option, values, range) in [
        ("--depression", "-90 90.5 nan", "than -90 … at most 90"),
        (
            "--max-gap",
            "0 -1 nan",
            "greater than 0 … at most 1000000000 s",
        ),
    ] {
        for value in values.split(' ') {
            let message = format!("'{value}' for '{option} … {range}");
            folder.refuses(&format!("enrich {LOG} {option} {value}"), 2, &message);
        }
        let message = format!("'abc' for '{option} … not a number");
        folder.refuses(&format!("enrich {LOG} {option} abc"), 2, &message);
    }
}

#[test]
fn depressions_from_nearly_straight_up_to_straight_down_are_accepted() {
    let folder = Folder::with(LOG, state_log(1.0));
    for (degrees, expected) in [("90", 90.0), ("-89.9", -89.9), ("0", 0.0), ("-30", -30.0)] {
        let report = folder.reports(&format!("enrich {LOG} --force --depression {degrees}"), 0);
        let used = report["camera"]["depression_deg"].as_f64().unwrap();
        assert!((used - expected).abs() < 1e-9, "{used}");
        assert_eq!(rotations(&folder.read(RESULT)).len(), 3 * 49);
    }
}

#[test]
fn an_output_that_cannot_be_is_refused() {
    let folder = Folder::with_flight();
    folder.add("results/monday.mcap", "");
    for (output, message) in [
        (
            "out/x.mcap",
            "no folder out for the output … create … another output with -o",
        ),
        (
            "results",
            "results: is a folder … name the output's file with -o",
        ),
        ("results --force", "results: is a folder"),
        ("new/", "new/: is a folder"),
    ] {
        folder.refuses(&enrich(&format!("-o {output}")), 1, message);
    }
}

#[test]
#[cfg(unix)]
fn an_output_folder_that_is_not_writable_is_refused() {
    use std::os::unix::fs::PermissionsExt;

    let folder = Folder::with_flight();
    fs::create_dir(folder.path("locked")).unwrap();
    fs::set_permissions(folder.path("locked"), fs::Permissions::from_mode(0o555)).unwrap();
    // Permissions do not stop root, but nobody creates files in /proc.
    let is_locked = |name: &&str| {
        let path = folder.path(name);
        path.is_dir() && tempfile::tempfile_in(path).is_err()
    };
    let Some(locked) = ["locked", "/proc/self"].into_iter().find(is_locked) else {
        return println!("skipped: there is no folder that this user may not write to");
    };
    let message = format!(
        "{locked}/x.mcap: cannot create a file in the output's folder … choose another output with -o"
    );
    folder.refuses(&enrich(&format!("-o {locked}/x.mcap")), 1, &message);
}

#[test]
fn an_output_that_exists_is_replaced_only_when_told() {
    let folder = Folder::with_flight();
    folder.add(RESULT, "an older result");
    let message = "flight.enriched.mcap: exists already … -o … --force";
    folder.refuses(&enrich(""), 1, message);
    folder.writes(RESULT, &enrich("--force"), 0);
    let counts = count_messages(&folder.read(RESULT));
    assert_eq!(counts["/camera/velocity"], 3310);
}

#[test]
fn the_input_is_never_replaced_however_it_is_spelled() {
    let folder = Folder::with_flight();
    let mut spellings = vec![LOG, "./flight.mcap"];
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(LOG, folder.path("link.mcap")).unwrap();
        spellings.push("link.mcap");
    }
    for spelling in spellings {
        for force in ["", "--force"] {
            let message = format!("{spelling}: … would replace the input … -o");
            folder.refuses(&enrich(&format!("-o {spelling} {force}")), 2, &message);
        }
    }
}

#[test]
fn a_log_without_a_usable_sample_is_refused_with_the_counts() {
    for (count, missing, rotations, velocities) in [
        (
            1,
            "vx",
            "has 1 of 1",
            "0 of 1 usable, 1 without a field that is needed",
        ),
        (
            50,
            "yaw",
            "has 0 of 50 usable, 50 without a field",
            "50 before",
        ),
    ] {
        let states = states_without(count, missing);
        let message = format!(
            "{LOG}: nothing can be derived … /camera/relative_rpy: … /drone/state {rotations} … \
             /camera/velocity: … /drone/state has … {velocities}"
        );
        let folder = Folder::with(LOG, log(&[topic("/drone/state", states)]));
        folder.refuses(&enrich(""), 1, &message);
    }
}

#[test]
fn damage_that_is_found_when_half_is_written_leaves_nothing_behind() {
    let mut flight = fs::read(FIXTURE).unwrap();
    flight[200_000..200_100].fill(0xff);
    let message = "flight.mcap: damaged at byte … mcap recover";
    Folder::with(LOG, flight).refuses(&enrich(""), 1, message);
}

#[test]
fn an_earlier_result_is_replaced() {
    let folder = Folder::with_flight();
    folder.writes(RESULT, &enrich(""), 0);
    let other = format!("enrich {RESULT} --depression 45 -o other.mcap");
    let report = folder.writes("other.mcap", &other, 0);
    assert_reads(&report, "Note … already enriched … 30° below … replaces");
    folder.writes(
        "direct.mcap",
        &format!("enrich {LOG} --depression 45 -o direct.mcap"),
        0,
    );
    assert!(folder.read("other.mcap") == folder.read("direct.mcap"));
}

#[test]
fn a_topic_of_the_same_name_that_is_not_flightcams_is_refused() {
    let foreign = topic("/camera/velocity", [json!({ "x": 1.0 })]);
    let log = log(&[topic("/drone/state", states(5, 1.0)), foreign]);
    let message = "flight.mcap: … /camera/velocity … flightcam did not write … rename or remove";
    Folder::with(LOG, log).refuses(&enrich(""), 1, message);
}

#[test]
fn the_result_lies_beside_the_log_and_the_report_tells_how_it_came_about() {
    let folder = Folder::with("logs/flight.mcap", fs::read(FIXTURE).unwrap());
    let result = "logs/flight.enriched.mcap";
    let report = folder.writes(result, "enrich logs/flight.mcap --depression 30", 0);
    assert_reads(
        &report,
        "logs/flight.mcap … flat, chosen because /drone/state has roll, pitch, yaw … \
         30° below the horizon … \
         Attitude … /drone/state: 3,310 of 3,310 samples used … \
         Velocity … /drone/state: 3,310 of 3,310 samples used … \
         /camera/relative_rpy: 3,309 messages … /camera/velocity: 3,310 messages … \
         unchanged … added … flight.enriched.mcap … \
         Foxglove … /camera/relative_rpy.yaw … /camera/velocity.x",
    );
    let bytes = report.lines().find(|line| line.contains("added"));
    let words = bytes.unwrap().split(' ').map(|word| word.replace(',', ""));
    let bytes: usize = words.filter_map(|word| word.parse::<usize>().ok()).sum();
    assert_eq!(bytes, folder.read(result).len());
}

#[test]
fn the_json_report_has_every_number() {
    let folder = Folder::with_flight();
    let mut report = folder.reports(&enrich(""), 0);
    let [copied, appended] = ["bytes_kept", "bytes_added"].map(|name| {
        let bytes = report[name].take().as_u64().unwrap();
        usize::try_from(bytes).unwrap()
    });
    let result = folder.read(RESULT);
    assert_eq!(copied + appended, result.len());
    assert!(copied > 200_000 && folder.read(LOG).starts_with(&result[..copied]));

    let samples = json!({ "topic": "/drone/state", "used": 3310, "dropped": {} });
    let expected = json!({
        "input": LOG,
        "output": RESULT,
        "profile": {
            "name": "flat",
            "chosen": "automatically",
            "attitude": { "topic": "/drone/state", "fields": ["roll", "pitch", "yaw"] },
        },
        "encoding": {
            "name": "protobuf",
            "chosen": "automatically",
            "telemetry_topic": "/drone/state",
            "telemetry_encoding": "protobuf",
        },
        "camera": { "kind": "stabilised", "depression_deg": 30.0, "yaw_offset_deg": 0.0 },
        "gimbal": null,
        "max_gap_s": 5.0,
        "attitude": samples,
        "velocity": samples,
        "breaks": { "gaps": 0, "resets": 0 },
        "written": [
            { "topic": "/camera/relative_rpy", "schema": "flightcam.v1.RelativeRpy", "messages": 3309 },
            { "topic": "/camera/velocity", "schema": "flightcam.v1.CameraVelocity", "messages": 3310 },
        ],
        "not_written": [],
        "layout": "append",
        "bytes_kept": null,
        "bytes_added": null,
        "complete": true,
        "notes": [],
    });
    assert_eq!(report, expected);
}

#[test]
fn the_encoding_is_as_asked_for_and_the_advice_names_its_fields() {
    let own = "flightcam.v1.CameraVelocity … /camera/relative_rpy.yaw and /camera/velocity.x.";
    let ros2 = "geometry_msgs/msg/Vector3Stamped … \
                /camera/relative_rpy.vector.z and /camera/velocity.vector.x.";
    for (argument, used, expected) in [
        ("auto", "protobuf", own),
        ("protobuf", "protobuf", own),
        ("json", "json", own),
        ("ros2", "ros2", ros2),
    ] {
        let folder = Folder::with_flight();
        let arguments = enrich(&format!("--encoding {argument} --force"));
        let report = folder.reports(&arguments, 0);
        assert_eq!(report["encoding"]["name"], used);
        let schema = report["written"][1]["schema"].as_str().unwrap();
        let printed = folder.run(&arguments, 0).0;
        assert_reads(&format!("{schema} {printed}"), expected);
    }
    let message = "'xml' for '--encoding … auto, protobuf, json, ros2";
    Folder::with_flight().refuses(&enrich("--encoding xml"), 2, message);
}

#[test]
fn quiet_prints_nothing() {
    let printed = Folder::with_flight().writes(RESULT, &enrich("--quiet"), 0);
    assert_eq!(printed, "");
}

#[test]
fn a_run_that_takes_a_while_draws_no_progress_bar_into_a_pipe() {
    // Unoptimised, this takes longer than the bar waits before it appears.
    let folder = Folder::with(LOG, log(&[topic("/drone/state", states(30_000, 1.0))]));
    let report = folder.writes(RESULT, &enrich(""), 0);
    assert_reads(&report, "/camera/velocity: 30,000 messages");
}

#[test]
fn without_a_velocity_there_are_rotations_and_the_reason() {
    for (missing, arguments, reason) in [
        ("altitude", "--profile mine.toml", "`mine` has no velocity"),
        (
            "vz",
            "",
            "0 of 50 usable, 50 without a field that is needed",
        ),
    ] {
        let states = states_without(50, missing);
        let folder = Folder::with(LOG, log(&[topic("/drone/state", states)]));
        folder.add("mine.toml", profile("roll"));
        let report = folder.writes(RESULT, &enrich(arguments), 0);
        let reason = format!("Not written … /camera/velocity: … {reason}");
        assert_reads(&report, "Written … /camera/relative_rpy: 49 messages");
        assert_reads(&report, &reason);
        let counts = [("/camera/relative_rpy", 49), ("/drone/state", 50)];
        let counts = counts.map(|(topic, count)| (topic.to_owned(), count));
        assert_eq!(count_messages(&folder.read(RESULT)), counts.into());
    }
}

#[test]
fn degrees_are_read_when_told_and_suspected_when_not() {
    let [radians, degrees, mistaken] = [
        (1.0, "", false),
        (PI / 180.0, "--profile flat-deg", false),
        (PI / 180.0, "", true),
    ]
    .map(|(unit, arguments, suspected)| {
        let folder = Folder::with(LOG, state_log(unit));
        let report = folder.writes(RESULT, &enrich(arguments), 0);
        assert_eq!(report.contains("--profile flat-deg"), suspected, "{report}");
        rotations(&folder.read(RESULT))
    });
    let difference = |angles: &[f64]| {
        assert_eq!(angles.len(), 3 * 49);
        let pairs = angles.iter().zip(&radians);
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    assert!(difference(&degrees) < 1e-12);
    assert!(difference(&mistaken) > 0.1);
}

#[test]
fn a_log_that_breaks_off_gives_what_it_has_and_exit_code_3() {
    let whole = fs::read(FIXTURE).unwrap();
    let length = whole.len() * 6 / 10;
    let folder = Folder::with(LOG, &whole[..length]);
    let report = folder.reports(&enrich(""), 3);
    assert_eq!(report["complete"], false);
    let whole_records = report["bytes_kept"].as_u64().unwrap();
    let lost = length as u64 - whole_records;
    let note = json!({ "kind": "breaks_off", "offset": whole_records, "lost_bytes": lost });
    assert_eq!(report["notes"][0], note);

    let used = report["attitude"]["used"].as_u64().unwrap();
    assert!((1000..3310).contains(&used), "{used}");
    let counts = count_messages(&folder.read(RESULT));
    assert_eq!(counts["/drone/state"], used);
    assert_eq!(counts["/camera/relative_rpy"], used - 1);
    assert_eq!(counts["/camera/velocity"], used);
}

#[test]
fn notes_say_what_can_be_done() {
    let gimbal = (0..2).map(|_| json!({ "q": [1, 0, 0, 0], "device_flags": 32 }));
    let px4 = [
        attitude("/vehicle_attitude"),
        topic("/gimbal_device_attitude_status", gimbal),
    ];
    let boot = |mut state: Value| {
        state["seconds"] = json!(0.5);
        state
    };
    let stamped = [topic("/drone/state", states(1, 1.0).map(boot))];
    let ros2 = [Topic {
        encoding: "cdr",
        messages: vec![pose_in_cdr(); 2],
        ..topic("/pose", []).with_schema("test/msg/Pose", "ros2msg", "float64[4] q")
    }];
    let flat = [flat("/drone/state")];
    for (topics, arguments, note) in [
        (
            &px4[..],
            "--depression 30",
            "angles on /gimbal_device_attitude_status, but --depression was given and takes precedence: … held at \
             that angle",
        ),
        (
            &px4,
            "--mount 0,-30,0",
            "--mount was given and takes precedence: … bolted to the airframe",
        ),
        (
            &stamped,
            "--depression 30 --time seconds:s",
            "times before the log's first message or after its last … --time says",
        ),
        (
            &flat,
            "--depression 30 --encoding ros2",
            "tools such as rosbags refuse … /drone/state of the log (json)",
        ),
        (
            &ros2,
            "--depression 30 --attitude /pose.q --encoding json",
            "tools such as rosbags refuse … the new ones … use --encoding ros2",
        ),
        (
            &flat,
            "--depression 30 --layout interleaved",
            "`flightcam restore` cannot undo",
        ),
    ] {
        let folder = Folder::with(LOG, log(topics));
        let report = folder.writes(RESULT, &format!("enrich {LOG} {arguments}"), 0);
        assert_reads(&report, &format!("Note … {note}"));
    }

    let folder = Folder::with(LOG, log(&flat));
    folder.add("metadata.yaml", "rosbag2_bagfile_information:\n");
    let report = folder.writes(RESULT, &enrich(""), 0);
    assert_reads(
        &report,
        "Note … metadata.yaml does not list the result … `ros2 bag reindex -s mcap FOLDER`",
    );
}

/// The identity as `float64[4]`.
fn pose_in_cdr() -> Vec<u8> {
    let mut message = vec![0, 1, 0, 0];
    message.extend([1.0, 0.0, 0.0, 0.0].map(f64::to_le_bytes).concat());
    message
}

#[test]
fn messages_that_cannot_be_decoded_are_counted_and_give_exit_code_3() {
    let mut state = topic("/drone/state", states(50, 1.0));
    state.messages[7].truncate(20);
    let report = Folder::with(LOG, log(&[state])).writes(RESULT, &enrich(""), 3);
    assert_reads(&report, "49 of 50 samples used … 1 dropped: not decodable");
}

#[test]
#[cfg(unix)]
fn the_result_has_the_permissions_of_the_log() {
    use std::os::unix::fs::PermissionsExt;

    let folder = Folder::with_flight();
    fs::set_permissions(folder.path(LOG), fs::Permissions::from_mode(0o640)).unwrap();
    folder.writes(RESULT, &enrich(""), 0);
    let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
    assert_eq!(mode(&folder.path(RESULT)) & 0o777, 0o640);
}
