//! DJI's flight records and the subtitles of its videos, as tools write them in JSON.

use serde_json::{Value, json};

use super::{
    flight::Flight,
    recorder::Recorder,
    recording::{Recording, Reference},
};

/// What is written at a time.
type Messages = fn(&Flight, u64) -> Vec<Value>;

pub fn recordings() -> Vec<Recording> {
    let record = "dji-flight-record";
    let place = json!({ "latitude": 1.5, "longitude": 2.5, "height": 3.5, "isGpdUsed": false });
    let frames = [
        ("frames", frame as Messages, json!({ "osd": place })),
        (
            "columns of the table",
            columns,
            json!({
                "OSD.latitude": 1.5, "OSD.longitude": 2.5, "OSD.height": 3.5, "OSD.isGPSUsed": false,
            }),
        ),
        (
            "flat frames",
            flat_frame,
            json!({
                "osd.latitude": 1.5, "osd.longitude": 2.5, "osd.height": 3.5, "osd.isGpdUsed": false,
            }),
        ),
        (
            "raw records",
            raw_records,
            json!({ "type": "OSD", "content": {
                "latitude": 1.5, "longitude": 2.5, "altitude": 3.5, "isGpsValid": false,
            } }),
        ),
    ];
    let frames = frames.map(|(name, write, invalid)| {
        let flight = Flight::in_one_message();
        recording(record, name, flight, write, Some(invalid)).with_geodetic(1e-9)
    });
    let subtitles = [
        ("metadata", subtitle as Messages),
        ("packets", packet),
        ("metadata of the Phantom 4 RTK", phantom_subtitle),
        ("packets of the Phantom 4 RTK", phantom_packet),
    ];
    let subtitles = subtitles.map(|(name, write)| {
        recording("dji-srt", name, Flight::without_velocity(), write, None).with_geodetic(1e-9)
    });
    frames.into_iter().chain(subtitles).collect()
}

/// One message has all, the gimbal's angles too. Others have a place that is not one.
fn recording(
    profile: &'static str,
    name: &str,
    flight: Flight,
    messages: Messages,
    without_fix: Option<Value>,
) -> Recording {
    let flight = Flight {
        gimbal_times: flight.attitude_times.clone(),
        ..flight
    };
    let write = move |flight: &Flight, log: &mut Recorder| {
        let times = flight.attitude_times.iter();
        let all = times.flat_map(|&time| {
            let messages = messages(flight, time).into_iter();
            messages.map(move |message| (time, message))
        });
        let invalid = flight.invalid_times.iter();
        let invalid = invalid.filter_map(|&time| Some((time, without_fix.clone()?)));
        let all: Vec<(u64, Value)> = all.chain(invalid).collect();
        log.json("/dji", None, all);
    };
    Recording::new(profile, name, flight, write).with_gimbal(Reference::Earth)
}

/// Roll, pitch and yaw of the drone and of the gimbal in degrees, the velocity, and the place.
fn numbers(flight: &Flight, time: u64) -> [[f64; 3]; 4] {
    [
        flight.angles(time).map(f64::to_degrees),
        flight.gimbal_angles(time).map(f64::to_degrees),
        flight.velocity(time).into(),
        flight.geodetic(time),
    ]
}

fn frame(flight: &Flight, time: u64) -> Vec<Value> {
    let [[roll, pitch, yaw], gimbal, velocity, place] = numbers(flight, time);
    vec![json!({
        "osd": {
            "roll": roll, "pitch": pitch, "yaw": yaw, "isGpdUsed": true,
            "xSpeed": velocity[0], "ySpeed": velocity[1], "zSpeed": velocity[2],
            "latitude": place[0], "longitude": place[1], "height": place[2], "altitude": 7.5,
        },
        "gimbal": { "mode": "YawFollow", "roll": gimbal[0], "pitch": gimbal[1], "yaw": gimbal[2] },
    })]
}

