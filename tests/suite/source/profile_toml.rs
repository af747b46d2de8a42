//! Profiles as text: what is accepted, what is refused and with which error, and that nothing is lost when one is
//! written.

use flightcam::sample::Kind;
use flightcam::source::profile::{
    AttitudeFields, Coordinates, NotAProfile, Orientation, Profile, RoleFields, SampleTime, Test,
    TimeField,
    convention::{LengthUnit, QuaternionOrder, TimeUnit},
};

use crate::support::folder::assert_reads;

const ATTITUDE: &str = r#"attitude = { topics = ["/a"], orientation.quaternion = "q" }"#;

fn parse(roles: &str) -> Result<Profile, NotAProfile> {
    Profile::parse(&format!("name = \"mine\"\n{roles}\n"))
}

fn parsed(roles: &str) -> Profile {
    parse(roles).unwrap_or_else(|problem| panic!("{roles}: {problem}"))
}

#[track_caller]
fn refused(roles: &str, words: &str) {
    match parse(roles) {
        Ok(_) => panic!("accepted: {roles}"),
        Err(problem) => assert_reads(&problem.to_string(), words),
    }
}

/// A profile with an attitude and this as another role.
fn beside_attitude(role: &str) -> String {
    format!("{ATTITUDE}\n{role}")
}

#[test]
fn every_built_in_profile_is_the_same_when_written_and_read_again() {
    for profile in Profile::built_in() {
        let text = toml::to_string(&profile).expect("TOML");
        assert_eq!(Profile::parse(&text), Ok(profile), "{text}");
    }
}

/// Every key there is, so that none is lost.
#[test]
fn a_profile_with_everything_is_the_same_when_written_and_read_again() {
    let everything = r#"
        name = "everything"
        description = "all there is"
        automatic = false
        namespaced = true
        time.field = { path = "stamp", unit = "us" }
        camera = { depression = 30.5, mount = [0, 0, 90], hfov = 84, vfov = 54.25 }

        [[attitude]]
        topics = ["/a_{n}", "/a"]
        schemas = ["A", "B"]
        when = { field = "frame", is = -1 }
        valid = ["ok[0]", "fix.ok"]
        time = "publish_time"
        orientation.quaternion = { fields = ["x", "y", "z", "w"], order = "xyzw" }
        convention = "flu-enu"
        reset_counter = { field = "resets", optional = true }

        [[attitude]]
        topics = ["/a"]
        when = { field = "frame", says = "/world" }
        orientation.euler = { roll = "r", pitch = "p", yaw = "y", unit = "centidegrees" }

        [velocity]
        vector = "v"
        frame = "body-frd"
        unit = "cm/s"
        required = true

        [[gimbal]]
        when = { field = "flags", has_bits = 80 }
        orientation.pitch = { field = "tilt", unit = "degrees", positive = "down" }
        reference = "airframe"

        [[gimbal]]
        time = "log_time"
        orientation.quaternion = "q"
        reference = "earth"

        [[position]]
        geodetic = { latitude = "a", longitude = "b", altitude = "c", unit = "degE7", altitude_unit = "mm" }

        [[position]]
        local = { vector = ["x", "y", "z"], frame = "enu", unit = "cm" }
    "#;
    let profile = Profile::parse(everything).expect("a profile");
    let text = toml::to_string(&profile).expect("TOML");
    assert_eq!(Profile::parse(&text).as_ref(), Ok(&profile), "{text}");

    assert!(!profile.automatic && profile.namespaced);
    let SampleTime::Field(TimeField { unit, .. }) = profile.time else {
        panic!("a time of a field");
    };
    assert_eq!(unit, Some(TimeUnit::Microseconds));
    let RoleFields::Velocity(velocity) = &profile.alternatives(Kind::Velocity)[0].fields else {
        panic!("a velocity");
    };
    assert!(velocity.required);
    let test = |alternative: usize| {
        let alternative = &profile.alternatives(Kind::Attitude)[alternative];
        alternative.location.when.clone().map(|when| when.test)
    };
    assert_eq!(test(0), Some(Test::Is(-1)));
    assert_eq!(test(1), Some(Test::Says("/world".to_owned())));
    let position = &profile.alternatives(Kind::Position)[1].fields;
    let RoleFields::Position(Coordinates::Local { unit, .. }) = position else {
        panic!("a local position");
    };
    assert_eq!(*unit, LengthUnit::Centimetres);
}

#[test]
fn a_single_alternative_needs_no_list() {
    let alone = parsed("[attitude]\ntopics = [\"/a\"]\norientation.quaternion = \"q\"");
    let listed = parsed("[[attitude]]\ntopics = [\"/a\"]\norientation.quaternion = \"q\"");
    assert_eq!(alone, listed);
    assert_eq!(alone, parsed(ATTITUDE));
}

