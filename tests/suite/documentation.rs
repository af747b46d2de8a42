//! The documentation agrees with the program: options, exit codes, commands, profiles and their keys, the report; and
//! its links lead somewhere.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    process::Command,
};

use crate::support::{
    folder::*,
    help::{self, Described},
    markdown::{Row, anchor, blocks, codes, pages, read, rows},
    repository,
};
use assert_cmd::cargo::cargo_bin;
use flightcam::source::profile::Profile;
use toml::{Table, Value};

const MOST_WORDS_IN_README: usize = 1100;
const ROLES: [&str; 4] = ["attitude", "velocity", "gimbal", "position"];

// ---- Commands ----

/// The options that docs/options.md has of a command, which is empty for the program itself, each with its row.
fn documented_options(command: &str) -> BTreeMap<String, (Option<String>, String)> {
    let mut options = BTreeMap::new();
    for Row { heading, cells } in rows(&read("docs/options.md")) {
        let commands = codes(&heading);
        let is_meant = heading == "Every command"
            || commands.contains(&command)
            || (command.is_empty() && commands.contains(&"flightcam"));
        if !is_meant {
            continue;
        }
        let names = codes(&cells[0])
            .into_iter()
            .filter_map(|name| name.split(' ').next());
        let (long, short): (Vec<&str>, Vec<&str>) = names.partition(|name| name.starts_with("--"));
        let [long] = long[..] else {
            panic!("one long name in {cells:?}");
        };
        let short = short.first().map(|&short| short.to_owned());
        options.insert(long.to_owned(), (short, cells[1].clone()));
    }
    options
}

#[test]
fn every_option_is_documented_and_every_documented_one_exists() {
    for command in help::commands().into_iter().chain([String::new()]) {
        let documented = documented_options(&command);
        let known = help::options(&command);
        let names = |options: Vec<&String>| options.into_iter().cloned().collect::<BTreeSet<_>>();
        assert_eq!(
            names(documented.keys().collect()),
            names(known.keys().collect()),
            "{command}"
        );
        for (
            name,
            Described {
                short,
                values,
                default,
            },
        ) in known
        {
            let (documented_short, meaning) = &documented[&name];
            assert_eq!(*documented_short, short, "{command} {name}");
            let words = default.into_iter().filter(|default| !default.contains(' '));
            for word in values.into_iter().chain(words) {
                let is_named = codes(meaning).contains(&word.as_str());
                assert!(is_named, "{command} {name} lacks `{word}`: {meaning}");
            }
        }
    }
}

#[test]
fn every_command_is_documented_and_every_documented_one_exists() {
    let text = read("docs/options.md");
    let headings = text.lines().filter_map(|line| line.strip_prefix("## "));
    let documented: BTreeSet<&str> = headings.flat_map(codes).collect();
    let commands = help::commands();
    let known = commands.iter().map(String::as_str).chain(["flightcam"]);
    assert_eq!(documented, known.collect());
}

#[test]
fn exit_codes_are_those_of_the_help() {
    let help = help::help("");
    let (_, list) = help.split_once("Exit codes:\n").expect("exit codes");
    let known: Vec<String> = (list.lines())
        .map(|line| line.split_whitespace().collect::<Vec<_>>().join(" "))
        .collect();
    assert_eq!(known.len(), 5, "{list}");
    for (page, heading) in [
        ("README.md", "Common use"),
        ("docs/options.md", "Exit codes"),
    ] {
        let rows = rows(&read(page));
        let rows = rows.iter().filter(|row| row.heading == heading);
        let documented: Vec<String> = rows.map(|row| row.cells.join(" ")).collect();
        assert_eq!(documented, known, "{page}");
    }
}

/// The runs of flightcam in a shell command, without redirections.
fn runs(line: &str) -> Vec<Vec<&str>> {
    let (line, _comment) = line.split_once(" # ").unwrap_or((line, ""));
    let commands = line.split(['|', ';']).map(str::trim);
    let runs = commands.filter_map(|command| {
        (command.strip_prefix("flightcam "))
            .or_else(|| command.strip_prefix("cargo run --release -- "))
    });
    runs.map(|run| {
        let (arguments, _redirections) = run.split_at(run.find(['<', '>']).unwrap_or(run.len()));
        arguments.split_whitespace().collect()
    })
    .collect()
}

