//! JSON fields that are null in the first messages, so that only later ones show what they are.

use flightcam::source::request::Request;
use mcap::WriteOptions;
use serde_json::{Value, json};

use crate::support::{
    folder::assert_reads,
    logbook::request as request_of_profile,
    piping::{check, rewritten, telemetry},
    selecting::{select_with, used},
    topics::*,
};

/// Each attitude and velocity in an object of its own.
const NESTED: &str = r#"
    name = "nested"
    attitude.orientation.quaternion = "pose.q"
    attitude.convention = "frd-ned"
    velocity = { vector = "pose.v", frame = "ned" }
"#;

/// A topic whose messages are `first` that many times, and then three times `later`.
fn beginning_with(first: Value, count: usize, later: Value) -> Topic {
    let first = std::iter::repeat_n(first, count);
    topic("/drone", first.chain(std::iter::repeat_n(later, 3)))
}

/// How many samples there are of the drone, in a file and in a stream; or why there are none.
fn samples(topics: &[Topic], request: &Request) -> Result<usize, String> {
    let log = log(topics);
    let small_chunks = WriteOptions::new().chunk_size(Some(300));
    let mut samples = Err(String::new());
    for log in [rewritten(&log, small_chunks), log] {
        let streamed = check(&log, request, 4000).expect("a readable log");
        samples = telemetry(&streamed.telemetry, request).map(|(_, samples)| samples.len() - 1);
    }
    samples
}

fn whole() -> Value {
    json!({ "pose": { "q": quaternion(), "v": vector() } })
}

#[test]
fn what_is_null_at_first_is_found_where_it_is_not() {
    let request = request_of_profile(NESTED);
    for first in [
        json!({ "pose": null }),
        json!({ "pose": { "q": null, "v": null } }),
        json!({ "pose": { "q": null, "v": vector() } }),
        json!({ "pose": null, "mode": "AUTO" }),
    ] {
        for count in [1, 9, 10, 11, 60, 900] {
            let drone = beginning_with(first.clone(), count, whole());
            let source = select_with(&[drone], &request);
            let source = source.unwrap_or_else(|error| panic!("{first} {count} times: {error}"));
            assert_eq!(used(&source), ("nested", "/drone", "/drone"));
        }
    }
    let drone = beginning_with(json!({ "pose": null }), 30, whole());
    assert_eq!(samples(&[drone], &request), Ok(6));
}

#[test]
fn different_fields_may_be_null_in_different_messages() {
    let messages = (0..40).map(|i| {
        json!({ "pose": {
            "q": if i == 20 { quaternion() } else { Value::Null },
            "v": if i == 35 { vector() } else { Value::Null },
        } })
    });
    let drone = topic("/drone", messages);
    assert_eq!(samples(&[drone], &request_of_profile(NESTED)), Ok(2));
}

#[test]
fn a_list_may_be_empty_at_first() {
    let request = request_of_profile(
        r#"
        name = "elements"
        attitude.orientation.quaternion = "bodies[1].q"
        attitude.convention = "frd-ned"
    "#,
    );
    let later = json!({ "bodies": [{}, { "q": quaternion() }] });
    for first in [json!({ "bodies": [] }), json!({ "bodies": [{}] })] {
        let drone = beginning_with(first, 30, later.clone());
        assert_eq!(samples(&[drone], &request), Ok(3));
    }
}

#[test]
fn a_schema_that_lists_an_object_does_not_say_what_is_in_it() {
    let schema = json!({ "properties": { "pose": { "type": ["object", "null"] } } });
    let drone = beginning_with(json!({ "pose": null }), 30, whole()).with_schema(
        "State",
        "jsonschema",
        schema.to_string(),
    );
    assert_eq!(samples(&[drone], &request_of_profile(NESTED)), Ok(6));
}

#[test]
fn what_is_missing_and_not_null_is_not_looked_for_further() {
    let drone = beginning_with(json!({ "mode": "AUTO" }), 30, whole());
    let problem = samples(&[drone], &request_of_profile(NESTED)).expect_err("no field");
    assert_reads(
        &problem,
        "no topic has messages with all of the fields `pose.q`",
    );
}

/// Not all of a log is read for a field that it may not have at all.
#[test]
fn a_field_that_is_null_in_a_thousand_messages_is_not_found() {
    let drone = beginning_with(json!({ "pose": null }), 1000, whole());
    let request = request_of_profile(NESTED);
    let problem = select_with(&[drone], &request).expect_err("no field");
    assert_reads(
        &problem.to_string(),
        "no topic has messages with all of the fields `pose.q`",
    );
}