fn columns(flight: &Flight, time: u64) -> Vec<Value> {
    let [[roll, pitch, yaw], gimbal, velocity, place] = numbers(flight, time);
    vec![json!({
        "OSD.roll": roll, "OSD.pitch": pitch, "OSD.yaw": yaw, "OSD.isGPSUsed": true,
        "OSD.xSpeed": velocity[0], "OSD.ySpeed": velocity[1], "OSD.zSpeed": velocity[2],
        "OSD.latitude": place[0], "OSD.longitude": place[1], "OSD.height": place[2],
        "GIMBAL.mode": "FPV", "GIMBAL.roll": gimbal[0], "GIMBAL.pitch": gimbal[1], "GIMBAL.yaw": gimbal[2],
    })]
}

fn flat_frame(flight: &Flight, time: u64) -> Vec<Value> {
    let [[roll, pitch, yaw], gimbal, velocity, place] = numbers(flight, time);
    vec![json!({
        "osd.roll": roll, "osd.pitch": pitch, "osd.yaw": yaw, "osd.isGpdUsed": true,
        "osd.xSpeed": velocity[0], "osd.ySpeed": velocity[1], "osd.zSpeed": velocity[2],
        "osd.latitude": place[0], "osd.longitude": place[1], "osd.height": place[2],
        "gimbal.mode": "Free", "gimbal.roll": gimbal[0], "gimbal.pitch": gimbal[1], "gimbal.yaw": gimbal[2],
    })]
}

fn raw_records(flight: &Flight, time: u64) -> Vec<Value> {
    let [[roll, pitch, yaw], gimbal, velocity, place] = numbers(flight, time);
    vec![
        json!({ "type": "Custom", "content": { "roll": 1.5, "hSpeed": 7.5 } }),
        json!({ "type": "OSD", "content": {
            "roll": roll, "pitch": pitch, "yaw": yaw, "isGpsValid": true,
            "speedX": velocity[0], "speedY": velocity[1], "speedZ": velocity[2],
            "latitude": place[0], "longitude": place[1], "altitude": place[2],
        } }),
        json!({ "type": "Gimbal", "content": { "roll": gimbal[0], "pitch": gimbal[1], "yaw": gimbal[2] } }),
    ]
}

fn subtitle(flight: &Flight, time: u64) -> Vec<Value> {
    let [[roll, pitch, yaw], gimbal, _, place] = numbers(flight, time);
    vec![json!({
        "drone_roll": roll, "drone_pitch": pitch, "drone_yaw": yaw, "drone_speedx": 7.5,
        "gb_roll": gimbal[0], "gb_pitch": gimbal[1], "gb_yaw": gimbal[2],
        "latitude": place[0], "longitude": place[1], "rel_alt": place[2], "abs_alt": 7.5,
    })]
}

fn packet(flight: &Flight, time: u64) -> Vec<Value> {
    let [[roll, pitch, yaw], gimbal, _, place] = numbers(flight, time);
    vec![json!({
        "DRONE_ROLL": roll, "DRONE_PITCH": pitch, "DRONE_YAW": yaw,
        "GB_ROLL": gimbal[0], "GB_PITCH": gimbal[1], "GB_YAW": gimbal[2],
        "LATITUDE": place[0], "LONGITUDE": place[1], "REL_ALT": place[2],
    })]
}

fn phantom_subtitle(flight: &Flight, time: u64) -> Vec<Value> {
    let [[roll, pitch, yaw], gimbal, _, place] = numbers(flight, time);
    vec![json!({
        "F_PRY": [pitch, roll, yaw], "G_PRY": [gimbal[1], gimbal[0], gimbal[2]],
        "GPS": [place[1], place[0], 7], "H": place[2],
    })]
}

fn phantom_packet(flight: &Flight, time: u64) -> Vec<Value> {
    let [[roll, pitch, yaw], gimbal, _, place] = numbers(flight, time);
    vec![json!({
        "F_PRY": { "1": roll, "2": pitch, "3": yaw }, "G_PRY": { "1": gimbal[0], "2": gimbal[1], "3": gimbal[2] },
        "GPS": { "LATITUDE": place[0], "LONGITUDE": place[1] }, "ALTITUDE": place[2],
    })]
}
