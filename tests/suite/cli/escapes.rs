//! Whatever a stranger names topics, types, fields, profiles and files: on a terminal it does nothing but show
//! itself, in its line. For programs it stays as it is.

use std::{collections::BTreeMap, io::Cursor, process::Command};

use assert_cmd::cargo::cargo_bin;
use mcap::records::Metadata;
use proptest::prelude::*;
use serde_json::{Value, json};

use crate::support::{folder::*, hostile_log, steering::*, topics::*};

/// Runs the program, and checks what it shows.
#[track_caller]
fn shows(folder: &Folder, arguments: &[&str], code: i32) -> String {
    let (ended, out, err) = folder.run_with(arguments);
    assert_eq!(ended, code, "{arguments:?}\n{out}{err}");
    assert_shown(&out);
    assert_shown(&err);
    out + &err
}

/// As [`shows`], and a name in it as it is to be shown, in a line that the name does not begin.
#[track_caller]
fn shows_name(folder: &Folder, arguments: &[&str], code: i32) -> String {
    let shown = shows(folder, arguments, code);
    assert!(shown.contains(PRINTED), "{arguments:?}\n{shown}");
    let fake = shown
        .lines()
        .find(|line| line.starts_with("Attitude    /fake"));
    assert_eq!(fake, None);
    shown
}

const ENRICH: [&str; 4] = ["enrich", LOG, "--depression", "30"];

fn enrich<'a>(more: &[&'a str]) -> Vec<&'a str> {
    [&ENRICH, more].concat()
}

#[test]
fn the_hostile_log_is_shown_in_its_lines() {
    let Some(log) = hostile_log("escapes.mcap") else {
        return;
    };
    let folder = Folder::with(LOG, log);
    let shown = shows(&folder, &["inspect", LOG], 0);
    let attitude = shown.lines().filter(|line| line.starts_with("Attitude  "));
    assert_eq!(attitude.count(), 2, "the role and its numbers:\n{shown}");
    assert!(shown.contains(r"\u{1b}[31m"), "{shown}");
    shows(&folder, &["inspect", LOG, "--json"], 0);
    let shown = shows(&folder, &enrich(&[]), 0);
    assert_eq!(shown.matches("\nAttitude  ").count(), 1, "{shown}");
    shows(&folder, &["restore", RESULT], 0);
}

#[test]
fn the_reports_show_names_in_their_lines() {
    let state = topic(NASTY, states(5, 1.0)).of_type(NASTY);
    let mut other = topic("/other", [json!({})]).of_type(NASTY);
    other.encoding = NASTY;
    let folder = Folder::with(LOG, log(&[state, other]));
    let inspected = shows_name(&folder, &["inspect", LOG], 0);
    for line in [
        format!("Profile     flat, chosen because {PRINTED} has roll, pitch, yaw"),
        format!("Velocity    {PRINTED} ({PRINTED}, json): vx, vy, vz"),
    ] {
        assert!(
            inspected.lines().any(|shown| shown == line),
            "{line}\nin\n{inspected}"
        );
    }
    assert!(inspected.contains(&format!("({PRINTED}): 1 message on /other")));
    let enriched = shows_name(&folder, &enrich(&[]), 0);
    assert!(enriched.contains(&format!("Attitude    {PRINTED}: 5 of 5 samples used\n")));
    let ros2 = shows_name(&folder, &enrich(&["--force", "--encoding", "ros2"]), 0);
    assert!(ros2.contains(&format!("as {PRINTED} of the log (json) is not")));
}

#[test]
fn what_is_missing_is_shown_with_its_names() {
    let states = states(5, 1.0).map(|mut state| {
        state["roll"] = json!(null);
        state["vx"] = json!(null);
        state
    });
    let folder = Folder::with(LOG, log(&[topic(NASTY, states)]));
    for arguments in [&["inspect", LOG][..], &enrich(&[])] {
        let shown = shows_name(&folder, arguments, 1);
        assert!(
            shown.contains(&format!("and {PRINTED} has 0 of 5 usable")),
            "{shown}"
        );
    }
}

#[test]
fn a_note_shows_names_in_its_line() {
    let degrees = topic(NASTY, states(400, 1.0f64.to_radians()));
    let folder = Folder::with(LOG, log(&[degrees]));
    let shown = shows_name(&folder, &enrich(&["--trust"]), 0);
    assert!(
        shown.contains(&format!("Note        {PRINTED} has an angle of")),
        "{shown}"
    );
}

