//! From how many rows does basis pursuit find the laws of random coupled mechanisms, plain and with graded norms?
//!
//! ```sh
//! cargo run --release -p sidc-studies --bin coupled -- --seeds 0..8 --rows 20 30 40 60 80 120 --out trials.csv
//! ```
//!
//! Every seed is another mechanism of each family, in large and in small swings; every law of it is asked for. Writes one line a trial.

use std::error::Error;
use std::fmt::Write;
use std::path::PathBuf;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use clap::Parser;
use sidc_discover::split;
use sidc_studies::coupled::{GRADINGS, Library, Size, Tabulated, outcome};
use sidc_testing::plants::coupled::{Coupled, FAMILIES, Family, Point, Swing};

/// Rows of a record, 0.05 s apart.
const ROWS: usize = 800;
const STEP: f64 = 0.05;

#[derive(Parser)]
struct Args {
    /// First seed
    #[arg(long, default_value_t = 0)]
    from: u64,
    /// Number of seeds
    #[arg(long, default_value_t = 2)]
    seeds: u64,
    #[arg(long, num_args = 1.., default_values_t = [20, 30, 40, 60, 80, 120])]
    rows: Vec<usize>,
    /// Atoms of a library; 0 for those of the law alone
    #[arg(long, num_args = 1.., default_values_t = [9, 11])]
    atoms: Vec<usize>,
    /// Places in the list of gradings; all without it
    #[arg(long, num_args = 1..)]
    gradings: Vec<usize>,
    /// Places in the list of families; all without it
    #[arg(long, num_args = 1..)]
    families: Vec<usize>,
    /// Steps after which a path is given up
    #[arg(long, default_value_t = 400)]
    steps: usize,
    #[arg(long)]
    out: PathBuf,
}

struct Case {
    family: Family,
    swing: Swing,
    seed: u64,
}

fn main() -> Result<(), Box<dyn Error>> {
    let args = Args::parse();
    let mut cases = Vec::new();
    for seed in args.from..args.from + args.seeds {
        for (k, family) in FAMILIES.into_iter().enumerate() {
            if !args.families.is_empty() && !args.families.contains(&k) {
                continue;
            }
            for swing in [Swing::Large, Swing::Small] {
                cases.push(Case {
                    family,
                    swing,
                    seed,
                });
            }
        }
    }
    let text = Mutex::new(String::from(
        "family,swing,seed,law,true_terms,atoms,rows,grading,exact,solved,terms,steps,residual,seconds\n",
    ));
    let next = AtomicUsize::new(0);
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                while let Some(case) = cases.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let lines = trials(case, &args);
                    if let Ok(mut text) = text.lock() {
                        text.push_str(&lines);
                        let _ = std::fs::write(&args.out, &*text);
                    }
                }
            });
        }
    });
    Ok(())
}

fn trials(case: &Case, args: &Args) -> String {
    let system = Coupled::draw(case.family, case.seed);
    let record = system.record(case.swing, ROWS, STEP);
    let mut lines = String::new();
    for law in system.laws() {
        let mut done = Vec::new();
        for atoms in &args.atoms {
            let size = match atoms {
                0 => Size::Own,
                99 => Size::All,
                n => Size::Atoms(*n),
            };
            let library = Library::new(&system, &law, size, case.seed);
            if done.contains(&library.atoms.len()) || library.atoms.len() > 13 {
                continue;
            }
            done.push(library.atoms.len());
            for rows in &args.rows {
                let picked = split(record.len(), 1, Some(*rows), case.seed).used;
                let points: Vec<&Point> = picked.iter().map(|r| &record[*r].1).collect();
                let target: Vec<f64> = points
                    .iter()
                    .map(|p| p.accelerations[law.coordinate])
                    .collect();
                let tabulated = Tabulated::new(&library.atoms, &points);
                let Some(phi) = tabulated.dictionary() else {
                    continue;
                };
                for (k, grading) in GRADINGS.iter().enumerate() {
                    if !args.gradings.is_empty() && !args.gradings.contains(&k) {
                        continue;
                    }
                    let grades = tabulated.grades(grading);
                    let found = outcome((&phi, &grades), &target, &law, &library, args.steps);
                    let _ = writeln!(
                        lines,
                        "{},{:?},{},{},{},{},{},{},{},{},{},{},{:.1e},{:.3}",
                        case.family.name(),
                        case.swing,
                        case.seed,
                        law.coordinate,
                        law.terms.len(),
                        library.atoms.len(),
                        rows,
                        grading.name(),
                        u8::from(found.exact),
                        u8::from(found.solved),
                        found.terms,
                        found.steps,
                        found.residual,
                        found.seconds,
                    );
                }
            }
        }
    }
    lines
}
