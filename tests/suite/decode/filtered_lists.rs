//! Paths to the first element of a list that satisfies filters, in every encoding.

use flightcam::{
    sample::{Kind, Sample},
    source::Source,
};
use proptest::{collection::vec, prelude::*};
use serde_json::{Value, json};

use crate::support::{
    folder::assert_reads,
    logbook::{Logbook, protobuf_message, request},
    ros::{Types, Wire},
    small_logs::{Found, dropped},
    telemetry::InMemory,
};

/// The encodings in which the same messages are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Form {
    Json,
    Protobuf,
    Ros(Wire),
}

const FORMS: [Form; 5] = [
    Form::Json,
    Form::Protobuf,
    Form::Ros(Wire::LittleEndian),
    Form::Ros(Wire::BigEndian),
    Form::Ros(Wire::Ros1),
];

const PROTOBUF: &str = "
    message Message { repeated Body bodies = 3; double still = 7; }
    message Body { Header header = 1; int32 id = 2; repeated Part parts = 4; Vector v = 5; bool ok = 6; string pad = 9; }
    message Header { string frame = 2; }
    message Part { string name = 1; double x = 2; repeated float list = 3; }
    message Vector { double x = 1; double y = 2; double z = 3; }";

fn types() -> Types {
    Types::from([
        ("t/T", "t/Body[] bodies\nfloat64 still"),
        (
            "t/Body",
            "string pad\nt/Header header\nint32 id\nt/Part[] parts\nt/Vector v\nbool ok",
        ),
        ("t/Header", "string frame"),
        ("t/Part", "string name\nfloat64 x\nfloat32[] list"),
        ("t/Vector", "float64 x\nfloat64 y\nfloat64 z"),
    ])
}

fn log_of(form: Form, messages: &[Value]) -> Logbook {
    let mut log = Logbook::new();
    let each = |write: &dyn Fn(&Value) -> Vec<u8>| messages.iter().map(write).collect();
    let (channel, payloads): (u16, Vec<Vec<u8>>) = match form {
        Form::Json => (
            log.json("/t"),
            each(&|message| message.to_string().into_bytes()),
        ),
        Form::Protobuf => {
            let (channel, descriptor) = log.protobuf("/t", PROTOBUF);
            let write = |message: &Value| protobuf_message(&descriptor, &message.to_string());
            (channel, each(&write))
        }
        Form::Ros(wire) => {
            let types = types();
            let channel = log.ros(wire, "/t", "t/T", &types.text("t/T"));
            (
                channel,
                each(&|message| types.serialize(wire, "t/T", message)),
            )
        }
    };
    for (payload, time) in payloads.iter().zip(0..) {
        log.put(channel, time, payload);
    }
    log
}

/// A profile that reads the velocity there, of a drone that stands still.
fn profile(vector: &str) -> String {
    format!(
        r#"
        name = "own"
        [attitude]
        topics = ["/t"]
        orientation.euler = {{ roll = "still", pitch = "still", yaw = "still", unit = "radians" }}
        [velocity]
        topics = ["/t"]
        vector = {vector}
        frame = "ned"
        "#
    )
}

fn find(form: Form, messages: &[Value], vector: &str) -> Found {
    log_of(form, messages).velocities(&profile(vector))
}

fn body(frame: &str, id: i32, v: [f64; 3]) -> Value {
    let [x, y, z] = v;
    json!({
        "pad": "-".repeat(id.unsigned_abs() as usize % 7),
        "header": { "frame": frame },
        "id": id,
        "parts": [{ "name": "a", "x": v[0], "list": [1, 2] }, { "name": frame, "x": v[1], "list": [] }],
        "v": { "x": x, "y": y, "z": z },
        "ok": id % 2 == 1,
    })
}

fn message(bodies: Vec<Value>) -> Value {
    json!({ "bodies": bodies, "still": 0 })
}

