//! `flightcam enrich` as a user sees it: arguments in; exit code, words and files out.
//!
//! Each run is checked for more than its own test asks: see [`Folder::refuses`] and [`Folder::writes`].

mod refusals;
mod report;

use std::{collections::BTreeMap, f64::consts::PI, fs, path::Path};

use mcap::MessageStream;
use serde_json::{Value, json};

use crate::support::{DERIVED, folder::*, topics::*};

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
fn an_existing_output_is_replaced_only_with_force() {
    let folder = Folder::with_flight();
    folder.add(RESULT, "an older result");
    let message = "flight.enriched.mcap: exists already … -o … --force";
    folder.refuses(&enrich(""), 1, message);
    folder.writes(RESULT, &enrich("--force"), 0);
    let counts = count_messages(&folder.read(RESULT));
    assert_eq!(counts["/camera/velocity"], 3310);
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
fn the_requested_encoding_is_written_and_the_advice_names_its_fields() {
    let own = "flightcam.v1.CameraOrientation … \
               /camera/relative_rpy.yaw, /camera/orientation.yaw and /camera/velocity.x.";
    let ros2 = "geometry_msgs/msg/QuaternionStamped … /camera/relative_rpy.vector.z, \
                /camera/orientation.quaternion.z and /camera/velocity.vector.x.";
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
fn degrees_are_read_with_flat_deg_and_refused_without_it() {
    let folder = Folder::with(LOG, state_log(PI / 180.0));
    folder.refuses(
        &enrich(""),
        1,
        "use --profile flat-deg; --trust goes on regardless",
    );
    let [radians, degrees, mistaken] = [
        (1.0, "", false),
        (PI / 180.0, "--profile flat-deg", false),
        (PI / 180.0, "--trust", true),
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
#[cfg(unix)]
fn the_result_has_the_permissions_of_the_log() {
    use std::os::unix::fs::PermissionsExt;

    let folder = Folder::with_flight();
    fs::set_permissions(folder.path(LOG), fs::Permissions::from_mode(0o640)).unwrap();
    folder.writes(RESULT, &enrich(""), 0);
    let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
    assert_eq!(mode(&folder.path(RESULT)) & 0o777, 0o640);
}
