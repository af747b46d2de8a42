//! Numbers of any size: what is written is finite and right, and what cannot be is dropped and counted.

use std::{fs, ops::ControlFlow};

use flightcam::{
    Options,
    camera::Mount,
    enrich::enrich,
    messages::{Encoding, EncodingChoice},
    report::Report,
    sample::{DropReason, Kind},
};
use proptest::prelude::*;
use prost::Message;
use prost_reflect::{DynamicMessage, Value};

use crate::support::{
    DERIVED, cases,
    folder::{Folder, LOG, RESULT, assert_reads},
    hostile_log,
    inspection::{found, inspected_with},
    logbook::{Logbook, request},
    message::DerivedMessage,
    options, repository,
    small_logs::dropped,
    stream,
};

const FIELDS: [&str; 6] = ["roll", "pitch", "yaw", "vx", "vy", "vz"];

/// Roll, pitch, yaw and the velocity, of any size: as floating-point numbers of 64 or 32 bits.
fn log_of(states: &[[f64; 6]], number: &str) -> Logbook {
    let mut log = Logbook::new();
    let fields = (1..).zip(FIELDS);
    let fields = fields.map(|(place, name)| format!("{number} {name} = {place};"));
    let definition = format!("message Message {{ {} }}", fields.collect::<String>());
    let (channel, message) = log.protobuf("/state", &definition);
    for (time, state) in (0..).zip(states) {
        let mut encoded = DynamicMessage::new(message.clone());
        for (name, &value) in FIELDS.iter().zip(state) {
            encoded.set_field_by_name(
                name,
                match number {
                    "float" => Value::F32(value as f32),
                    "int64" => Value::I64(value as i64),
                    _ => Value::F64(value),
                },
            );
        }
        log.put(channel, 20 * time, &encoded.encode_to_vec());
    }
    log
}

/// How such a log is read.
fn profile(angles: &str, speeds: &str, axes: &str) -> String {
    format!(
        r#"
        name = "any"
        [attitude]
        topics = ["/state"]
        orientation.euler = {{ roll = "roll", pitch = "pitch", yaw = "yaw", unit = "{angles}" }}
        [velocity]
        topics = ["/state"]
        vector = ["vx", "vy", "vz"]
        frame = "{axes}"
        unit = "{speeds}"
        "#
    )
}

/// The derived messages, none of which may have a number that is not finite.
fn written(log: Logbook, options: &Options) -> Option<(Vec<DerivedMessage>, Report)> {
    let (folder, input) = log.finish();
    let output = folder.path().join("result.mcap");
    let trusting = options.clone().trust(true);
    let report = match enrich(&input, &output, &trusting) {
        Ok(report) => report,
        Err(error) => {
            assert_reads(&error.to_string(), "nothing can be derived");
            return None;
        }
    };
    let messages = stream(&fs::read(output).expect("the result"), false);
    let of_ours = |topic: &str| DERIVED.contains(&topic);
    let derived: Vec<DerivedMessage> = (messages.iter())
        .filter(|message| of_ours(&message.topic))
        .map(DerivedMessage::decode)
        .collect();
    for message in &derived {
        let is_finite = message.numbers.iter().all(|number| number.is_finite());
        assert!(is_finite, "{message:?}");
    }
    Some((derived, report))
}

fn velocities(derived: &[DerivedMessage]) -> impl Iterator<Item = &DerivedMessage> {
    (derived.iter()).filter(|message| message.topic == "/camera/velocity")
}

fn length([x, y, z]: [f64; 3]) -> f64 {
    x.hypot(y).hypot(z)
}

const LEVEL: [f64; 3] = [0.0; 3];
const TILTED: [f64; 3] = [0.1, 0.2, 0.7];

fn state([roll, pitch, yaw]: [f64; 3], [x, y, z]: [f64; 3]) -> [f64; 6] {
    [roll, pitch, yaw, x, y, z]
}

#[test]
fn a_speed_beyond_the_largest_double_is_dropped_and_counted_in_every_encoding() {
    let beyond = [1.7e308; 3];
    let states = [[1.0, 2.0, 3.0], beyond, [-1.0; 3], beyond].map(|v| state(TILTED, v));
    for axes in ["ned", "enu", "body-frd", "body-flu"] {
        for encoding in Encoding::ALL {
            let options = options()
                .telemetry(request(&profile("radians", "m/s", axes)))
                .encoding(EncodingChoice::Given(encoding));
            let (derived, report) = written(log_of(&states, "double"), &options).expect("a result");
            let times = velocities(&derived).map(|message| message.log_time / 1_000_000);
            assert_eq!(times.collect::<Vec<_>>(), [0, 40]);
            let tally = &report.samples[&Kind::Velocity].tally;
            assert_eq!((tally.used, dropped(tally)), (2, vec![("too_large", 2)]));
            assert!(report.complete, "every message was read");
        }
    }
}

