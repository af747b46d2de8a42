//! Telemetry and camera as given on the command line: how they affect the result, and what is refused.

use std::f64::consts::PI;

use serde_json::{Value, json};

use crate::support::{DERIVED, folder::*, message::DerivedMessage, stream, topics::*};

/// Enriches a log, which must succeed; returns the derived messages and the report.
#[track_caller]
fn enriched(topics: &[Topic], arguments: &str) -> (Vec<DerivedMessage>, Value) {
    let folder = Folder::with(LOG, log(topics));
    let report = folder.reports(&format!("enrich {LOG} {arguments}"), 0);
    let derived = stream(&folder.read(RESULT), false).into_iter();
    let derived = derived.filter(|message| DERIVED.contains(&message.topic.as_str()));
    (
        derived
            .map(|message| DerivedMessage::decode(&message))
            .collect(),
        report,
    )
}

#[track_caller]
fn assert_same(these: &[DerivedMessage], those: &[DerivedMessage]) {
    assert_eq!(these.len(), those.len());
    for (this, that) in these.iter().zip(those) {
        assert_eq!((&this.topic, this.stamp), (&that.topic, that.stamp));
        for (a, b) in this.numbers.iter().zip(&that.numbers) {
            assert!((a - b).abs() < 1e-9, "{this:?} is not {that:?}");
        }
    }
}

#[track_caller]
fn assert_differ(these: &[DerivedMessage], those: &[DerivedMessage]) {
    let mut pairs = these.iter().zip(those);
    assert!(pairs.any(|(a, b)| (a.numbers[2] - b.numbers[2]).abs() > 1e-3));
}

const COUNT: i32 = 50;

fn flat() -> Topic {
    topic("/drone/state", states(COUNT, 1.0))
}

/// The same flight with the nose level, so that a fixed camera and one on a gimbal see the same.
fn level() -> Topic {
    topic(
        "/drone/state",
        states(COUNT, 1.0).map(|mut state| {
            state["roll"] = json!(0);
            state["pitch"] = json!(0);
            state
        }),
    )
}

#[test]
fn telemetry_named_by_arguments_yields_the_same_as_the_profile_flat() {
    let degrees = states(COUNT, PI / 180.0);
    let imu = degrees.map(|state| json!({ "att": [state["roll"], state["pitch"], state["yaw"]] }));
    let centimetres = |speed: &Value| speed.as_f64().unwrap() * 100.0;
    let gps = states(COUNT, 1.0).map(|state| {
        json!({ "v": { "x": centimetres(&state["vy"]), "y": centimetres(&state["vx"]), "z": -centimetres(&state["vz"]) } })
    });
    let one_off = [topic("/imu", imu), topic("/gps", gps)];
    let arguments = "--depression 30 --velocity /gps.v:enu:cm/s --attitude /imu.att[0],/imu.att[1],/imu.att[2]:degrees";
    let (derived, report) = enriched(&one_off, arguments);
    let (expected, _) = enriched(&[flat()], "--depression 30");
    assert_same(&derived, &expected);
    assert_eq!(derived.len(), 49 + 50 + 50);
    assert_eq!(report["profile"]["name"], "command line");
    assert_eq!(report["attitude"]["topic"], "/imu");
    assert_eq!(report["velocity"]["topic"], "/gps");
}

mod mount {
    use super::*;

    #[test]
    fn a_mount_fixes_the_camera_to_the_airframe() {
        let (gimballed, _) = enriched(&[level()], "--depression 30");
        for mount in ["--mount 0,-30,0", "--mount=0,-30,0", "--mount -0,-30.0,0e0"] {
            let (bolted, report) = enriched(&[level()], mount);
            assert_same(&bolted, &gimballed);
            assert_eq!(report["camera"]["kind"], "fixed");
        }
        let (tilted, _) = enriched(&[flat()], "--mount 0,-30,0");
        assert_differ(&tilted, &gimballed);
        let (rolled, report) = enriched(&[flat()], "--mount -10,-30,20");
        assert_differ(&rolled, &tilted);
        assert_eq!(report["camera"]["mount_deg"], json!([-10.0, -30.0, 20.0]));
    }

    #[test]
    fn a_mount_with_a_depression_turns_the_gimballed_camera_sideways() {
        let (bolted, _) = enriched(&[level()], "--mount 0,-30,90");
        let (gimballed, report) = enriched(&[level()], "--mount 0,0,90 --depression 30");
        assert_same(&gimballed, &bolted);
        assert_eq!(report["camera"]["yaw_offset_deg"], 90.0);
    }

    #[test]
    fn an_impossible_mount_is_a_wrong_argument() {
        let folder = Folder::with(LOG, log(&[flat()]));
        for (arguments, message) in [
            (
                "--mount 0,-30",
                "--mount … write roll, pitch and yaw in degrees, as in 0,-30,0",
            ),
            ("--mount 0,down,0", "--mount … not a number"),
            (
                "--mount 0,-91,0",
                "--mount … out of range … pitch from -90 to 90",
            ),
            ("--mount 0,nan,0", "--mount … out of range"),
            (
                "--depression 30 --mount 5,0,0",
                "mount with roll or pitch contradicts a depression angle … --depression … only the yaw (--mount",
            ),
            (
                "--depression 30 --mount 0,-30,0",
                "mount with roll or pitch contradicts a depression angle … --depression … --mount",
            ),
            (
                "--mount 0,-30,0 --gimbal /drone/state.pitch:radians",
                "mount contradicts a gimbal … leave out --mount or --gimbal",
            ),
        ] {
            folder.refuses(&format!("enrich {LOG} {arguments}"), 2, message);
        }
    }
}

