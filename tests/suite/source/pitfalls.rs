//! What would silently yield wrong numbers: a topic read as another, a unit or a frame that does not apply, unused
//! fields that spoil used ones.

use flightcam::{
    log::{Log, ReadError},
    reader::Reader,
    sample::{Kind, Sample, Tallies, Velocity},
    source::{
        Source,
        profile::{Profile, ProfileChoice},
        request::Request,
    },
};
use serde_json::{Value, json};

use crate::support::{
    folder::{Folder, LOG, assert_reads},
    selecting::{refuses, request, selects},
    topics::{self, Topic, log, topic},
};

/// The samples of a few topics' messages, and what was dropped.
fn read(topics: &[Topic], request: &Request, kinds: &[Kind]) -> (Vec<Sample>, Tallies) {
    let folder = Folder::with(LOG, log(topics));
    let log = Log::open(&folder.path(LOG)).expect("a log");
    let source = Source::select(&log, request).expect("a source");
    let source = source
        .keep(&log, request, &kinds.iter().copied().collect())
        .expect("the same source");
    let mut samples = Vec::new();
    let read = Reader::new(&log, source).and_then(|reader| {
        reader.for_each(|arrival| {
            samples.push(arrival.sample);
            Ok::<_, ReadError>(())
        })
    });
    (samples, read.expect("a readable log").dropped)
}

fn of_profile(toml: &str) -> Request {
    let profile = Profile::parse(toml).expect("a profile");
    Request {
        profile: ProfileChoice::Given(Box::new(profile)),
        ..Request::default()
    }
}

fn dropped(tallies: &Tallies, kind: Kind) -> u64 {
    tallies[kind].dropped.values().sum()
}

fn thrice(name: &'static str, message: Value) -> Topic {
    topic(name, [message.clone(), message.clone(), message])
}

fn pose() -> Topic {
    let orientation = json!({ "w": 1, "x": 0, "y": 0, "z": 0 });
    thrice(
        "/mavros/local_position/pose",
        json!({ "pose": { "orientation": orientation } }),
    )
}

fn twist(name: &'static str) -> Topic {
    thrice(
        name,
        json!({ "twist": { "linear": { "x": 10, "y": 0, "z": 0 } } }),
    )
}

#[test]
fn a_given_topic_keeps_the_axes_that_the_profile_knows_for_it() {
    let local = twist("/mavros/local_position/velocity_local");
    let body = twist("/mavros/local_position/velocity_body");
    let given = request(&[("--velocity", body.name)]);
    let (samples, _) = read(&[pose(), local, body], &given, &[Kind::Velocity]);
    for sample in samples {
        let Sample::Velocity(sample) = sample else {
            panic!("only velocities are read");
        };
        assert_eq!(sample.velocity, Velocity::Frd([10.0, 0.0, 0.0].into()));
    }
    // Odometry in a frame of its own is not an attitude in NED, whether given or found.
    let odometry = thrice(
        "/fmu/out/vehicle_odometry",
        json!({ "pose_frame": 2, "q": [1, 0, 0, 0], "velocity_frame": 2, "velocity": [1, 0, 0] }),
    );
    for arguments in [&[][..], &[("--attitude", "/fmu/out/vehicle_odometry")]] {
        let (samples, tallies) = read(
            std::slice::from_ref(&odometry),
            &request(arguments),
            &[Kind::Attitude],
        );
        assert_eq!(samples, []);
        assert_eq!(dropped(&tallies, Kind::Attitude), 3);
    }
}

#[test]
fn a_pitch_alone_is_not_measured_from_north_and_has_no_convention() {
    for argument in ["/g.pitch:degrees:earth", "/g.pitch:degrees:up:flu-enu"] {
        let parsed = flightcam::source::request::RoleArgument::parse(Kind::Gimbal, argument);
        assert!(parsed.is_err(), "{argument}");
    }
    for keys in [
        "reference = \"earth\"",
        "reference = \"heading\"\nconvention = \"flu-enu\"",
    ] {
        let toml = format!(
            "name = \"g\"\n[attitude]\norientation.quaternion = \"/a.q\"\nconvention = \"frd-ned\"\n[gimbal]\n\
             orientation.pitch = {{ field = \"/g.pitch\", unit = \"degrees\" }}\n{keys}\n"
        );
        let problem = Profile::parse(&toml).expect_err("it makes no sense");
        let problem = problem.to_string();
        assert!(problem.contains("a pitch alone"), "{problem}");
    }
}

