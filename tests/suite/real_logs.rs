//! Real flights give the results of an independent implementation of the design.

use std::fs;

use flightcam::{Report, messages::Encoding, sample::Kind};

use crate::support::{expected::assert_as_expected, orientations::check_orientations, *};

/// Checks a real log's result against the expected one to 1e-9; `None` where there are no real logs.
fn check(name: &str) -> Option<Report> {
    check_against(name, name)
}

/// The same, with the expected result of a log of another name.
fn check_against(name: &str, expectations: &str) -> Option<Report> {
    let folder = real_logs()?;
    let log = fs::read(folder.join(format!("{name}.mcap"))).expect("the log");
    let csv = folder.join(format!("{expectations}.expected.csv"));
    let csv = fs::read_to_string(csv).expect("the numbers");
    let (result, report) = enrich_bytes(&log).expect("the log is enriched");

    let derived = judge(&log, &result, false);
    let orientations = check_orientations(&derived).len() as u64;
    assert_eq!(orientations, report.samples[&Kind::Attitude].tally.used);
    assert_as_expected(derived, &csv);
    Some(report)
}

fn used(report: &Report) -> (u64, u64) {
    let used = |kind| report.samples[&kind].tally.used;
    (used(Kind::Attitude), used(Kind::Velocity))
}

#[test]
fn a_real_flight_gives_every_rotation_and_velocity() {
    let Some(report) = check("test_ulog") else {
        return;
    };
    assert_eq!(report.profile.name, "px4-ulog");
    assert_eq!(used(&report), (131, 66));
}

#[test]
fn the_same_flight_recorded_in_ros2_gives_the_same() {
    let Some(report) = check_against("test_ulog.ros2", "test_ulog") else {
        return;
    };
    assert_eq!(report.profile.name, "px4-ros2");
    assert_eq!(report.encoding.name, Encoding::Ros2);
    assert_eq!(used(&report), (131, 66));
}

#[test]
fn resets_of_the_estimator_and_invalid_velocities_are_left_out() {
    let Some(report) = check("sample_px4_events") else {
        return;
    };
    assert_eq!(report.breaks.resets, 2);
    let dropped: Vec<(&str, u64)> = report.samples[&Kind::Velocity]
        .tally
        .dropped
        .iter()
        .map(|(reason, count)| (reason.name(), *count))
        .collect();
    assert_eq!(
        dropped,
        [
            ("marked_invalid", 98),
            ("outside_attitude", 1),
            ("across_attitude_reset", 1)
        ]
    );
}

#[test]
fn a_flight_without_a_valid_velocity_still_has_its_rotations_and_orientations() {
    let Some(report) = check("sample_log_small") else {
        return;
    };
    assert_eq!(report.written.len(), 2);
    let [missing] = &report.not_written[..] else {
        panic!("one topic is missing")
    };
    assert_eq!(missing.topic, "/camera/velocity");
    assert!(
        missing.reason.to_string().contains("636 marked invalid"),
        "{}",
        missing.reason
    );
}
