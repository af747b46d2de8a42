//! Text from elsewhere as people get to read it, and as programs do.

use std::path::{Path, PathBuf};

use flightcam::{
    Foreign, MissingReason, UnmetFilter,
    decode::path::{FieldPath, Filter, MessagePath},
    error::*,
    sample::{DropReason, Kind, Tally},
    source::{
        FoundValue, NamedFrame, Origin, Reading, RefusedFrames, RunnerUp, UnmetCondition,
        profile::{
            Test,
            convention::{Axes, SpeedUnit, WorldAxes},
        },
        request::BadArgument,
        undecodable::UndecodableMessage,
    },
    text,
    writer::provenance::EarlierRun,
};

use crate::support::steering::*;

#[test]
fn characters_that_steer_are_escaped_as_in_rust() {
    let text = Foreign::from(NASTY);
    assert_eq!(text.to_string(), PRINTED);
    assert_eq!(text::escaped(NASTY).to_string(), PRINTED);
    assert_eq!(text::path(Path::new("a\tb\n")).to_string(), r"a\tb\n");
    let lines = text::escaped_lines("one\n\u{1b}two\r\n").to_string();
    assert_eq!(lines, "one\n\\u{1b}two\\r\n");
    assert_eq!(
        text::join(["a\n", "b"].map(Foreign::from), " or "),
        r"a\n or b"
    );
}

#[test]
fn exactly_what_steers_is_escaped() {
    for c in '\0'..=char::MAX {
        let shown = Foreign::from(c.to_string()).to_string();
        assert_eq!(shown != c.to_string(), text::is_escaped(c), "{c:?}");
        assert!(!shown.contains(steers), "{c:?} is shown as {shown:?}");
        if text::is_escaped(c) {
            assert!(shown.is_ascii() && shown.starts_with('\\'), "{shown:?}");
        }
    }
    assert!(alphabet().into_iter().all(text::is_escaped));
}

#[test]
fn ordinary_text_of_all_scripts_is_shown_as_it_is() {
    let texts = [
        r"/drone/é C:\logs\n \u{1b} `quoted` 'quoted' $HOME",
        "e\u{301} Å ß İ ς",
        "中文 日本語 한국어",
        "العربية עברית हिन्दी ไทย",
        "🚁 👍🏽 ❤\u{fe0f} 🇩🇪",
        "Привет Ελληνικά",
        "\u{a0}\u{3000}",
    ];
    for text in texts {
        assert_eq!(Foreign::from(text).to_string(), text);
    }
}

#[test]
fn to_programs_a_text_is_as_it_was_found() {
    let text = Foreign::from(NASTY);
    assert_eq!(text, NASTY);
    assert_eq!(text.as_str(), NASTY);
    assert_eq!(text.len(), NASTY.len());
    let json = serde_json::to_value(&text).expect("JSON");
    assert_eq!(json, NASTY);
}

#[test]
fn a_field_path_is_shown_escaped_and_written_as_it_was_found() {
    let path: FieldPath = "a\u{1b}.b[0]".parse().expect("a path");
    assert_eq!(path.to_string(), r"a\u{1b}.b[0]");
    assert_eq!(String::from(path.clone()), "a\u{1b}.b[0]");
    assert_eq!(serde_json::to_value(&path).expect("JSON"), "a\u{1b}.b[0]");
}

fn nasty() -> Foreign {
    NASTY.into()
}

fn path() -> PathBuf {
    NASTY.into()
}

fn field() -> FieldPath {
    "a\u{1b}\n".parse().expect("a path")
}

fn filter() -> Filter {
    "\"a\u{1b}\n\"==\"b\u{1b}\n\"".parse().expect("a filter")
}

fn reading() -> PathReading {
    PathReading {
        topic: nasty(),
        fields: vec![field()],
    }
}

fn instead() -> Box<Instead> {
    let topic = LogTopic {
        topic: nasty(),
        message_encoding: nasty(),
        schema: Some(nasty()),
    };
    let candidate = Candidate {
        topic: topic.clone(),
        fields: vec![field()],
    };
    Box::new(Instead {
        meant: vec![nasty(); 2],
        readings: vec![reading()],
        role: Kind::Attitude,
        candidates: vec![candidate],
        others: OtherTopics::Listed(vec![topic]),
    })
}

/// What an error says, and in how many lines.
type Message = (String, usize);

fn messages<E: std::error::Error>(
    lines: usize,
    errors: impl IntoIterator<Item = E>,
) -> Vec<Message> {
    let messages = |error: E| (error.to_string(), lines);
    errors.into_iter().map(messages).collect()
}

