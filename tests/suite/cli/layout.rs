//! `flightcam layout` as a user meets it.

use serde_json::Value;

use crate::support::{folder::*, topics, viewing::panels};

/// With the demonstration flight as [`RESULT`], enriched, and nothing else.
fn with_result() -> Folder {
    let folder = Folder::with_flight();
    folder.run(
        &format!("enrich {LOG} --depression 30 --visuals --visual-rate 5"),
        0,
    );
    Folder::with(RESULT, folder.read(RESULT))
}

#[test]
fn a_layout_goes_to_standard_output_or_to_a_file() {
    let folder = with_result();
    let (printed, err) = folder.run(&format!("layout {RESULT}"), 0);
    assert_eq!(err, "");
    let layout: Value = serde_json::from_str(&printed).expect("one JSON document");
    assert!(panels(&layout).len() > 8);
    let (same, _) = folder.run(&format!("layout {RESULT} -o - --for lichtblick"), 0);
    assert_eq!(same, printed);
    let out = folder.writes("layout.json", &format!("layout {RESULT} -o layout.json"), 0);
    assert_eq!(out, "");
    assert_eq!(folder.read("layout.json"), printed.as_bytes());
}

#[test]
fn a_file_that_exists_is_replaced_only_if_that_is_asked_for() {
    let folder = with_result();
    folder.add("layout.json", "mine");
    folder.refuses(
        &format!("layout {RESULT} -o layout.json"),
        1,
        "layout.json: exists already … hint: … --force",
    );
    let arguments = format!("layout {RESULT} -o layout.json --force --for foxglove");
    folder.writes("layout.json", &arguments, 0);
    let layout: Value = serde_json::from_slice(&folder.read("layout.json")).expect("JSON");
    assert_eq!(layout["version"], 1);
}

#[test]
fn the_log_itself_is_never_replaced() {
    with_result().refuses(
        &format!("layout {RESULT} -o {RESULT} --force"),
        2,
        "the output would replace the input",
    );
}

#[test]
fn a_log_that_is_not_enriched_is_an_error_that_says_what_to_do() {
    Folder::with_flight().refuses(
        &format!("layout {LOG} -o layout.json"),
        1,
        "flight.mcap: is not enriched … hint: … `flightcam enrich flight.mcap --visuals`",
    );
    Folder::with_flight().refuses("layout missing.mcap", 1, "missing.mcap: ");
    Folder::with_flight().refuses("layout -", 2, "the log must be a file … hint: save the log");
}

#[test]
fn a_log_that_breaks_off_is_read_as_far_as_possible() {
    let mut log = with_result().read(RESULT);
    log.truncate(log.len() * 3 / 4);
    let folder = Folder::with(LOG, log);
    let (printed, err) = folder.run(&format!("layout {LOG}"), 3);
    assert_reads(&err, "warning: flight.mcap: …");
    serde_json::from_str::<Value>(&printed).expect("one JSON document");
}

#[test]
fn names_from_a_log_reach_no_terminal_as_they_are() {
    let place = topics::twice("/a\u{1b}[31mb", serde_json::json!({ "latitude": 1 }));
    let state = serde_json::json!({
        "roll": 0, "pitch": 0, "yaw": 1, "vx": 1, "vy": 0, "vz": 0,
        "latitude": 47, "longitude": 8, "altitude": 500,
    });
    let log = topics::log(&[
        topics::twice("/state", state),
        place.of_type("foxglove.LocationFix"),
    ]);
    let folder = Folder::with(LOG, log);
    folder.run(&format!("enrich {LOG} --depression 30 --visuals"), 0);
    folder.run(&format!("layout {RESULT} -o layout.json"), 0);
    let (printed, _) = folder.run(&format!("layout {RESULT}"), 0);
    assert!(!printed.contains('\u{1b}'), "{printed}");
    assert_eq!(folder.read("layout.json"), printed.as_bytes());
    let layout: Value = serde_json::from_str(&printed).expect("JSON");
    let hidden = &layout["configById"]["map!map"]["disabledTopics"];
    assert_eq!(hidden[0], "/a\u{1b}[31mb");
}
