//! Velocities that are taken from positions: when that is advised, when it is done, and how well it agrees with measured
//! velocities.

use std::io::Cursor;

use flightcam::{
    Input, Layout, Options, Report, VelocityFrom, derive,
    derived::{Derived, Value},
    enrich,
    geometry::DepressionAngle,
    inspect::inspect,
    run::Output,
    sample::Kind,
    source::request::Request,
};
use serde_json::{Value as Json, json};
use std::ops::ControlFlow;

use crate::support::{folder::*, judge::indexed, selecting::*, topics::*, *};

/// Velocities in the camera's axes, m/s, by their times.
type Series = Vec<(u64, [f64; 3])>;

fn from_position(request: Request) -> Request {
    Request {
        velocity_from: VelocityFrom::Position,
        ..request
    }
}

fn positions() -> Options {
    options().telemetry(from_position(Request::default()))
}

/// A drone that heads north-east at 5 m/s north and climbs at 1 m/s, at 47° north, with other fields.
fn states(count: u32, more: impl Fn(&mut Json)) -> Topic {
    let state = |n: u32| {
        let t = f64::from(n) * 0.02;
        let mut state = json!({
            "roll": 0, "pitch": 0, "yaw": std::f64::consts::FRAC_PI_4,
            "lat": 47.0 + 5.0 * t / DEGREE_NORTH, "lon": 8.5, "alt": 400.0 + t,
        });
        more(&mut state);
        state
    };
    topic("/state", (0..count).map(state))
}

/// Metres for a degree of latitude at 47° north and 400 m, from published series.
const DEGREE_NORTH: f64 = 111_169.0 + 7.0;

fn without_velocity(state: &mut Json) {
    for name in ["vx", "vy", "vz"] {
        state[name] = Json::Null;
    }
}

/// The velocities in a result, in the order of their times.
fn velocities(result: &[u8]) -> Series {
    let messages = indexed(result).into_iter();
    let of_topic = messages.filter(|message| message.topic == "/camera/velocity");
    let mut velocities: Series = of_topic
        .map(|message| {
            (
                message.log_time,
                message::DerivedMessage::decode(&message).triple(),
            )
        })
        .collect();
    velocities.sort_by_key(|(time, _)| *time);
    velocities
}

// ---- Advice ----

#[test]
fn a_log_with_positions_and_without_a_usable_velocity_says_what_can_be_done() {
    let folder = Folder::with(LOG, log(&[states(20, without_velocity)]));
    let arguments = format!("enrich {LOG} -o {RESULT} --depression 30");
    let words = "Not written … /camera/velocity: … /state has 0 of 20 usable … ; \
                 --velocity-from position takes it from the positions on /state";
    assert_reads(&folder.run(&arguments, 0).0, words);
    let report = folder.run(&format!("{arguments} --force --json"), 0).0;
    let report: Json = serde_json::from_str(&report).expect("JSON");
    assert_eq!(report["not_written"][0]["positions"], "/state");
    let inspected = folder.run(&format!("inspect {LOG}"), 0).0;
    assert_reads(
        &inspected,
        "but not … /camera/velocity: … ; --velocity-from position",
    );
}

