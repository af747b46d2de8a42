//! Paths to fields, in Foxglove's message-path syntax.

use flightcam::{
    decode::path::{FieldPath, Filter, MessagePath, PathStep},
    profile::{Comparison, Literal, Number},
};
use proptest::prelude::*;

use crate::support::folder::assert_reads;

fn field(path: &str) -> FieldPath {
    path.parse().expect("a path")
}

fn filter(text: &str) -> Filter {
    text.parse().expect("a filter")
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
        (r#""OSD.pitch""#, vec![name("OSD.pitch")]),
        (r#"a."b.c".d"#, vec![name("a"), name("b.c"), name("d")]),
        (
            r#""a b"."[0]"[1]."{}/:""#,
            vec![name("a b"), name("[0]"), PathStep::Index(1), name("{}/:")],
        ),
        (r#""\"\\\n""#, vec![name(r#""\\n"#)]),
        (r#""".x"#, vec![name(""), name("x")]),
        (
            r#"tf[:]{id==1}{a.b!="}"}[0]"#,
            vec![
                name("tf"),
                PathStep::First(vec![filter("id==1"), filter(r#"a.b!="}""#)]),
                PathStep::Index(0),
            ],
        ),
    ] {
        assert_eq!(field(text).steps(), steps, "{text}");
    }
}

#[test]
fn a_filter_compares_a_field_with_a_value() {
    use Comparison::*;
    let text = |text: &str| Literal::Text(text.to_owned());
    let number = Literal::Number;
    for (written, path, comparison, value) in [
        ("id==1", "id", Equal, number(Number::Signed(1))),
        ("id!=-1", "id", Unequal, number(Number::Signed(-1))),
        (
            "a.b[0]==18446744073709551615",
            "a.b[0]",
            Equal,
            number(Number::Unsigned(u64::MAX)),
        ),
        ("x==1.5e3", "x", Equal, number(Number::Real(1500.0))),
        (r#"id == "b c""#, "id", Equal, text("b c")),
        (r#" id != '"' "#, "id", Unequal, text(r#"""#)),
        (r#"id=='it\'s'"#, "id", Equal, text("it's")),
        (r#""a==b"=="\\""#, r#""a==b""#, Equal, text(r"\")),
        ("ok==true", "ok", Equal, Literal::Truth(true)),
        ("ok!=false", "ok", Unequal, Literal::Truth(false)),
        (
            r#"list[:]{a==1}.b=="x""#,
            "list[:]{a==1}.b",
            Equal,
            text("x"),
        ),
    ] {
        let expected = Filter {
            field: field(path),
            comparison,
            value,
        };
        assert_eq!(written.parse(), Ok(expected), "{written}");
    }
    for text in [
        "", "id", "id=1", "id==", "==1", "id==NaN", "id==inf", "id==a", "id>1", "id==1}",
        "id==\"a", "id==1 2", "id===1", "id==$x",
    ] {
        let problem = text.parse::<Filter>().expect_err(text).to_string();
        assert_reads(&problem, "is not a filter: … `device_id==1`");
    }
    let long = format!("id=='{}'", "x".repeat(257));
    assert!(long.parse::<Filter>().is_err());
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
        "q[:].x",
        "q[:]{}",
        "q[:]{id}",
        "q[:]{id==1",
        "q[a]",
        "q[1",
        "q]1[",
        "q[0]x",
        "q{id==1}",
        "q.@abs",
        "a b",
        "/a/b",
        "\"a",
        "\"a\"b",
        "a\"b\"",
        "q[99999999999999999999]",
    ] {
        let problem = text.parse::<FieldPath>().expect_err(text).to_string();
        assert!(problem.starts_with(&format!("`{text}` is not the path of a field")));
        assert_reads(
            &problem,
            "names joined by dots … counted from 0 … `q[0]` … a filter for its elements … in double quotes",
        );
    }
}

#[test]
fn a_path_may_begin_with_a_topic_in_quotes_or_without() {
    for (text, topic, filters, path) in [
        ("/imu.q[0]", "/imu", &[][..], Some("q[0]")),
        ("/imu", "/imu", &[], None),
        (r#""/a.b".c.d"#, "/a.b", &[], Some("c.d")),
        (r#""/a[0]{1}""#, "/a[0]{1}", &[], None),
        (r#""/a\"\\b".c"#, r#"/a"\b"#, &[], Some("c")),
        ("vehicle_attitude.q", "vehicle_attitude", &[], Some("q")),
        (r#"/fc."OSD.pitch""#, "/fc", &[], Some(r#""OSD.pitch""#)),
        ("/imu{id==1}.q", "/imu", &["id==1"], Some("q")),
        (
            r#""/a.b"{id==1}{b.c=="x.y"}.q"#,
            "/a.b",
            &["id==1", r#"b.c=="x.y""#],
            Some("q"),
        ),
        ("/imu{id==1}", "/imu", &["id==1"], None),
    ] {
        let expected = MessagePath {
            topic: topic.to_owned(),
            filters: filters.iter().map(|text| filter(text)).collect(),
            field: path.map(field),
            quoted: text.starts_with(['"']) || text.contains('{'),
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
        "/imu{id}.q",
        "/imu{id==1",
        "/imu{id==1}q",
        "/fmu/vehicle_attitude_v{n}.q",
    ] {
        let problem = text.parse::<MessagePath>().expect_err(text).to_string();
        assert_reads(
            &problem,
            "is not a message path: write a topic and a field, as in … double quotes",
        );
    }
}

fn name() -> impl Strategy<Value = String> {
    prop_oneof![
        "[a-zA-Z_][a-zA-Z0-9_]{0,8}",
        r#"[a-z.,:/ \[\]{}"'\\=!@]{0,6}"#,
        "\\PC{0,4}",
    ]
}

fn literal() -> impl Strategy<Value = Literal> {
    let real = any::<f64>().prop_filter("finite", |number| number.is_finite());
    prop_oneof![
        any::<i64>().prop_map(|number| Literal::Number(Number::Signed(number))),
        (i64::MAX as u64 + 1..).prop_map(|number| Literal::Number(Number::Unsigned(number))),
        real.prop_map(|number| Literal::Number(Number::Real(number))),
        any::<bool>().prop_map(Literal::Truth),
        name().prop_map(Literal::Text),
    ]
}

/// A path of any names, each written in quotes.
fn any_path() -> impl Strategy<Value = String> {
    let quoted = |name: String| {
        let escaped = name.replace('\\', r"\\").replace('"', r#"\""#);
        format!("\"{escaped}\"")
    };
    let index = (0..usize::MAX).prop_map(|index| format!("[{index}]"));
    let filters = prop::collection::vec((name(), any::<bool>(), literal()), 1..3);
    let first = filters.prop_map(move |filters| {
        let filters = filters.into_iter().map(|(name, is_equal, value)| {
            let comparison = if is_equal { "==" } else { "!=" };
            format!("{{{}{comparison}{}}}", quoted(name), written(&value))
        });
        format!("[:]{}", filters.collect::<String>())
    });
    let place = prop::collection::vec(prop_oneof![2 => index, 1 => first], 0..3);
    let step = (name(), place).prop_map(move |(name, places)| quoted(name) + &places.concat());
    prop::collection::vec(step, 1..4).prop_map(|steps| steps.join("."))
}

fn written(value: &Literal) -> String {
    match value {
        Literal::Number(Number::Real(number)) => format!("{number:e}"),
        Literal::Number(Number::Signed(number)) => number.to_string(),
        Literal::Number(Number::Unsigned(number)) => number.to_string(),
        Literal::Text(text) => format!("'{}'", text.replace('\\', r"\\").replace('\'', r"\'")),
        Literal::Truth(truth) => truth.to_string(),
    }
}

/// A path of plain names, as it is displayed.
fn plain_step() -> impl Strategy<Value = String> {
    (
        "[a-zA-Z_][a-zA-Z0-9_-]{0,8}",
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
    fn a_path_is_displayed_as_it_was_parsed(steps in prop::collection::vec(plain_step(), 1..5)) {
        let text = steps.join(".");
        let path = field(&text);
        prop_assert_eq!(path.to_string(), text.clone());
        let quoted: MessagePath = format!("\"/a.b:c\".{text}").parse().expect("a path");
        prop_assert_eq!(quoted.field, Some(path));
    }

    #[test]
    fn a_path_of_any_names_is_the_same_when_written_and_read_again(text in any_path()) {
        let path = field(&text);
        let written = String::from(path.clone());
        prop_assert_eq!(&written.parse(), &Ok(path.clone()), "{} as {}", text, written);
        // Together with a topic, too.
        let whole: MessagePath = format!("/t.{written}").parse().expect("a path");
        prop_assert_eq!(whole.field, Some(path));
    }

    #[test]
    fn a_path_of_any_text_is_the_same_when_written_and_read_again(text in ".{0,20}") {
        if let Ok(path) = text.parse::<FieldPath>() {
            prop_assert_eq!(String::from(path.clone()).parse(), Ok(path));
        }
    }
}
