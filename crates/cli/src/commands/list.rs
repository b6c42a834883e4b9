//! `sidc list`: the contents of all registries.

use crate::exit_status;
use crate::failure::Failure;
use crate::outputs::stdout;
use sidc_emit::TARGETS;
use sidc_lang::library::GENERATORS;
use sidc_lang::term::FUNCTIONS;
use sidc_solve::SOLVERS;

const EXAMPLES: &str = "Examples:
  sidc list                               generators, functions, solvers, targets";

/// List generators, functions, solvers and export targets
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {}

pub fn run(_: &Args) -> Result<u8, Failure> {
    let mut text = String::new();
    let mut section = |title: &str, lines: Vec<(String, String)>| {
        text.push_str(&format!("{title}\n"));
        for (name, about) in lines {
            text.push_str(&format!("  {name:<22} {about}\n"));
        }
    };
    section(
        "generators",
        GENERATORS
            .iter()
            .map(|g| (g.usage().into(), g.about().into()))
            .collect(),
    );
    section(
        "functions",
        FUNCTIONS
            .iter()
            .map(|f| (f.name.into(), f.domain.into()))
            .collect(),
    );
    section(
        "solvers (the first is the default)",
        SOLVERS
            .iter()
            .map(|s| (s.name().into(), s.about().into()))
            .collect(),
    );
    section(
        "export targets",
        TARGETS
            .iter()
            .map(|t| (t.name().into(), t.about().into()))
            .collect(),
    );
    stdout::print(&text)?;
    Ok(exit_status::PASS)
}
