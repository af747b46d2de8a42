//! Reading the wanted fields of a message allocates nothing, so that a long log costs no more than its bytes.

use serde_json::json;

use crate::support::{
    logbook::{Logbook, protobuf_message},
    ros::{Types, Wire},
    telemetry::{InMemory, Kind, Language, write},
};

/// How many samples there are in messages, and how many allocations it takes to read them again.
fn count(mut telemetry: InMemory) -> (u64, u64) {
    let (source, messages) = telemetry.parts();
    // The first message shows in which axes all are, which is remembered.
    messages
        .iter()
        .for_each(|message| source.read(message, |_, _| {}));
    let mut samples = 0;
    let allocations = allocation_counter::measure(|| {
        for message in &messages {
            source.read(message, |_, sample| samples += u64::from(sample.is_ok()));
        }
    });
    (samples, allocations.count_total)
}

const MOMENTS: u64 = 50;

#[test]
fn reading_a_message_allocates_nothing() {
    for kind in Kind::ALL {
        for language in Language::ALL {
            let counted = count(InMemory::read(
                write(kind, language, MOMENTS),
                kind.profile(),
            ));
            let expected = match (kind, language) {
                // Its header, which is skipped, has an object within it: the parser notes that in a buffer.
                (Kind::Odometry, Language::Json) => MOMENTS,
                _ => 0,
            };
            assert_eq!(
                counted,
                (2 * MOMENTS, expected),
                "{} {language}",
                kind.name()
            );
        }
    }
}

const PROFILE: &str = r#"
    name = "of elements"
    time = { field = { path = "stamps[1]", unit = "ns" } }
    [attitude]
    topics = ["/rotors"]
    when = { field = "mode", says = "flying" }
    orientation.euler = { roll = "esc[0].angles[2]", pitch = "esc[2].angles[0]", yaw = "esc[2].angles[1]", unit = "degrees" }
"#;

const MESSAGE: &str = r#"{"stamps":[3,4,5],"note":"tail\twind","mode":"flying",
    "esc":[{"angles":[1,2,3]},{"angles":[4]},{"angles":[5,6]}]}"#;

#[test]
fn reading_strings_and_list_elements_allocates_nothing() {
    let mut log = Logbook::new();
    let (channel, message) = log.protobuf(
        "/rotors",
        "message Message { repeated uint64 stamps = 1; string note = 2; string mode = 3; repeated Esc esc = 4; }
         message Esc { repeated float angles = 1; }",
    );
    log.put(channel, 0, &protobuf_message(&message, MESSAGE));
    assert_eq!(count(InMemory::read(log, PROFILE)), (1, 0));

    let types = Types::from([
        (
            "t/Rotors",
            "uint64[] stamps\nstring note\nstring mode\nt/Esc[] esc",
        ),
        ("t/Esc", "float32[] angles"),
    ]);
    for wire in Wire::ALL {
        let mut log = Logbook::new();
        let channel = log.ros(wire, "/rotors", "t/Rotors", &types.text("t/Rotors"));
        let message = serde_json::from_str(MESSAGE).expect("JSON");
        log.put(channel, 0, &types.serialize(wire, "t/Rotors", &message));
        assert_eq!(count(InMemory::read(log, PROFILE)), (1, 0), "{wire:?}");
    }
}

#[test]
fn json_strings_with_escapes_take_one_buffer() {
    let flat = |name: &str, text: &str| {
        let mut log = Logbook::new();
        let channel = log.json("/rotors");
        let esc = json!([{"angles": [0, 0, 3]}, {}, {"angles": [5, 6]}]);
        let message = format!(
            r#"{{"{name}":"{text}","{name}":"{text}","stamps":[3,4],"esc":{esc},"mode":"{text}"}}"#
        );
        log.put(channel, 0, message.as_bytes());
        count(InMemory::read(log, PROFILE))
    };
    assert_eq!(flat("note", "flying"), (1, 0));
    assert_eq!(flat("note", r"fl\u0079ing"), (1, 1));
    assert_eq!(flat(r"n\u006fte", "flying"), (1, 1));
    assert_eq!(flat(r"n\u006fte", r"fl\u0079ing"), (1, 1));
}
