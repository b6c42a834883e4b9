//! Halves and doubles every number that decides: which answers change?
//!
//! ```sh
//! cargo run --release -p sidc-studies --bin thresholds                       # what docs/thresholds-study.csv lacks
//! cargo run --release -p sidc-studies --bin thresholds -- Misfit Search.carried    # these anew, and what lacks of them
//! cargo run --release -p sidc-studies --bin thresholds -- --cases            # seconds of each case, and the families it reads
//! ```
//!
//! In: a `sidc` built with `--cfg vary_thresholds` into target/vary, which reads a factor for one number from the environment
//! (crates/thresholds/src/vary.rs). Out: docs/thresholds-study.csv, one row per number and factor, written row by row, so that an interrupted study can
//! continue. A row is redone if its number has changed in the code.

mod answer;
mod cases;
mod files;
mod run;

use std::collections::{BTreeMap, VecDeque};
use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Mutex, PoisonError};

use clap::Parser;
use sidc_testing::program::root;
use sidc_testing::thresholds::{CONSTANTS, FACTORS, STUDY, Sensitivity, parts, read, value, write};

use run::{Program, Reference};

/// Halves and doubles every number that decides, and compares answers.
#[derive(Parser, Debug)]
struct Args {
    /// Families, or numbers as FAMILY.NAME, that are run anew; without them all that the table lacks
    only: Vec<String>,
    /// The program, built with RUSTFLAGS="--cfg vary_thresholds"; built into target/vary if absent
    #[arg(long)]
    sidc: Option<PathBuf>,
    /// Runs at a time; as many as there are cores if absent
    #[arg(long)]
    jobs: Option<usize>,
    /// Print the seconds of each case and the families it reads, and move nothing
    #[arg(long)]
    cases: bool,
}

/// A row to be filled: its index in the table, and everything except its cases.
type Order = (usize, Sensitivity);

fn main() -> Result<(), Box<dyn Error>> {
    let args = Args::parse();
    let sidc = match &args.sidc {
        Some(path) => path.canonicalize()?,
        None => built()?,
    };
    let folder = tempfile::tempdir()?;
    let program = Program::new(sidc, folder.path());
    program.prepare()?;
    let references = cases::CASES
        .iter()
        .map(|case| program.reference(case))
        .collect::<Result<Vec<Reference>, _>>()?;
    if args.cases {
        for r in &references {
            let families: Vec<&str> = r.families.iter().map(String::as_str).collect();
            println!(
                "{:24} {:.2} s  {}",
                r.case.name,
                r.seconds,
                families.join(" ")
            );
        }
        return Ok(());
    }
    let path = root().join(STUDY);
    let known = std::fs::read_to_string(&path).map_or_else(|_| Vec::new(), |text| read(&text));
    let (done, open) = orders(&args.only, &known);
    println!("{} rows stand, {} are to be run", done.len(), open.len());
    let jobs = args.jobs.unwrap_or_else(run::cores);
    study(&program, &references, done, open, jobs, &path)
}

/// Builds the program with variable thresholds.
fn built() -> Result<PathBuf, Box<dyn Error>> {
    let target = root().join("target/vary");
    let status = Command::new(env!("CARGO"))
        .args(["build", "--release", "-p", "sidc-cli", "--target-dir"])
        .arg(&target)
        .env("RUSTFLAGS", "--cfg vary_thresholds")
        .current_dir(root())
        .status()?;
    match status.success() {
        true => Ok(target.join(format!("release/sidc{}", std::env::consts::EXE_SUFFIX))),
        false => Err("sidc does not build with --cfg vary_thresholds".into()),
    }
}

/// Finished rows by their index in the table, and rows to be run.
fn orders(
    only: &[String],
    known: &[Sensitivity],
) -> (BTreeMap<usize, Sensitivity>, VecDeque<Order>) {
    let (mut done, mut open) = (BTreeMap::new(), VecDeque::new());
    let mut place = 0;
    for table in parts().into_iter().flat_map(|(_, tables)| tables) {
        for number in &table.thresholds {
            let path = format!("{}.{}", table.name, number.name);
            let asked = only.iter().any(|o| *o == path || o == table.name);
            for factor in FACTORS {
                place += 1;
                if CONSTANTS.contains(&(table.name, number.name)) {
                    continue;
                }
                let old = known
                    .iter()
                    .find(|row| row.is_of(table.name, number, factor));
                match old {
                    Some(row) if !asked => {
                        done.insert(place, row.clone());
                    }
                    _ if asked || only.is_empty() => open.push_back((
                        place,
                        Sensitivity {
                            family: table.name.into(),
                            name: number.name.into(),
                            value: value(number),
                            factor,
                            cases: 0,
                            changed: Vec::new(),
                        },
                    )),
                    _ => {}
                }
            }
        }
    }
    (done, open)
}

/// Fills the open rows, and writes the table after each.
fn study(
    program: &Program,
    references: &[Reference],
    done: BTreeMap<usize, Sensitivity>,
    open: VecDeque<Order>,
    jobs: usize,
    path: &Path,
) -> Result<(), Box<dyn Error>> {
    let (done, open) = (Mutex::new(done), Mutex::new(open));
    let next = || {
        open.lock()
            .unwrap_or_else(PoisonError::into_inner)
            .pop_front()
    };
    let work = || -> Result<(), String> {
        while let Some((place, mut row)) = next() {
            let order = format!("{}.{}={}", row.family, row.name, row.factor);
            for reference in references
                .iter()
                .filter(|r| r.families.contains(&row.family))
            {
                row.cases += 1;
                if let Some(part) = program.changed(reference, &order)? {
                    row.changed.push(format!("{}: {part}", reference.case.name));
                }
            }
            println!("{row}");
            let mut done = done.lock().unwrap_or_else(PoisonError::into_inner);
            done.insert(place, row);
            let rows: Vec<Sensitivity> = done.values().cloned().collect();
            // Written to a second file and renamed, so that a killed study leaves a complete table.
            let part = path.with_extension("part");
            std::fs::write(&part, write(&rows)).map_err(|e| e.to_string())?;
            std::fs::rename(&part, path).map_err(|e| e.to_string())?;
        }
        Ok(())
    };
    std::thread::scope(|scope| {
        let threads: Vec<_> = (0..jobs.max(1)).map(|_| scope.spawn(work)).collect();
        threads
            .into_iter()
            .try_for_each(|thread| match thread.join() {
                Ok(ended) => ended.map_err(Into::into),
                Err(_) => Err("a thread panicked".into()),
            })
    })
}