#[test]
fn a_speed_that_a_double_can_hold_is_used_though_its_square_cannot_be_held() {
    for size in [1e150, 1e200, 1e300, 1e307, 1.7e308, f64::MAX] {
        for axes in ["ned", "body-frd"] {
            // Nearly half a turn, of which an intermediate result is twice as large.
            let state = state([0.1, 0.2, 2.8], [size, 0.0, 0.0]);
            let options = options().telemetry(request(&profile("radians", "m/s", axes)));
            let (derived, _) = written(log_of(&[state; 2], "double"), &options).expect("a result");
            let mut seen = velocities(&derived);
            let numbers = seen.next().expect("a velocity").triple();
            let ratio = length(numbers.map(|number| number / size));
            assert!((ratio - 1.0).abs() < 1e-12, "{size}: {numbers:?}");
        }
    }
}

#[test]
fn the_smallest_speeds_are_not_lost() {
    for size in [5e-324, 1e-310, 1e-300, 1e-200] {
        let state = state(LEVEL, [0.0, size, -size]);
        let options = Options::new()
            .mount(Mount::from_degrees(0.0, 0.0, 0.0).expect("in range"))
            .telemetry(request(&profile("radians", "m/s", "ned")));
        let (derived, _) = written(log_of(&[state; 2], "double"), &options).expect("a result");
        let numbers = velocities(&derived).next().expect("a velocity").triple();
        assert_eq!(numbers, [0.0, size, -size]);
    }
}

#[test]
fn whole_and_single_precision_numbers_of_any_size_are_right() {
    let profile = profile("radians", "cm/s", "ned");
    for (number, size) in [("int64", i64::MAX as f64), ("float", f64::from(f32::MAX))] {
        let states = [state(LEVEL, [-size, size, 0.0]); 2];
        let options = options().telemetry(request(&profile));
        let (derived, report) = written(log_of(&states, number), &options).expect("a result");
        assert_eq!(report.samples[&Kind::Velocity].tally.used, 2);
        let numbers = velocities(&derived).next().expect("a velocity").triple();
        let ratio = length(numbers) / (size / 100.0 * 2f64.sqrt());
        assert!((ratio - 1.0).abs() < 1e-12, "{number}: {numbers:?}");
    }
}

#[test]
fn an_angle_of_very_many_turns_points_where_it_points_without_them() {
    let ahead = Options::new().mount(Mount::from_degrees(0.0, 0.0, 0.0).expect("in range"));
    for (unit, turn) in [
        ("degrees", 360.0),
        ("centidegrees", 360e2),
        ("degE7", 360e7),
    ] {
        // All of these are whole numbers that a double holds.
        for turns in [-1e4, 2e3, 1e6, -1e6] {
            for which in 0..3 {
                let turned = |turns: f64| {
                    let mut angles = LEVEL;
                    angles[which] = turns * turn + turn / 12.0;
                    state(angles, [1.0, 0.0, 0.0])
                };
                let states = [state(LEVEL, [1.0, 0.0, 0.0]), turned(0.0), turned(turns)];
                let options = ahead
                    .clone()
                    .telemetry(request(&profile(unit, "m/s", "ned")));
                let (derived, _) = written(log_of(&states, "double"), &options).expect("a result");
                let mut rotations =
                    (derived.iter()).filter(|message| message.topic == "/camera/relative_rpy");
                let mut rotation = || rotations.next().expect("a rotation").numbers[which];
                assert!((rotation().to_degrees() - 30.0).abs() < 1e-12, "{unit}");
                assert!(rotation().abs() < 1e-12, "{unit}, {turns} turns");
            }
        }
    }
}

#[test]
fn an_angle_of_any_size_is_used_if_it_is_to_be_trusted_and_said_to_be_suspicious() {
    let states = [0.0, 1.0, 1e300, -f64::MAX].map(|yaw| state([0.0, 0.0, yaw], [1.0; 3]));
    for unit in ["radians", "degrees", "centidegrees", "degE7"] {
        let options = options().telemetry(request(&profile(unit, "m/s", "ned")));
        let (_folder, input) = log_of(&states, "double").finish();
        let error = flightcam::derive(&input, &options, |_| ControlFlow::Continue(()));
        let error = error.expect_err("it cannot be").to_string();
        assert_reads(
            &error,
            "an angle of 1.7976931348623157e308, which cannot be",
        );
        let (_, report) = written(log_of(&states, "double"), &options).expect("a result");
        assert_eq!(report.samples[&Kind::Attitude].tally.used, 4);
    }
    let (_folder, input) = log_of(&states, "double").finish();
    let folder = Folder::with(LOG, fs::read(input).expect("the log"));
    let printed = folder.writes(RESULT, &format!("enrich {LOG} --depression 30 --trust"), 0);
    assert_reads(
        &printed,
        "has an angle of 1.7976931348623157e308, read as radians",
    );
}