/// Runs flightcam where none of its files exists but profiles.
#[track_caller]
fn accepts(place: &str, arguments: &[&str]) {
    assert!(!arguments.concat().contains(['\'', '"']), "{arguments:?}");
    let folder = Folder::new();
    for profile in arguments.iter().filter(|word| word.ends_with(".toml")) {
        folder.add(profile, &blocks(&read("docs/profiles.md"), "toml")[0]);
    }
    let mut command = Command::new(cargo_bin!("flightcam"));
    command
        .current_dir(folder.path(""))
        .env("HOME", folder.path(""));
    let output = command.args(arguments).output().expect("it runs");
    let err = String::from_utf8_lossy(&output.stderr);
    let code = output.status.code();
    assert!(matches!(code, Some(0 | 1)), "{place}: {arguments:?}: {err}");
}

#[test]
fn every_command_in_an_example_has_arguments_that_are_understood() {
    let mut count = 0;
    for (page, text) in pages() {
        for block in blocks(&text, "sh") {
            for line in block.replace("\\\n", " ").lines() {
                for run in runs(line) {
                    accepts(&page, &run);
                    count += 1;
                }
            }
        }
    }
    assert!(count > 15, "{count} commands were found");
}

#[test]
fn every_form_of_a_message_path_is_understood() {
    let text = read("docs/profiles.md");
    let forms = rows(&text)
        .into_iter()
        .filter(|row| row.heading == "On the command line");
    let mut count = 0;
    for Row { cells, .. } in forms {
        let [form] = codes(&cells[0])[..] else {
            panic!("one form in {cells:?}");
        };
        let arguments: Vec<&str> = "enrich flight.mcap"
            .split(' ')
            .chain(form.split(' '))
            .collect();
        accepts("docs/profiles.md", &arguments);
        count += 1;
    }
    assert!(count > 5, "{count} forms were found");
}

// ---- Profiles ----

#[test]
fn every_built_in_profile_is_listed_in_its_order() {
    let rows = rows(&read("docs/profiles.md"));
    let rows = rows.iter().filter(|row| row.heading == "Built-in profiles");
    let listed: Vec<&str> = rows.flat_map(|row| codes(&row.cells[0])).collect();
    let profiles = Profile::built_in();
    let names: Vec<&str> = profiles
        .iter()
        .map(|profile| profile.name.as_str())
        .collect();
    assert_eq!(listed, names);
}

fn parse(page: &str, toml: &str) -> Profile {
    Profile::parse(toml).unwrap_or_else(|problem| panic!("{page}: {problem}\n{toml}"))
}

/// The texts of the profiles that are examples, each with its page.
fn example_texts() -> Vec<(String, String)> {
    let texts = pages().into_iter().flat_map(|(page, text)| {
        let blocks = blocks(&text, "toml").into_iter();
        blocks.map(move |toml| (page.clone(), toml))
    });
    texts.collect()
}

/// The profiles that are examples.
fn examples() -> Vec<Profile> {
    let texts = example_texts().into_iter();
    texts.map(|(page, toml)| parse(&page, &toml)).collect()
}

/// A key of the reference, with its row.
struct Key {
    /// With the role before it; `*` for any role.
    path: String,
    default: String,
    meaning: String,
}

