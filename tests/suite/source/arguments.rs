//! Telemetry as given on the command line: what each form of an argument means, and how wrong ones are answered.

use flightcam::{
    decode::path::{FieldPath, Filter},
    sample::{GimbalReference, Kind},
    source::{
        profile::{
            Alternative, AttitudeFields, Components, Coordinates, Euler, GimbalFields,
            HeightFields, Location, Orientation, Pitch, Quaternion, RoleFields, SampleTime,
            TimeField, VelocityFields,
            convention::{
                AngleUnit, Axes, BodyAxes, Convention, EulerOrder, LengthUnit, PositiveDirection,
                QuaternionOrder, SpeedUnit, TimeUnit, WorldAxes,
            },
        },
        request::{BadArgument, RoleArgument, namespace},
    },
};

use crate::support::folder::assert_reads;

fn field(path: &str) -> FieldPath {
    path.parse().expect("a path")
}

fn filter(text: &str) -> Filter {
    text.parse().expect("a filter")
}

fn each<const N: usize>(paths: [&str; N]) -> Components<N> {
    Components::Each(paths.map(field))
}

fn on(topic: &str, fields: RoleFields) -> Alternative {
    let location = Location::on(topic);
    Alternative { location, fields }
}

/// The alternative that an argument stands for.
#[track_caller]
fn parsed(role: Kind, argument: &str) -> Alternative {
    match RoleArgument::parse(role, argument) {
        Ok(RoleArgument::Fields(alternative)) => *alternative,
        Ok(RoleArgument::Topic { topic, .. }) => panic!("only a topic: {topic}"),
        Err(problem) => panic!("{argument}: {problem}"),
    }
}

/// Checks the errors of wrong arguments.
#[track_caller]
fn complains(role: Kind, cases: &[(&str, &str)]) {
    for (argument, words) in cases {
        match RoleArgument::parse(role, argument) {
            Ok(_) => panic!("{argument} is accepted"),
            Err(problem) => assert_reads(&problem.to_string(), words),
        }
    }
}

mod attitude {
    use super::*;

    fn source(
        topic: &str,
        orientation: Orientation,
        convention: impl Into<Option<Convention>>,
    ) -> Alternative {
        let attitude = AttitudeFields {
            orientation,
            convention: convention.into(),
            reset_counter: None,
        };
        on(topic, RoleFields::Attitude(attitude))
    }

    fn euler(unit: AngleUnit) -> Orientation {
        Orientation::Euler(Euler {
            roll: field("roll"),
            pitch: field("pitch"),
            yaw: field("yaw"),
            unit,
            order: EulerOrder::default(),
        })
    }

    fn quaternion(fields: Components<4>, order: QuaternionOrder) -> Orientation {
        Orientation::Quaternion(Quaternion { fields, order })
    }

    #[test]
    fn an_attitude_is_three_angles_with_their_unit() {
        for (unit, expected) in [
            ("radians", AngleUnit::Radians),
            ("degrees", AngleUnit::Degrees),
            ("centidegrees", AngleUnit::Centidegrees),
        ] {
            let argument = format!("/imu.roll,/imu.pitch,/imu.yaw:{unit}");
            let expected = source("/imu", euler(expected), None);
            assert_eq!(parsed(Kind::Attitude, &argument), expected);
        }
        let spaced = parsed(
            Kind::Attitude,
            "/imu.roll, /imu.pitch, /imu.yaw:flu-enu:degrees",
        );
        let expected = source("/imu", euler(AngleUnit::Degrees), Convention::FLU_ENU);
        assert_eq!(spaced, expected, "in whatever order the words come");
    }

