//! `sidc export R.json --to TARGET`: a result as code or mathematics.

use std::path::{Path, PathBuf};

use crate::exit_status;
use crate::failure::Failure;
use crate::inputs::texts;
use crate::option_values::names::hint;
use crate::outputs::paths::shown;
use crate::outputs::{doubts, files};
use sidc_emit as emit;
use sidc_emit::{TARGETS, Written};

const EXAMPLES: &str = "Examples:
  sidc export R.json --to latex           equations for a paper
  sidc export R.json --to c -o model.h    code with Jacobians";

/// Write a result as LaTeX, Rust, …
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Result of `sidc identify … -o R.json`
    result: PathBuf,
    /// Target language (`sidc list` shows them)
    #[arg(long)]
    to: String,
    /// File to write instead of stdout
    #[arg(short, long)]
    output: Option<PathBuf>,
}

pub fn run(args: &Args) -> Result<u8, Failure> {
    let target = emit::target(&args.to).ok_or_else(|| unknown(&args.to))?;
    files::check_writable(args.output.as_deref(), [&args.result])?;
    let discovery = texts::result(&args.result)?.discovery;
    if discovery.equations.is_empty() {
        return Err(Failure::new(format!(
            "error[nothing-to-export]: {} has no equation: none was found\n  = help: `sidc report {} DATA` says why",
            shown(&args.result),
            shown(&args.result)
        )));
    }
    let written = target
        .emit(&discovery)
        .map_err(|why| Failure::new(format!("error[not-expressible]: {why}")))?;
    // A failure is printed alone, without the warning about doubts.
    if let (Written::Binary { suffix, .. }, None) = (&written, &args.output) {
        return Err(unnamed(args, suffix));
    }
    doubts::warn(&discovery);
    files::write_or_print(args.output.as_deref(), written.into_bytes())?;
    Ok(exit_status::PASS)
}

/// A binary file needs a name: printed on a terminal it is unreadable.
fn unnamed(args: &Args, suffix: &str) -> Failure {
    let name = args.result.with_extension(suffix);
    let name = name.file_name().unwrap_or_default();
    Failure::new(format!(
        "error[binary-export]: a file of `{}` is binary and is not printed\n  = help: name one: -o {}",
        args.to,
        shown(Path::new(name))
    ))
}

fn unknown(name: &str) -> Failure {
    let names: Vec<&str> = TARGETS.iter().map(|t| t.name()).collect();
    let hint = hint(name, names.iter().copied());
    Failure::new(format!(
        "error[unknown-target]: no target named `{name}`{hint}\n  = targets: {}",
        names.join(", ")
    ))
}
