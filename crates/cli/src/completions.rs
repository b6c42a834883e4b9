//! `sidc completions SHELL`: what a shell needs to complete commands and options.

use clap::{CommandFactory, ValueEnum};
use clap_complete::{Shell, generate};

use super::{Cli, Failure, output, status};

/// Print a completion script for a shell
#[derive(clap::Args)]
#[command(after_help = super::examples::COMPLETIONS)]
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

pub fn run(args: &Args) -> Result<u8, Failure> {
    let shell = match args.shell {
        Kind::Bash => Shell::Bash,
        Kind::Zsh => Shell::Zsh,
        Kind::Fish => Shell::Fish,
        Kind::Powershell => Shell::PowerShell,
    };
    let mut script = Vec::new();
    generate(shell, &mut Cli::command(), "sidc", &mut script);
    output::print(&String::from_utf8_lossy(&script))?;
    Ok(status::PASS)
}