#[test]
fn no_error_says_a_name_unescaped() {
    let misfits = || {
        [
            Misfit::NoMessages {
                topics: vec![nasty(); 2],
            },
            Misfit::NoMessages {
                topics: vec![nasty(); 9],
            },
            Misfit::NotWithAttitude { topic: nasty() },
            Misfit::NotInProfile {
                profile: nasty(),
                role: Kind::Gimbal,
            },
            Misfit::NoSuchFields {
                fields: vec![field()],
                nearest: None,
            },
            Misfit::NoSuchType {
                schemas: vec![nasty(); 2],
                nearest: None,
            },
        ]
    };
    let misfit = || Box::new(misfits()[2].clone());
    let two = || [nasty(), nasty()];
    let read = [
        ReadError::NotAFile { path: path() },
        ReadError::Locked { path: path() },
        ReadError::NotMcap {
            path: path(),
            format: None,
        },
        ReadError::Damaged {
            path: path(),
            offset: 1,
            damage: ChunkFault::UnknownCompression(nasty()).into(),
        },
    ];
    let journal = [
        JournalError::Foreign {
            path: path(),
            journal: path(),
            of: nasty(),
        },
        JournalError::Distrusted {
            path: path(),
            journal: path(),
            fault: JournalFault::Empty,
        },
    ];
    let mut earlier = EarlierRun::default();
    (earlier.version, earlier.camera) = (Some(nasty()), Some(nasty()));
    let write = [
        WriteError::TopicTaken {
            path: path(),
            topic: "/t",
            schema: Some(nasty()),
        },
        WriteError::AlreadyEnriched {
            path: path(),
            topic: "/t",
            earlier: earlier.into(),
            reason: Lost::Rewritten,
        },
        WriteError::NoFolder {
            path: path(),
            folder: path(),
        },
        WriteError::OutputExists { path: path() },
        WriteError::JournalInTheWay {
            path: path(),
            journal: path(),
        },
    ];
    let single = [
        TelemetryError::SeveralTopicsFit {
            path: path(),
            role: Kind::Attitude,
            topics: two().into(),
        },
        TelemetryError::SeveralVehicles {
            path: path(),
            namespaces: two().into(),
        },
    ];
    let listing = [
        TelemetryError::NoSuchNamespace {
            path: path(),
            namespace: nasty(),
            instead: instead(),
        },
        TelemetryError::RoleDoesNotFit {
            path: path(),
            role: Kind::Gimbal,
            misfit: misfit(),
            instead: instead(),
        },
        TelemetryError::ProfileDoesNotFit {
            path: path(),
            profile: nasty(),
            misfit: misfit(),
            instead: instead(),
        },
    ];
    let several = [
        TelemetryError::SeveralProfilesFit {
            path: path(),
            fits: vec![(nasty(), nasty()); 2],
        },
        TelemetryError::SeveralReadings {
            path: path(),
            role: Kind::Attitude,
            readings: vec![reading(); 2],
        },
    ];
    let not_found = TelemetryError::NotFound {
        path: path(),
        tried: vec![RunnerUp {
            profile: nasty(),
            attitude: Err(*misfit()),
            others: [(Kind::Velocity, nasty())].into(),
        }],
        instead: instead(),
    };
    let reason = MissingReason::TooFewUsable {
        sample: Kind::Attitude,
        needed: 2,
        topic: nasty(),
        tally: Tally::default(),
        refused_frames: vec![RefusedFrames {
            reason: DropReason::OwnFrame,
            frames: vec![NamedFrame {
                field: field(),
                name: nasty(),
            }],
            said: Reading::Velocity {
                axes: Axes::World(WorldAxes::NED),
                unit: SpeedUnit::MetresPerSecond,
            },
        }],
        first_undecodable: Some(Box::new(UndecodableMessage {
            topic: nasty(),
            log_time: 0,
            problem: Fault::Value {
                field: field(),
                value: nasty(),
                wanted: Content::Number,
            },
        })),
        unmet_filters: vec![UnmetFilter {
            filter: filter(),
            values: vec![filter().value],
            has_more: false,
            is_missing: false,
        }],
        conditions: vec![UnmetCondition {
            field: field(),
            wanted: vec![Test::Says(NASTY.to_owned())],
            found: vec![FoundValue {
                value: nasty(),
                messages: 1,
            }],
            others: 0,
        }],
    };
    let faults = [
        Fault::NotJson {
            field: Some(field()),
            problem: nasty(),
            offset: 1,
            text: nasty(),
        },
        Fault::EndsEarly {
            field: field(),
            length: 1,
        },
    ];
    let displayed = [
        reason.to_string(),
        Origin {
            topic: nasty(),
            select: vec![filter()],
            fields: vec![field()],
        }
        .to_string(),
    ];
    let profile = [
        ProfileError::Unknown {
            name: nasty(),
            built_in: vec![nasty()],
        },
        ProfileError::Bad {
            path: path(),
            problem: Box::new(NotAProfile::Content {
                line: 1,
                problem: ProfileProblem::UnknownKey {
                    key: nasty(),
                    meant: Some(nasty()),
                },
            }),
        },
    ];
    let role = [
        BadRole::NoField { path: nasty() },
        BadRole::TopicTwice { topic: nasty() },
        BadRole::SeveralSelections { topic: nasty() },
        BadRole::SelectTwice { filter: nasty() },
        BadRole::SeveralTopics { topics: two() },
    ];
    let argument = [
        BadArgument::SeveralTopics { topics: two() },
        BadArgument::UnknownWord {
            word: nasty(),
            known: vec![&["m"]],
        },
        BadArgument::LeftOver { word: nasty() },
        BadArgument::SeveralSelections { topic: nasty() },
        BadArgument::NoFields {
            topic: nasty(),
            word: nasty(),
        },
        BadArgument::NotATime { path: nasty() },
    ];
    let not_paths = [
        "\u{1b}\n]".parse::<FieldPath>().err(),
        "\n[".parse::<MessagePath>().err(),
        "\u{1b}=".parse::<Filter>().err(),
    ];
    let run = RunError::NotRestorable {
        path: path(),
        reason: Lost::NotEnriched,
    };
    let all = [
        messages(1, misfits()),
        messages(1, read),
        messages(1, journal),
        messages(1, write),
        messages(1, single),
        messages(8, listing),
        messages(3, several),
        messages(10, [not_found]),
        displayed.map(|text| (text, 1)).into(),
        messages(1, faults),
        messages(1, profile),
        messages(1, role),
        messages(1, argument),
        messages(1, not_paths.into_iter().flatten()),
        messages(1, [run]),
    ];
    for (text, lines) in all.concat() {
        assert_shown(&text);
        assert!(text.contains('\\'), "{text}");
        assert_eq!(text.lines().count(), lines, "{text}");
    }
}
