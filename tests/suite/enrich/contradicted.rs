//! Logs whose own numbers show that they were read wrongly.

use prost::Message;
use prost_reflect::{DynamicMessage, Value};

use crate::support::{
    folder::Folder,
    logbook::Logbook,
    manoeuvres::{Manoeuvre, Sensors, fly, measure},
};

const TO_AND_FRO: &str = "the attitude jumps to and fro by up to 86°, 99 times in 99 steps, as where several sources \
     write to one topic, and no field is known that tells them apart … record each source on a topic of its own … \
     --trust goes on regardless";

/// A folder with the log as `log.mcap`.
fn folder_with(log: Logbook) -> Folder {
    let (_folder, path) = log.finish();
    Folder::with("log.mcap", std::fs::read(path).expect("the log"))
}

/// Two drones whose telemetry goes to one topic, in JSON.
fn two_drones() -> Folder {
    let mut log = Logbook::new();
    let channel = log.json("/state");
    for place in 0..100 {
        log.put_flat(channel, 20 * place, ["0.1", "1.6"][place as usize % 2], "1");
    }
    folder_with(log)
}

#[test]
fn two_drones_that_nothing_tells_apart_are_refused_wherever_the_result_goes() {
    let arguments = [
        "enrich log.mcap --depression 30 -o result.mcap",
        "enrich log.mcap --depression 30 -o result.mcap --layout interleaved",
        "enrich log.mcap --depression 30 --in-place",
    ];
    for arguments in arguments {
        two_drones().refuses(arguments, 1, TO_AND_FRO);
    }
    let folder = two_drones();
    folder.writes("result.mcap", &format!("{} --trust", arguments[0]), 0);
}

#[test]
#[cfg(unix)]
fn a_stream_gets_the_log_as_it_is() {
    let folder = two_drones();
    let log = folder.read("log.mcap");
    for input in ["log.mcap", "-"] {
        let arguments = format!("enrich {input} --depression 30 -o -");
        let (code, out, err) = folder.run_within(8_000_000, &arguments, "log.mcap");
        assert_eq!(code, 1, "{err}");
        assert!(out == log, "the log is passed on: {err}");
        assert!(err.contains("jumps to and fro"), "{err}");
    }
}

#[test]
fn two_receivers_that_nothing_tells_apart_are_refused() {
    let mut log = Logbook::new();
    let definition = "message Message { double roll = 1; double pitch = 2; double yaw = 3;
        double vx = 4; double vy = 5; double vz = 6; }";
    let (channel, message) = log.protobuf("/state", definition);
    for place in 0..100_u64 {
        let mut state = DynamicMessage::new(message.clone());
        state.set_field_by_name("yaw", Value::F64(0.001 * place as f64));
        // The first reports twice as often.
        let north = if place % 3 == 2 { -3.0 } else { 4.0 };
        state.set_field_by_name("vx", Value::F64(north));
        log.put(channel, 20 * place, &state.encode_to_vec());
    }
    let words = "the velocity jumps to and fro by up to 7.0 m/s, 66 times in 99 steps … as in --velocity '/topic{";
    folder_with(log).refuses("enrich log.mcap --depression 30", 1, words);
}

#[test]
fn a_recorder_that_stamped_nothing_is_refused() {
    let mut log = Logbook::new();
    let channel = log.json("/state");
    for place in 0..50 {
        log.put_flat(channel, 5, &format!("0.{place:03}"), "1");
    }
    let words = "all 50 attitude samples are at one time: their messages were not stamped … --time header.stamp";
    folder_with(log).refuses("enrich log.mcap --depression 30", 1, words);
}

/// A flight whose velocity is east, north, up, with angles in a unit of which a radian has so many.
fn flight_in_enu(per_radian: f64) -> Folder {
    let mut log = Logbook::new();
    let channel = log.json("/state");
    let sensors = Sensors {
        velocity_hz: 20.0,
        imu_hz: 0.0,
        ..Sensors::default()
    };
    let measured = measure(&fly(Manoeuvre::Free, 60.0, 4.0, 3), sensors, 3);
    for ((time, attitude), (_, velocity)) in measured.attitudes.iter().zip(&measured.velocities) {
        let (roll, pitch, yaw) = attitude.euler_angles();
        let [roll, pitch, yaw] = [roll, pitch, yaw].map(|angle| angle * per_radian);
        let (east, north, up) = (velocity.y, velocity.x, -velocity.z);
        let json = format!(
            r#"{{"roll":{roll},"pitch":{pitch},"yaw":{yaw},"vx":{east},"vy":{north},"vz":{up}}}"#
        );
        log.put(channel, (time * 1e3).round() as u64, json.as_bytes());
    }
    folder_with(log)
}

#[test]
fn the_unit_of_the_angles_makes_no_difference() {
    for (unit, per_radian) in [
        ("radians", 1.0),
        ("degrees", 1_f64.to_degrees()),
        ("centidegrees", 100_f64.to_degrees()),
    ] {
        let arguments = format!(
            "enrich log.mcap --depression 30 --attitude /state.roll,/state.pitch,/state.yaw:{unit}:frd-ned \
             --velocity /state.vx,/state.vy,/state.vz:ned"
        );
        let words = "contradicts how a drone leans where it accelerates";
        flight_in_enu(per_radian).refuses(&arguments, 1, words);
    }
}

#[test]
fn the_axes_that_fit_are_named_in_the_way_the_user_asked() {
    let contradiction = "the attitude together with the velocity contradicts how a drone leans where it accelerates … \
         what would fit: the velocity read as m/s in enu …";
    let flight = flight_in_enu(1.0);
    let by_profile =
        format!("{contradiction} name the fields with --velocity, and put :enu after them");
    flight.refuses("enrich log.mcap --depression 30", 1, &by_profile);
    let fields = "enrich log.mcap --depression 30 --velocity /state.vx,/state.vy,/state.vz";
    let by_argument = format!("{contradiction} put :enu after the fields of --velocity");
    flight.refuses(&format!("{fields}:ned"), 1, &by_argument);
    flight.writes("log.enriched.mcap", &format!("{fields}:enu"), 0);
}

#[test]
fn a_gimbal_that_points_up_and_a_drone_on_its_side_are_noted() {
    let mut log = Logbook::new();
    let channel = log.json("/state");
    for place in 0..50 {
        let json = r#"{"roll":0,"pitch":1.5,"yaw":0.3,"vx":1,"vy":0,"vz":0,"up":0.7}"#;
        log.put(channel, 20 * place, json.as_bytes());
    }
    let arguments = "enrich log.mcap -o result.mcap --gimbal /state.up:radians";
    let report = folder_with(log).writes("result.mcap", arguments, 0);
    for words in [
        "the drone leans by more than 60° in 100 % of the attitude samples",
        "the gimbal points up in 100 % of its samples",
    ] {
        assert!(report.contains(words), "{report}");
    }
}
