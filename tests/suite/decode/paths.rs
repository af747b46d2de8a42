//! Paths to fields, in Foxglove's message-path syntax.

use flightcam::decode::path::{FieldPath, MessagePath, PathStep};
use proptest::prelude::*;

use crate::support::folder::assert_reads;

fn field(path: &str) -> FieldPath {
    path.parse().expect("a path")
}

#[test]
fn a_path_leads_through_names_and_lists() {
    let name = |name: &str| PathStep::Name(name.to_owned());
    for (text, steps) in [
        ("roll", vec![name("roll")]),
        ("velocity.x", vec![name("velocity"), name("x")]),
        ("q[0]", vec![name("q"), PathStep::Index(0)]),
        (
            "esc[2].rpm",
            vec![name("esc"), PathStep::Index(2), name("rpm")],
        ),
        (
            "m[1][2]",
            vec![name("m"), PathStep::Index(1), PathStep::Index(2)],
        ),
    ] {
        assert_eq!(field(text).steps(), steps, "{text}");
    }
}

#[test]
fn an_invalid_path_is_an_error_that_shows_the_syntax() {
    for text in [
        "",
        ".x",
        "x.",
        "x..y",
        "[0]",
        "q[-1]",
        "q[+1]",
        "q[]",
        "q[1:2]",
        "q[:]",
        "q[a]",
        "q[1",
        "q]1[",
        "q[0]x",
        "q{id==1}",
        "q.@abs",
        "a b",
        "/a/b",
        "q[99999999999999999999]",
    ] {
        let problem = text.parse::<FieldPath>().expect_err(text).to_string();
        assert!(problem.starts_with(&format!("`{text}` is not the path of a field")));
        assert_reads(
            &problem,
            "names joined by dots … counted from 0 … `q[0]` … slices and filters",
        );
    }
}

#[test]
fn a_path_may_begin_with_a_topic_in_quotes_or_without() {
    for (text, topic, path) in [
        ("/imu.q[0]", "/imu", Some("q[0]")),
        ("/imu", "/imu", None),
        (r#""/a.b".c.d"#, "/a.b", Some("c.d")),
        (r#""/a[0]{1}""#, "/a[0]{1}", None),
        ("vehicle_attitude.q", "vehicle_attitude", Some("q")),
    ] {
        let expected = MessagePath {
            topic: topic.to_owned(),
            field: path.map(field),
        };
        assert_eq!(text.parse(), Ok(expected), "{text}");
    }
    for text in [
        "",
        ".x",
        "/imu.",
        r#""/imu"#,
        r#""/imu"q"#,
        r#""".q"#,
        "/imu[0].q",
        "/imu{id==1}.q",
    ] {
        let problem = text.parse::<MessagePath>().expect_err(text).to_string();
        assert_reads(
            &problem,
            "is not a message path: write a topic and a field, as in … double quotes",
        );
    }
}

fn step() -> impl Strategy<Value = String> {
    (
        "[a-zA-Z_][a-zA-Z0-9_]{0,8}",
        prop::collection::vec(0..usize::MAX, 0..3),
    )
        .prop_map(|(name, indexes)| {
            let indexes = indexes.iter().map(|index| format!("[{index}]"));
            name + &indexes.collect::<String>()
        })
}

proptest! {
    #![proptest_config(crate::support::cases(256))]

    #[test]
    fn a_path_is_displayed_as_it_was_parsed(steps in prop::collection::vec(step(), 1..5)) {
        let text = steps.join(".");
        let path = field(&text);
        prop_assert_eq!(path.to_string(), text.clone());
        let quoted: MessagePath = format!("\"/a.b:c\".{text}").parse().expect("a path");
        prop_assert_eq!(quoted.field, Some(path));
    }

    #[test]
    fn a_path_of_any_text_is_the_same_when_written_and_read_again(text in ".{0,20}") {
        if let Ok(path) = text.parse::<FieldPath>() {
            prop_assert_eq!(String::from(path.clone()).parse(), Ok(path));
        }
    }
}
