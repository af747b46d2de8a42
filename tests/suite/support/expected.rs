//! Results against numbers that were computed independently.

use super::{ReadMessage, message::DerivedMessage, orientations::check_orientations};

/// A row of the expected results: topic, log time, three numbers.
type Row = (String, u64, [f64; 3]);

fn expected(csv: &str) -> Vec<Row> {
    csv.lines()
        .skip(1)
        .map(|line| {
            let fields: Vec<&str> = line.split(',').collect();
            let number = |i: usize| fields[i].parse().expect("a number");
            let time = fields[1].parse().expect("a time");
            (
                fields[0].to_owned(),
                time,
                [number(2), number(3), number(4)],
            )
        })
        .collect()
}

fn derived(messages: Vec<ReadMessage>) -> Vec<Row> {
    let row = |message: ReadMessage| {
        let decoded = DerivedMessage::decode(&message);
        let frame_id = match message.topic.as_str() {
            "/camera/velocity" => "camera",
            _ => "previous_camera",
        };
        assert_eq!(
            (decoded.stamp, decoded.frame_id.as_str()),
            (message.log_time, frame_id)
        );
        (message.topic, message.log_time, decoded.triple())
    };
    messages.into_iter().map(row).collect()
}

/// Checks the new messages of a result: the rotations and velocities against a table of their numbers, to 1e-9, and the
/// orientations, which the table does not have, by the rotations between them.
#[track_caller]
pub fn assert_as_expected(mut messages: Vec<ReadMessage>, csv: &str) {
    check_orientations(&messages);
    messages.retain(|message| message.topic != "/camera/orientation");
    let mut expected = expected(csv);
    let mut derived = derived(messages);
    let key = |row: &Row| (row.0.clone(), row.1);
    expected.sort_by_key(key);
    derived.sort_by_key(key);
    assert_eq!(
        derived.iter().map(key).collect::<Vec<_>>(),
        expected.iter().map(key).collect::<Vec<_>>()
    );
    for ((topic, time, derived), (_, _, expected)) in derived.iter().zip(&expected) {
        for (derived, expected) in derived.iter().zip(expected) {
            let error = (derived - expected).abs();
            assert!(error < 1e-9, "{topic} at {time}: {derived}, not {expected}");
        }
    }
}
