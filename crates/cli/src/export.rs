//! `sidc export R.json --to TARGET`: a result as code or mathematics.

use std::path::PathBuf;

use super::{Failure, hint, inputs, output, status};
use sidc_emit as emit;
use sidc_emit::TARGETS;
use sidc_lang::source::Sources;
use sidc_system::result;

/// Write a result as LaTeX, Rust, …
#[derive(clap::Args)]
#[command(after_help = super::examples::EXPORT)]
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
    output::ready(args.output.as_deref(), [&args.result])?;
    let text = inputs::result(&args.result)?;
    let name = inputs::short_name(&args.result);
    let discovery = result::read(&name, &text)
        .map_err(|d| Failure::new(inputs::render(&[d], &Sources::default())))?;
    let code = target
        .emit(&discovery)
        .map_err(|why| Failure::new(format!("error[not-expressible]: {why}")))?;
    match &args.output {
        Some(path) => output::write(path, &code)?,
        None => output::print(&code)?,
    }
    Ok(status::PASS)
}

fn unknown(name: &str) -> Failure {
    let names: Vec<&str> = TARGETS.iter().map(|t| t.name()).collect();
    let hint = hint(name, names.iter().copied());
    Failure::new(format!(
        "error[unknown-target]: no target named `{name}`{hint}\n  = targets: {}",
        names.join(", ")
    ))
}