#[test]
fn a_given_time_holds_for_all_roles_and_needs_its_unit() {
    let own = of_profile(
        "name = \"own\"\n[attitude]\norientation.quaternion = \"/a.q\"\nconvention = \"frd-ned\"\n\
         time.field = { path = \"t\", unit = \"s\" }\n",
    );
    let messages = [1, 2, 3].map(|t| json!({ "q": [1, 0, 0, 0], "t": t, "u": 10 * t }));
    let log = [topic("/a", messages)];
    let times = |request: &Request| -> Vec<u64> {
        let (samples, _) = read(&log, request, &[Kind::Attitude]);
        samples
            .iter()
            .map(|sample| sample.stamp().log_time)
            .collect()
    };
    let second = 1_000_000_000;
    assert_eq!(times(&own), [second, 2 * second, 3 * second]);
    let given = |time: &str| Request {
        time: Some(time.parse().expect("a time")),
        ..own.clone()
    };
    assert_eq!(
        times(&given("u:s")),
        [10 * second, 20 * second, 30 * second]
    );
    let folder = Folder::with(LOG, topics::log(&log));
    let opened = Log::open(&folder.path(LOG)).expect("a log");
    let error = Source::select(&opened, &given("u")).expect_err("10 of what?");
    assert!(
        error.to_string().contains("its unit is not given"),
        "{error}"
    );
}

#[test]
fn flags_and_counters_are_compared_bit_by_bit() {
    let profile = of_profile(
        "name = \"own\"\n[[attitude]]\ntopics = [\"/a\"]\nwhen = { field = \"flags\", has_bits = 32 }\n\
         orientation.quaternion = \"q\"\nconvention = \"frd-ned\"\nreset_counter = { field = \"resets\" }\n",
    );
    let messages = [(-16, -1), (32, -2), (31, 0)];
    let messages = messages
        .map(|(flags, resets)| json!({ "q": [1, 0, 0, 0], "flags": flags, "resets": resets }));
    let (samples, tallies) = read(&[topic("/a", messages)], &profile, &[Kind::Attitude]);
    let resets: Vec<Option<u64>> = (samples.iter())
        .map(|sample| match sample {
            Sample::Attitude(sample) => sample.reset_counter,
            _ => None,
        })
        .collect();
    assert_eq!(resets, [Some(u64::MAX), Some(u64::MAX - 1)]);
    assert_eq!(dropped(&tallies, Kind::Attitude), 1);
}

#[test]
fn a_number_does_not_match_a_condition_on_a_string() {
    let profile = of_profile(
        "name = \"own\"\n[[attitude]]\ntopics = [\"/a\"]\nwhen = { field = \"frame\", says = \"ned\" }\n\
         orientation.quaternion = \"q\"\nconvention = \"frd-ned\"\n",
    );
    let frames = [json!(0), json!(false), json!("enu"), json!("ned")];
    let messages = frames.map(|frame| json!({ "q": [1, 0, 0, 0], "frame": frame }));
    let (samples, tallies) = read(&[topic("/a", messages)], &profile, &[Kind::Attitude]);
    assert_eq!(samples.len(), 1);
    assert_eq!(dropped(&tallies, Kind::Attitude), 3);
}

#[test]
fn several_conditions_on_one_text_are_told_apart() {
    let profile = of_profile(
        "name = \"own\"\n[[attitude]]\ntopics = [\"/a\"]\nwhen = { field = \"frame\", says = \"ned\" }\n\
         orientation.quaternion = \"q\"\nconvention = \"frd-ned\"\n\
         [[attitude]]\ntopics = [\"/a\"]\nwhen = { field = \"frame\", says = \"neds\" }\n\
         orientation.quaternion = \"r\"\nconvention = \"frd-ned\"\n",
    );
    let messages = ["ned", "neds", "ne", ""]
        .map(|frame| json!({ "q": [1, 0, 0, 0], "r": [0, 0, 0, 1], "frame": frame }));
    let (samples, tallies) = read(&[topic("/a", messages)], &profile, &[Kind::Attitude]);
    let scalars: Vec<f64> = (samples.iter())
        .map(|sample| match sample {
            Sample::Attitude(sample) => sample.orientation.w,
            _ => f64::NAN,
        })
        .collect();
    assert_eq!(scalars, [1.0, 0.0]);
    assert_eq!(dropped(&tallies, Kind::Attitude), 2);
}

