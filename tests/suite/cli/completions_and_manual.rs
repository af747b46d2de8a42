//! Completion scripts for shells, and manual pages.

use std::{fs, process::Command};

use crate::support::{
    folder::*,
    help::{commands, options},
};

const SHELLS: [&str; 5] = ["bash", "elvish", "fish", "powershell", "zsh"];

fn printed(arguments: &str) -> String {
    let (out, err) = Folder::new().run(arguments, 0);
    assert_eq!(err, "");
    out
}

#[test]
fn completions_name_every_command_and_option() {
    for shell in SHELLS {
        let script = printed(&format!("completions {shell}"));
        for command in commands() {
            assert!(script.contains(&command), "{shell}: {command}");
            for option in options(&command).keys() {
                let name = option.trim_start_matches('-');
                assert!(script.contains(name), "{shell}: {command} {option}");
            }
        }
    }
}

#[test]
fn bash_completes_commands_options_and_their_values() {
    let folder = Folder::new();
    folder.add("completions", printed("completions bash"));
    let script = r#"
        source ./completions || exit 1
        COMP_WORDS=("$@") COMP_CWORD=$(($# - 1))
        _flightcam flightcam "${COMP_WORDS[COMP_CWORD]}" "${COMP_WORDS[COMP_CWORD - 1]}"
        echo "${COMPREPLY[*]}"
    "#;
    for (words, expected) in [
        ("flightcam ins", "inspect"),
        ("flightcam enrich --enc", "--encoding"),
        ("flightcam enrich --layout i", "interleaved"),
    ] {
        let mut bash = Command::new("bash");
        bash.current_dir(folder.path(""))
            .args(["-c", script, "bash"]);
        let Ok(output) = bash.args(words.split(' ')).output() else {
            return eprintln!("skipped: this machine has no bash");
        };
        assert!(output.status.success(), "{output:?}");
        let completed = String::from_utf8(output.stdout).expect("text");
        assert_eq!(completed.trim(), expected, "{words}");
    }
}

#[test]
fn the_manual_page_names_every_command() {
    let page = printed("manual");
    assert!(page.contains(".TH flightcam 1"), "{page}");
    for command in commands() {
        assert!(
            page.contains(&format!("flightcam\\-{command}(1)")),
            "{command}"
        );
    }
}

#[test]
fn each_command_has_a_manual_page_with_all_of_its_options() {
    let folder = Folder::new();
    folder.run("manual share/man1", 0);
    let page = |name: &str| {
        let page = fs::read_to_string(folder.path(&format!("share/man1/{name}.1")));
        page.unwrap_or_else(|error| panic!("{name}: {error}"))
    };
    assert!(page("flightcam").contains(".SH \"EXIT CODES\"\n.nf\n  0  done\n"));
    for command in commands() {
        let page = page(&format!("flightcam-{command}"));
        for option in options(&command).keys() {
            let escaped = option.replace('-', "\\-");
            assert!(page.contains(&escaped), "{command}: {option}");
        }
    }
    let count = fs::read_dir(folder.path("share/man1"))
        .expect("the folder")
        .count();
    assert_eq!(count, commands().len() + 1);
}

#[test]
fn a_manual_that_cannot_be_written_is_an_error() {
    let folder = Folder::with("file", "");
    folder.refuses("manual file/man1", 1, "cannot write the manual");
}
