//! Several sources on one topic are never mixed into one that does not exist.

use flightcam::{Input, Output};
use serde_json::{Value, json};

use crate::support::{folder::*, topics::*};

/// States of a drone; the n-th message also has what `id` returns for n.
fn with_ids(count: i32, id: impl Fn(i32) -> Value) -> Topic {
    let messages = (0..).zip(states(count, 1.0)).map(|(n, mut state)| {
        let id = id(n);
        let object = state.as_object_mut().expect("an object");
        object.extend(id.as_object().expect("an object").clone());
        state
    });
    topic("/state", messages.collect::<Vec<_>>())
}

#[test]
fn sources_that_a_field_tells_apart_are_an_error_that_lists_them() {
    let text = |n: i32| if n % 2 == 0 { "uav1" } else { "uav2" };
    for (id, words) in [
        (
            (|n| json!({ "vehicle_id": 1 + n % 2 })) as fn(i32) -> Value,
            "several sources write to /state: its `vehicle_id` is 1 or 2 … '/state{vehicle_id==1}'",
        ),
        (
            |n| json!({ "system_id": n / 50 }),
            "its `system_id` is 0 or 1",
        ),
        (
            |n| json!({ "header": { "system_id": 10 * (n % 3) } }),
            "its `header.system_id` is 0 or 10 or 20",
        ),
    ] {
        let folder = Folder::with(LOG, log(&[with_ids(100, id)]));
        folder.refuses(&format!("enrich {LOG} --depression 30"), 1, words);
        folder.refuses(
            &format!("enrich {LOG} --depression 30 --in-place"),
            1,
            words,
        );
        let (out, _) = folder.run(&format!("inspect {LOG} --depression 30"), 1);
        assert_reads(&out, &format!("enrich would fail: … {words}"));
    }
    let folder = Folder::with(LOG, log(&[with_ids(100, |n| json!({ "uav_id": text(n) }))]));
    let words = r#"its `uav_id` is "uav1" or "uav2""#;
    folder.refuses(&format!("enrich {LOG} --depression 30"), 1, words);
}

/// What the hint of an error says to type, with words in the place of `…`.
fn hinted(folder: &Folder, arguments: &[&str], words: &str) -> Vec<String> {
    let (code, _, err) =
        folder.run_with(&[&["enrich", LOG, "--depression", "30", "--force"], arguments].concat());
    assert_eq!(code, 1, "{err}");
    let (_, hint) = err
        .split_once("for instance with ")
        .unwrap_or_else(|| panic!("{err}"));
    let (option, value) = hint
        .trim()
        .split_once(' ')
        .expect("an option and its value");
    let value = value.trim_matches('\'').replace("…", words);
    vec![option.to_owned(), value]
}

#[test]
fn what_the_hint_says_chooses_one_source() {
    let folder = Folder::with(
        LOG,
        log(&[with_ids(100, |n| json!({ "vehicle_id": 1 + n % 2 }))]),
    );
    let chosen = hinted(&folder, &[], "");
    assert_eq!(chosen, ["--attitude", "/state{vehicle_id==1}"]);
    // What else is in these messages is that source's, too.
    let report = folder.reports(
        &format!("enrich {LOG} --depression 30 {}", chosen.join(" ")),
        0,
    );
    for kind in ["attitude", "velocity"] {
        assert_eq!(report[kind]["used"], 50, "{kind}");
        assert_eq!(report[kind]["unselected"], 50, "{kind}");
    }

    let given = "/state.roll,/state.pitch,/state.yaw:radians";
    let chosen = hinted(&folder, &["--attitude", given], "radians");
    let expected = ["roll", "pitch", "yaw"].map(|name| format!("/state{{vehicle_id==1}}.{name}"));
    assert_eq!(chosen, ["--attitude", &(expected.join(",") + ":radians")]);
}

#[test]
fn what_the_hint_says_chooses_one_element_of_a_list() {
    let transforms = (0..60).map(|n| {
        let transform = |name: &str, w: f64| json!({ "child_frame_id": name, "q": [w, 1.0, 0, 0] });
        let [a, b] = [transform("a", 0.01 * f64::from(n)), transform("b", 1.0)];
        json!({ "transforms": if n % 2 == 0 { [a, b] } else { [b, a] } })
    });
    let folder = Folder::with(LOG, log(&[topic("/tf", transforms)]));
    let given = ["--attitude", "/tf.transforms[0].q:frd-ned"];
    let chosen = hinted(&folder, &given, "frd-ned");
    let path = r#"/tf.transforms[:]{child_frame_id=="a"}.q:frd-ned"#;
    assert_eq!(chosen, ["--attitude", path]);
    let report = folder.reports(
        &format!("enrich {LOG} --depression 30 {}", chosen.join(" ")),
        0,
    );
    assert_eq!(report["attitude"]["used"], 60);
}

#[test]
fn an_id_that_does_not_change_and_a_count_are_no_sources() {
    for id in [
        (|_| json!({ "vehicle_id": 7, "child_frame_id": "base_link" })) as fn(i32) -> Value,
        // It counts.
        |n| json!({ "instance": n }),
        // A name that says nothing of a source.
        |n| json!({ "mode": n % 2 }),
    ] {
        let folder = Folder::with(LOG, log(&[with_ids(100, id)]));
        folder.writes(RESULT, &format!("enrich {LOG} --depression 30"), 0);
    }
}

/// What is found at the end of the telemetry must not have cost a stream the log.
#[test]
fn a_stream_gets_the_log_as_it_is_if_its_sources_are_mixed() {
    let log = log(&[with_ids(3000, |n| json!({ "vehicle_id": n % 2 }))]);
    let folder = Folder::with(LOG, &log);
    let options = flightcam::Options::new()
        .depression(flightcam::DepressionAngle::from_degrees(30.0).expect("an angle"));
    let path = folder.path(LOG);
    for is_piped in [false, true] {
        let mut out = Vec::new();
        let input = match is_piped {
            false => Input::from(path.as_path()),
            true => Input::Stream {
                name: "the input".into(),
                stream: Box::new(log.as_slice()),
            },
        };
        let output = Output::Stream {
            name: "the output".into(),
            stream: Box::new(&mut out),
        };
        let error = flightcam::enrich(input, output, &options).expect_err("mixed sources");
        assert_reads(
            &error.to_string(),
            "several sources … the log was passed on as it came",
        );
        assert!(
            out == log,
            "{is_piped}: {} of {} bytes",
            out.len(),
            log.len()
        );
    }
}
