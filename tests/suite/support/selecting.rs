//! Which telemetry of a log is selected.

use flightcam::{
    Error,
    log::Log,
    sample::{Kind, VelocityFrom},
    source::{
        Source,
        profile::{Profile, ProfileChoice},
        request::{Request, RoleArgument},
    },
};

use super::{folder::*, piping, topics::*};

/// A request, given as on the command line.
pub fn request(arguments: &[(&str, &str)]) -> Request {
    let mut request = Request::default();
    for &(option, value) in arguments {
        match option {
            "--profile" => {
                let profile = Profile::load(value).expect("a built-in profile");
                request.profile = ProfileChoice::Given(Box::new(profile));
            }
            "--namespace" => request.namespace = Some(value.to_owned()),
            "--velocity-from" => {
                assert_eq!(value, VelocityFrom::Position.name());
                request.velocity_from = VelocityFrom::Position;
            }
            option => {
                let name = |kind: &Kind| format!("--{}", kind.name());
                let role = Kind::ALL.into_iter().find(|kind| name(kind) == option);
                let role = role.expect("the option of a role");
                let argument = RoleArgument::parse(role, value).expect("an argument");
                request.roles.insert(role, argument);
            }
        }
    }
    request
}

/// The profile of a text.
#[track_caller]
pub fn parsed(toml: &str) -> Profile {
    Profile::parse(toml).unwrap_or_else(|problem| panic!("{problem}: {toml}"))
}

/// A request for the profile of a text.
#[track_caller]
pub fn own(toml: &str) -> Request {
    Request {
        profile: ProfileChoice::Given(Box::new(parsed(toml))),
        ..Request::default()
    }
}

/// What is selected of a log in a file, which must be the same as from a pipe.
#[track_caller]
pub fn select_with(topics: &[Topic], request: &Request) -> Result<Source, Error> {
    piping::check(&log(topics), request, 4096);
    let folder = Folder::with(LOG, log(topics));
    Ok(Source::select(&Log::open(&folder.path(LOG))?, request)?)
}

/// What is used: the profile, and the topics of attitude and velocity.
pub fn used(source: &Source) -> (&str, &str, &str) {
    let topic = |kind| source.role(kind).map_or("", |role| role.topic.as_str());
    let profile = source.profile.name.as_str();
    (profile, topic(Kind::Attitude), topic(Kind::Velocity))
}

#[track_caller]
pub fn selects(topics: &[Topic], arguments: &[(&str, &str)], expected: (&str, &str, &str)) {
    match select_with(topics, &request(arguments)) {
        Ok(source) => assert_eq!(used(&source), expected, "with {arguments:?}"),
        Err(error) => panic!("with {arguments:?}: {error}"),
    }
}

#[track_caller]
pub fn refuses(topics: &[Topic], arguments: &[(&str, &str)], words: &str) {
    let error = select_with(topics, &request(arguments)).expect_err("an error");
    assert_reads(&error.to_string(), words);
}