/// The keys that docs/profiles.md explains.
fn reference() -> Vec<Key> {
    let mut keys = Vec::new();
    for Row { heading, cells } in rows(&read("docs/profiles.md")) {
        let prefix = match heading.as_str() {
            "Profile" => "",
            "Every role" => "*.",
            "Attitude" => "attitude.",
            "Velocity" => "velocity.",
            "Gimbal" => "gimbal.",
            "Position" => "position.",
            "Height" => "height.",
            "Angular rate" => "angular_rate.",
            "Acceleration" => "acceleration.",
            _ => continue,
        };
        let mut before = String::new();
        for code in codes(&cells[0]) {
            // `.pitch` follows the key that it belongs to.
            let key = match (code.strip_prefix('.'), before.rsplit_once('.')) {
                (Some(name), Some((table, _))) => format!("{table}.{name}"),
                _ => code.to_owned(),
            };
            before.clone_from(&key);
            keys.push(Key {
                path: format!("{prefix}{key}"),
                default: cells[1].clone(),
                meaning: cells[2].clone(),
            });
        }
    }
    keys
}

fn table(profile: &Profile) -> Table {
    Table::try_from(profile).expect("TOML")
}

/// The keys of a table and of all within it.
fn add_keys(table: &Table, prefix: &str, keys: &mut BTreeSet<String>) {
    for (key, value) in table {
        let path = format!("{prefix}{key}");
        let within = format!("{path}.");
        match value {
            Value::Table(table) => add_keys(table, &within, keys),
            Value::Array(values) => (values.iter().filter_map(Value::as_table))
                .for_each(|table| add_keys(table, &within, keys)),
            _ => {}
        }
        keys.insert(path);
    }
}

/// The values of a key in a table and in all alternatives within it.
fn values_at<'a>(table: &'a mut Table, path: &str) -> Vec<&'a mut Value> {
    let Some((first, rest)) = path.split_once('.') else {
        return table.get_mut(path).into_iter().collect();
    };
    match table.get_mut(first) {
        Some(Value::Table(table)) => values_at(table, rest),
        Some(Value::Array(values)) => (values.iter_mut().filter_map(Value::as_table_mut))
            .flat_map(|table| values_at(table, rest))
            .collect(),
        _ => Vec::new(),
    }
}

#[test]
fn every_key_of_a_profile_is_explained_and_every_explained_one_exists() {
    let mut explained = BTreeSet::new();
    for Key { path, .. } in reference() {
        let tables = path
            .match_indices('.')
            .map(|(end, _)| path[..end].to_owned());
        explained.extend(tables.filter(|table| table != "*"));
        explained.insert(path);
    }
    let mut known = BTreeSet::new();
    for profile in Profile::built_in().iter().chain(&examples()) {
        add_keys(&table(profile), "", &mut known);
    }
    // Some keys are short for others, by which they are replaced when a profile is read.
    let built_in = Profile::built_in_texts().iter().map(ToString::to_string);
    let examples = example_texts().into_iter().map(|(_, toml)| toml);
    for text in built_in.chain(examples) {
        add_keys(&text.parse().expect("TOML"), "", &mut known);
    }
    let known = known.into_iter().map(|path| match path.split_once('.') {
        Some((_role, rest)) if explained.contains(&format!("*.{rest}")) => format!("*.{rest}"),
        _ => path,
    });
    assert_eq!(explained, known.collect());
}

/// A profile that leaves all to the defaults.
const MINIMAL: &str = r#"
    name = "minimal"
    [[attitude]]
    orientation.quaternion = "q"
    reset_counter.field = "resets"
    [[attitude]]
    orientation.euler = { roll = "r", pitch = "p", yaw = "y", unit = "degrees" }
    [velocity]
    vector = "v"
    frame = "ned"
    [gimbal]
    orientation.pitch = { field = "pitch", unit = "degrees" }
    reference = "heading"
    [[position]]
    geodetic = { latitude = "lat", longitude = "lon", altitude = "alt", unit = "degrees" }
    [[position]]
    local = { vector = "p", frame = "ned" }
    [height]
    field = "h"
    [angular_rate]
    vector = "w"
    frame = "frd"
    [acceleration]
    vector = "a"
    frame = "frd"
"#;

#[test]
fn defaults_are_as_documented() {
    let mut minimal = table(&parse("MINIMAL", MINIMAL));
    let mut count = 0;
    for Key { path, default, .. } in reference() {
        let [default] = codes(&default)[..] else {
            continue;
        };
        let path = path.replace('*', ROLES[0]);
        let [value, ..] = &values_at(&mut minimal, &path)[..] else {
            panic!("{path} has no default");
        };
        assert_eq!(value.to_string(), default, "{path}");
        count += 1;
    }
    assert!(count > 10, "{count} defaults were found");
}

