//! Simulates the cart-pendulum and writes what an experiment would measure.
//!
//! ```sh
//! cargo run --release -p sidc-studies --bin plant -- --seed 3 --force gaussian --rows 2000 --start 28deg -o out.csv
//! ```
//!
//! Without options, this is the experiment of the benchmark: 10,000 samples at 100 Hz. Every number is printed so that it reads back as the same f64;
//! accelerations come from the equations of motion, not from differences.

use clap::{Parser, ValueEnum};
use sidc_testing::integrate::grid;
use sidc_testing::plants::cart_pendulum::{Plant, State};
use sidc_testing::plants::force::{Force, Kind};
use sidc_testing::plants::run::run;
use sidc_testing::random::Random;
use sidc_testing::table::Table;
use std::error::Error;
use std::f64::consts::PI;
use std::path::PathBuf;

/// Simulates the cart-pendulum under a chosen force and writes a CSV table.
#[derive(Parser, Debug)]
struct Options {
    /// Seed of everything random
    #[arg(long, default_value_t = 0)]
    seed: u64,
    #[arg(long, value_enum, default_value_t = Kind::Experiment)]
    force: Kind,
    #[arg(long, default_value_t = 10_000)]
    rows: usize,
    /// Samples per second
    #[arg(long, default_value_t = 100.0)]
    rate: f64,
    /// First angle: 28deg, 0.5 (rad) or random; 0 hangs down. The experiment starts near upright, the others at 0
    #[arg(long, allow_hyphen_values = true)]
    start: Option<String>,
    /// Force of the first sample instead of the one drawn, N
    #[arg(long, allow_hyphen_values = true)]
    first_force: Option<f64>,
    #[arg(long, value_enum, default_value_t = Columns::All)]
    columns: Columns,
    /// Where to write; standard output if absent
    #[arg(short)]
    output: Option<PathBuf>,
    #[command(flatten)]
    plant: Plant,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Columns {
    /// t, y, theta, F
    Positions,
    /// also speeds and accelerations
    All,
}

fn main() -> Result<(), Box<dyn Error>> {
    let options = Options::parse();
    let text = simulate(&options)?.csv();
    match &options.output {
        Some(path) => std::fs::write(path, text)?,
        None => print!("{text}"),
    }
    Ok(())
}

fn simulate(options: &Options) -> Result<Table, Box<dyn Error>> {
    if !(options.rate.is_finite() && options.rate > 0.0) {
        return Err(format!(
            "--rate {}: expected samples per second, above 0",
            options.rate
        )
        .into());
    }
    let plant = &options.plant;
    let mut random = Random::new(options.seed);
    let theta = start_angle(options, &mut random)?;
    let mut force = Force::draw(options.force, options.rows, options.rate, &mut random);
    if let Some(first) = options.first_force {
        force.start_with(first);
    }
    let mut table = Table::new(&["t", "y", "theta", "F"]);
    if options.columns == Columns::All {
        table.names.extend(["dy", "dtheta", "ddy", "ddtheta"]);
    }
    table.digits = None;
    table.comments = comments(plant);

    // One more time than rows, because the interval of the last sample ends there.
    let times = grid(options.rows + 1, 1.0 / options.rate);
    let start: State = [0.0, 0.0, theta, 0.0];
    for row in run(plant, start, &times, |k, x| force.at(k, plant, x)) {
        let [y, dy, theta, dtheta] = row.state;
        let mut cells = vec![row.time, y, theta, row.force];
        if options.columns == Columns::All {
            let (ddy, ddtheta) = row.accelerations;
            cells.extend([dy, dtheta, ddy, ddtheta]);
        }
        table.push(&cells);
    }
    Ok(table)
}

fn start_angle(options: &Options, random: &mut Random) -> Result<f64, Box<dyn Error>> {
    let text = match (&options.start, options.force) {
        (Some(text), _) => text.trim(),
        (None, Kind::Experiment) => "170deg",
        (None, _) => "0",
    };
    if text == "random" {
        return Ok(random.uniform(-PI, PI));
    }
    let (number, unit) = match text.strip_suffix("deg") {
        Some(degrees) => (degrees, PI / 180.0),
        None => (text.strip_suffix("rad").unwrap_or(text), 1.0),
    };
    let angle: f64 = number.trim().parse().map_err(|_| {
        format!("--start {text}: expected an angle such as 28deg or 0.5, or the word random")
    })?;
    Ok(angle * unit)
}

/// The command and the true equations, so that the file explains itself even years later.
fn comments(plant: &Plant) -> Vec<String> {
    let mut arguments: Vec<String> = Vec::new();
    let mut skip = false;
    for a in std::env::args().skip(1) {
        // The output path is omitted: it may be private.
        if skip || a.starts_with("-o") {
            skip = !skip && a == "-o";
            continue;
        }
        arguments.push(a);
    }
    let mut lines = vec![
        format!(
            "made by: cargo run --release -p sidc-studies --bin plant -- {}",
            arguments.join(" ")
        )
        .trim_end_matches([' ', '-'])
        .to_string(),
    ];
    lines.extend(plant.equations());
    lines
}