#[test]
fn keys_that_are_left_out_have_their_defaults() {
    let profile = parsed(&beside_attitude(
        r#"velocity = { vector = "v", frame = "ned" }"#,
    ));
    let explicit = parsed(
        r#"automatic = true
        namespaced = false
        time = "log_time"
        attitude = { topics = ["/a"], orientation.quaternion = { fields = "q", order = "wxyz" } }
        velocity = { vector = "v", frame = "ned", unit = "m/s", required = false }"#,
    );
    assert_eq!(profile, explicit);
}

mod topic_in_a_path {
    use super::*;

    #[test]
    fn a_topic_in_a_path_is_the_roles_topic() {
        let role = |vector: &str| {
            parsed(&beside_attitude(&format!(
                "velocity = {{ vector = {vector}, frame = \"ned\" }}"
            )))
        };
        let with_topics = |topic: &str, vector: &str| {
            let place = format!("topics = ['{topic}'], vector = {vector}");
            parsed(&beside_attitude(&format!(
                "velocity = {{ {place}, frame = \"ned\" }}"
            )))
        };
        for (lifted, topic, vector) in [
            (r#""/gps.vel""#, "/gps", r#""vel""#),
            (
                r#"["/gps.n", "/gps.e", "/gps.d"]"#,
                "/gps",
                r#"["n", "e", "d"]"#,
            ),
            (
                r#"["/gps.v[0]", "v[1]", "v[2]"]"#,
                "/gps",
                r#"["v[0]", "v[1]", "v[2]"]"#,
            ),
            (r#"'"/a.b".v.x'"#, "/a.b", r#""v.x""#),
        ] {
            assert_eq!(role(lifted), with_topics(topic, vector), "{lifted}");
        }
    }

    #[test]
    fn a_topic_may_be_in_any_key_that_takes_a_path() {
        let profile = parsed(
            r#"
            [attitude]
            orientation.quaternion = { fields = "/a.q", order = "xyzw" }
            when = { field = "/a.frame", says = "/world" }
            valid = ["/a.ok"]
            reset_counter = { field = "/a.resets" }
            time.field = { path = "/a.stamp" }"#,
        );
        let attitude = &profile.alternatives(Kind::Attitude)[0];
        assert_eq!(attitude.location.topics, ["/a"]);
        assert_eq!(attitude.location.valid[0].to_string(), "ok");
        let when = attitude.location.when.as_ref().expect("a condition");
        assert_eq!(
            when.test,
            Test::Says("/world".to_owned()),
            "what a field says is no path"
        );
    }

    #[test]
    fn a_topic_in_a_path_is_refused_next_to_another() {
        let velocity =
            |keys: &str| beside_attitude(&format!("velocity = {{ {keys}, frame = \"ned\" }}"));
        for (keys, words) in [
            (
                r#"topics = ["/gps"], vector = "/gps.v""#,
                "names the topic /gps, and there is `topics` as well; leave one of the two out, in `velocity`",
            ),
            (
                r#"vector = ["/gps.n", "/gps.e", "/imu.d"]"#,
                "/gps and /imu; what belongs to one sample must come in one message, in `velocity`",
            ),
            (r#"vector = "/gps.v", valid = ["/fix.ok"]"#, "/gps"),
            (r#"vector = "/gps""#, "`/gps` names no field, in `velocity`"),
        ] {
            refused(&velocity(keys), words);
        }
    }
}

#[test]
fn unknown_keys_are_refused_by_name_at_every_level() {
    for (role, key) in [
        ("colour = \"red\"", "unknown key `colour`; docs/profiles.md"),
        ("positions = []", "unknown key `positions`"),
        (
            "velocity = { vector = \"v\", frame = \"ned\", topic = [\"/b\"] }",
            "unknown key `velocity.topic`",
        ),
        (
            "velocity = [{ vector = \"v\", frame = \"ned\" }, { vector = \"v\", frame = \"ned\", units = \"m/s\" }]",
            "unknown key `velocity.units`",
        ),
        (
            "gimbal = { orientation.pitch = { field = \"p\", unit = \"degrees\", sign = \"up\" }, reference = \"earth\" }",
            "`sign`, expected one of `field`, `unit`, `positive` … `gimbal`",
        ),
        (
            "gimbal = { orientation.quaternion = { fields = \"q\", order = \"wxyz\", unit = 1 }, reference = \"earth\" }",
            "`unit`, expected `fields` or `order` … `gimbal`",
        ),
        (
            "position = { local = { vector = \"p\", frame = \"ned\", datum = \"x\" } }",
            "`datum` … `position`",
        ),
        (
            "velocity = { vector = \"v\", frame = \"ned\", when = { field = \"f\", is = 1, not = 2 } }",
            "unknown key `velocity.when.not`",
        ),
        (
            "time.field = { path = \"t\", units = \"s\" }",
            "`units`, expected `path` or `unit` … `time`",
        ),
    ] {
        refused(&beside_attitude(role), key);
    }
    refused(
        "attitude = { orientation.quaternion = \"q\", reset = \"r\" }",
        "unknown key `attitude.reset`",
    );
    refused(
        "attitude = { orientation.quaternion = \"q\", reset_counter = { field = \"r\", optinal = true } }",
        "`optinal`, expected `field` or `optional` … `attitude`",
    );
}

#[test]
fn errors_name_the_place_and_what_would_be_valid() {
    for (text, words) in [
        ("", "there is no `attitude`"),
        ("attitude = []", "there is no `attitude`"),
        (
            "attitude = { topics = [\"/a\"] }",
            "missing field `orientation`, in `attitude`",
        ),
        (
            "attitude.orientation = {}",
            "an orientation needs one of `quaternion`, `euler`, in `attitude`",
        ),
        (
            "attitude.orientation = { quaternion = \"q\", euler = {} }",
            "takes only one of `quaternion`, `euler`",
        ),
        (
            "attitude.orientation.quaternion = 5",
            "a field or a list of fields … `attitude`",
        ),
        (
            "attitude.orientation.quaternion = \"q[-1]\"",
            "`q[-1]` is not the path of a field … `attitude`",
        ),
        (
            "attitude.orientation.quaternion = [\"a\", \"b\"]",
            "2 fields were given; expected one or 4 … `attitude`",
        ),
        (
            "attitude.orientation.quaternion = { fields = \"q\" }",
            "missing field `order` … `attitude`",
        ),
        (
            "attitude.orientation.quaternion = { fields = \"q\", order = \"zyxw\" }",
            "`zyxw`, expected `wxyz` or `xyzw` … `attitude`",
        ),
        (
            "attitude.orientation.euler = { roll = \"r\", pitch = \"p\", yaw = \"y\" }",
            "missing field `unit`, in `orientation`, in `attitude`",
        ),
        (
            "attitude = { orientation.quaternion = \"q\", when = { field = \"f\" } }",
            "`when` needs one of `is`, `is_integer`, `says`, `contains`, `has_bits`, in `attitude`",
        ),
        (
            "attitude = { orientation.quaternion = \"q\", when = { field = \"f\", is = 1, says = \"x\" } }",
            "`when` takes only one of `is`, `is_integer`, `says`, `contains`, `has_bits`, in `attitude`",
        ),
        (
            "attitude = { orientation.quaternion = \"q\", reset_counter = \"r\" }",
            "expected a table, as in { field = \"count\" }, in `reset_counter`, in `attitude`",
        ),
        (
            "attitude = [{ topics = [\"/a\"], orientation.quaternion = \"q\" }, { orientation.quaternion = \"q\" }]",
            "has `topics` and the first one has not, or the other way round; name the topics of each, or of none",
        ),
    ] {
        refused(text, words);
    }
    for (role, words) in [
        (
            "velocity = { vector = \"v\" }",
            "missing field `frame`, in `velocity`",
        ),
        (
            "velocity = [{ vector = \"v\", frame = \"ned\" }, { vector = \"v\", frame = \"xyz\" }]",
            "axes are three letters, one for each component … in `velocity`",
        ),
        (
            "gimbal.orientation.quaternion = \"q\"",
            "missing field `reference`, in `gimbal`",
        ),
        (
            "position = {}",
            "a position needs one of `geodetic`, `local`, in `position`",
        ),
        (
            "position = { geodetic = {}, local = {} }",
            "takes only one of `geodetic`, `local`, in `position`",
        ),
    ] {
        refused(&beside_attitude(role), words);
    }
    let torn = Profile::parse("name = \"torn\"\n[attitude\n").expect_err("not TOML");
    assert_reads(&torn.to_string(), "line 2");
}

#[test]
fn a_quaternion_is_w_first_by_default() {
    let order = |quaternion: &str| {
        let profile = parsed(&format!("attitude.orientation.quaternion = {quaternion}"));
        match &profile.alternatives(Kind::Attitude)[0].fields {
            RoleFields::Attitude(AttitudeFields {
                orientation: Orientation::Quaternion(quaternion),
                ..
            }) => quaternion.order,
            other => panic!("{other:?}"),
        }
    };
    assert_eq!(order("\"q\""), QuaternionOrder::Wxyz);
    assert_eq!(order("[\"a\", \"b\", \"c\", \"d\"]"), QuaternionOrder::Wxyz);
    assert_eq!(
        order("{ fields = \"q\", order = \"xyzw\" }"),
        QuaternionOrder::Xyzw
    );
}

/// A profile with a mistake in the line that `MISTAKE` stands for.
const LINES: &str = r#"name = "mine"
description = "with mistakes"

[[attitude]]
topics = ["/a"]
orientation.quaternion = "q"

[[attitude]]
topics = ["/b"]
when = { field = "frame", is = 1 }
orientation.euler = { roll = "r", pitch = "p", yaw = "y", unit = "degrees" }

[velocity]
topics = ["/v"]
vector = "v"
frame = "ned"

[gimbal]
orientation.pitch = { field = "/g.pitch", unit = "degrees" }
reference = "heading"
"#;

#[test]
fn errors_say_in_which_line() {
    assert!(Profile::parse(LINES).is_ok());
    for (right, wrong, line, words) in [
        (
            "description",
            "descriptoin",
            2,
            "unknown key `descriptoin`; did you mean `description`?",
        ),
        (
            "topics = [\"/b\"]",
            "topic = [\"/b\"]",
            9,
            "unknown key `attitude.topic`; did you mean `topics`?",
        ),
        ("is = 1", "iz = 1", 10, "unknown key `attitude.when.iz`"),
        (
            "field = \"frame\"",
            "feild = \"frame\"",
            10,
            "unknown key `attitude.when.feild`; did you mean `field`?",
        ),
        (
            "\"frame\", is = 1",
            "\"frame\", is = 1, says = \"x\"",
            10,
            "takes only one of",
        ),
        ("\"frame\"", "\"a[\"", 10, "`a[` is not the path of a field"),
        (
            "unit = \"degrees\" }\n\n[vel",
            "unit = \"gradians\" }\n\n[vel",
            11,
            "`gradians`, expected one of",
        ),
        (
            ", unit = \"degrees\" }\n\n[vel",
            " }\n\n[vel",
            11,
            "missing field `unit`",
        ),
        ("roll = \"r\", ", "", 11, "missing field `roll`"),
        (
            "yaw = \"y\"",
            "yaw = 5",
            11,
            "invalid type: integer `5`, expected",
        ),
        (
            "frame = \"ned\"",
            "frame = \"ndd\"",
            16,
            "axes are three letters",
        ),
        ("frame = \"ned\"\n", "", 13, "missing field `frame`"),
        (
            "vector = \"v\"",
            "vector = [\"v\", \"w\"]",
            15,
            "2 fields were given",
        ),
        (
            "vector = \"v\"",
            "vector = \"/v.v\"",
            13,
            "names the topic /v, and there is `topics` as well",
        ),
        (
            "topics = [\"/v\"]",
            "topics = \"/v\"",
            14,
            "invalid type: string \"/v\", expected a sequence",
        ),
        (
            "topics = [\"/a\"]\n",
            "",
            7,
            "has `topics` and the first one has not",
        ),
        (
            "topics = [\"/v\"]",
            "topics = [\"/v{vehicle}\"]",
            13,
            "namespaced = true",
        ),
        (
            "reference = \"heading\"",
            "reference = \"earth\"",
            18,
            "a pitch alone has no yaw",
        ),
        (
            "field = \"/g.pitch\"",
            "field = \"/g\"",
            19,
            "`/g` names no field",
        ),
    ] {
        assert!(LINES.contains(right), "{right}");
        let text = LINES.replacen(right, wrong, 1);
        let problem = Profile::parse(&text).expect_err(wrong).to_string();
        assert_reads(&problem, &format!("line {line}: … {words}"));
    }
}

#[test]
fn a_key_like_no_other_is_refused_without_a_guess() {
    let problem = parse(&beside_attitude("colour = \"red\"")).expect_err("no key");
    assert!(!problem.to_string().contains("did you mean"), "{problem}");
}

#[test]
fn a_camera_that_cannot_be_is_refused() {
    for (camera, words) in [
        (
            "depression = 91",
            "line 2: a depression angle of 91° is out of range",
        ),
        (
            "depression = nan",
            "line 2: a depression angle of NaN° is out of range",
        ),
        (
            "mount = [0, 100, 0]",
            "line 2: a mount of roll 0°, pitch 100°, yaw 0° is out of range",
        ),
        ("mount = [0, 0]", "line 2: …"),
        ("hfov = 80", "line 2: `hfov` and `vfov` belong together"),
        (
            "hfov = 0, vfov = 40",
            "line 2: a field of view of 0° by 40° is out of range",
        ),
        ("depresion = 30", "line 2: unknown …`depresion`"),
    ] {
        refused(&format!("camera = {{ {camera} }}\n{ATTITUDE}"), words);
    }
}
