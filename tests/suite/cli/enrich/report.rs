//! What `flightcam enrich` reports of a log that it enriched.

use super::*;

#[test]
fn the_result_is_next_to_the_log_and_the_report_says_how_it_was_made() {
    let folder = Folder::with("logs/flight.mcap", fs::read(FIXTURE).unwrap());
    let result = "logs/flight.enriched.mcap";
    let report = folder.writes(result, "enrich logs/flight.mcap --depression 30", 0);
    assert_reads(
        &report,
        "logs/flight.mcap … flat, chosen because /drone/state has roll, pitch, yaw … \
         30° below the horizon … \
         Attitude … /drone/state: 3,310 of 3,310 samples used … \
         Velocity … /drone/state: 3,310 of 3,310 samples used … \
         /camera/relative_rpy: 3,309 messages … /camera/orientation: 3,310 messages … \
         /camera/velocity: 3,310 messages … unchanged … added … flight.enriched.mcap … \
         Foxglove … plot /camera/relative_rpy.yaw, /camera/orientation.yaw and /camera/velocity.x.",
    );
    let bytes = report.lines().find(|line| line.contains("added"));
    let words = bytes.unwrap().split(' ').map(|word| word.replace(',', ""));
    let numbers: Vec<usize> = words.filter_map(|word| word.parse().ok()).collect();
    let [log, result] = ["logs/flight.mcap", result].map(|name| folder.read(name).len());
    assert_eq!(numbers[1], result - log, "the file grew by that");
}

#[test]
fn the_json_report_has_every_number() {
    let folder = Folder::with_flight();
    let mut report = folder.reports(&enrich(""), 0);
    let [copied, added] = ["bytes_kept", "bytes_added"].map(|name| {
        let bytes = report[name].take().as_u64().unwrap();
        usize::try_from(bytes).unwrap()
    });
    let result = folder.read(RESULT);
    assert_eq!(added, result.len() - folder.read(LOG).len());
    assert!(copied > 200_000 && folder.read(LOG).starts_with(&result[..copied]));

    let samples = |read_as: Value| json!({ "topic": "/drone/state", "used": 3310, "dropped": {}, "read_as": [read_as] });
    let attitude = samples(json!({
        "kind": "angles",
        "axes": "frd-ned",
        "unit": "radians",
        "order": "yaw-pitch-roll",
        "because": "profile",
    }));
    let velocity = samples(json!({
        "kind": "velocity",
        "axes": "ned",
        "unit": "m/s",
        "because": "profile",
    }));
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
        "position": null,
        "max_gap_s": 5.0,
        "min_interval_s": 0.0,
        "motion": {},
        "attitude": attitude,
        "velocity": velocity,
        "breaks": { "gaps": 0, "resets": 0, "clock_steps": 0 },
        "written": [
            { "topic": "/camera/relative_rpy", "schema": "flightcam.v1.RelativeRpy", "messages": 3309 },
            { "topic": "/camera/orientation", "schema": "flightcam.v1.CameraOrientation", "messages": 3310 },
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
fn a_shorter_result_in_place_of_an_earlier_one_is_said_to_be_shorter() {
    let folder = Folder::with_flight();
    folder.run(&enrich("--in-place --encoding json"), 0);
    let earlier = folder.read(LOG).len();
    let report = folder.writes(LOG, &enrich("--in-place"), 0);
    let less = earlier - folder.read(LOG).len();
    assert!(less > 1000, "{less}");
    let less = indicatif::HumanCount(less as u64);
    let words =
        format!("Bytes … unchanged, and {less} less than the log had with its earlier result");
    assert_reads(&report, &words);
    // The same result again.
    let json = folder.writes(LOG, &enrich("--in-place --json"), 0);
    let report: Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!(report["bytes_added"], 0);
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
fn a_log_without_velocity_yields_rotations_and_orientations_and_the_reason() {
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
        let to_plot = "plot /camera/relative_rpy.yaw and /camera/orientation.yaw.";
        assert_reads(&report, to_plot);
        let counts = [
            ("/camera/relative_rpy", 49),
            ("/camera/orientation", 50),
            ("/drone/state", 50),
        ];
        let counts = counts.map(|(topic, count)| (topic.to_owned(), count));
        assert_eq!(count_messages(&folder.read(RESULT)), counts.into());
    }
}

#[test]
fn a_truncated_log_is_enriched_up_to_its_end_with_exit_code_3() {
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
    assert_eq!(counts["/camera/orientation"], used);
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
            "--depression 30 --attitude /pose.q:frd-ned --encoding json",
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