/// Puts a wrong value at a key of some profile that has it. Returns the valid values that the error lists.
fn values_there_are(path: &str) -> Vec<String> {
    for profile in Profile::built_in().iter().chain(&examples()) {
        let mut table = table(profile);
        let Some(value) = values_at(&mut table, path).into_iter().next() else {
            continue;
        };
        *value = Value::String("?".to_owned());
        let text = toml::to_string(&table).expect("TOML");
        let problem = Profile::parse(&text).expect_err("a value that there is not");
        let problem = problem.to_string();
        let (_, expected) = problem.split_once("expected ").expect("what is expected");
        let expected = expected.split(", in ").next().expect("a list");
        return codes(expected).into_iter().map(str::to_owned).collect();
    }
    panic!("no profile has {path}");
}

#[test]
fn the_values_of_a_key_are_as_documented() {
    let mut count = 0;
    for Key { path, meaning, .. } in reference() {
        let mentioned = codes(&meaning);
        let values: Vec<&str> = (mentioned.iter())
            .filter_map(|code| code.strip_prefix('"')?.strip_suffix('"'))
            .collect();
        if values.is_empty() {
            continue;
        }
        let known = values_there_are(&path.replace('*', ROLES[0]));
        for value in values {
            assert!(known.iter().any(|known| known == value), "{path}: {value}");
        }
        for value in known {
            let is_mentioned = mentioned.iter().any(|code| code.trim_matches('"') == value);
            assert!(is_mentioned, "{path} lacks {value}");
        }
        count += 1;
    }
    assert!(count > 10, "{count} keys with values were found");
}

// ---- The rest ----

#[test]
fn the_keys_of_the_report_are_as_documented() {
    let folder = Folder::with_flight();
    for (command, arguments) in [
        (
            "enrich",
            format!("enrich {LOG} --depression 30 --visuals --json"),
        ),
        ("inspect", format!("inspect {LOG} --json")),
        ("check", format!("check {LOG} --json")),
        ("restore", format!("restore {RESULT} --json")),
    ] {
        let report: serde_json::Map<String, serde_json::Value> =
            serde_json::from_str(&folder.run(&arguments, 0).0).expect("JSON");
        let rows = rows(&read("docs/report.md"));
        let rows = rows.iter().filter(|row| codes(&row.heading) == [command]);
        let documented: BTreeSet<&str> = rows.flat_map(|row| codes(&row.cells[0])).collect();
        assert_eq!(
            documented,
            report.keys().map(String::as_str).collect(),
            "{command}"
        );
    }
}

#[test]
fn every_link_leads_somewhere() {
    let mut count = 0;
    for (page, text) in pages() {
        for (start, _) in text.match_indices("](") {
            let link = &text[start + 2..];
            let link = &link[..link.find(')').expect("the link's end")];
            if link.starts_with("https://") {
                continue;
            }
            count += 1;
            let (file, fragment) = link.split_once('#').unwrap_or((link, ""));
            let source = repository(&page);
            let target = match file {
                "" => source,
                file => source.parent().expect("a folder").join(file),
            };
            assert!(target.exists(), "{page}: {link}");
            if !fragment.is_empty() {
                let text = fs::read_to_string(&target).expect("a page");
                let mut headings = text.lines().filter(|line| line.starts_with('#'));
                let is_there = headings.any(|heading| anchor(heading) == fragment);
                assert!(is_there, "{page}: {link}");
            }
        }
    }
    assert!(count > 15, "{count} links were found");
}

#[test]
fn the_readme_stays_short() {
    let text = read("README.md");
    let words = text
        .split_whitespace()
        .filter(|word| word.contains(char::is_alphanumeric));
    let count = words.count();
    assert!(count <= MOST_WORDS_IN_README, "{count} words");
}
