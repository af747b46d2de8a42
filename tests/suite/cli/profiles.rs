//! `flightcam profiles`: what it lists, and that what it prints is a profile.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::PathBuf,
};

use flightcam::source::profile::Profile;

use crate::support::{folder::*, repository};

/// The files from which the built-in profiles come, by the profile's name: `10-px4-ulog.toml` is `px4-ulog`.
fn files() -> BTreeMap<String, PathBuf> {
    let files = fs::read_dir(repository("profiles")).expect("the folder");
    files
        .map(|file| file.expect("a file").path())
        .map(|path| {
            let stem = path.file_stem().expect("a name").to_string_lossy();
            let (_order, name) = stem.split_once('-').expect("a number before the name");
            (name.to_owned(), path.clone())
        })
        .collect()
}

fn printed(name: &str) -> String {
    let (toml, err) = Folder::new().run(&format!("profiles {name}"), 0);
    assert_eq!(err, "");
    toml
}

#[test]
fn every_profile_is_listed_on_a_line_with_what_it_is_for_and_below_it_its_sources() {
    let list = printed("");
    let mut listed = BTreeSet::new();
    let mut with_sources = BTreeSet::new();
    let mut last = String::new();
    for line in list.lines() {
        if line.starts_with(' ') {
            assert!(line.trim().starts_with("https://"), "{line}");
            with_sources.insert(last.clone());
            continue;
        }
        let (name, description) = line.split_once("  ").expect("two columns");
        let description = description.trim();
        assert!(description.len() > 20, "{line}");
        let by_name_only = description.ends_with("(only by --profile)");
        assert_eq!(by_name_only, name == "flat-deg", "{line}");
        listed.insert(name.to_owned());
        last = name.to_owned();
    }
    assert_eq!(listed, files().into_keys().collect());
    listed.retain(|name| !name.starts_with("flat"));
    assert_eq!(with_sources, listed);
    assert!(
        list.contains(" https://github.com/PX4/px4_msgs\n"),
        "{list}"
    );
}

#[test]
fn a_profile_is_printed_as_it_is_with_the_sources_of_its_conventions() {
    for profile in Profile::built_in() {
        let toml = printed(&profile.name);
        let file = &files()[&profile.name];
        assert_eq!(toml, fs::read_to_string(file).expect("the file"));
        assert_eq!(Profile::parse(&toml).expect("a profile"), profile);
        let is_of_its_own = profile.name.starts_with("flat");
        assert!(is_of_its_own || toml.contains("https://"));
    }
}

#[test]
fn a_printed_profile_works_as_a_profile_file() {
    let folder = Folder::with_flight();
    let built_in = folder.reports(&format!("enrich {LOG} --depression 30 --profile flat"), 0);
    folder.add(
        "mine.toml",
        printed("flat").replace("name = \"flat\"", "name = \"mine\""),
    );
    let mut own = folder.reports(
        &format!("enrich {LOG} --depression 30 --profile mine.toml --force"),
        0,
    );
    assert_eq!(own["profile"]["name"], "mine");
    for key in ["profile", "bytes_added"] {
        own[key] = built_in[key].clone();
    }
    assert_eq!(own, built_in);

    for name in files().into_keys() {
        folder.add("px4.toml", printed(&name));
        let fits = ["flat", "flat-deg"].contains(&name.as_str());
        let (_, err) = folder.run(
            &format!("inspect {LOG} --profile px4.toml"),
            i32::from(!fits),
        );
        assert_eq!(err, "", "{name}: it is a profile");
    }
}

#[test]
fn an_unknown_profile_is_refused_with_the_known_names() {
    let names: Vec<String> = (Profile::built_in().into_iter())
        .map(|profile| profile.name)
        .collect();
    let message = format!(
        "unknown profile `px4`; the built-in profiles are {}",
        names.join(", ")
    );
    Folder::new().refuses("profiles px4", 2, &message);
}
