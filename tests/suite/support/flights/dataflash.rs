//! ArduPilot's DataFlash log as arducap converts it: JSON with the numbers as they are stored.

use serde_json::{Map, Value, json};

use super::{
    flight::{Angles, Flight},
    recorder::Recorder,
    recording::{Recording, Reference},
};

pub fn recordings() -> Vec<Recording> {
    vec![
        recording("hundredths of a degree, EKF3", in_hundredths(), |log| {
            log.attitude(in_integers);
            log.estimates(
                "XKF1",
                "XKF4",
                Some(Cores {
                    count: 3,
                    primary: 1,
                }),
            );
            log.position();
            log.mount();
            log.imu();
        })
        .with_gimbal(Reference::Heading)
        .with_geodetic(1e-9),
        recording("degrees, EKF3 with one core", Flight::new(), |log| {
            log.attitude(in_degrees);
            log.estimates(
                "XKF1",
                "XKF4",
                Some(Cores {
                    count: 1,
                    primary: 0,
                }),
            );
        })
        .with_local(1e-9),
        recording("EKF2", Flight::new(), |log| {
            log.attitude(in_degrees);
            log.estimates(
                "NKF1",
                "NKF4",
                Some(Cores {
                    count: 2,
                    primary: 0,
                }),
            );
        })
        .with_local(1e-9),
        recording("EKF2 without a core's number", in_hundredths(), |log| {
            log.attitude(in_integers);
            log.estimates("NKF1", "NKF4", None);
        })
        .with_local(1e-9),
        recording("EKF2 before 4.1", in_hundredths(), |log| {
            log.attitude(in_integers);
            log.estimates("NKF1", "NKF4", None);
            let states = log.flight.velocity_times.iter();
            let states = states.map(|&time| (time, json!({ "SV": 0.5, "PI": 0 })));
            let states = states.collect();
            log.write("NKF4", states);
        })
        .with_local(1e-9),
        recording("EKF1", in_hundredths(), |log| {
            log.attitude(in_integers);
            log.estimates("EKF1", "EKF4", None);
        }),
        recording("EKF1 with TimeMS", in_whole_milliseconds(), |log| {
            log.has_milliseconds = true;
            log.attitude(in_integers);
            log.estimates("EKF1", "EKF4", None);
        }),
    ]
}

fn recording(name: &str, flight: Flight, write: fn(&mut DataFlash)) -> Recording {
    let flight = Flight {
        position_times: flight.velocity_times.clone(),
        ..flight
    };
    let write = move |flight: &Flight, log: &mut Recorder| {
        write(&mut DataFlash {
            flight,
            log,
            has_milliseconds: false,
        });
    };
    Recording::new("ardupilot-dataflash", name, flight, write)
}

fn in_hundredths() -> Flight {
    Flight::new().in_steps_of(0.01)
}

/// As those of TimeMS are.
fn in_whole_milliseconds() -> Flight {
    in_hundredths().only(|time| time.is_multiple_of(1_000_000))
}

fn in_integers(angles: Angles) -> [Value; 3] {
    angles.map(|angle| json!((angle.to_degrees() * 100.0).round() as i64))
}

fn in_degrees(angles: Angles) -> [Value; 3] {
    angles.map(|angle| json!(angle.to_degrees()))
}

/// The cores of an estimator, of which only the primary one is right.
#[derive(Clone, Copy)]
struct Cores {
    count: u64,
    primary: u64,
}

struct DataFlash<'a> {
    flight: &'a Flight,
    log: &'a mut Recorder,
    /// Whether messages have TimeMS, so that all are stamped with 0, and not TimeUS.
    has_milliseconds: bool,
}