/// Texts are compared up to a length, beyond which none is equal to another.
#[test]
fn a_long_text_is_not_taken_for_one_that_begins_like_it() {
    let of_length = |length| {
        of_profile(&format!(
            "name = \"own\"\n[[attitude]]\ntopics = [\"/a\"]\nwhen = {{ field = \"frame\", says = \"{}\" }}\n\
             orientation.quaternion = \"q\"\nconvention = \"frd-ned\"\n",
            "x".repeat(length)
        ))
    };
    let messages = [255, 256, 257, 1000]
        .map(|length| json!({ "q": [1, 0, 0, 0], "frame": "x".repeat(length) }));
    let log_of_all = [topic("/a", messages)];
    let (samples, tallies) = read(&log_of_all, &of_length(256), &[Kind::Attitude]);
    assert_eq!(samples.len(), 1);
    assert_eq!(dropped(&tallies, Kind::Attitude), 3);

    let folder = Folder::with(LOG, log(&log_of_all));
    let log = Log::open(&folder.path(LOG)).expect("a log");
    let refused = Source::select(&log, &of_length(257)).expect_err("a text that is too long");
    assert_reads(
        &refused.to_string(),
        "its field `frame` is compared with a text of more than 256 bytes",
    );
}

#[test]
fn the_first_alternative_that_fits_anywhere_is_preferred() {
    let profile = Profile::parse(
        "name = \"own\"\n[[attitude]]\ntopics = [\"/a\", \"/b\"]\norientation.quaternion = \"q\"\nconvention = \"frd-ned\"\n\
         [[attitude]]\ntopics = [\"/a\"]\norientation.quaternion = \"r\"\nconvention = \"frd-ned\"\n",
    );
    let request = Request {
        profile: ProfileChoice::Given(Box::new(profile.expect("a profile"))),
        ..Request::default()
    };
    let topics = [
        thrice("/a", json!({ "r": [1, 0, 0, 0] })),
        thrice("/b", json!({ "q": [1, 0, 0, 0] })),
    ];
    let folder = Folder::with(LOG, log(&topics));
    let log = Log::open(&folder.path(LOG)).expect("a log");
    let source = Source::select(&log, &request).expect("a source");
    assert_eq!(source.attitude().topic, "/b");
}

#[test]
fn vehicles_of_different_autopilots_are_distinguished_too() {
    let velocity = twist("/d1/mavros/local_position/velocity_local");
    let orientation = json!({ "w": 1, "x": 0, "y": 0, "z": 0 });
    let mavros = thrice(
        "/d1/mavros/local_position/pose",
        json!({ "pose": { "orientation": orientation } }),
    );
    let px4 = thrice(
        "/px4_2/fmu/out/vehicle_attitude",
        json!({ "q": [1, 0, 0, 0] }),
    );
    let topics = [mavros, velocity, px4];
    refuses(&topics, &[], "several vehicles … /d1, /px4_2");
    let px4 = ("px4-ros2", topics[2].name, "");
    selects(&topics, &[("--namespace", "/px4_2")], px4);
}

#[test]
fn unused_fields_do_not_spoil_used_ones() {
    let state =
        json!({ "roll": 0, "pitch": 0, "yaw": 0, "vx": 1, "vy": 0, "vz": 0, "lat": 47, "lon": 8 });
    let messages = [json!("n/a"), json!(400)].map(|altitude| {
        let mut message = state.clone();
        message["alt"] = altitude;
        message
    });
    let log = [topic("/state", messages)];
    let kinds = [Kind::Attitude, Kind::Velocity];
    let (samples, tallies) = read(&log, &Request::default(), &kinds);
    assert_eq!(samples.len(), 4);
    assert_eq!(kinds.map(|kind| dropped(&tallies, kind)), [0, 0]);
    let (samples, tallies) = read(&log, &Request::default(), &[Kind::Position]);
    assert_eq!(samples.len(), 1);
    assert_eq!(dropped(&tallies, Kind::Position), 1);
}