#[test]
fn a_gimbals_angle_of_very_many_turns_points_where_it_points_without_them() {
    let profile = format!(
        "{}\n[gimbal]\ntopics = [\"/state\"]\n\
         orientation.pitch = {{ field = \"vz\", unit = \"degrees\" }}\nreference = \"heading\"",
        profile("radians", "m/s", "ned")
    );
    let states = [-30.0, 360e12 - 30.0, -360e12 - 30.0, f64::MAX];
    let states = states.map(|pitch| state(LEVEL, [1.0, 0.0, pitch]));
    let options = Options::new().telemetry(request(&profile));
    let (derived, report) = written(log_of(&states, "double"), &options).expect("a result");
    assert_eq!(report.samples[&Kind::Gimbal].tally.used, 4);
    for message in derived
        .iter()
        .filter(|message| message.interval.is_some())
        .take(2)
    {
        assert!(
            message.numbers.iter().all(|angle| angle.abs() < 1e-12),
            "{message:?}"
        );
    }
}

#[test]
fn the_report_its_json_and_inspect_name_what_is_too_large() {
    let states = [[1.0; 3], [1.7e308; 3], [1.0; 3]].map(|v| state(TILTED, v));
    let (_folder, input) = log_of(&states, "double").finish();
    let log = fs::read(input).expect("the log");
    let words = "1 dropped: with a number that is too large to compute with";
    let folder = Folder::with(LOG, &log);
    let printed = folder.writes(RESULT, &format!("enrich {LOG} --depression 30"), 0);
    assert_reads(&printed, &format!("2 of 3 samples used … {words}"));
    let json = Folder::with(LOG, &log).reports(&format!("enrich {LOG} --depression 30"), 0);
    assert_eq!(json["velocity"]["dropped"]["too_large"], 1);
    let (printed, _) = Folder::with(LOG, &log).run(&format!("inspect {LOG}"), 0);
    assert_reads(
        &printed,
        "1 with a number that is too large to compute with",
    );
    let documented = fs::read_to_string(repository("docs/report.md")).expect("the documentation");
    assert!(documented.contains("`too_large`"));
}

#[test]
fn inspect_shows_no_place_that_is_not_finite() {
    let profile = format!(
        "{}\n[position]\ntopics = [\"/state\"]\n\
         geodetic = {{ latitude = \"vx\", longitude = \"vy\", altitude = \"vz\", unit = \"radians\" }}",
        profile("radians", "m/s", "ned")
    );
    let places = [[1e308, 0.0, 0.0], [0.0, -1e308, 0.0], [0.8, 0.1, 5.0]];
    let (_folder, input) = log_of(&places.map(|place| state(LEVEL, place)), "double").finish();
    let log = fs::read(input).expect("the log");
    let options = options().telemetry(request(&profile));
    let inspection = inspected_with(&log, &options).expect("a log");
    let position = found(&inspection, Kind::Position);
    assert_eq!(dropped(&position.tally), [("too_large", 2)]);
    let json = serde_json::to_value(position.first).expect("JSON");
    assert!(json["latitude"].as_f64().expect("a number") < 90.0);
}

#[test]
fn a_hostile_log_with_the_largest_velocities_gives_no_infinite_ones() {
    let Some(log) = hostile_log("number-v-1.7e+308.mcap") else {
        return;
    };
    let folder = Folder::with(LOG, &log);
    let report = folder.reports(&format!("enrich {LOG} --depression 30"), 0);
    let velocity = &report["velocity"];
    assert_eq!(velocity["used"], 0);
    assert_eq!(velocity["dropped"]["too_large"], report["attitude"]["used"]);
    let result = stream(&folder.read(RESULT), false);
    let derived = (result.iter()).filter(|message| DERIVED.contains(&message.topic.as_str()));
    for message in derived.map(DerivedMessage::decode) {
        assert_ne!(message.topic, "/camera/velocity");
        assert!(message.numbers.iter().all(|number| number.is_finite()));
    }
    let inspection = inspected_with(&log, &options()).expect("a log");
    let inspected = found(&inspection, Kind::Velocity);
    assert_eq!((inspected.tally.used, inspected.share_invalid), (0, 1.0));
}

