//! What `flightcam enrich` refuses: with which exit code and which advice, and that nothing is left behind.

use super::*;

#[test]
fn a_file_that_is_not_a_log_is_refused_with_advice() {
    let garbage = [mcap::MAGIC, &[0xc5; 300]].concat();
    let cases: [(&[u8], &str); 4] = [
        (b"a log, they said", "magic bytes … the log you meant"),
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
fn a_log_without_telemetry_is_refused_with_what_was_looked_for_and_what_it_has() {
    let battery = topic("/battery", [json!({ "voltage": 15.9 })]);
    let attitude = topic(
        "/imu",
        [json!({ "roll": 0, "pitch": 0, "yaw": 0, "vx": 0 })],
    );
    let none = "the log has none: px4-ulog, … flat";
    let nearest = "flat: no topic has messages with all of the fields `roll`, `pitch`, `yaw`, `vn`, `ve`, `vd`; /imu \
                   comes closest: it has no field `vy`, `vz`; … with the most fields has pitch, roll, vx, yaw … the \
                   log has none: px4-ulog";
    let cases: [(&[Topic], &str, &str); 4] = [
        (&[battery], none, "topics of the log: … /battery (json"),
        (&[attitude], nearest, "/imu (json, no schema)"),
        (&[], none, "the log has no messages"),
        (
            &[topic("/drone/state", [])],
            none,
            "the log has no messages",
        ),
    ];
    for (topics, looked_for, present) in cases {
        let message =
            format!("{LOG}: no usable telemetry … {looked_for} … {present} … --profile FILE.toml");
        Folder::with(LOG, log(topics)).refuses(&enrich(""), 1, &message);
    }
}

#[test]
fn topics_that_fit_equally_well_are_refused_with_how_to_choose() {
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
            "--gimbal /state --attitude /state.roll,/state.pitch,/state.yaw:radians",
            "only a topic … gimbal … /state … give --gimbal fields",
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
        (
            flight(),
            "rol",
            "`rol`; did you mean `roll`? demo.DroneState has … yaw",
        ),
        (flight(), "timestamp", "`timestamp` is not a number"),
        (
            state_log(1.0),
            "rol",
            "`rol`; did you mean `roll`? … has pitch, roll, vx",
        ),
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
fn an_invalid_profile_is_refused_with_its_position_and_the_known_names() {
    let folder = Folder::with_flight();
    folder.add("torn.toml", "name = \"torn\"\n[attitude\n");
    folder.add("typo.toml", profile("roll").replace("topics", "topic"));
    for (profile, code, message) in [
        (
            "px4",
            2,
            "`px4` … px4-ulog, px4-ros2, mavros … flat, flat-deg … .toml",
        ),
        (
            "px4-ulgo",
            2,
            "unknown profile `px4-ulgo`; did you mean px4-ulog? the built-in profiles are",
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
fn an_impossible_output_is_refused() {
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
fn a_log_without_a_usable_attitude_is_refused_with_the_counts() {
    let states = states_without(50, "yaw");
    let message = format!(
        "{LOG}: nothing can be derived … \
         /camera/relative_rpy: at least two usable … /drone/state has 0 of 50 usable, 50 without a field … \
         /camera/orientation: at least one usable … /drone/state has 0 of 50 usable, 50 without a field … \
         /camera/velocity: … /drone/state has … 50 before"
    );
    let folder = Folder::with(LOG, log(&[topic("/drone/state", states)]));
    folder.refuses(&enrich(""), 1, &message);
}

#[test]
fn one_usable_attitude_is_enough_for_an_orientation() {
    let states = states_without(1, "vx");
    let folder = Folder::with(LOG, log(&[topic("/drone/state", states)]));
    let report = folder.writes(RESULT, &enrich(""), 0);
    assert_reads(
        &report,
        "Written     /camera/orientation: 1 message\n … \
         Not written /camera/relative_rpy: at least two usable … /drone/state has 1 of 1 usable … \
         Not written /camera/velocity: … 0 of 1 usable, 1 without a field that is needed … \
         plot /camera/orientation.yaw.",
    );
    let counts = [("/camera/orientation", 1), ("/drone/state", 1)];
    let counts = counts.map(|(topic, count)| (topic.to_owned(), count));
    assert_eq!(count_messages(&folder.read(RESULT)), counts.into());
}

#[test]
fn damage_found_halfway_leaves_no_output() {
    let mut flight = fs::read(FIXTURE).unwrap();
    flight[200_000..200_100].fill(0xff);
    let message = "flight.mcap: damaged at byte … mcap recover";
    Folder::with(LOG, flight).refuses(&enrich(""), 1, message);
}

#[test]
fn a_topic_of_the_same_name_that_is_not_flightcams_is_refused() {
    for name in DERIVED {
        let foreign = topic(name, [json!({ "x": 1.0 })]);
        let log = log(&[topic("/drone/state", states(5, 1.0)), foreign]);
        let message = format!("flight.mcap: … {name} … flightcam did not write … rename or remove");
        Folder::with(LOG, log).refuses(&enrich(""), 1, &message);
    }
}

#[test]
fn only_enrich_reads_from_a_pipe() {
    for command in ["inspect -", "restore - -o original.mcap"] {
        let message = "standard input: cannot be read from front to back … a file first";
        Folder::new().refuses(command, 2, message);
    }
}

#[test]
fn a_profile_without_end_is_not_read_to_its_end() {
    let folder = Folder::with_flight();
    folder.add("long.toml", "#".repeat(2 << 20));
    let mut profiles = vec!["./long.toml"];
    if cfg!(unix) {
        profiles.push("/dev/zero");
    }
    for profile in profiles {
        let message = format!("{profile}: not a profile: it is longer than 1 MiB");
        folder.refuses(&enrich(&format!("--profile {profile}")), 2, &message);
    }
}
