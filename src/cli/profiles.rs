//! `flightcam profiles`: which logs are understood, and profiles as starting points for your own.

use std::{collections::BTreeSet, iter};

use clap::Args;
use flightcam::{
    Error,
    source::profile::{OwnProfile, Profile},
    text,
};

use super::{Exit, own_profiles, print::print_result};

/// List the profiles and their sources, or print one to start your own from
///
/// Profiles of your own are .toml files in ~/.config/flightcam/profiles, or where XDG_CONFIG_HOME says. They are tried
/// beside the built-in ones.
#[derive(Debug, Args)]
#[command(after_help = "\
Example:
  flightcam profiles flat > mine.toml
  flightcam enrich flight.mcap --profile mine.toml --depression 30")]
pub struct Arguments {
    /// The profile to print, with the sources of its conventions
    name: Option<String>,
}

pub fn run(arguments: &Arguments) -> Result<Exit, Error> {
    let own = own_profiles::all()?;
    let text = match &arguments.name {
        Some(name) => match own.iter().find(|own| own.profile.name == *name) {
            Some(own) => text::escaped_lines(&own.text).to_string(),
            None => Profile::built_in_text(name)?.to_owned(),
        },
        None => list(&own),
    };
    print_result(text.trim_end());
    Ok(Exit::Done)
}

fn list(own: &[OwnProfile]) -> String {
    let built_in = Profile::built_in();
    let is_replaced = |profile: &Profile| own.iter().any(|own| own.profile.name == profile.name);
    let own = own.iter().map(|own| {
        let from = vec![text::path(&own.path).to_string()];
        (&own.profile, from)
    });
    let built_in = built_in.iter().zip(Profile::built_in_texts());
    let built_in = built_in.filter(|(profile, _)| !is_replaced(profile));
    let built_in = built_in.map(|(profile, text)| (profile, sources(text)));
    let listed: Vec<(&Profile, Vec<String>)> = own.chain(built_in).collect();
    let width = listed.iter().map(|(profile, _)| profile.name.len()).max();
    let width = width.unwrap_or(0);
    let lines = listed.into_iter().flat_map(|(profile, from)| {
        let name = text::escaped(&profile.name).to_string();
        let description = text::escaped(&profile.description);
        let by_name = match profile.automatic {
            true => "",
            false => " (only by --profile)",
        };
        let first = format!("{name:<width$}  {description}{by_name}");
        let from = from.into_iter();
        iter::once(first).chain(from.map(move |from| format!("{:<width$}  {from}", "")))
    });
    lines.collect::<Vec<_>>().join("\n")
}

/// What a profile's conventions rest on, by the links in its text: repositories, and other pages.
fn sources(text: &str) -> Vec<String> {
    let words = text.split_whitespace();
    let links = words.filter_map(|word| {
        word.trim_end_matches([',', '.', ')'])
            .strip_prefix("https://")
    });
    let pages: BTreeSet<String> = links
        .map(|link| match link.split('/').collect::<Vec<_>>()[..] {
            [host @ "github.com", owner, repository, ..] => format!("{host}/{owner}/{repository}"),
            _ => link.to_owned(),
        })
        .collect();
    pages
        .into_iter()
        .map(|page| format!("https://{page}"))
        .collect()
}
