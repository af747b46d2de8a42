//! What `--help` says: the commands, their options, and the values that those take.

use std::collections::BTreeMap;

use super::folder::Folder;

/// An option: its short form, the values to choose from, and the default.
#[derive(Debug, Default)]
pub struct Described {
    pub short: Option<String>,
    pub values: Vec<String>,
    pub default: Option<String>,
}

/// What `flightcam … --help` prints.
pub fn help(command: &str) -> String {
    let (help, err) = Folder::new().run(&format!("{command} --help"), 0);
    assert_eq!(err, "");
    help
}

/// The names of all commands but `help`.
pub fn commands() -> Vec<String> {
    let help = help("");
    let (_, list) = help.split_once("Commands:\n").expect("a list of commands");
    let names = list
        .lines()
        .take_while(|line| !line.is_empty())
        .filter_map(|line| line.split_whitespace().next());
    names
        .filter(|name| *name != "help")
        .map(str::to_owned)
        .collect()
}

/// A command's options by their long names, as in `--output`.
pub fn options(command: &str) -> BTreeMap<String, Described> {
    let mut options: BTreeMap<String, Described> = BTreeMap::new();
    let mut last = None;
    for line in help(command).lines() {
        let is_name = line.starts_with("  -") || line.starts_with("      -");
        let line = line.trim_start();
        if let Some(value) = line.strip_prefix("- ") {
            let (value, _) = value.split_once(':').expect("a value and what it means");
            let option: &mut Described = last
                .as_ref()
                .and_then(|name| options.get_mut(name))
                .expect("an option before its values");
            option.values.push(value.to_owned());
        } else if let Some(default) = line.strip_prefix("[default: ") {
            let option = last.as_ref().and_then(|name| options.get_mut(name));
            option.expect("an option before its default").default =
                Some(default.trim_end_matches(']').to_owned());
        } else if is_name {
            let mut names = line.split([' ', ',']).filter(|name| !name.is_empty());
            let first = names.next().expect("a name");
            let (short, long) = match first.starts_with("--") {
                true => (None, first),
                false => (Some(first.to_owned()), names.next().expect("a long name")),
            };
            let option = options.entry(long.to_owned()).or_default();
            option.short = option.short.take().or(short);
            last = Some(long.to_owned());
        }
    }
    options
}
