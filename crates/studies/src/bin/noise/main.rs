//! Identification from noisy positions: simulated rigs, sensors with noise and defects, and the results of `sidc identify`.
//!
//! ```sh
//! cargo build --release && cargo run --release -p sidc-studies --bin noise -- --case cart_pendulum --level 0 0.001 0.01 0.05 --seeds 10
//! … -- --case duffing --defect delay=5 --defect missing=0.02 --csv runs.csv --svg curve.svg
//! … -- --case cart_pendulum --level 0.01 --write /tmp/rig      # model, tables and truth.json, nothing is run
//! ```
//!
//! Prints one row per level. "Exact" means the true support and nothing else; coefficient errors are those of exact equations.

mod cases;
mod plot;
mod run;
mod sensors;
mod table;

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use cases::{CASES, Case, Draw};
use clap::Parser;
use run::{Outcome, Program};
use sensors::{Defect, Record};
use table::Row;

/// Studies identification from noisy measurements.
#[derive(Parser, Debug)]
struct Args {
    /// Rigs to study, or `all`; --list names them
    #[arg(long, num_args = 1.., default_values_t = ["cart_pendulum".to_string()])]
    case: Vec<String>,
    /// Noise, relative to each sensor's scale
    #[arg(long, num_args = 1.., default_values_t = [0.0, 0.001, 0.01, 0.05])]
    level: Vec<f64>,
    /// Runs at each level
    #[arg(long, default_value_t = 3)]
    seeds: u64,
    /// The first seed; it draws start, force and noise
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Length of each trajectory; the case knows a fitting one
    #[arg(long)]
    seconds: Option<f64>,
    /// Samples per second
    #[arg(long)]
    rate: Option<f64>,
    /// Trajectories, one file each
    #[arg(long)]
    files: Option<usize>,
    /// What drives a cart
    #[arg(long, value_enum, default_value_t = sidc_testing::plants::force::Kind::Experiment)]
    force: sidc_testing::plants::force::Kind,
    /// Spoils the sensors further: quantise=STEP, wrap, missing=SHARE, offset=SIZE, delay=SAMPLES (of commands),
    /// outliers=SHARE:SIGMAS, spread=RATIO (over files); STEP and SIZE in units of the sensor's scale; @COLUMN restricts it
    #[arg(long, num_args = 1..)]
    defect: Vec<Defect>,
    /// Passed to sidc identify
    #[arg(long)]
    method: Option<String>,
    /// Passed to sidc identify
    #[arg(long)]
    time_limit: Option<String>,
    /// Tell sidc the noise of the sensors
    #[arg(long)]
    told: bool,
    /// Any other option of sidc identify, as one word: --with=--solver=omp
    #[arg(long, allow_hyphen_values = true)]
    with: Vec<String>,
    /// The program; SIDC in the environment or the sidc next to this example if absent
    #[arg(long)]
    sidc: Option<PathBuf>,
    /// Write all runs here, a line for each equation
    #[arg(long)]
    csv: Option<PathBuf>,
    /// Draw the curves of a case
    #[arg(long)]
    svg: Option<PathBuf>,
    /// Write model, tables and truth.json of the first level and seed into this folder, and run nothing
    #[arg(long)]
    write: Option<PathBuf>,
    /// Show each run as it ends
    #[arg(short, long)]
    verbose: bool,
    /// Name the cases
    #[arg(long)]
    list: bool,
}

fn main() -> ExitCode {
    match go(&Args::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(e) => {
            // Printed as the program under study wrote it, with its line breaks.
            eprintln!("{e}");
            ExitCode::FAILURE
        }
    }
}

fn go(args: &Args) -> Result<(), Box<dyn Error>> {
    if args.list {
        CASES
            .iter()
            .for_each(|c| println!("{:20} {}", c.name, c.about));
        return Ok(());
    }
    let cases = chosen(args)?;
    if let Some(folder) = &args.write {
        return cases.iter().try_for_each(|case| write(args, case, folder));
    }
    if args.svg.is_some() && cases.len() > 1 {
        return Err("--svg draws one case at a time".into());
    }
    let program = program(args)?;
    let mut csv = table::CSV_HEAD.to_string();
    for case in cases {
        study(args, case, &program, &mut csv)?;
    }
    if let Some(path) = &args.csv {
        std::fs::write(path, csv)?;
    }
    Ok(())
}

fn chosen(args: &Args) -> Result<Vec<&'static Case>, String> {
    if args.case.iter().any(|name| name == "all") {
        return Ok(CASES.iter().collect());
    }
    let named = args.case.iter().map(|name| {
        let found = CASES.iter().find(|c| c.name == name);
        found.ok_or_else(|| format!("no case {name}; --list names them"))
    });
    named.collect()
}

