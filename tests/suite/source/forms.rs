//! Messages in several forms, of several types on one topic, and of several sources of which one is the primary one.

use flightcam::{
    Error,
    sample::Kind,
    source::{profile::Profile, request::Request},
};
use serde_json::{Value, json};

use crate::support::{
    folder::*,
    selecting::{parsed, select_with},
    topics::{Topic, log, topic},
};

#[test]
fn an_alternative_is_one_for_each_form() {
    let short = parsed(
        r#"
        name = "mine"
        forms = [{ type_field = "kind" }, { below = "body", type_field = "head.kind" }]

        [attitude]
        type = "A\"TT"
        when = { field = "state", says = "ok" }
        valid = ["fine", "flags[2]"]
        orientation.euler = { roll = "a.roll", pitch = "a.pitch", yaw = "a.yaw", unit = "degrees" }
        reset_counter = { field = "resets", optional = true }

        [velocity]
        topics = ["/velocity"]
        time.field = { path = "stamp", unit = "us" }
        vector = ["v.x", "v.y", "v.z"]
        frame = "ned"
        "#,
    );
    let long = parsed(
        r#"
        name = "mine"

        [[attitude]]
        select = ['kind=="A\"TT"']
        when = { field = "state", says = "ok" }
        valid = ["fine", "flags[2]"]
        orientation.euler = { roll = "a.roll", pitch = "a.pitch", yaw = "a.yaw", unit = "degrees" }
        reset_counter = { field = "resets", optional = true }

        [[attitude]]
        select = ['head.kind=="A\"TT"']
        when = { field = "body.state", says = "ok" }
        valid = ["body.fine", "body.flags[2]"]
        orientation.euler = { roll = "body.a.roll", pitch = "body.a.pitch", yaw = "body.a.yaw", unit = "degrees" }
        reset_counter = { field = "body.resets", optional = true }

        [[velocity]]
        topics = ["/velocity"]
        time.field = { path = "stamp", unit = "us" }
        vector = ["v.x", "v.y", "v.z"]
        frame = "ned"

        [[velocity]]
        topics = ["/velocity"]
        time.field = { path = "body.stamp", unit = "us" }
        vector = ["body.v.x", "body.v.y", "body.v.z"]
        frame = "ned"
        "#,
    );
    assert_eq!(short, long);
}

#[test]
fn a_type_needs_a_form_that_says_where_it_is() {
    for forms in ["", "forms = [{ below = \"body\" }]"] {
        let toml = format!(
            "name = \"mine\"\n{forms}\n[attitude]\ntype = \"ATT\"\norientation.quaternion = \"q\""
        );
        let problem = Profile::parse(&toml).expect_err("a problem").to_string();
        assert_reads(&problem, "unknown key `attitude.type`");
    }
}

/// A stream in which the attitude comes first after that many other messages.
fn stream(others: usize) -> Topic {
    let other = |i: usize| json!({ "mavpackettype": "PARAM_VALUE", "param_index": i });
    let states = (0..50).flat_map(|i| {
        let angle = f64::from(i) * 0.01;
        [
            json!({ "mavpackettype": "ATTITUDE", "roll": angle, "pitch": 0.1, "yaw": 0.2 }),
            json!({ "mavpackettype": "LOCAL_POSITION_NED", "vx": angle, "vy": 1.0, "vz": 0.5 }),
        ]
    });
    let heartbeat = std::iter::once(json!({ "mavpackettype": "HEARTBEAT", "type": 2 }));
    topic(
        "/mavlink",
        heartbeat.chain((0..others).map(other)).chain(states),
    )
}

#[test]
fn a_type_that_comes_late_on_a_topic_is_found() {
    for others in [0, 20, 900] {
        let source = select_with(&[stream(others)], &Request::default());
        let source = source.unwrap_or_else(|error| panic!("{others}: {error}"));
        assert_eq!(source.profile.name, "mavlink-stream");
        assert!(source.role(Kind::Velocity).is_some());
    }
}

/// Velocities of cores, and messages that name the primary one.
fn cores(numbers: &[u64], named: &[u64]) -> Vec<Topic> {
    let attitude = (0..20).map(|i| json!({ "Roll": 100 + i, "Pitch": 200, "Yaw": 300 }));
    let velocity = (0..20).flat_map(|_| {
        let of_core = |core: &u64| json!({ "C": core, "VN": 3.0, "VE": 1.0, "VD": 0.5 });
        numbers.iter().map(of_core).collect::<Vec<Value>>()
    });
    let mut topics = vec![
        topic("/ardupilot/ATT", attitude),
        topic("/ardupilot/XKF1", velocity),
    ];
    if !named.is_empty() {
        let names = named.iter().map(|core| json!({ "C": 0, "PI": core }));
        topics.push(topic("/ardupilot/XKF4", names));
    }
    topics
}

fn velocity_of(topics: &[Topic]) -> Result<String, Error> {
    let source = select_with(topics, &Request::default())?;
    Ok(source.role(Kind::Velocity).expect("a velocity").to_string())
}

#[test]
fn the_primary_source_is_the_one_that_most_messages_name() {
    for (named, core) in [(&[0, 0, 0][..], 0), (&[2; 5], 2), (&[0, 1, 1, 1], 1)] {
        let velocity = velocity_of(&cores(&[0, 1, 2], named)).expect("a velocity");
        assert!(
            velocity.starts_with(&format!("/ardupilot/XKF1{{C=={core}}}")),
            "{velocity}"
        );
    }
}

#[test]
fn without_a_name_one_source_is_taken_and_of_several_none() {
    let velocity = velocity_of(&cores(&[1], &[])).expect("a velocity");
    assert!(velocity.starts_with("/ardupilot/XKF1 has"), "{velocity}");
    let folder = Folder::with(LOG, log(&cores(&[0, 1], &[])));
    folder.refuses(
        &format!("enrich {LOG} --depression 30"),
        1,
        "error: … /ardupilot/XKF1 … `C` … 0 … 1",
    );
}

#[test]
fn integers_are_hundredths_of_a_degree_and_other_numbers_degrees() {
    let roll = |number: &str| {
        let messages = (0..3).map(|_| {
            let text = format!(r#"{{"Roll": {number}, "Pitch": {number}, "Yaw": {number}}}"#);
            serde_json::from_str::<Value>(&text).expect("JSON")
        });
        let folder = Folder::with(LOG, log(&[topic("/ardupilot/ATT", messages)]));
        let report = folder.run(&format!("inspect {LOG} --json"), 0).0;
        let report: Value = serde_json::from_str(&report).expect("JSON");
        let first = &report["telemetry"]["roles"]["attitude"]["first"];
        first["roll_deg"].as_f64().expect("a number")
    };
    for (number, degrees) in [
        ("2000", 20.0),
        ("20.0", 20.0),
        ("20.5", 20.5),
        ("-50", -0.5),
        ("0", 0.0),
    ] {
        assert!((roll(number) - degrees).abs() < 1e-9, "{number}");
    }
}