#[test]
fn where_nothing_at_all_can_be_derived_the_error_says_it_too() {
    let apart = states(3, without_velocity);
    let alone = Topic {
        messages: vec![br#"{"q":[0,0,0,0]}"#.to_vec()],
        ..attitude("/a")
    };
    let folder = Folder::with(LOG, log(&[alone, apart]));
    folder.refuses(
        &format!(
            "enrich {LOG} -o {RESULT} --depression 30 --attitude /a.q:frd-ned --velocity /state.vx,/state.vy,/state.vz:ned \
             --position /state.lat,/state.lon,/state.alt:degrees"
        ),
        1,
        "nothing can be derived … for the velocity, --velocity-from position takes it from the positions on /state",
    );
}

#[test]
fn positions_are_advised_only_where_they_would_help() {
    let not_advised = |topic: Topic| {
        let folder = Folder::with(LOG, log(&[topic]));
        let report = enrich(folder.path(LOG), folder.path(RESULT), &options()).expect("a result");
        assert_eq!(report.not_written[0].topic, "/camera/velocity");
        assert_eq!(report.not_written[0].positions, None);
        let inspected = inspect(folder.path(LOG), &options()).expect("an inspection");
        let telemetry = inspected.telemetry.expect("telemetry");
        assert_eq!(telemetry.would_not_write[0].positions, None);
    };
    // None, unusable ones, and too few.
    not_advised(states(20, |state| {
        without_velocity(state);
        state["lat"] = Json::Null;
    }));
    not_advised(states(20, |state| {
        without_velocity(state);
        state.as_object_mut().expect("an object").remove("lon");
    }));
    not_advised(states(2, without_velocity));
}

// ---- Doing it ----

#[test]
fn the_velocity_is_that_of_the_positions() {
    let folder = Folder::with(LOG, log(&[states(50, without_velocity)]));
    let level = Options::new()
        .depression(DepressionAngle::from_degrees(0.0).expect("in range"))
        .telemetry(from_position(Request::default()));
    let report = enrich(folder.path(LOG), folder.path(RESULT), &level).expect("a result");
    let velocities = velocities(&folder.read(RESULT));
    let expected: Vec<u64> = (1..49).map(time).collect();
    assert!(velocities.iter().map(|(time, _)| *time).eq(expected));
    let ahead = 5.0 * std::f64::consts::FRAC_1_SQRT_2;
    for (_, [x, y, z]) in velocities {
        assert!((x - ahead).abs() < 1e-3, "{x}");
        assert!((y + ahead).abs() < 1e-3, "{y}");
        assert!((z + 1.0).abs() < 1e-6, "{z}");
    }
    let samples = |kind| &report.samples[&kind];
    assert_eq!(samples(Kind::Position).tally.used, 48);
    assert_eq!(samples(Kind::Position).topic.as_deref(), Some("/state"));
    assert_eq!(samples(Kind::Velocity).tally.used, 48);
    assert_eq!(samples(Kind::Velocity).topic, None);
    assert_eq!(samples(Kind::Velocity).derived_from, Some(Kind::Position));
}

/// PX4's counts, beside the position.
#[test]
fn a_reset_that_a_log_counts_is_not_taken_for_motion() {
    for count in ["lat_lon_reset_counter", "alt_reset_counter"] {
        let jumping = states(20, |state| {
            without_velocity(state);
            let is_later = state["alt"].as_f64() > Some(400.19);
            state[count] = json!(u8::from(is_later));
        });
        let folder = Folder::with(LOG, log(&[jumping]));
        enrich(folder.path(LOG), folder.path(RESULT), &positions()).expect("a result");
        // Each half has ten positions.
        assert_eq!(velocities(&folder.read(RESULT)).len(), 8 + 8, "{count}");
    }
}

#[test]
fn all_layouts_and_ways_to_read_a_log_give_the_same() {
    // Of several chunks, whose messages are not in order of time.
    let usual = states(400, without_velocity);
    let bytes = log(&[attitude("/other"), usual]);
    let folder = Folder::with(LOG, &bytes);
    enrich(folder.path(LOG), folder.path(RESULT), &positions()).expect("a result");
    let expected = velocities(&folder.read(RESULT));
    assert_eq!(expected.len(), 398);

    let mut interleaved = Vec::new();
    let output = Output::stream("result", &mut interleaved);
    let options = positions().layout(Layout::Interleaved);
    enrich(folder.path(LOG), output, &options).expect("a result");
    assert_eq!(velocities(&interleaved), expected);

    let mut streamed = Vec::new();
    let output = Output::stream("result", &mut streamed);
    enrich(
        Input::stream("log", Cursor::new(bytes)),
        output,
        &positions(),
    )
    .expect("a result");
    assert_eq!(velocities(&streamed), expected);

    let mut derived: Series = Vec::new();
    derive(folder.path(LOG), &positions(), |values| {
        derived.extend(values.iter().filter_map(velocity));
        ControlFlow::Continue(())
    })
    .expect("a readable log");
    assert_eq!(derived, expected);
}

fn velocity(derived: &Derived) -> Option<(u64, [f64; 3])> {
    match derived.value {
        Value::CameraVelocity(velocity) => Some((derived.stamp.log_time, velocity.into())),
        _ => None,
    }
}

#[test]
fn a_profile_that_requires_a_velocity_fits_a_log_with_positions_instead() {
    let bare = states(20, |_| {});
    refuses(
        std::slice::from_ref(&bare),
        &[],
        "no topic has messages with all of the fields",
    );
    let source = select_with(&[bare, rates()], &from_position(Request::default()));
    let source = source.expect("a source");
    assert_eq!(used(&source), ("flat", "/state", ""));
    let error = select_with(&[rates()], &from_position(Request::default()));
    let error = error.expect_err("neither velocity nor position");
    assert_reads(
        &error.to_string(),
        "all of the fields `roll`, `pitch`, `yaw`, `lat`, `lon`, `alt`; /rates comes closest",
    );
}

/// Not a drone's state, though it has the names of angles.
fn rates() -> Topic {
    twice("/rates", json!({ "roll": 0, "pitch": 0, "yaw": 0 }))
}

#[test]
fn positions_may_be_on_a_topic_of_their_own() {
    let gps = (0..20).map(|n| json!({ "p": { "x": 0.1 * f64::from(n), "y": 0, "z": 0 } }));
    let topics = [rates(), topic("/gps", gps)];
    let requested = request(&[("--position", "/gps.p:enu"), ("--profile", "flat")]);
    let source = select_with(&topics, &from_position(requested)).expect("a source");
    assert_eq!(
        source.role(Kind::Position).expect("positions").topic,
        "/gps"
    );
}

#[test]
fn a_velocity_and_positions_instead_of_it_are_not_both_asked_for() {
    let folder = Folder::with_flight();
    let arguments =
        format!("enrich {LOG} --depression 30 --velocity /a.v:ned --velocity-from position");
    folder.refuses(&arguments, 2, "--velocity-from position");
}

#[test]
fn the_report_and_the_record_say_where_velocities_come_from() {
    let folder = Folder::with(LOG, log(&[states(50, without_velocity)]));
    let arguments = format!("enrich {LOG} -o {RESULT} --depression 30 --velocity-from position");
    let report = folder.run(&arguments, 0).0;
    assert_reads(
        &report,
        "Velocity … from the position: 48 of 48 samples used … \
         Position … /state: 48 of 50 samples used … latitude and longitude in degrees, altitude in m … \
         2 dropped: without another position shortly before or shortly after",
    );
    let record = String::from_utf8_lossy(&folder.read(RESULT)).into_owned();
    assert!(record.contains("velocity_from"));
    let inspected = folder
        .run(&format!("inspect {LOG} --velocity-from position"), 0)
        .0;
    assert_reads(
        &inspected,
        "Velocity … from the position … Position … /state … /camera/velocity … up to 48 messages",
    );
}

#[test]
fn too_few_positions_are_the_reason_why_there_is_no_velocity() {
    let folder = Folder::with(LOG, log(&[states(2, without_velocity)]));
    let report = enrich(folder.path(LOG), folder.path(RESULT), &positions()).expect("a result");
    assert_eq!(
        report.not_written[0].reason.to_string(),
        "at least 3 usable position samples are needed, and /state has 0 of 2 usable, \
         2 without another position shortly before or shortly after"
    );
    let none = states(5, |state| {
        state["vx"] = json!(1);
        state["vy"] = json!(1);
        state["vz"] = json!(1);
        state.as_object_mut().expect("an object").remove("alt");
    });
    let request = from_position(request(&[(
        "--attitude",
        "/state.roll,/state.pitch,/state.yaw:radians",
    )]));
    let folder = Folder::with(LOG, log(&[none]));
    let report = enrich(
        folder.path(LOG),
        folder.path(RESULT),
        &options().telemetry(request),
    );
    let reason = report.expect("a result").not_written[0].reason.to_string();
    assert_reads(&reason, "has no position");
}

// ---- Real flights ----

/// What velocities are taken from.
fn measured_and_taken(name: &str, position: Option<&str>) -> Option<[Series; 2]> {
    let folder = real_logs()?;
    let log = folder.join(format!("{name}.mcap"));
    let mut requested = Request::default();
    if let Some(position) = position {
        requested = request(&[("--position", position)]);
    }
    let sources = [Request::default(), from_position(requested)];
    Some(sources.map(|request| {
        let mut velocities = Vec::new();
        derive(&log, &options().telemetry(request), |values| {
            velocities.extend(values.iter().filter_map(velocity));
            ControlFlow::Continue(())
        })
        .expect("a readable log");
        velocities
    }))
}

/// How many velocities taken from positions have measured ones around them, the root of their mean square difference,
/// and that of the measured ones; m/s.
fn agreement(measured: &Series, taken: &Series) -> (usize, f64, f64) {
    let (mut count, mut differences, mut speeds) = (0, 0.0, 0.0);
    for (time, taken) in taken {
        let after = measured.partition_point(|(other, _)| other < time);
        let (Some((t0, before)), Some((t1, after))) = (
            after.checked_sub(1).and_then(|before| measured.get(before)),
            measured.get(after),
        ) else {
            continue;
        };
        if t1 - t0 > 300_000_000 {
            continue;
        }
        let fraction = (time - t0) as f64 / (t1 - t0) as f64;
        count += 1;
        for axis in 0..3 {
            let measured = before[axis] + fraction * (after[axis] - before[axis]);
            differences += (measured - taken[axis]).powi(2);
            speeds += measured.powi(2);
        }
    }
    let mean = |sum: f64| (sum / count as f64).sqrt();
    (count, mean(differences), mean(speeds))
}

/// Both flights hover, with an estimator whose position and velocity do not agree better than this.
#[test]
fn real_flights_positions_agree_with_their_measured_velocities() {
    let local = "/vehicle_local_position.x,/vehicle_local_position.y,/vehicle_local_position.z:ned";
    for (name, position, least, most) in [
        ("test_ulog", None, 30, 0.26),
        ("test_ulog", Some(local), 60, 0.24),
        ("test_ulog.ros2", None, 60, 0.24),
        ("sample_px4_events", None, 100, 0.15),
        ("sample_px4_events", Some(local), 200, 0.15),
    ] {
        let Some([measured, taken]) = measured_and_taken(name, position) else {
            return;
        };
        let (count, difference, speed) = agreement(&measured, &taken);
        println!(
            "{name} {position:?}: {count} velocities, {difference:.3} m/s apart, at {speed:.3} m/s"
        );
        assert!(
            count >= least && difference < most,
            "{name}: {count}, {difference}, {speed}"
        );
    }
}

#[test]
fn a_real_flight_without_a_valid_velocity_gets_one_from_its_receiver() {
    let Some(folder) = real_logs() else { return };
    let log = folder.join("sample_log_small.mcap");
    let results = Folder::new();
    let without: Report = enrich(&log, results.path("a.mcap"), &options()).expect("a result");
    let receiver = without.not_written[0].positions.as_deref();
    assert_eq!(receiver, Some("/vehicle_gps_position"));
    let with = enrich(&log, results.path("b.mcap"), &positions()).expect("a result");
    assert_eq!(with.not_written, []);
    assert_eq!(with.samples[&Kind::Velocity].tally.used, 30);
    // It stands, and its altitude drifts.
    let velocities = velocities(&results.read("b.mcap"));
    assert!(
        velocities
            .iter()
            .all(|(_, v)| v.iter().all(|x| x.abs() < 2.0)),
        "{velocities:?}"
    );
}