fn program(args: &Args) -> Result<Program, Box<dyn Error>> {
    let binary = match (&args.sidc, std::env::var_os("SIDC")) {
        (Some(path), _) => path.clone(),
        (None, Some(path)) => path.into(),
        // The binary in the folder of this one.
        (None, None) => {
            let name = format!("sidc{}", std::env::consts::EXE_SUFFIX);
            std::env::current_exe()?.with_file_name(name)
        }
    };
    let mut options = Vec::new();
    if let Some(method) = &args.method {
        options.push(format!("--method={method}"));
    }
    if let Some(limit) = &args.time_limit {
        options.push(format!("--time-limit={limit}"));
    }
    options.extend(args.with.iter().cloned());
    Ok(Program {
        binary,
        options,
        told: args.told,
    })
}

/// What the sensors of `case` record.
fn record(args: &Args, case: &Case, level: f64, seed: u64) -> Record {
    let rate = args.rate.unwrap_or(case.rate);
    let files = args.files.unwrap_or(case.files).max(1);
    let clean = (0..files).map(|file| {
        (case.motion)(&Draw {
            rows: (args.seconds.unwrap_or(case.seconds) * rate).round() as usize,
            rate,
            file,
            seed,
            force: args.force,
        })
    });
    sensors::record(case, clean.collect(), level, &args.defect, seed)
}

fn study(
    args: &Args,
    case: &Case,
    program: &Program,
    csv: &mut String,
) -> Result<(), Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let model = sensors::model(case, &args.defect);
    let laws = (case.truth)();
    let defects: Vec<String> = args.defect.iter().map(Defect::to_string).collect();
    let defects = defects.join(" ");
    let mut points = Vec::new();
    for (i, &level) in args.level.iter().enumerate() {
        let mut outcomes = Vec::new();
        for seed in args.seed..args.seed + args.seeds {
            let record = record(args, case, level, seed);
            let files = run::write(folder.path(), case, &model, &record)?;
            if i == 0 && seed == args.seed {
                let counts = run::check(program, &files[0], &laws)?;
                println!("{}", title(case, &record, &counts, &defects));
                let targets: Vec<&str> = laws.iter().map(|(target, _)| *target).collect();
                println!("{}", table::head(&targets));
            }
            let outcome = run::run(program, case, &files, &record, (level, seed))?;
            if args.verbose {
                show(&outcome);
            }
            *csv += &table::csv(case.name, &defects, &outcome);
            outcomes.push(outcome);
        }
        let row = Row {
            level,
            outcomes: &outcomes,
        };
        println!("{}", row.text());
        points.push(plot::Point {
            level,
            exact: row.exact(),
            runs: outcomes.len(),
            worst: row.worst(),
        });
    }
    println!();
    if let Some(path) = &args.svg {
        let title = format!("{}: {} runs at each level", case.name, args.seeds);
        std::fs::write(path, plot::svg(&title, &points))?;
    }
    Ok(())
}

fn title(case: &Case, record: &Record, counts: &[usize], defects: &str) -> String {
    let rows: Vec<String> = record
        .tables
        .iter()
        .map(|t| t.rows.len().to_string())
        .collect();
    let terms: Vec<String> = counts.iter().map(usize::to_string).collect();
    let sizes = case.sensors.iter().zip(&record.sizes);
    let sizes: Vec<String> = sizes
        .map(|(s, size)| format!("{} {size:.2}", s.column))
        .collect();
    let mut text = format!(
        "{}: {} rows, {} terms; standard deviations of the first motion: {}",
        case.name,
        rows.join(" + "),
        terms.join(" + "),
        sizes.join(", ")
    );
    if !defects.is_empty() {
        text += &format!("; {defects}");
    }
    text
}

/// Prints one run on stderr.
fn show(outcome: &Outcome) {
    let exit = outcome.exit.map_or("killed".into(), |e| e.to_string());
    eprintln!(
        "level {} seed {}: {:.2} s, exit {exit}",
        outcome.level, outcome.seed, outcome.seconds
    );
    for law in &outcome.laws {
        let mark = if law.exact { "exact" } else { "WRONG" };
        let status = &law.status;
        eprintln!("  {mark} {status:5} {} = {}", law.target, law.text);
    }
}

fn write(args: &Args, case: &Case, folder: &Path) -> Result<(), Box<dyn Error>> {
    let level = args.level.first().copied().unwrap_or(0.0);
    std::fs::create_dir_all(folder)?;
    let record = record(args, case, level, args.seed);
    let model = sensors::model(case, &args.defect);
    for path in run::write(folder, case, &model, &record)? {
        println!("{}", path.display());
    }
    let path = folder.join("truth.json");
    let text = run::truth(case, &record, level, args.seed);
    std::fs::write(&path, format!("{text:#}\n"))?;
    println!("{}", path.display());
    Ok(())
}
