//! The ground of `--visuals`, from logs that have heights above it and from logs that have none.

use std::io::Cursor;

use flightcam::{
    Input, Layout, Options, Report, enrich,
    report::{GroundBecause, GroundReport},
    run::Output,
    sample::{DropReason, Kind},
    visuals::{Ground, VisualOptions},
};
use serde_json::{Value as Json, json};

use crate::support::{
    enrich_bytes_with,
    flights::{Recording, flight::Flight, recordings_for},
    folder::*,
    options,
    topics::{log as log_of, topic},
};

fn showing(visuals: VisualOptions) -> Options {
    options().visuals(visuals)
}

fn recorded(profile: &str, name: &str) -> Recording {
    let wanted = format!("{profile}: {name}");
    let mut recordings = recordings_for(profile);
    let found = recordings.find(|recording| recording.name == wanted);
    found.unwrap_or_else(|| panic!("there is no recording {wanted}"))
}

/// A PX4 log with a height above the ground beside each position on the globe.
fn px4_log() -> Vec<u8> {
    recorded("px4-ulog", "Foxglove's Python converter").log()
}

fn report(log: &[u8], options: &Options) -> Report {
    enrich_bytes_with(log, options).expect("a result").1
}

fn ground(report: &Report) -> GroundReport {
    let visuals = report.visuals.as_ref().expect("a report on visuals");
    visuals.ground.clone().expect("positions are known")
}

fn json(report: &Report) -> Json {
    serde_json::to_value(report).expect("JSON")
}

#[test]
fn the_heights_of_a_px4_log_say_where_the_ground_is() {
    let report = report(&px4_log(), &showing(VisualOptions::new()));
    let flight = Flight::new();
    let heights = &report.samples[&Kind::Height];
    assert_eq!(
        heights.topic.as_ref().expect("a topic").as_str(),
        "/vehicle_local_position"
    );
    assert_eq!(heights.tally.used, flight.position_times.len() as u64);
    let unmarked = heights.tally.dropped[&DropReason::MarkedInvalid];
    assert_eq!(
        unmarked,
        (flight.velocity_times.len() + flight.invalid_times.len()) as u64
    );

    let altitudes = flight.position_times.iter();
    let altitudes = altitudes.map(|&time| flight.geodetic(time)[2] - flight.height(time));
    let (low, high) = altitudes.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), ground| {
        (low.min(ground), high.max(ground))
    });
    let GroundBecause::Measured {
        topic,
        samples,
        lowest_m,
        highest_m,
        share,
    } = ground(&report).because
    else {
        panic!("{:?}", ground(&report));
    };
    assert_eq!(
        (topic.as_str(), samples),
        ("/vehicle_local_position", heights.tally.used)
    );
    // Ticks are between the heights.
    assert!(
        low - 1e-3 < lowest_m && lowest_m < low + 0.5,
        "{lowest_m} m, not {low} m"
    );
    assert!(
        high - 0.5 < highest_m && highest_m < high + 1e-3,
        "{highest_m} m, not {high} m"
    );
    assert!(share > 0.98, "{share}");
    let in_json = &json(&report);
    assert_eq!(in_json["height"]["used"], heights.tally.used);
    assert_eq!(in_json["visuals"]["ground"]["because"], "measured");
    assert_eq!(
        in_json["visuals"]["ground"]["topic"],
        "/vehicle_local_position"
    );
}

#[test]
fn heights_are_read_only_where_they_are_shown() {
    let without_visuals = json(&report(&px4_log(), &options()));
    assert_eq!(without_visuals.get("height"), None);
    assert_eq!(without_visuals["position"], Json::Null);

    let given = showing(VisualOptions::new().ground(Ground::Altitude(12.5)));
    let given = report(&px4_log(), &given);
    assert_eq!(json(&given).get("height"), None);
    assert_eq!(
        json(&given)["visuals"]["ground"],
        json!({"altitude_m": 12.5, "because": "given"})
    );
}