/// Doubles of every size, those at the limits often, and what is no number.
fn any_double() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => any::<u64>().prop_map(f64::from_bits),
        2 => -10.0..10.0,
        1 => prop::sample::select(vec![
            f64::MAX, f64::MIN, f64::MAX / 1.7, f64::MIN_POSITIVE, 5e-324, 0.0, -0.0, 1e154, -1e308,
            f64::INFINITY, f64::NAN,
        ]),
    ]
}

proptest! {
    #![proptest_config(cases(96))]

    #[test]
    fn whatever_the_numbers_all_that_is_written_is_finite_and_every_sample_is_counted(
        states in prop::collection::vec(prop::array::uniform6(any_double()), 1..12),
        angles in prop::sample::select(vec!["radians", "degrees", "centidegrees"]),
        speeds in prop::sample::select(vec![("m/s", 1.0), ("cm/s", 1e2), ("mm/s", 1e3)]),
        axes in prop::sample::select(vec!["ned", "enu", "body-frd", "body-flu"]),
        encoding in prop::sample::select(Encoding::ALL.to_vec()),
        is_fixed in any::<bool>(),
        is_single in any::<bool>(),
    ) {
        let number = if is_single { "float" } else { "double" };
        // Two at the start that are usable, so that something can be derived.
        let usable = [state(LEVEL, [1.0; 3]), state(TILTED, [2.0; 3])];
        let states = [&usable[..], &states[..]].concat();
        let mount = Mount::from_degrees(10.0, -30.0, 5.0).expect("in range");
        let options = if is_fixed { Options::new().mount(mount) } else { options() }
            .telemetry(request(&profile(angles, speeds.0, axes)))
            .encoding(EncodingChoice::Given(encoding));
        let (derived, report) = written(log_of(&states, number), &options).expect("a result");
        for kind in [Kind::Attitude, Kind::Velocity] {
            prop_assert_eq!(report.samples[&kind].tally.total(), states.len() as u64);
        }
        let read = |number: f64| {
            if is_single { f64::from(number as f32) } else { number }
        };
        let has_angles = |state: &&[f64; 6]| state[..3].iter().all(|&angle| read(angle).is_finite());
        let used = report.samples[&Kind::Attitude].tally.used;
        let undefined = report.samples[&Kind::Attitude].tally.dropped
            .get(&DropReason::UndefinedHeading).copied().unwrap_or_default();
        prop_assert_eq!(used + undefined, states.iter().filter(has_angles).count() as u64);
        let used = report.samples[&Kind::Velocity].tally.used;
        prop_assert_eq!(velocities(&derived).count() as u64, used);
        // Turning a velocity leaves its length.
        for message in velocities(&derived) {
            let [.., x, y, z] = states[(message.log_time / 20_000_000) as usize];
            let read = [x, y, z].map(read);
            // Halved, because the sum of rounded squares may be beyond the largest double.
            let halved = [read.map(|v| v / speeds.1 / 2.0), message.triple().map(|v| v / 2.0)];
            let [expected, is] = halved.map(length);
            prop_assert!((is / expected - 1.0).abs() < 1e-9 || (is - expected).abs() < 1e-320);
        }
    }

    #[test]
    fn a_quaternion_of_numbers_of_any_size_is_a_rotation_or_dropped(
        quaternions in prop::collection::vec(prop::array::uniform4(any_double()), 1..12),
    ) {
        let profile = r#"
            name = "any"
            [attitude]
            topics = ["/state"]
            orientation.quaternion = ["roll", "pitch", "yaw", "vx"]
            convention = "frd-ned"
        "#;
        let usable = [[1.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 1e-170]];
        let quaternions = [&usable[..], &quaternions[..]].concat();
        let states: Vec<[f64; 6]> =
            quaternions.iter().map(|&[w, x, y, z]| [w, x, y, z, 0.0, 0.0]).collect();
        let mount = Mount::from_degrees(0.0, 0.0, 0.0).expect("in range");
        let options = Options::new().mount(mount).telemetry(request(profile));
        let (derived, report) = written(log_of(&states, "double"), &options).expect("a result");
        let is_rotation = |q: &&[f64; 4]| {
            (0.5..=2.0).contains(&q[0].hypot(q[1]).hypot(q[2]).hypot(q[3]))
        };
        let tally = &report.samples[&Kind::Attitude].tally;
        prop_assert_eq!(tally.used, quaternions.iter().filter(is_rotation).count() as u64);
        prop_assert_eq!(tally.total(), quaternions.len() as u64);
        prop_assert_eq!(derived.len() as u64, (tally.used - 1) + tally.used);
    }
}
