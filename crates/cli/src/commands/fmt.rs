//! `sidc fmt MODEL`: changes only white space.

use std::path::PathBuf;

use crate::exit_status;
use crate::failure::Failure;
use crate::inputs::texts;
use crate::outputs::{diagnostics, files, paths};
use sidc_lang as lang;
use sidc_lang::source::Sources;

const EXAMPLES: &str = "Examples:
  sidc fmt pendulum.sid                   lay the model out, in place
  sidc fmt --check *.sid                  status 1 if one would change";

/// Lay a model out in the standard way (white space only; comments stay)
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Models (.sid), rewritten in place
    #[arg(required = true)]
    models: Vec<PathBuf>,
    /// Change nothing; status 1 if a file would change
    #[arg(long)]
    check: bool,
}

pub fn run(args: &Args) -> Result<u8, Failure> {
    let mut unformatted = Vec::new();
    for path in &args.models {
        let mut sources = Sources::default();
        let (before, _) = texts::model_text(path)?;
        let file = sources.add(path.display().to_string(), before.as_str());
        let formatted =
            lang::format(file, &before).map_err(|found| diagnostics::failure(&found, &sources))?;
        if formatted == before {
            continue;
        }
        if args.check {
            unformatted.push(paths::shown(path));
        } else {
            files::write(path, &formatted)?;
        }
    }
    if unformatted.is_empty() {
        return Ok(exit_status::PASS);
    }
    Err(Failure::new(format!(
        "would be laid out anew: {}\n  = help: run `sidc fmt {}`",
        unformatted.join(", "),
        unformatted.join(" ")
    )))
}
