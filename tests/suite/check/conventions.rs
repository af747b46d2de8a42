//! Logs of each publisher, read with one convention broken: what a check says of it.

mod broken;

use std::{collections::BTreeMap, fmt::Write as _};

use broken::{BREAKS, Examined, Verdict, examine, examine_broken, examine_late, late};
use flightcam::sample::Kind;

use crate::support::{
    flights::{Recording, recordings, recordings_for},
    manoeuvres::Manoeuvre,
};

/// A recording of a flight that has everything.
fn flown(profile: &str, name: &str) -> Recording {
    let wanted = format!("{profile}: {name}");
    let mut recordings = recordings_for(profile);
    let found = recordings.find(|recording| recording.name == wanted);
    let found = found.unwrap_or_else(|| panic!("there is no recording {wanted}"));
    found.of_manoeuvre(Manoeuvre::Free, 40.0)
}

#[test]
fn a_log_is_proven_as_it_is_and_condemned_with_a_convention_broken() {
    for (profile, name, breaks) in [
        (
            "px4-ros2",
            "attitude and local position",
            &["velocity enu", "attitude flu-enu"][..],
        ),
        (
            "mavros",
            "IMU and body velocity in ROS 1",
            &["velocity body-frd", "attitude flu-nwu"],
        ),
    ] {
        let recording = flown(profile, name);
        let log = recording.log();
        let right = examine(&log, &recording);
        assert_eq!(right.verdict, Verdict::Right, "{name}: {:#?}", right.report);
        for wanted in breaks {
            let found = BREAKS.iter().find(|one| one.name == *wanted);
            let found = found.unwrap_or_else(|| panic!("there is no break {wanted}"));
            let broken = examine_broken(&log, &recording, &right.report, found);
            assert_eq!(broken.verdict, Verdict::Condemned, "{:#?}", broken.report);
        }
    }
}

/// Prints what a check says of each publisher's log of a manoeuvre, by break. With optimisation, each takes a minute:
/// `cargo test --release --test suite -- --ignored --nocapture table_of_breaks`.
fn print_table(manoeuvre: Manoeuvre) {
    let mut counts: BTreeMap<String, BTreeMap<Verdict, u32>> = BTreeMap::new();
    let mut details = String::new();
    for recording in recordings().into_iter().filter(is_in_table) {
        let recording = recording.of_manoeuvre(manoeuvre, 60.0);
        let log = recording.log();
        let mut count = |name: &str, Examined { verdict, report }: &Examined| {
            *counts
                .entry(name.to_owned())
                .or_default()
                .entry(*verdict)
                .or_default() += 1;
            let _ = writeln!(
                details,
                "{manoeuvre:?}, {}, {name}: {verdict:?} {:?}\n{}",
                recording.name,
                report.findings.explanations,
                broken::summary(report),
            );
        };
        let right = examine(&log, &recording);
        count("none", &right);
        for broken in &BREAKS {
            let examined = examine_broken(&log, &recording, &right.report, broken);
            if examined.verdict != Verdict::Unbroken {
                count(broken.name, &examined);
            }
        }
        for milliseconds in [50, 200, 1000] {
            if let Some(log) = late(&log, &right.report, milliseconds) {
                let name = format!("velocity {milliseconds} ms late");
                count(&name, &examine_late(&log, &recording, milliseconds));
            }
        }
    }
    println!("{details}");
    for (name, counts) in counts {
        println!("{manoeuvre:?}\t{name}\t{counts:?}");
    }
}

/// A table of each manoeuvre, so that they are made side by side.
macro_rules! print_tables {
    ($($test:ident: $manoeuvre:ident,)*) => {
        $(
            #[test]
            #[ignore = "makes the table in docs/check.md"]
            fn $test() {
                print_table(Manoeuvre::$manoeuvre);
            }
        )*
    };
}

print_tables! {
    table_of_breaks_in_free_flight: Free,
    table_of_breaks_in_a_survey: Survey,
    table_of_breaks_in_an_orbit: Orbit,
    table_of_breaks_in_a_plane: Wing,
    table_of_breaks_along_a_line: Line,
    table_of_breaks_in_a_hover: Hover,
}

/// One recording of each kind: not all spellings of `flat`, nor the same in other encodings.
fn is_in_table(recording: &Recording) -> bool {
    [
        "px4-ulog: Foxglove's Python converter",
        "px4-ulog: mcap convert",
        "px4-ulog: JSON",
        "px4-ros2: attitude and local position",
        "px4-ros2: odometry in body FRD",
        "mavros: local position",
        "mavros: IMU and body velocity in ROS 1",
        "ardupilot-ros2: pose and receiver",
        "dji-osdk: from broadcast",
        "dji-osdk: from subscription",
        "nav-msgs: nav_msgs/msg/Odometry",
        "flat: roll, vx, lat",
        "flat-deg: roll, vx, lat",
    ]
    .contains(&recording.name.as_str())
}

#[test]
fn profiles_say_where_angular_rates_and_accelerations_are() {
    for (profile, name) in [
        ("px4-ulog", "mcap convert"),
        ("dji-osdk", "from subscription"),
        ("ardupilot-ros2", "pose and receiver"),
    ] {
        let recording = flown(profile, name);
        let examined = examine(&recording.log(), &recording);
        for kind in [Kind::AngularRate, Kind::Acceleration] {
            assert!(examined.report.samples[&kind].tally.used > 0, "{name}");
        }
        assert_eq!(examined.verdict, Verdict::Right, "{:#?}", examined.report);
    }
}
