//! The command line: parses the arguments, runs one command, and exits with its status.
//!
//! Imports go one way: from here to `commands`, one file or folder per command, and from there to what commands share: `option_values`,
//! `inputs` and `outputs` (files, standard output, diagnostics), `monitoring` (progress, limits, Ctrl-C). No command uses another.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

mod commands;
mod exit_status;
mod failure;
mod inputs;
mod monitoring;
mod option_values;
mod outputs;
mod thresholds;

use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};

use commands::{
    check, completions, export, fmt, identify, linearize, list, lsp, man, new, report, simulate,
    smooth,
};

/// A compiler for equation discovery: from measured time series to differential equations, with evidence.
#[derive(Parser)]
#[command(name = "sidc", version, arg_required_else_help = true, after_help = EXAMPLES)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

const EXAMPLES: &str = "Examples:
  sidc new data.csv -o model.sid                    a first model of a table, to change
  sidc check pendulum.sid data.csv                  what the model means, and what the data lack
  sidc identify pendulum.sid data.csv -o R.json     find the equations
  sidc simulate R.json new.csv                      run them along other data, and compare
  sidc report R.json data.csv -o report.html        all of it as one page to look at
  sidc export R.json --to latex                     write them down
  sidc linearize R.json --at theta=pi               A and B near a point, eigenvalues, stability
  sidc smooth pendulum.sid data.csv -o smooth.csv   curves, derivatives and the noise of each sensor
  sidc lsp                                          the language server that editors start
Status: 0 every equation passes · 1 a fault in model, data or file · 2 usage · 3 a doubt, a limit or Ctrl-C";

#[derive(Subcommand)]
enum Command {
    New(new::Args),
    Check(check::Args),
    Identify(identify::Args),
    Simulate(simulate::Args),
    Smooth(smooth::Args),
    Fmt(fmt::Args),
    Report(report::Args),
    Export(export::Args),
    Linearize(linearize::Args),
    List(list::Args),
    Lsp(lsp::Args),
    Completions(completions::Args),
    #[command(hide = true)]
    Man(man::Args),
}

fn main() -> ExitCode {
    let result = match Cli::parse().command {
        Command::New(args) => new::run(&args),
        Command::Check(args) => check::run(&args),
        Command::Identify(args) => identify::run(&args),
        Command::Simulate(args) => simulate::run(&args),
        Command::Smooth(args) => smooth::run(&args),
        Command::Fmt(args) => fmt::run(&args),
        Command::Report(args) => report::run(&args),
        Command::Export(args) => export::run(&args),
        Command::Linearize(args) => linearize::run(&args),
        Command::List(args) => list::run(&args),
        Command::Lsp(args) => lsp::run(&args),
        Command::Completions(args) => completions::run(&args, Cli::command()),
        Command::Man(args) => man::run(&args, Cli::command()),
    };
    ExitCode::from(result.unwrap_or_else(|failure| {
        failure.print();
        exit_status::INPUT
    }))
}