    #[test]
    fn an_attitude_is_a_quaternion_in_one_field_or_in_four() {
        let together = |path| Components::Together(field(path));
        let four = each(["q[0]", "q[1]", "q[2]", "q[3]"]);
        use QuaternionOrder::*;
        const FLU_ENU: Option<Convention> = Some(Convention::FLU_ENU);
        const FRD_NED: Option<Convention> = Some(Convention::FRD_NED);
        for (argument, topic, fields, order, convention) in [
            (
                "/pose.orientation:flu-enu",
                "/pose",
                together("orientation"),
                Wxyz,
                FLU_ENU,
            ),
            ("/att.q:xyzw", "/att", together("q"), Xyzw, None),
            ("/att.q", "/att", together("q"), Wxyz, None),
            (
                "/a.q[0],/a.q[1],/a.q[2],/a.q[3]:wxyz:frd-ned",
                "/a",
                four,
                Wxyz,
                FRD_NED,
            ),
            (r#""/a.b".c:xyzw"#, "/a.b", together("c"), Xyzw, None),
            (r#""/a:1,2".c"#, "/a:1,2", together("c"), Wxyz, None),
            (
                "vehicle_attitude/0.q",
                "vehicle_attitude/0",
                together("q"),
                Wxyz,
                None,
            ),
        ] {
            let expected = source(topic, quaternion(fields, order), convention);
            assert_eq!(parsed(Kind::Attitude, argument), expected, "{argument}");
        }
    }

    #[test]
    fn an_attitude_may_be_a_topic_alone() {
        for (argument, topic, filters) in [
            ("/odom", "/odom", &[][..]),
            (r#""/a.b""#, "/a.b", &[]),
            (
                r#"/odom{id==1}{frame!="a:b,}"}"#,
                "/odom",
                &["id==1", r#"frame!="a:b,}""#],
            ),
        ] {
            let parsed = RoleArgument::parse(Kind::Attitude, argument);
            let select = filters.iter().map(|text| filter(text)).collect();
            let topic = topic.to_owned();
            assert_eq!(parsed, Ok(RoleArgument::Topic { topic, select }));
        }
    }

    #[test]
    fn which_messages_of_a_topic_are_meant_is_said_after_it() {
        let of_list = |path: &str| {
            let orientation = Orientation::Quaternion(Quaternion {
                fields: Components::Together(field(path)),
                order: QuaternionOrder::Xyzw,
            });
            source("/a", orientation, None)
        };
        let expected = Alternative {
            location: Location {
                select: vec![filter("id==1"), filter("frame == 'a'")],
                ..Location::on("/a")
            },
            ..of_list("q")
        };
        let argument = r#"/a{id==1}{frame=="a"}.q:xyzw"#;
        assert_eq!(parsed(Kind::Attitude, argument), expected);

        let argument = r#"/a.list[:]{name=="x:y,z"}.q:xyzw"#;
        let expected = of_list(r#"list[:]{name=="x:y,z"}.q"#);
        assert_eq!(parsed(Kind::Attitude, argument), expected);
    }

    #[test]
    fn a_wrong_attitude_is_an_error_with_advice() {
        let words = "radians, degrees or centidegrees; … wxyz or xyzw; frd-ned or flu-enu";
        let unknown = |word| format!("`{word}` has no meaning here … {words}");
        complains(
            Kind::Attitude,
            &[
                (
                    "/imu.roll,/imu.pitch,/imu.yaw",
                    "need their unit: `:degrees` or `:radians`",
                ),
                (
                    "/imu.r,/gps.p,/imu.y:degrees",
                    "/imu and /gps are different topics … one message",
                ),
                (
                    "/imu{id==1}.r,/imu{id==2}.p,/imu{id==1}.y:degrees",
                    "not all of the paths on /imu have the same filter",
                ),
                (
                    "/imu{id==1}.r,/imu.p,/imu.y:degrees",
                    "write the filter after the topic of every path",
                ),
                (
                    "/imu.r,pitch,yaw:degrees",
                    "pitch … every path begins with its topic",
                ),
                ("/imu.r,/imu.p,/imu.y:rad", &unknown("rad")),
                ("/imu.q:ned", &unknown("ned")),
                ("/imu.q:", &unknown("")),
                ("/imu.q:xyzw:wxyz", "`wxyz` does not go with the rest"),
                (
                    "/imu.r,/imu.p,/imu.y:degrees:xyzw",
                    "`xyzw` does not go with the rest",
                ),
                (
                    "/imu.q:degrees",
                    "unit goes with three fields: roll, pitch, yaw",
                ),
                (
                    "/imu.a,/imu.b",
                    "2 fields … one (a quaternion), three … or four (w, x, y, z)",
                ),
                (
                    "/i.a,/i.b,/i.c,/i.d,/i.e",
                    "5 fields … one (a quaternion), three … or four",
                ),
                ("/odom:flu-enu", "only a topic … /odom.field:flu-enu"),
                (
                    "/imu.q:frd-neu",
                    "`neu` are left-handed axes, and there is no rotation",
                ),
                (
                    "/imu.r,/imu.p,/imu.y:degrees:roll-pitch",
                    &unknown("roll-pitch"),
                ),
            ],
        );
    }
}

mod velocity {
    use super::*;

    #[test]
    fn a_velocity_is_a_vector_or_three_fields_with_their_axes() {
        let apart = || each(["vel.n", "vel.e", "vel.d"]);
        let together = |path| Components::Together(field(path));
        use SpeedUnit::*;
        for (argument, topic, vector, frame, unit) in [
            (
                "/gps.vel.n,/gps.vel.e,/gps.vel.d:ned:cm/s",
                "/gps",
                apart(),
                Axes::World(WorldAxes::NED),
                CentimetresPerSecond,
            ),
            (
                "/twist.linear:body-flu",
                "/twist",
                together("linear"),
                Axes::Body(BodyAxes::FLU),
                MetresPerSecond,
            ),
            (
                "/v.v:mm/s:enu",
                "/v",
                together("v"),
                Axes::World(WorldAxes::ENU),
                MillimetresPerSecond,
            ),
            (
                "/v.v:body-frd:m/s",
                "/v",
                together("v"),
                Axes::Body(BodyAxes::FRD),
                MetresPerSecond,
            ),
        ] {
            let velocity = VelocityFields {
                vector,
                frame,
                unit,
                required: false,
            };
            let expected = on(topic, RoleFields::Velocity(velocity));
            assert_eq!(parsed(Kind::Velocity, argument), expected, "{argument}");
        }
    }

    #[test]
    fn a_velocity_may_be_in_any_three_axes() {
        for (word, axes) in [
            ("neu", "neu"),
            ("swd", "swd"),
            ("body-flu", "body-flu"),
            ("flu", "body-flu"),
            ("body-rub", "body-rub"),
        ] {
            let alternative = parsed(Kind::Velocity, &format!("/v.v:{word}"));
            let RoleFields::Velocity(velocity) = alternative.fields else {
                panic!("not a velocity");
            };
            assert_eq!(velocity.frame.to_string(), axes);
        }
        for word in ["nee", "nd", "nedu", "nfd", "body-ned", "NED"] {
            let problem = RoleArgument::parse(Kind::Velocity, &format!("/v.v:{word}"));
            assert!(problem.is_err(), "{word}");
        }
    }

    #[test]
    fn a_wrong_velocity_is_an_error_with_advice() {
        let words = "ned, enu, neu, body-frd or body-flu; m/s, cm/s or mm/s";
        let unknown = |word| format!("`{word}` has no meaning here … {words}");
        complains(
            Kind::Velocity,
            &[
                (
                    "/gps.v",
                    "needs its axes: `:ned`, `:enu`, `:body-frd` or `:body-flu`",
                ),
                ("/gps.v:NED", &unknown("NED")),
                ("/gps.v:ned:km/h", &unknown("km/h")),
                ("/gps.v:ned:enu", "`enu` does not go with the rest"),
                (
                    "/gps.a,/gps.b:ned",
                    "2 fields … a velocity takes one (a vector) or three",
                ),
                ("/gps:ned", "only a topic … /gps.field:ned"),
            ],
        );
    }
}

mod gimbal {
    use super::*;

    fn source(
        orientation: Orientation,
        reference: GimbalReference,
        convention: impl Into<Option<Convention>>,
    ) -> Alternative {
        let gimbal = GimbalFields {
            orientation,
            reference,
            convention: convention.into(),
        };
        on("/gimbal", RoleFields::Gimbal(gimbal))
    }

    #[test]
    fn a_gimbal_is_a_pitch_above_or_below_the_horizon() {
        for (argument, unit, positive) in [
            (
                "/gimbal.pitch:degrees",
                AngleUnit::Degrees,
                PositiveDirection::Up,
            ),
            (
                "/gimbal.pitch:down:radians",
                AngleUnit::Radians,
                PositiveDirection::Down,
            ),
        ] {
            let pitch = Orientation::Pitch(Pitch {
                field: field("pitch"),
                unit,
                positive,
            });
            let expected = source(pitch, GimbalReference::Heading, None);
            assert_eq!(parsed(Kind::Gimbal, argument), expected, "{argument}");
        }
    }

    #[test]
    fn a_gimbal_is_a_rotation_from_a_reference() {
        let quaternion = |order| {
            let fields = Components::Together(field("q"));
            Orientation::Quaternion(Quaternion { fields, order })
        };
        let [roll, pitch, yaw] = ["r", "p", "y"].map(field);
        let unit = AngleUnit::Degrees;
        let euler = Orientation::Euler(Euler {
            roll,
            pitch,
            yaw,
            unit,
            order: EulerOrder::default(),
        });
        use {GimbalReference::*, QuaternionOrder::*};
        for (argument, orientation, reference) in [
            ("/gimbal.q:earth", quaternion(Wxyz), Earth),
            ("/gimbal.q:heading:xyzw", quaternion(Xyzw), Heading),
            (
                "/gimbal.r,/gimbal.p,/gimbal.y:degrees:airframe",
                euler,
                Airframe,
            ),
        ] {
            let expected = source(orientation, reference, None);
            assert_eq!(parsed(Kind::Gimbal, argument), expected, "{argument}");
        }
        let flu = parsed(Kind::Gimbal, "/gimbal.q:earth:flu-enu");
        assert_eq!(flu, source(quaternion(Wxyz), Earth, Convention::FLU_ENU));
    }

    #[test]
    fn a_wrong_gimbal_is_an_error_with_advice() {
        let either =
            "pitch angle … unit (`:degrees`, … quaternion … (`:earth`, `:heading`, `:airframe`)";
        complains(
            Kind::Gimbal,
            &[
                ("/g.pitch", either),
                ("/g.pitch:down", either),
                (
                    "/g.q:north",
                    "`north` has no meaning here … earth, heading or airframe",
                ),
                (
                    "/g.r,/g.p,/g.y:degrees",
                    "measured from: `:earth`, `:heading` or `:airframe`",
                ),
                (
                    "/g.r,/g.p,/g.y:earth",
                    "need their unit: `:degrees` or `:radians`",
                ),
                ("/g.a,/g.b:degrees", "one field, the pitch, or three"),
                (
                    "/g.a,/g.b:earth",
                    "2 fields … one (a pitch angle or a quaternion), three",
                ),
                ("/g.q:earth:up", "`up` does not go with the rest"),
            ],
        );
    }
}

mod position {
    use super::*;

    #[test]
    fn a_position_is_geodetic_or_local() {
        let [latitude, longitude, altitude] = ["lat", "lon", "alt"].map(field);
        let geodetic = Coordinates::Geodetic {
            latitude,
            longitude,
            altitude,
            unit: AngleUnit::DegE7,
            altitude_unit: LengthUnit::Millimetres,
        };
        let local = |vector, frame, unit| Coordinates::Local {
            vector,
            frame,
            unit,
        };
        let xyz = local(each(["x", "y", "z"]), WorldAxes::NED, LengthUnit::Metres);
        let together = Components::Together(field("p"));
        let vector = local(together, WorldAxes::ENU, LengthUnit::Centimetres);
        for (argument, coordinates) in [
            ("/gps.lat,/gps.lon,/gps.alt:degE7:mm", geodetic),
            ("/gps.x,/gps.y,/gps.z:ned", xyz),
            ("/gps.p:enu:cm", vector),
        ] {
            let expected = on("/gps", RoleFields::Position(coordinates));
            assert_eq!(parsed(Kind::Position, argument), expected, "{argument}");
        }
    }

    #[test]
    fn a_wrong_position_is_an_error_with_advice() {
        let either = "takes three … their unit (`:degrees`, `:degE7`), x, y and z their axes (`:ned`, `:enu`)";
        complains(
            Kind::Position,
            &[
                ("/p.a,/p.b,/p.c", either),
                ("/p.a,/p.b:degrees", either),
                ("/p.a,/p.b,/p.c:degrees:ned", either),
                ("/p.v:ned:km", "`km` has no meaning here … m, cm or mm"),
                (
                    "/p.a,/p.b:ned",
                    "2 fields were given, but a position takes three",
                ),
            ],
        );
    }
}

#[test]
fn a_height_is_one_field_and_its_unit() {
    for (argument, unit) in [
        ("/range.distance", LengthUnit::Metres),
        ("/range.distance:cm", LengthUnit::Centimetres),
    ] {
        let field = field("distance");
        let expected = on("/range", RoleFields::Height(HeightFields { field, unit }));
        assert_eq!(parsed(Kind::Height, argument), expected, "{argument}");
    }
    complains(
        Kind::Height,
        &[
            ("/range.a,/range.b", "2 fields … a height takes one"),
            ("/range.distance:km", "km … m, cm or mm"),
        ],
    );
}

#[test]
fn a_time_is_the_logs_the_publishers_or_a_fields() {
    let of_field = |path, unit| {
        let path = field(path);
        SampleTime::Field(TimeField { path, unit })
    };
    for (argument, expected) in [
        ("log", SampleTime::LogTime),
        ("publish", SampleTime::PublishTime),
        ("header.stamp", of_field("header.stamp", None)),
        (
            "time_usec:us",
            of_field("time_usec", Some(TimeUnit::Microseconds)),
        ),
        ("t[1]:ms", of_field("t[1]", Some(TimeUnit::Milliseconds))),
        ("t:s", of_field("t", Some(TimeUnit::Seconds))),
        ("t:ns", of_field("t", Some(TimeUnit::Nanoseconds))),
        (
            r#""t:a"[:]{n==":"}.t:s"#,
            of_field(r#""t:a"[:]{n==":"}.t"#, Some(TimeUnit::Seconds)),
        ),
    ] {
        assert_eq!(argument.parse(), Ok(expected), "{argument}");
    }
    for (argument, words) in [
        ("t:min", "`min` has no meaning here … s, ms, us or ns"),
        (
            "/imu.stamp",
            "`/imu.stamp` is not a time: write log, publish, or a field … without their topic",
        ),
        ("", "`` is not a time: write log, publish, or a field"),
    ] {
        let parsed: Result<SampleTime, BadArgument> = argument.parse();
        assert_reads(&parsed.expect_err("no time").to_string(), words);
    }
}

#[test]
fn a_namespace_is_a_prefix_however_its_slashes_are_written() {
    for text in ["drone1", "/drone1", "drone1/", "/drone1/"] {
        assert_eq!(namespace(text), Ok("/drone1".to_owned()));
    }
    assert_eq!(namespace("/fleet/drone1"), Ok("/fleet/drone1".to_owned()));
    for text in ["/", ""] {
        assert_eq!(namespace(text), Ok(String::new()));
    }
}