#[test]
fn the_first_element_that_satisfies_all_filters_is_read() {
    let bodies = vec![
        body("map", 1, [1.0, 0.0, 0.0]),
        body("base", 2, [2.0, 0.0, 0.0]),
        body("base", 3, [3.0, 0.0, 0.0]),
        body("base", 3, [4.0, 0.0, 0.0]),
    ];
    for (filters, expected) in [
        (r#"{header.frame=="map"}"#, 1.0),
        (r#"{header.frame=="base"}"#, 2.0),
        (r#"{header.frame=='base'}{id==3}"#, 3.0),
        (r#"{header.frame!="map"}"#, 2.0),
        ("{id!=1}{id!=2}", 3.0),
        ("{ok==false}", 2.0),
        ("{ok==true}{id!=1}", 3.0),
        ("{v.x==4}", 4.0),
        ("{v.x==4.0}", 4.0),
        (r#"{parts[1].name=="base"}"#, 2.0),
        (r#"{parts[:]{name=="base"}.x==0}"#, 2.0),
    ] {
        for form in FORMS {
            let found = find(
                form,
                &[message(bodies.clone())],
                &format!("'''bodies[:]{filters}.v'''"),
            );
            let expected = (vec![[expected, 0.0, 0.0]], vec![]);
            assert_eq!(found, Ok(expected), "{form:?} {filters}");
        }
    }
}

#[test]
fn each_message_is_searched_anew_in_whatever_order_its_elements_are() {
    let [a, b] = [
        body("map", 1, [1.0, 2.0, 3.0]),
        body("base", 2, [4.0, 5.0, 6.0]),
    ];
    let messages = [
        message(vec![a.clone(), b.clone()]),
        message(vec![b.clone(), a.clone()]),
        message(vec![a.clone()]),
        message(vec![]),
        message(vec![a.clone(), a.clone(), b.clone(), a.clone()]),
    ];
    for form in FORMS {
        let vector = r#"'bodies[:]{header.frame=="base"}.v'"#;
        let found = find(form, &messages, vector);
        // The other messages are not this source's.
        assert_eq!(found, Ok((vec![[4.0, 5.0, 6.0]; 3], vec![])), "{form:?}");
    }
}

#[test]
fn elements_within_elements_are_found() {
    let messages = [
        message(vec![
            body("map", 1, [1.0, 2.0, 3.0]),
            body("base", 2, [4.0, 5.0, 6.0]),
        ]),
        message(vec![body("base", 2, [7.0, 8.0, 9.0])]),
    ];
    for form in FORMS {
        let each = |field: &str| format!(r#"'bodies[:]{{id==2}}.{field}'"#);
        let vector = format!(
            "[{}, {}, {}]",
            each(r#"parts[:]{name=="a"}.x"#),
            each(r#"parts[:]{name=="base"}.x"#),
            each(r#"parts[:]{name=="a"}.list[1]"#),
        );
        let found = find(form, &messages, &vector);
        let expected = (vec![[4.0, 5.0, 2.0], [7.0, 8.0, 2.0]], vec![]);
        assert_eq!(found, Ok(expected), "{form:?}");
    }
}

#[test]
fn two_roles_may_read_different_elements_of_one_list() {
    let profile = r#"
        name = "two"
        [attitude]
        topics = ["/t"]
        orientation.quaternion = ['bodies[:]{id==1}.v.x', 'bodies[:]{id==1}.v.y', 'still', 'bodies[:]{id==1}.v.z']
        convention = "frd-ned"
        [gimbal]
        topics = ["/t"]
        orientation.pitch = { field = 'bodies[:]{header.frame=="gimbal"}.v.x', unit = "radians" }
        reference = "heading"
    "#;
    let drone = body("drone", 1, [1.0, 0.0, 0.0]);
    let gimbal = body("gimbal", 5, [-0.5, 0.0, 0.0]);
    let messages = [
        message(vec![drone.clone(), gimbal.clone()]),
        message(vec![gimbal.clone(), drone.clone()]),
        message(vec![drone.clone()]),
        message(vec![gimbal.clone()]),
        message(vec![drone, body("other", 1, [0.0, 1.0, 0.0]), gimbal]),
    ];
    for form in FORMS {
        let (samples, tallies) = log_of(form, &messages).samples(profile).expect("samples");
        for sample in &samples {
            if let Sample::Attitude(attitude) = sample {
                let angle = attitude.orientation.angle();
                assert!(angle < 1e-12, "{form:?}: another element was read");
            }
        }
        let pitches: Vec<f64> = (samples.iter())
            .filter_map(|sample| match sample {
                Sample::Gimbal(gimbal) => Some(gimbal.orientation.euler_angles().1),
                _ => None,
            })
            .collect();
        assert_eq!(pitches.len(), 4, "{form:?}");
        assert!(pitches.iter().all(|pitch| (pitch + 0.5).abs() < 1e-12));
        assert_eq!(samples.len(), 8);
        for kind in [Kind::Attitude, Kind::Gimbal] {
            assert_eq!(tallies[kind].unselected, 1, "{form:?}");
            assert_eq!(dropped(&tallies[kind]), []);
        }
    }
}

#[test]
fn a_wrong_filter_is_an_error_that_names_its_field() {
    for (filter, words) in [
        (
            "{frame==1}",
            "it has no field `frame`; … has … `header`, `id`",
        ),
        (
            r#"{id=="a"}"#,
            "its field `id` is not text but a single number",
        ),
        (
            "{header.frame==1}",
            "its field `header.frame` is not a number but text",
        ),
        (
            "{header==1}",
            "its field `header` is not a number but a message",
        ),
    ] {
        for form in [Form::Protobuf, Form::Ros(Wire::Ros1)] {
            let vector = format!("'bodies[:]{filter}.v'");
            let problem = find(form, &[message(vec![])], &vector).expect_err("a wrong filter");
            assert_reads(&problem.replace('`', ""), &words.replace('`', ""));
        }
    }
    let both = r#"['bodies[:]{id==1}.v.x', 'bodies[0].v.y', 'still']"#;
    for form in FORMS {
        let problem = find(form, &[message(vec![body("a", 1, [0.0; 3])])], both);
        let problem = problem.expect_err("a place and a filter");
        assert_reads(&problem, "are wanted both by their place and by a filter");
    }
}

#[test]
fn finding_elements_allocates_nothing() {
    let [a, b] = [
        body("map", 1, [1.0, 2.0, 3.0]),
        body("base", 2, [4.0, 5.0, 6.0]),
    ];
    let messages: Vec<Value> = (0..40)
        .map(|i| match i % 2 {
            0 => message(vec![a.clone(), b.clone()]),
            _ => message(vec![b.clone(), a.clone(), b.clone()]),
        })
        .collect();
    let profile = profile(r#"'bodies[:]{header.frame=="base"}{id!=1}.v'"#);
    for form in FORMS {
        let mut telemetry = InMemory::read(log_of(form, &messages), &profile);
        let (source, messages) = telemetry.parts();
        let mut samples = 0;
        let mut read = |messages: &[_]| {
            for message in messages {
                source.read(message, |_, sample| samples += u32::from(sample.is_ok()));
            }
        };
        // The first ones show what the filters do not hold for, which is remembered.
        read(&messages[..2]);
        let allocations = allocation_counter::measure(|| read(&messages[2..]));
        let expected = match form {
            // Objects within skipped ones are noted by the parser in a buffer.
            Form::Json => allocations.count_total.min(2 * 38),
            _ => 0,
        };
        assert_eq!(allocations.count_total, expected, "{form:?}");
        assert_eq!(samples, 80, "{form:?}");
    }
}

#[test]
fn a_filter_that_never_holds_is_reported_with_what_there_is() {
    let frames = ["base_link", "camera", "base_link"];
    let messages: Vec<Value> = (frames.iter())
        .map(|frame| message(vec![body(frame, 1, [0.0; 3])]))
        .collect();
    for form in FORMS {
        let unmet = |filters: &str| {
            let profile = profile(&format!("'''bodies[:]{filters}.v'''"));
            let mut telemetry = InMemory::read(log_of(form, &messages), &profile);
            let (source, messages) = telemetry.parts();
            for message in &messages {
                source.read(message, |_, _| {});
            }
            assert_eq!(source.unselected(Kind::Velocity), 3);
            assert_eq!(source.unselected(Kind::Attitude), 0);
            unmet_of(source)
        };
        assert_eq!(
            unmet(r#"{header.frame=="base_lnk"}"#),
            [r#"`header.frame` is "base_link" or "camera", never "base_lnk""#],
            "{form:?}"
        );
        assert_eq!(
            unmet(r#"{header.frame!="a"}{id==2}"#),
            ["`id` is 1, never 2"],
            "{form:?}"
        );
        assert_eq!(unmet("{id!=1}"), ["`id` is always 1"], "{form:?}");
    }
}

fn unmet_of(source: &Source) -> Vec<String> {
    let unmet = source.unmet_filters(Kind::Velocity).into_iter();
    unmet.map(|filter| filter.to_string()).collect()
}

/// What JSON leaves open: elements without the field, null, and other types in between.
#[test]
fn json_elements_may_differ() {
    let profile = profile(r#"'bodies[:]{id==2}.v'"#);
    let whole = body("a", 2, [1.0, 2.0, 3.0]);
    let messages = [
        json!({ "still": 0, "bodies": [null, { "id": "x2" , "v": 7 }, {}, { "id": null }, whole] }),
        json!({ "still": 0, "bodies": [{ "id": "2", "v": { "x": 4, "y": 5, "z": 6 } }] }),
        json!({ "still": 0, "bodies": null }),
        json!({ "still": 0 }),
    ];
    // An element in which a field is not what is wanted, where it may be wanted.
    let mut clean = messages.clone();
    clean[0]["bodies"][1] = json!({ "id": 3 });
    let found = log_of(Form::Json, &clean).velocities(&profile);
    assert_eq!(found, Ok((vec![[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]], vec![])));
    let found = log_of(Form::Json, &messages).velocities(&profile);
    assert_eq!(found, Ok((vec![[4.0, 5.0, 6.0]], vec![("undecodable", 1)])));
    let mut log = Logbook::new();
    let channel = log.json("/t");
    log.put(channel, 0, messages[1].to_string().as_bytes());
    let path = request(&profile);
    let (_folder, file) = log.finish();
    let log = flightcam::log::Log::open(&file).expect("a log");
    let source = Source::select(&log, &path).expect("a source");
    assert_eq!(source.role(Kind::Velocity).expect("one").topic, "/t");
}

fn any_body() -> impl Strategy<Value = Value> {
    let frame = prop::sample::select(vec!["map", "base", ""]);
    (frame, 0..4i32, [-9..9i32, -9..9, -9..9])
        .prop_map(|(frame, id, v)| body(frame, id, v.map(f64::from)))
}

proptest! {
    #![proptest_config(crate::support::cases(96))]

    #[test]
    fn the_same_element_is_found_in_every_encoding(
        lists in vec(vec(any_body(), 0..6), 1..6),
        frame in prop::sample::select(vec!["map", "base", ""]),
        id in 0..4i32,
        is_equal in any::<bool>(),
    ) {
        let comparison = if is_equal { "==" } else { "!=" };
        let vector = format!(r#"'bodies[:]{{header.frame=="{frame}"}}{{id{comparison}{id}}}.v'"#);
        let is_meant = |body: &&Value| body["header"]["frame"] == frame && (body["id"] == id) == is_equal;
        let number = |value: &Value| value.as_f64().expect("a number");
        let expected: Vec<[f64; 3]> = (lists.iter())
            .filter_map(|bodies| bodies.iter().find(is_meant))
            .map(|body| ["x", "y", "z"].map(|axis| number(&body["v"][axis])))
            .collect();
        let messages: Vec<Value> = lists.into_iter().map(message).collect();
        for form in FORMS {
            match find(form, &messages, &vector) {
                Ok(found) => prop_assert_eq!(&found, &(expected.clone(), vec![]), "{:?}", form),
                // No element shows which fields there are.
                Err(problem) => prop_assert!(form == Form::Json && expected.is_empty(), "{}", problem),
            }
        }
    }
}
