//! Conditions of a profile: misspelt ones are errors, and what they leave out is said with what was found.

use flightcam::{
    Error, Note,
    log::Log,
    sample::Kind,
    source::{Source, profile::Profile, request::Request},
};
use serde_json::{Value, json};

use crate::support::{folder::*, selecting::*, topics::*};

/// A profile whose first alternative has a condition, and whose second has none.
fn with_condition(condition: &str) -> Request {
    own(&format!(
        r#"name = "mine"
        [[attitude]]
        topics = ["/a"]
        {condition}
        orientation.quaternion = {{ fields = "q", order = "xyzw" }}
        convention = "frd-ned"
        [[attitude]]
        topics = ["/a"]
        orientation.quaternion = "q"
        convention = "frd-ned"
        "#
    ))
}

fn message(frame: Value) -> Value {
    json!({ "q": [1, 0, 0, 0], "frame": frame, "ok": true })
}

#[test]
fn a_misspelt_field_of_a_condition_is_an_error_although_another_alternative_fits() {
    let log = [twice("/a", message(json!(1)))];
    for (condition, field) in [
        (r#"when = { field = "frme", is = 1 }"#, "frme"),
        (r#"when = { field = "frme", says = "ned" }"#, "frme"),
        (r#"valid = ["ok", "frme"]"#, "frme"),
    ] {
        let error = select_with(&log, &with_condition(condition)).expect_err("an error");
        assert_reads(
            &error.to_string(),
            &format!(
                "`mine` does not fit: an alternative of `attitude` would never be used, because no message has the field \
                 of its `when` or `valid`: /a: it has no field `{field}`; did you mean `frame`?"
            ),
        );
    }
    for condition in [r#"when = { field = "frame", is = 1 }"#, r#"valid = ["ok"]"#] {
        let source = select_with(&log, &with_condition(condition)).expect("a source");
        assert_eq!(source.attitude().topic, "/a");
    }
}

#[test]
fn a_misspelt_field_is_an_error_in_every_role_and_in_one_of_several_topics() {
    let toml = |topics: &str| {
        format!(
            r#"name = "mine"
            [attitude]
            topics = ["/a"]
            orientation.quaternion = "q"
            convention = "frd-ned"
            [[velocity]]
            topics = [{topics}]
            when = {{ field = "mode", is = 1 }}
            vector = "v"
            frame = "ned"
            [[velocity]]
            topics = ["/b", "/c"]
            vector = "v"
            frame = "enu"
            "#
        )
    };
    let velocity = |name, mode: &str| twice(name, json!({ "v": [1, 2, 3], mode: 1 }));
    let topics = [
        attitude("/a"),
        velocity("/b", "Mode"),
        velocity("/c", "mode"),
    ];
    let error = select_with(&topics, &own(&toml(r#""/b""#))).expect_err("an error");
    assert_reads(
        &error.to_string(),
        "of `velocity` would never be used … /b: it has no field `mode`; did you mean `Mode`?",
    );
    // One of its topics has the field.
    assert!(select_with(&topics, &own(&toml(r#""/b", "/c""#))).is_ok());
}

#[test]
fn an_alternative_for_another_version_of_the_messages_is_no_error() {
    let versions = r#"name = "mine"
        [[attitude]]
        topics = ["/a"]
        when = { field = "new_frame", is = 1 }
        orientation.quaternion = "orientation"
        convention = "frd-ned"
        [[attitude]]
        topics = ["/a"]
        schemas = ["New"]
        valid = ["new_ok"]
        orientation.quaternion = "q"
        convention = "frd-ned"
        [[attitude]]
        topics = ["/a"]
        orientation.quaternion = "q"
        convention = "frd-ned"
        "#;
    let log = [twice("/a", message(json!(1)))];
    assert!(select_with(&log, &own(versions)).is_ok());
}

#[test]
fn what_was_taken_over_from_a_built_in_profile_is_no_error() {
    let text = Profile::built_in_text("px4-ros2").expect("a profile");
    let mine = own(&text.replace("name = \"px4-ros2\"", "name = \"mine\""));
    for frame in ["pose_frame", "local_frame"] {
        let odometry =
            json!({ "q": [1, 0, 0, 0], frame: 1, "velocity_frame": 1, "velocity": [1, 0, 0] });
        let log = [twice("/fmu/out/vehicle_odometry", odometry)];
        let source = select_with(&log, &mine).expect("a source");
        assert_eq!(source.profile.name, "mine");
    }
}

// ---- What conditions leave out ----

const ONLY_NED: &str = r#"
name = "mine"
[[attitude]]
topics = ["/a"]
when = { field = "frame", is = 1 }
orientation.quaternion = "q"
convention = "frd-ned"
[[attitude]]
topics = ["/a"]
when = { field = "name", says = "ned" }
orientation.quaternion = "q"
convention = "frd-ned"
[[attitude]]
topics = ["/a"]
when = { field = "flags", has_bits = 48 }
orientation.quaternion = "q"
convention = "frd-ned"
"#;

fn messages() -> Vec<Value> {
    let frames = [(2, "enu", 4), (2, "enu", 4), (3, "\u{1b}x", 5), (1, "", 0)];
    let messages = frames.into_iter();
    messages
        .map(|(frame, name, flags)| json!({ "q": [1, 0, 0, 0], "frame": frame, "name": name, "flags": flags }))
        .collect()
}

#[test]
fn the_error_says_what_was_found_and_what_was_wanted() {
    let mut messages = messages();
    // The one that satisfies the conditions is no attitude.
    messages[3]["q"] = json!([0, 0, 0, 0]);
    let folder = Folder::with(LOG, log(&[topic("/a", messages)]));
    folder.add("mine.toml", ONLY_NED);
    let found = "frame was 2 (2 times), 3 (once), wanted 1; name was \"enu\" (2 times), \"\\u{1b}x\" (once), wanted \
                 \"ned\"; flags was 4 (2 times), 5 (once), wanted any bit of 48";
    let arguments = format!("enrich {LOG} --depression 30 --profile mine.toml");
    let message = format!(
        "nothing can be derived … /a has 0 of 4 usable, 3 left out by the profile's conditions (`when`), \
         1 with a quaternion that is not a rotation; {found}"
    );
    folder.refuses(&arguments, 1, &message);
    let (out, _) = folder.run(&format!("inspect {LOG} --profile mine.toml"), 1);
    assert_reads(
        &out,
        &format!("Note … 3 attitude samples of /a were left out: {found}"),
    );
}

#[test]
fn the_report_says_what_was_found_and_what_was_wanted() {
    let messages = [messages(), messages()].concat();
    let folder = Folder::with(LOG, log(&[topic("/a", messages)]));
    folder.add(
        "mine.toml",
        ONLY_NED
            .split("[[attitude]]")
            .take(2)
            .collect::<Vec<_>>()
            .join("[[attitude]]"),
    );
    let arguments = format!("enrich {LOG} --depression 30 --profile mine.toml");
    let report = folder.writes(RESULT, &arguments, 0);
    assert_reads(
        &report,
        "2 of 8 samples used … 6 dropped: left out by the profile's conditions (`when`) … Note … 6 attitude samples of /a \
         were left out: frame was 2 (4 times), 3 (2 times), wanted 1",
    );
    let report = folder.reports(&format!("{arguments} --force"), 0);
    assert_eq!(
        report["attitude"]["dropped"],
        json!({ "unmet_condition": 6 })
    );
    let note = json!({
        "kind": "unmet_conditions",
        "sample": "attitude",
        "topic": "/a",
        "samples": 6,
        "conditions": [{
            "field": "frame",
            "wanted": [{ "is": 1 }],
            "found": [{ "value": "2", "messages": 4 }, { "value": "3", "messages": 2 }],
            "others": 0,
        }],
    });
    assert_eq!(report["notes"], json!([note]));
}

#[test]
fn only_the_first_few_values_are_remembered() {
    let messages = (0..40).map(|n| message(json!(n % 20 + 2)));
    let request = own(r#"name = "mine"
        [attitude]
        topics = ["/a"]
        when = { field = "frame", is = 1 }
        orientation.quaternion = "q"
        convention = "frd-ned"
        "#);
    let folder = Folder::with(LOG, log(&[topic("/a", messages)]));
    let log = Log::open(&folder.path(LOG)).expect("a log");
    let source = Source::select(&log, &request).expect("a source");
    // Two that share the messages, as two threads do.
    let [mut one, mut other] = [source.clone(), source];
    let ids = one.channel_ids();
    let mut segments = flightcam::log::SegmentReader::new(&log);
    let mut place = 0;
    for segment in &log.contents.segments {
        for read in segments.read(segment, &ids).expect("messages") {
            let reader = if place % 2 == 0 { &mut one } else { &mut other };
            reader.read(&read.expect("a message"), |_, _| {});
            place += 1;
        }
    }
    one.merge(&other);
    let (samples, conditions) = one.unmet_conditions(Kind::Attitude);
    assert_eq!(samples, 40);
    let [condition] = &conditions[..] else {
        panic!("{conditions:?}");
    };
    assert_eq!(condition.found.len(), 10);
    let found: u64 = condition.found.iter().map(|found| found.messages).sum();
    assert_eq!(found + condition.others, 40);
    assert_reads(
        &condition.to_string(),
        "frame was 2 (2 times) … something else (20 times), wanted 1",
    );
}

// ---- Degrees read as radians ----

#[test]
fn the_advice_on_degrees_fits_how_the_angles_were_asked_for() {
    let folder = Folder::with(LOG, log(&[topic("/state", states(50, 0.017))]));
    let angles = r#"orientation.euler = { roll = "/state.roll", pitch = "/state.pitch", yaw = "/state.yaw", unit = "radians" }"#;
    folder.add(
        "mine.toml",
        format!("name = \"mine\"\n[attitude]\n{angles}\n"),
    );
    for (arguments, advice, by) in [
        ("", "use --profile flat-deg", "built_in"),
        ("--profile flat", "use --profile flat-deg", "built_in"),
        (
            "--attitude /state.roll,/state.pitch,/state.yaw:radians",
            "put :degrees after the fields of --attitude",
            "argument",
        ),
        (
            "--profile mine.toml",
            "write unit = \"degrees\" for the attitude in the profile mine",
            "own_profile",
        ),
    ] {
        let command = format!("enrich {LOG} --depression 30 --force {arguments}");
        let words = format!("cannot be radians … if they are degrees, {advice}");
        folder.refuses(&command, 1, &words);
        let command = format!("{command} --trust");
        let report = folder.writes(RESULT, &command, 0);
        assert_reads(
            &report,
            &format!("Note … read as radians … if they are degrees, {advice}"),
        );
        let report = folder.reports(&command, 0);
        assert_eq!(report["notes"][0]["asked"]["by"], by);
    }
}

#[test]
fn a_note_is_data_for_whoever_uses_the_library() {
    let folder = Folder::with(LOG, log(&[topic("/a", [messages(), messages()].concat())]));
    let options = flightcam::Options::new()
        .depression(flightcam::DepressionAngle::from_degrees(30.0).expect("an angle"))
        .telemetry(own(ONLY_NED
            .split("[[attitude]]")
            .take(2)
            .collect::<Vec<_>>()
            .join("[[attitude]]")
            .as_str()));
    let report = flightcam::enrich(folder.path(LOG), folder.path(RESULT), &options);
    let notes = report
        .map_err(|error: Error| error.to_string())
        .expect("a report")
        .notes;
    let [Note::UnmetConditions { conditions, .. }] = &notes[..] else {
        panic!("{notes:?}");
    };
    assert_eq!(conditions[0].found[0].messages, 4);
}
