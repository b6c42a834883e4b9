//! `sidc fmt MODEL`: white space only, never spelling.

use std::path::PathBuf;

use super::{Failure, inputs, output, status};
use sidc_lang as lang;
use sidc_lang::source::Sources;

/// Lay a model out in the standard way (white space only; comments stay)
#[derive(clap::Args)]
#[command(after_help = super::examples::FMT)]
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
        let file = inputs::model(path, &mut sources)?;
        let before = sources.get(file).map_or("", |s| s.text.as_str());
        let formatted = lang::format(file, before)
            .map_err(|found| Failure::new(inputs::render(&found, &sources)))?;
        if formatted == before {
            continue;
        }
        if args.check {
            unformatted.push(inputs::shown(path));
        } else {
            output::write(path, &formatted)?;
        }
    }
    if unformatted.is_empty() {
        return Ok(status::PASS);
    }
    Err(Failure::new(format!(
        "would be laid out anew: {}\n  = help: run `sidc fmt {}`",
        unformatted.join(", "),
        unformatted.join(" ")
    )))
}