#[test]
fn without_a_camera_the_options_for_it_are_explained() {
    let message = "does not say where the camera looks … --depression DEG … --depression 30 … -30° … --mount ROLL,PITCH,YAW … --gimbal";
    Folder::with(LOG, log(&[flat()])).refuses(&format!("enrich {LOG}"), 2, message);
}

mod gimbal {
    use super::*;

    fn pitched(name: &'static str, field: &str, angle: f64) -> Topic {
        topic(name, (0..COUNT).map(|_| json!({ field: angle })))
    }

    #[test]
    fn a_gimbal_with_a_pitch_alone_is_followed() {
        let (expected, _) = enriched(&[flat()], "--depression 30");
        for (field, angle, argument) in [
            ("pitch", -30.0, "/gimbal.pitch:degrees"),
            ("tilt", 30.0, "/gimbal.tilt:degrees:down"),
            ("tilt", PI / 6.0, "/gimbal.tilt:down:radians"),
            ("p", -3000.0, "/gimbal.p:centidegrees"),
        ] {
            let topics = [flat(), pitched("/gimbal", field, angle)];
            let (derived, report) = enriched(&topics, &format!("--gimbal {argument}"));
            assert_same(&derived, &expected);
            assert_eq!(report["camera"]["kind"], "gimbal");
            assert_eq!(report["gimbal"]["topic"], "/gimbal");
            assert_eq!(report["gimbal"]["used"], COUNT);
        }
    }

    #[test]
    fn gimbal_angles_may_be_in_the_attitudes_messages() {
        let with_gimbal = states(COUNT, 1.0).map(|mut state| {
            state["gimbal"] = json!({ "pitch": -45 });
            state
        });
        let (derived, _) = enriched(
            &[topic("/drone/state", with_gimbal)],
            "--gimbal /drone/state.gimbal.pitch:degrees",
        );
        let (expected, _) = enriched(&[flat()], "--depression 45");
        assert_same(&derived, &expected);
    }

    #[test]
    fn the_logs_gimbal_is_followed_unless_an_angle_is_given() {
        let q = |pitch: f64| json!([(pitch / 2.0).cos(), 0.0, (pitch / 2.0).sin(), 0.0]);
        let px4 = || {
            let attitudes = (0..COUNT).map(|i| {
                let half = 0.01 * f64::from(i);
                json!({ "q": [half.cos(), 0, 0, half.sin()] })
            });
            let gimbal = (0..COUNT).map(|_| json!({ "q": q(-PI / 6.0), "device_flags": 32 }));
            [
                topic("/vehicle_attitude", attitudes),
                topic("/gimbal_device_attitude_status", gimbal),
            ]
        };
        let (followed, report) = enriched(&px4(), "");
        assert_eq!(report["camera"]["kind"], "gimbal");
        let (same, report) = enriched(&px4(), "--depression 30");
        assert_same(&same, &followed);
        let note = json!({
            "kind": "gimbal_ignored",
            "topic": "/gimbal_device_attitude_status",
            "camera": { "kind": "stabilised", "depression_deg": 30.0, "yaw_offset_deg": 0.0 },
        });
        assert_eq!(report["notes"][0], note);
        let (other, _) = enriched(&px4(), "--depression 60");
        assert_differ(&other, &followed);
        let (_, report) = enriched(&px4(), "--mount 0,-30,0");
        assert_eq!(report["notes"][0]["camera"]["kind"], "fixed");
    }
}

mod time {
    use super::*;

    /// Flat telemetry whose messages say when they were made: half a second after they were logged.
    fn stamped() -> Topic {
        let stamped = (0..).zip(states(COUNT, 1.0)).map(|(n, mut state)| {
            let made = time(n) + 500_000_000;
            state["header"] = json!({ "stamp": { "sec": made / 1_000_000_000, "nanosec": made % 1_000_000_000 } });
            state["time_usec"] = json!(made / 1000);
            state["seconds"] = json!(made as f64 / 1e9);
            state
        });
        topic("/drone/state", stamped)
    }

    #[test]
    fn sample_times_are_those_that_the_option_names() {
        for (argument, earlier, later) in [
            ("", 0, 0),
            ("--time log", 0, 0),
            ("--time publish", LATENCY, 0),
            ("--time header.stamp", 0, 500_000_000),
            ("--time time_usec:us", 0, 500_000_000),
            ("--time seconds:s", 0, 500_000_000),
        ] {
            let (derived, _) = enriched(&[stamped()], &format!("--depression 30 {argument}"));
            let of_velocity = derived
                .iter()
                .filter(|message| message.topic == "/camera/velocity");
            let times: Vec<u64> = of_velocity.map(|message| message.log_time).collect();
            let expected: Vec<u64> = (0..COUNT as u32)
                .map(|n| time(n) - earlier + later)
                .collect();
            assert_eq!(times, expected, "{argument}");
        }
    }

    #[test]
    fn an_impossible_time_is_refused() {
        let folder = Folder::with(LOG, log(&[stamped()]));
        for (argument, code, message) in [
            (
                "/drone/state.stamp",
                2,
                "--time … write log, publish, or a field of the messages without their topic",
            ),
            (
                "time_usec:min",
                2,
                "--time … `min` has no meaning here … s, ms, us or ns",
            ),
            ("header.stmp", 1, "no field `header.stmp`"),
            (
                "header",
                1,
                "`header` is not a number or a message of seconds and nanoseconds",
            ),
        ] {
            folder.refuses(
                &format!("enrich {LOG} --depression 30 --time {argument}"),
                code,
                message,
            );
        }
    }
}
