//! `flightcam completions`: a script that lets a shell complete flightcam's commands and options.

use clap::{Args, CommandFactory};
use clap_complete::{Shell, generate};
use flightcam::Error;

use super::{Cli, Exit, print::print_result};

/// Print a script that lets a shell complete flightcam's commands and options
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  bash        flightcam completions bash > ~/.local/share/bash-completion/completions/flightcam
  zsh         flightcam completions zsh > ~/.zfunc/_flightcam
              with `fpath+=~/.zfunc` before `compinit` in ~/.zshrc
  fish        flightcam completions fish > ~/.config/fish/completions/flightcam.fish
  elvish      flightcam completions elvish >> ~/.config/elvish/rc.elv
  PowerShell  flightcam completions powershell >> $PROFILE")]
pub struct Arguments {
    /// The shell
    shell: Shell,
}

pub fn run(arguments: &Arguments) -> Result<Exit, Error> {
    let mut command = Cli::command();
    let name = command.get_name().to_owned();
    let mut script = Vec::new();
    generate(arguments.shell, &mut command, name, &mut script);
    print_result(String::from_utf8_lossy(&script).trim_end());
    Ok(Exit::Done)
}
