//! Any number of any ROS message is read exactly, whatever comes before it: random definitions and messages of them,
//! in each of the three forms, from a serialiser of the tests' own.

use std::collections::BTreeMap;

use flightcam::{
    geometry::RollPitchYaw,
    sample::{DropReason, Kind, Position, Sample, Velocity},
};
use proptest::{collection::vec, prelude::*, sample::Index, test_runner::TestRng};
use serde_json::{Map, Value, json};

use crate::support::{
    logbook::Logbook,
    ros::{Field, List, Types, Wire},
};

/// What a field holds, before it has a name.
#[derive(Debug, Clone)]
enum Shape {
    Number(&'static str),
    Text,
    Time,
    Message(Vec<(Shape, List)>),
}

const NUMBERS: [&str; 13] = [
    "bool", "byte", "char", "int8", "uint8", "int16", "uint16", "int32", "uint32", "int64",
    "uint64", "float32", "float64",
];

fn list() -> impl Strategy<Value = List> {
    prop_oneof![
        4 => Just(List::No),
        2 => (1..5_usize).prop_map(List::Fixed),
        2 => Just(List::Varying),
        1 => Just(List::Bounded(6)),
    ]
}

/// A message within at most two others.
fn message() -> impl Strategy<Value = Shape> {
    let leaf = prop_oneof![
        8 => prop::sample::select(&NUMBERS[..]).prop_map(Shape::Number),
        2 => Just(Shape::Text),
        1 => Just(Shape::Time),
    ];
    let within = leaf.prop_recursive(2, 24, 6, |inner| {
        vec((inner, list()), 0..6).prop_map(Shape::Message)
    });
    vec((within, list()), 1..8).prop_map(Shape::Message)
}

/// Random numbers for what fills a message, which need not be made simpler when a case fails.
#[derive(Debug)]
struct Random(TestRng);

impl Random {
    fn below(&mut self, end: usize) -> usize {
        self.0.random_range(0..end)
    }

    fn value(&mut self, wire: Wire, base: &str) -> Value {
        let bits: u64 = self.0.random();
        // Small numbers and the ends of ranges come often.
        let bits = bits >> [0, 0, 32, 48, 63, 64][self.below(6)].min(63);
        match base {
            "bool" => (bits & 1 == 1).into(),
            "byte" if wire == Wire::Ros1 => (bits as i8).into(),
            "uint8" | "char" | "byte" => (bits as u8).into(),
            "uint16" => (bits as u16).into(),
            "uint32" => (bits as u32).into(),
            "uint64" => bits.into(),
            "int8" => (bits as i8).into(),
            "int16" => (bits as i16).into(),
            "int32" => (bits as i32).into(),
            "int64" => (bits as i64).into(),
            "float32" => finite(f32::from_bits(bits as u32).into()).into(),
            _ => finite(f64::from_bits(bits)).into(),
        }
    }
}

/// JSON has no other numbers.
fn finite(number: f64) -> f64 {
    if number.is_finite() { number } else { -0.0 }
}

/// A definition in the making, of a message of that shape.
struct Definition {
    wire: Wire,
    types: Types,
}

impl Definition {
    fn add(&mut self, shape: &[(Shape, List)]) -> String {
        let name = format!("p/M{}", self.types.0.len());
        self.types.0.insert(name.clone(), Vec::new());
        let fields = shape
            .iter()
            .enumerate()
            .map(|(place, (shape, list))| Field {
                name: format!("f{place}"),
                base: match shape {
                    Shape::Number(base) => (*base).to_owned(),
                    Shape::Text => "string".to_owned(),
                    Shape::Time if self.wire == Wire::Ros1 => "time".to_owned(),
                    Shape::Time => "builtin_interfaces/Time".to_owned(),
                    Shape::Message(fields) => self.add(fields),
                },
                list: match (list, self.wire) {
                    (List::Bounded(_), Wire::Ros1) => List::Varying,
                    (list, _) => *list,
                },
            });
        let fields = fields.collect();
        self.types.0.insert(name.clone(), fields);
        name
    }
}

/// A message in the making, and its numbers by their paths.
struct Filling<'a> {
    wire: Wire,
    random: &'a mut Random,
    numbers: BTreeMap<String, f64>,
}

impl Filling<'_> {
    fn message(&mut self, fields: &[(Shape, List)], path: &str) -> Value {
        let mut message = Map::new();
        for (place, (shape, list)) in fields.iter().enumerate() {
            let path = format!("{path}f{place}");
            let length = match list {
                List::No => None,
                List::Fixed(length) => Some(*length),
                List::Varying | List::Bounded(_) => Some(self.random.below(5)),
            };
            let value = match length {
                None => self.one(shape, path),
                Some(length) => (0..length)
                    .map(|index| self.one(shape, format!("{path}[{index}]")))
                    .collect(),
            };
            message.insert(format!("f{place}"), value);
        }
        Value::Object(message)
    }

    fn one(&mut self, shape: &Shape, path: String) -> Value {
        match shape {
            Shape::Text => "größer"[..[0, 1, 2, 4][self.random.below(4)]].into(),
            Shape::Message(fields) => self.message(fields, &format!("{path}.")),
            Shape::Number(base) => {
                let value = self.random.value(self.wire, base);
                let truth = value.as_bool().map(|truth| f64::from(u8::from(truth)));
                let number = value.as_f64().or(truth).expect("a number");
                self.numbers.insert(path, number);
                value
            }
            Shape::Time => {
                let [seconds, nanoseconds] =
                    [self.random.below(1 << 31), self.random.below(1_000_000_000)];
                let name = if self.wire == Wire::Ros1 {
                    "nsec"
                } else {
                    "nanosec"
                };
                self.numbers.insert(format!("{path}.sec"), seconds as f64);
                self.numbers
                    .insert(format!("{path}.{name}"), nanoseconds as f64);
                json!({"sec": seconds, name: nanoseconds})
            }
        }
    }
}