/// A log whose telemetry has this type.
fn with_schema(
    name: &'static str,
    encodings: [&'static str; 2],
    data: impl Into<Vec<u8>>,
) -> Folder {
    let [messages, schema] = encodings;
    let mut state = topic("/state", states(2, 1.0)).with_schema(name, schema, data);
    state.encoding = messages;
    Folder::with(LOG, log(&[state]))
}

#[test]
fn what_is_wrong_with_a_schema_is_shown_with_what_it_quotes() {
    let ros2 = ["cdr", "ros2msg"];
    let cases: [(Folder, &str); 9] = [
        (with_schema("T", [NASTY, NASTY], ""), PRINTED),
        (with_schema(NASTY, ["protobuf", "protobuf"], ""), PRINTED),
        (with_schema(NASTY, ros2, "a/B c"), "does not define `a/B`"),
        (
            with_schema("a/T", ros2, "x\u{1b}[31m"),
            r"`x\u{1b}[31m`, names no field",
        ),
        (with_schema("a/T", ros2, "a\u{1b}= b"), "is not a type"),
        (
            with_schema("a/T", ros2, "a\u{1b}[x] b"),
            "no valid array size",
        ),
        (
            with_schema("a/T", ros2, "a\u{1b}\u{202e} b"),
            r"`a/a\u{1b}\u{202e}`",
        ),
        (
            with_schema("a/T\u{1b}", ros2, "T\u{1b} b"),
            "contains itself",
        ),
        (
            with_schema("a/T\u{1b}", ros2, "float64 roll\nfloat64 yaw"),
            r"a/T\u{1b} has roll, yaw",
        ),
    ];
    for (folder, expected) in cases {
        for arguments in [
            &["inspect", LOG, "--attitude", "/state"][..],
            &["inspect", LOG],
        ] {
            let shown = shows(&folder, arguments, 1);
            assert!(shown.contains(expected), "{expected}\nin\n{shown}");
        }
    }
}

#[test]
fn the_fields_that_a_topic_has_are_shown_in_one_line() {
    let state = json!({ "roll": 1, "pitch": 1, "yaw": 1, "vx": 1, "vy": 1, NASTY: 1 });
    let folder = Folder::with(LOG, log(&[topic("/state", [state])]));
    let shown = shows_name(&folder, &["inspect", LOG], 1);
    assert!(
        shown.contains(&format!("has \"{PRINTED}\", pitch, roll, vx, vy, yaw")),
        "{shown}"
    );
}

#[test]
fn what_an_earlier_run_says_of_itself_is_shown_in_its_line() {
    let record = Metadata {
        name: "flightcam".to_owned(),
        metadata: BTreeMap::from(
            [
                ("version", NASTY),
                ("camera", NASTY),
                ("profile", NASTY),
                ("topics", "/camera/velocity"),
            ]
            .map(|(key, value)| (key.to_owned(), value.to_owned())),
        ),
    };
    let mut writer = mcap::Writer::new(Cursor::new(Vec::new())).unwrap();
    let channel = writer
        .add_channel(0, "/camera/velocity", "json", &BTreeMap::new())
        .unwrap();
    let header = mcap::records::MessageHeader {
        channel_id: channel,
        sequence: 0,
        log_time: 1,
        publish_time: 1,
    };
    writer.write_to_known_channel(&header, b"{}").unwrap();
    writer.write_metadata(&record).unwrap();
    writer.finish().unwrap();
    let folder = Folder::with(LOG, writer.into_inner().into_inner());
    let earlier = format!("(version {PRINTED}, camera {PRINTED}, profile {PRINTED})");
    for arguments in [&["inspect", LOG][..], &enrich(&[])] {
        assert!(shows_name(&folder, arguments, 1).contains(&earlier));
    }
    let taken = topic("/camera/velocity", [json!({})]).of_type(NASTY);
    shows_name(&Folder::with(LOG, log(&[taken])), &enrich(&[]), 1);
}

/// A profile named [`NASTY`], with a field to match.
fn profile() -> String {
    let [name, yaw] = [NASTY, "ya\u{1b}\u{202e}w"].map(|text| Value::from(text).to_string());
    format!(
        "name = {name}\n[attitude]\ntopics = [{name}]\n\
         orientation.euler = {{ roll = \"roll\", pitch = \"pitch\", yaw = {yaw}, unit = \"radians\" }}\n"
    )
}

fn with_profile() -> Folder {
    let states = states(5, 1.0).map(|mut state| {
        state["ya\u{1b}\u{202e}w"] = state["yaw"].take();
        state
    });
    let folder = Folder::with(LOG, log(&[topic(NASTY, states)]));
    folder.add("own.toml", profile());
    folder
}

#[test]
fn a_profile_from_a_stranger_is_shown_in_its_lines() {
    let folder = with_profile();
    let own = ["--profile", "own.toml"];
    let shown = shows_name(&folder, &[&["inspect", LOG][..], &own].concat(), 0);
    assert!(shown.contains(&format!(
        "Profile     {PRINTED}, as asked for; {PRINTED} has roll, pitch, ya"
    )));
    assert!(shown.contains(r"ya\u{1b}\u{202e}w"), "{shown}");
    shows_name(&folder, &enrich(&own), 0);
    let again = ["enrich", RESULT, "--depression", "30", "-o", "again.mcap"];
    let shown = shows_name(&folder, &[&again[..], &own].concat(), 0);
    assert!(
        shown.contains(&format!("profile {PRINTED}); this result replaces")),
        "{shown}"
    );
    shows_name(&folder, &["inspect", RESULT, "--profile", "own.toml"], 0);
    let shown = shows_name(&folder, &["restore", RESULT], 0);
    assert!(
        shown.contains("Undone      what flightcam added (version "),
        "{shown}"
    );

    let spoilt = [
        profile() + "\"k\\u001b\\n\" = 1",
        profile() + "x\u{1b}\u{202e} =",
        profile().replace("\"radians\"", "\"\\u001b\\nradians\""),
        profile().replace("\"roll\"", "\"/b\\u001b\\n\""),
    ];
    for text in spoilt {
        folder.add("own.toml", text);
        let shown = shows(&folder, &[&["inspect", LOG][..], &own].concat(), 2);
        assert!(shown.contains(r"\u{1b}"), "{shown}");
    }
}

#[test]
fn what_goes_into_the_result_is_as_it_was() {
    let folder = with_profile();
    shows(&folder, &enrich(&["--profile", "own.toml"]), 0);
    let result = folder.read(RESULT);
    let summary = mcap::Summary::read(&result).unwrap().expect("a summary");
    let index = &summary.metadata_indexes[0];
    let record = mcap::read::metadata(&result, index).unwrap();
    let fact = |key: &str| record.metadata[key].as_str();
    assert_eq!(fact("profile"), NASTY);
    assert_eq!(fact("attitude_topic"), NASTY);
    assert_eq!(
        fact("encoding_reason"),
        format!("chosen because {NASTY} is json")
    );
    let written: toml::Table = fact("profile_toml").parse().expect("TOML");
    assert_eq!(written["name"].as_str(), Some(NASTY));
    let attitude = written["attitude"].to_string();
    assert!(
        attitude.contains(r"ya\u001B\u202Ew") || attitude.contains("ya\\u001B\u{202e}w"),
        "{attitude}"
    );
}

#[test]
fn json_has_names_as_they_are_in_its_own_escapes() {
    let folder = with_profile();
    let own = ["--json", "--profile", "own.toml"];
    let shown = shows(&folder, &[&["inspect", LOG][..], &own].concat(), 0);
    let json: Value = serde_json::from_str(&shown).expect("JSON");
    let attitude = &json["telemetry"]["profile"]["attitude"];
    assert_eq!(json["telemetry"]["profile"]["name"], NASTY);
    assert_eq!(attitude["topic"], NASTY);
    assert_eq!(attitude["fields"][2], "ya\u{1b}\u{202e}w");
    assert_eq!(
        json["telemetry"]["roles"]["attitude"]["fields"],
        attitude["fields"]
    );
    let shown = shows(&folder, &enrich(&own), 0);
    let json: Value = serde_json::from_str(&shown).expect("JSON");
    assert_eq!(json["attitude"]["topic"], NASTY);
    let shown = shows(&folder, &["restore", RESULT, "--json"], 0);
    let json: Value = serde_json::from_str(&shown).expect("JSON");
    assert_eq!(json["undone"]["profile"], NASTY);
}

#[test]
fn json_escapes_characters_beyond_16_bits_too() {
    let folder = Folder::with(LOG, log(&[topic("/\u{e0041}é🚁", states(5, 1.0))]));
    let shown = shows(&folder, &["inspect", LOG, "--json"], 0);
    assert!(shown.contains(r"/\udb40\udc41é🚁"), "{shown}");
    let json: Value = serde_json::from_str(&shown).expect("JSON");
    assert_eq!(
        json["telemetry"]["profile"]["attitude"]["topic"],
        "/\u{e0041}é🚁"
    );
}

#[test]
#[cfg(unix)]
fn the_name_of_a_file_is_shown_in_its_line() {
    let name = "fl\u{1b}[31m\nResult      fake\u{202e}.mcap";
    let shown = r"fl\u{1b}[31m\nResult      fake\u{202e}.mcap";
    let folder = Folder::with(name, log(&[topic("/state", states(5, 1.0))]));
    let arguments: [&[&str]; 7] = [
        &["inspect", name],
        &["enrich", name, "--depression", "30", "-o", "result.mcap"],
        &["enrich", "result.mcap", "--depression", "30", "-o", name],
        &["restore", name],
        &["restore", "result.mcap", "-o", name],
        &["inspect", name, "--namespace", "/none\u{1b}\n"],
        &["inspect", "no\u{1b}.mcap"],
    ];
    for (arguments, code) in arguments.into_iter().zip([0, 0, 1, 1, 1, 1, 1]) {
        let printed = shows(&folder, arguments, code);
        assert!(
            printed.contains(shown) || printed.contains(r"no\u{1b}.mcap"),
            "{printed}"
        );
        assert!(!printed.contains("\nResult      fake"), "{printed}");
    }
}

#[test]
fn what_is_typed_is_echoed_in_its_line() {
    const TYPED: &str = "\u{1b}[31m\nfake\u{202e}";
    let folder = Folder::with_flight();
    let long = format!("--{TYPED}");
    let path = format!("/a{TYPED}.b:{TYPED}");
    let cases: [&[&str]; 11] = [
        &[TYPED],
        &["enrich", LOG, TYPED],
        &["enrich", LOG, &long],
        &["enrich", LOG, "--depression", TYPED],
        &["enrich", LOG, "--mount", TYPED],
        &["enrich", LOG, "--encoding", TYPED],
        &["enrich", LOG, "--profile", TYPED],
        &["enrich", LOG, "--attitude", &path],
        &["enrich", LOG, "--attitude", TYPED, "--time", TYPED],
        &["inspect", LOG, "--time", &path],
        &["profiles", TYPED],
    ];
    for arguments in cases {
        let shown = match folder.run_with(arguments) {
            (1 | 2, out, err) if out.is_empty() => err,
            other => panic!("{arguments:?}: {other:?}"),
        };
        assert_shown(&shown);
        assert!(
            !shown.lines().any(|line| line.starts_with("fake")),
            "{shown}"
        );
        assert!(
            shown.starts_with("error: ") && shown.contains(r"\u{1b}[31m\nfake\u{202e}"),
            "{shown}"
        );
    }
}

#[test]
fn styles_of_the_program_itself_stay() {
    for arguments in [&["enrich", "--depression", "x"][..], &["--help"]] {
        let mut command = Command::new(cargo_bin!("flightcam"));
        let output = command
            .args(arguments)
            .env("CLICOLOR_FORCE", "1")
            .output()
            .unwrap();
        let text = String::from_utf8([output.stdout, output.stderr].concat()).unwrap();
        assert!(text.contains("\u{1b}["), "{text:?}");
    }
}

#[test]
#[cfg(unix)]
fn a_hint_names_a_topic_that_a_shell_reads_back_or_none() {
    let cases: [([&'static str; 2], Option<&str>); 10] = [
        (["/a", "/b"], Some("/a")),
        (["/é中", "/é中2"], Some("/é中")),
        (["/a b", "/c d"], Some("'/a b'")),
        (["/a'b", "/c'd"], Some(r"'/a'\''b'")),
        (["/$HOME`ls`", "/c;d&e"], Some("'/$HOME`ls`'")),
        (["/a.b:c,d[0]", "/a.b:c,e[0]"], Some("'\"/a.b:c,d[0]\"'")),
        ([" /a", " /b"], Some("'\" /a\"'")),
        (["/a\u{1b}", "/b"], Some("/b")),
        (["/a\u{1b}", "/b\n"], None),
        (["/a\".b", "/{n}"], None),
    ];
    for (names, expected) in cases {
        let folder = Folder::with(LOG, log(&names.map(|name| topic(name, states(5, 1.0)))));
        let shown = shows(&folder, &enrich(&[]), 1);
        let hint = shown
            .lines()
            .find(|line| line.starts_with("hint: "))
            .expect("a hint");
        let Some(typed) = expected else {
            assert_eq!(hint, "hint: choose one with --attitude");
            continue;
        };
        assert_eq!(
            hint,
            format!("hint: choose one, for instance with --attitude {typed}")
        );
        let mut shell = Command::new("sh");
        let script = format!("exec \"$0\" {} --attitude {typed}", ENRICH.join(" "));
        shell.arg("-c").arg(script).arg(cargo_bin!("flightcam"));
        let output = shell.current_dir(folder.path("")).output().unwrap();
        assert!(output.status.success(), "{typed}: {output:?}");
    }
    let vehicles = ["/drone 1\u{1b}", "/drone 2"].map(|vehicle| {
        let name = format!("{vehicle}/mavros/local_position/pose");
        pose(name.leak())
    });
    let shown = shows(&Folder::with(LOG, log(&vehicles)), &enrich(&[]), 1);
    assert!(shown.ends_with("with --namespace '/drone 2'\n"), "{shown}");
}

/// Names with characters that steer, and others.
fn any_name() -> impl Strategy<Value = String> {
    let steering = prop::sample::select(alphabet());
    let plain = prop::sample::select("abc1_- é中🚁\\'\"".chars().collect::<Vec<_>>());
    prop::collection::vec(prop_oneof![steering, plain], 1..8)
        .prop_map(|name| name.into_iter().collect())
}

/// What a log and its file are named.
type Names = [String; 8];

/// What is shown of a log with these names: for each run its exit code, standard output and standard error.
fn shown_of(names: &Names, sort: usize) -> Vec<(i32, String, String)> {
    let leaked = names.each_ref().map(|name| &*name.clone().leak());
    let [one, two, schema, field, encoding, other, file, vehicle] = leaked;
    let called = |name: &str| &*format!("/{name}").leak();
    let states = || {
        states(5, 1.0).map(|mut state| {
            state[field] = json!(1);
            state
        })
    };
    let state = |name| topic(called(name), states()).of_type(schema);
    let mut strange = topic("/other", [json!({})]).with_schema(other, encoding, "");
    strange.encoding = encoding;
    let note = |name: &str| topic(name.to_owned().leak(), [json!({ field: 1 })]).of_type(schema);
    let topics = match sort {
        0 => vec![state(one), strange, note("/n")],
        1 => vec![state(&format!("1{one}")), state(&format!("2{two}"))],
        2 => vec![note(one), strange, note(&format!("{one}2"))],
        3 => vec![
            pose(format!("/{vehicle}/mavros/local_position/pose").leak()),
            strange,
        ],
        _ => vec![
            pose(format!("/1{vehicle}/mavros/local_position/pose").leak()),
            pose(format!("/2{vehicle}/mavros/local_position/pose").leak()),
        ],
    };
    let file = if cfg!(unix) {
        &format!("f{file}.mcap")
    } else {
        LOG
    };
    let folder = Folder::with(file, log(&topics));
    let runs: [&[&str]; 8] = [
        &["inspect", file],
        &["inspect", file, "--profile", "mavros"],
        &["enrich", file, "--depression", "30", "-o", RESULT],
        &[
            "enrich",
            RESULT,
            "--depression",
            "30",
            "-o",
            "again.mcap",
            "--encoding",
            "ros2",
        ],
        &["inspect", RESULT],
        &["restore", RESULT],
        &["restore", file],
        &["inspect", file, "--json"],
    ];
    runs.map(|arguments| folder.run_with(arguments)).into()
}

proptest! {
    #![proptest_config(crate::support::cases(24))]

    #[test]
    fn no_names_steer_a_terminal_or_change_the_lines(
        names in prop::array::uniform8(any_name()),
        sort in 0..5usize,
    ) {
        let plain = names.each_ref().map(|name| harmless(name));
        let (shown, expected) = (shown_of(&names, sort), shown_of(&plain, sort));
        for ((code, out, err), (expected_code, expected_out, expected_err)) in shown.iter().zip(&expected) {
            assert_shown(out);
            assert_shown(err);
            prop_assert_eq!(code, expected_code, "{}{}\n{}{}", out, err, expected_out, expected_err);
            let lines = |text: &str| text.matches('\n').count();
            prop_assert_eq!(lines(out), lines(expected_out), "{}\n{}", out, expected_out);
            prop_assert_eq!(lines(err), lines(expected_err), "{}\n{}", err, expected_err);
        }
    }
}
