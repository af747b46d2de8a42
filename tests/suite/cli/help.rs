//! `--help` and `--version`.

use flightcam::{sample::Kind, source::request::RoleArgument};

use crate::support::folder::*;

#[test]
fn help_and_version_are_printed_when_asked_for() {
    for (arguments, text) in [
        ("--help", "MCAP … Usage: flightcam … enrich"),
        ("enrich --help", "Usage: … --depression … --profile"),
        ("--version", env!("CARGO_PKG_VERSION")),
    ] {
        let (out, err) = Folder::new().run(arguments, 0);
        assert_reads(&out, text);
        assert_eq!(err, "");
    }
}

#[test]
fn every_example_in_the_help_is_understood() {
    for subcommand in ["enrich", "inspect", "check"] {
        let (help, _) = Folder::new().run(&format!("{subcommand} --help"), 0);
        let words: Vec<&str> = help.split_whitespace().collect();
        let examples = words
            .windows(2)
            .filter(|pair| pair[1].starts_with(['/', '\'']) && pair[0].starts_with("--"));
        let examples: Vec<(&str, &str)> = examples.map(|pair| (pair[0], pair[1])).collect();
        assert!(examples.len() >= 10, "{examples:?}");
        for (option, value) in examples {
            // One is in a sentence, and some are quoted for the shell.
            let value = value.trim_end_matches(',').trim_matches('\'');
            let role = Kind::ALL
                .into_iter()
                .find(|kind| option[2..] == *kind.name());
            let parsed = role.map(|role| RoleArgument::parse(role, value));
            assert!(matches!(parsed, Some(Ok(_))), "{option} {value}");
        }
    }
}

#[test]
fn the_help_has_each_option_under_its_heading_and_fits_a_terminal() {
    for form in ["-h", "--help"] {
        let (help, _) = Folder::new().run(&format!("enrich {form}"), 0);
        assert_reads(
            &help,
            "Usage: flightcam enrich <INPUT> [--depression <DEG>] [OPTIONS] … \
             Options: … --output … --max-gap … --encoding … --force … --quiet … --json … \
             Camera: … --depression … --mount … \
             Telemetry: … --profile … --namespace … --attitude … --time … \
             Examples: … flightcam enrich flight.mcap --depression 30",
        );
        assert!(
            help.lines().all(|line| line.chars().count() <= 100),
            "{help}"
        );
    }
}
