//! The command line: one file a subcommand; the only place that touches files and terminals.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

mod against;
mod answer;
mod candidates;
mod check;
mod completions;
mod examples;
mod export;
mod fmt;
mod identify;
mod inputs;
mod limits;
mod linearize;
mod list;
mod narrate;
mod new;
mod output;
mod point;
mod progress;
mod report;
mod simulate;
mod smooth;
mod values;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

use sidc_lang::diagnostic::did_you_mean;

/// Exit statuses, as docs/command-line.md promises them. 2 (usage) is clap's own.
pub(crate) mod status {
    pub const PASS: u8 = 0;
    /// The model, the data or a file is at fault.
    pub const INPUT: u8 = 1;
    /// A doubt, a failure, an interrupt or a limit: equations are still printed.
    pub const DOUBT: u8 = 3;
    /// Ctrl-C a second time: nothing is printed. What shells say of a program that Ctrl-C ended.
    pub const KILLED: u8 = 130;
}

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
    Completions(completions::Args),
}

/// Parses the command line, runs the subcommand, and turns what happened into an exit status.
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
        Command::Completions(args) => completions::run(&args),
    };
    ExitCode::from(result.unwrap_or_else(|said| said.print()))
}

/// What to add to the message about an unknown name, if one of the known names may be meant.
pub(crate) fn hint<'a>(wrong: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    did_you_mean(wrong, known).map_or_else(String::new, |n| format!("; did you mean `{n}`?"))
}

/// A failure of the whole command, with everything to say about it.
#[derive(Default)]
pub(crate) struct Failure(Vec<String>);

impl Failure {
    pub fn new(text: impl Into<String>) -> Self {
        Failure(vec![text.into()])
    }

    /// What another failure has to say as well.
    pub fn add(&mut self, other: Failure) {
        self.0.extend(other.0);
    }

    /// The value, unless there is something to say.
    pub fn or<T>(self, value: T) -> Result<T, Failure> {
        if self.0.is_empty() {
            Ok(value)
        } else {
            Err(self)
        }
    }

    fn print(&self) -> u8 {
        for text in &self.0 {
            eprint!("{text}");
            if !text.ends_with('\n') {
                eprintln!();
            }
        }
        status::INPUT
    }
}