impl DataFlash<'_> {
    /// Writes messages of a type, each with the names and values of its fields.
    fn write(&mut self, name: &str, messages: Vec<(u64, Value)>) {
        let has_milliseconds = self.has_milliseconds;
        let stamp = |(time, mut message): (u64, Value)| {
            let (field, nanoseconds) = match has_milliseconds {
                true => ("TimeMS", 1_000_000),
                false => ("TimeUS", 1000),
            };
            message[field] = json!(time / nanoseconds);
            (if has_milliseconds { 0 } else { time }, message)
        };
        let messages: Vec<(u64, Value)> = messages.into_iter().map(stamp).collect();
        let names = messages
            .iter()
            .filter_map(|(_, message)| message.as_object());
        let names = names.flat_map(Map::keys);
        let number = json!({"type": "number"});
        let properties: Map<String, Value> =
            names.map(|name| (name.clone(), number.clone())).collect();
        let schema = json!({"type": "object", "title": name, "properties": properties});
        let topic = format!("/ardupilot/{name}");
        self.log.json(&topic, Some(&schema), messages);
    }

    fn attitude(&mut self, written: fn(Angles) -> [Value; 3]) {
        let message = |&time: &u64| {
            let [roll, pitch, yaw] = written(self.flight.angles(time));
            let message = json!({
                "DesRoll": 150, "Roll": roll, "DesPitch": 250, "Pitch": pitch, "DesYaw": 350, "Yaw": yaw, "AEKF": 3,
            });
            (time, message)
        };
        let messages = self.flight.attitude_times.iter().map(message).collect();
        self.write("ATT", messages);
    }

    /// Velocities and positions, and which core is the primary one.
    fn estimates(&mut self, name: &str, says_primary: &str, cores: Option<Cores>) {
        let right = |time: u64| {
            let (velocity, local) = (self.flight.velocity(time), self.flight.local(time));
            json!({
                "Roll": 150, "Pitch": 250, "Yaw": 350, "VN": velocity.x, "VE": velocity.y, "VD": velocity.z,
                "PN": local.x, "PE": local.y, "PD": local.z,
            })
        };
        let wrong = json!({
            "Roll": 1, "Pitch": 2, "Yaw": 3, "VN": 1.5, "VE": 2.5, "VD": 3.5, "PN": 1.5, "PE": 2.5, "PD": 3.5,
        });
        let of_core = |time: u64, core: u64, primary: u64| {
            let mut message = match core == primary {
                true => right(time),
                false => wrong.clone(),
            };
            message["C"] = json!(core);
            (time, message)
        };
        let times = self.flight.velocity_times.iter();
        let messages = times.flat_map(|&time| match cores {
            None => vec![(time, right(time))],
            Some(Cores { count, primary }) => (0..count)
                .map(|core| of_core(time, core, primary))
                .collect(),
        });
        let messages = messages.collect();
        self.write(name, messages);
        if let Some(Cores { count, primary }) = cores {
            let times = self.flight.velocity_times.iter();
            let states = times.flat_map(|&time| {
                (0..count).map(move |core| (time, json!({ "C": core, "PI": primary })))
            });
            let states = states.collect();
            self.write(says_primary, states);
        }
    }

    fn position(&mut self) {
        let message = |&time: &u64| {
            let [latitude, longitude, altitude] = self.flight.geodetic(time);
            let message = json!({
                "Lat": latitude * 1e7, "Lng": longitude * 1e7, "Alt": altitude, "RelHomeAlt": 7.5,
            });
            (time, message)
        };
        let messages = self.flight.position_times.iter().map(message).collect();
        self.write("POS", messages);
    }

    /// Two mounts, of which the second one is another.
    fn mount(&mut self) {
        let message = |&time: &u64| {
            let [roll, pitch, yaw] = self.flight.gimbal_angles(time).map(f64::to_degrees);
            let first = json!({
                "I": 0, "DRoll": 1.5, "Roll": roll, "DPitch": 2.5, "Pitch": pitch, "DYawB": 3.5, "YawB": yaw, "YawE": 4.5,
            });
            let second = json!({ "I": 1, "Roll": 1.5, "Pitch": 2.5, "YawB": 3.5, "YawE": 4.5 });
            [(time, first), (time, second)]
        };
        let messages = self.flight.gimbal_times.iter().flat_map(message).collect();
        self.write("MNT", messages);
    }

    fn imu(&mut self) {
        let message = |&time: &u64| {
            let [rates, force] = self.flight.felt(time);
            let message = json!({
                "I": 0, "GyrX": rates.x, "GyrY": rates.y, "GyrZ": rates.z,
                "AccX": force.x, "AccY": force.y, "AccZ": force.z,
            });
            (time, message)
        };
        let messages = self.flight.attitude_times.iter().map(message).collect();
        self.write("IMU", messages);
    }
}
