//! `sidc completions SHELL`: a script that completes commands and options in a shell.

use clap::ValueEnum;
use clap_complete::{Shell, generate};

use crate::exit_status;
use crate::failure::Failure;
use crate::outputs::stdout;

const EXAMPLES: &str = "Examples:
  sidc completions bash > ~/.local/share/bash-completion/completions/sidc
  sidc completions zsh > ~/.zfunc/_sidc
  sidc completions fish > ~/.config/fish/completions/sidc.fish
  sidc completions powershell >> $PROFILE";

/// Print a completion script for a shell
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    shell: Kind,
}

#[derive(Clone, Copy, ValueEnum)]
enum Kind {
    Bash,
    Zsh,
    Fish,
    Powershell,
}

/// `program` is the whole command line, with the commands and options to complete.
pub fn run(args: &Args, mut program: clap::Command) -> Result<u8, Failure> {
    let shell = match args.shell {
        Kind::Bash => Shell::Bash,
        Kind::Zsh => Shell::Zsh,
        Kind::Fish => Shell::Fish,
        Kind::Powershell => Shell::PowerShell,
    };
    let mut script = Vec::new();
    generate(shell, &mut program, "sidc", &mut script);
    stdout::print(script)?;
    Ok(exit_status::PASS)
}