#[test]
fn a_log_in_a_pipe_has_the_same_ground() {
    for (profile, name) in [
        ("px4-ulog", "Foxglove's Python converter"),
        ("mavros", "local position"),
    ] {
        let log = recorded(profile, name).log();
        let options = showing(VisualOptions::new());
        let mut result = Vec::new();
        let input = Input::stream("log", Cursor::new(&log));
        let piped = enrich(input, Output::stream("result", &mut result), &options);
        let piped = piped.expect("a result");
        let of_file = report(&log, &options);
        assert_eq!(ground(&piped), ground(&of_file), "{name}");
        assert!(
            matches!(ground(&piped).because, GroundBecause::Measured { .. }),
            "{name}"
        );
        assert_eq!(piped.samples, of_file.samples, "{name}");
    }
}

#[test]
fn interleaved_the_ground_and_the_counts_are_the_same() {
    let log = px4_log();
    let appended = showing(VisualOptions::new());
    let interleaved = appended.clone().layout(Layout::Interleaved);
    let [appended, interleaved] = [appended, interleaved].map(|options| report(&log, &options));
    assert_eq!(ground(&appended), ground(&interleaved));
    assert_eq!(appended.samples, interleaved.samples);
}

#[test]
fn without_usable_heights_the_take_off_is_assumed_and_the_report_says_so() {
    let log = recorded("px4-ulog", "JSON").log();
    let folder = Folder::with(LOG, &log);
    let shown = format!("enrich {LOG} --depression 30 --visuals");
    assert!(folder.writes(RESULT, &shown, 0).contains("ground from"));
    let given = folder.writes(RESULT, &format!("{shown} --force --ground takeoff"), 0);
    assert!(
        given.contains("that of the take-off, as asked for"),
        "{given}"
    );

    let log = recorded("dji-osdk", "from broadcast").log();
    let folder = Folder::with(LOG, &log);
    let assumed = folder.writes(RESULT, &shown, 0);
    assert!(
        assumed.contains("that of the take-off, which is assumed"),
        "{assumed}"
    );
    assert!(!assumed.contains("Height"), "{assumed}");
}

/// A logger of the user's own, with the heights of two sensors.
const TWO_SENSORS: &str = r#"
    name = "two-sensors"
    [attitude]
    topics = ["/state"]
    orientation.euler = { roll = "roll", pitch = "pitch", yaw = "yaw", unit = "radians" }
    [position]
    topics = ["/state"]
    local = { vector = "place", frame = "ned" }
    [height]
    topics = ["/range"]
    field = "distance"
    unit = "cm"
"#;

#[test]
fn of_two_sensors_on_one_topic_the_profile_has_to_say_which_is_meant() {
    let state = |_| json!({"roll": 0, "pitch": 0, "yaw": 0, "place": [0, 0, -30]});
    let range = |number| json!({"sensor_id": number % 2, "distance": 1000 + number % 2 * 500});
    let log = log_of(&[
        topic("/state", (0..200).map(state)),
        topic("/range", (0..200).map(range)),
    ]);
    let folder = Folder::with(LOG, &log);
    folder.add("mine.toml", TWO_SENSORS);
    let run = format!("enrich {LOG} --depression 30 --profile mine.toml");
    folder.refuses(
        &format!("{run} --visuals"),
        1,
        "/range … sensor_id … `select` in the profile",
    );
    // Without visuals nobody asks for heights.
    folder.writes(RESULT, &run, 0);

    let select = format!("{TWO_SENSORS}    select = [\"sensor_id==1\"]\n");
    folder.add("mine.toml", select);
    let report = folder.writes(RESULT, &format!("{run} --visuals --force"), 0);
    assert_reads(
        &report,
        "Height … /range: 100 of 100 samples used … cm above the ground … 100 messages of another source left out … \
         ground from 15.0 to 15.0 m by 100 heights of /range",
    );
}