/// Nine numbers: an attitude, a velocity, a position.
fn profile(fields: &[&str]) -> String {
    let [r, p, y, vx, vy, vz, px, py, pz] = fields else {
        panic!("not nine: {fields:?}")
    };
    format!(
        r#"
        name = "random"
        [attitude]
        topics = ["/t"]
        orientation.euler = {{ roll = "{r}", pitch = "{p}", yaw = "{y}", unit = "radians" }}
        [velocity]
        topics = ["/t"]
        vector = ["{vx}", "{vy}", "{vz}"]
        frame = "ned"
        [position]
        topics = ["/t"]
        local = {{ vector = ["{px}", "{py}", "{pz}"], frame = "ned" }}
        "#
    )
}

fn check(
    wire: Wire,
    fields: &[(Shape, List)],
    random: &mut Random,
    wanted: &[Index],
) -> Result<(), TestCaseError> {
    let mut definition = Definition {
        wire,
        types: Types::default(),
    };
    let name = definition.add(fields);
    let text = definition.types.text(&name);
    let mut log = Logbook::new();
    let channel = log.ros(wire, "/t", &name, &text);
    let mut messages = Vec::new();
    for time in 0..3 {
        let mut filling = Filling {
            wire,
            random,
            numbers: BTreeMap::new(),
        };
        let message = filling.message(fields, "");
        messages.push(filling.numbers);
        log.put(
            channel,
            time,
            &definition.types.serialize(wire, &name, &message),
        );
    }
    // Of the first message; the others may lack some, where their lists are shorter.
    let paths: Vec<&String> = messages[0].keys().collect();
    prop_assume!(!paths.is_empty());
    let paths: Vec<&str> = wanted
        .iter()
        .map(|wanted| wanted.get(&paths).as_str())
        .collect();

    let found = log.samples(&profile(&paths));
    let (samples, tallies) =
        found.map_err(|error| TestCaseError::fail(format!("{error}\n{text}")))?;
    for (kind, paths) in [Kind::Attitude, Kind::Velocity, Kind::Position]
        .into_iter()
        .zip(paths.chunks(3))
    {
        let mut missing = 0;
        for (numbers, time) in messages.iter().zip(0..) {
            let mut of_kind = samples.iter().filter(|sample| sample.kind() == kind);
            let sample = of_kind.find(|sample| sample.stamp().log_time == time * 1_000_000);
            let numbers: Option<Vec<f64>> = paths
                .iter()
                .map(|&path| numbers.get(path).copied())
                .collect();
            let Some(numbers) = numbers else {
                missing += 1;
                prop_assert!(sample.is_none());
                continue;
            };
            match sample.expect("a sample") {
                Sample::Attitude(sample) => {
                    let [roll, pitch, yaw] = numbers[..] else {
                        panic!()
                    };
                    let expected = RollPitchYaw { roll, pitch, yaw }.to_quaternion();
                    prop_assert_eq!(
                        sample.orientation.coords,
                        expected.coords,
                        "{:?}\n{}",
                        paths,
                        text
                    );
                }
                Sample::Velocity(sample) => {
                    let Velocity::Ned(found) = sample.velocity else {
                        panic!()
                    };
                    prop_assert_eq!(found.as_slice(), numbers, "{:?}\n{}", paths, text);
                }
                Sample::Position(sample) => {
                    let Position::Local(found) = sample.position else {
                        panic!()
                    };
                    prop_assert_eq!(found.as_slice(), numbers, "{:?}\n{}", paths, text);
                }
                other => panic!("{other:?}"),
            }
        }
        let expected = (missing > 0).then_some((DropReason::MissingField, missing));
        let dropped = tallies[kind]
            .dropped
            .iter()
            .map(|(&reason, &count)| (reason, count));
        prop_assert_eq!(dropped.collect::<Vec<_>>(), Vec::from_iter(expected));
    }
    Ok(())
}

proptest! {
    #![proptest_config(crate::support::cases(256))]
    #[test]
    fn every_number_of_a_random_message_is_read_exactly(
        shape in message(),
        mut random in any::<()>().prop_perturb(|(), rng| Random(rng)),
        wanted in vec(any::<Index>(), 9),
    ) {
        let Shape::Message(fields) = shape else { panic!("a message") };
        for wire in Wire::ALL {
            check(wire, &fields, &mut random, &wanted)?;
        }
    }
}
