//! How many rows does basis pursuit need for the laws of random coupled mechanisms, with plain and with graded norms?
//!
//! ```sh
//! cargo run --release -p sidc-studies --bin coupled -- --seeds 8 --rows 20 30 40 60 80 120 --out trials.csv
//! ```
//!
//! Each seed draws a mechanism of each family, in large and in small swings, and every law of it is sought. Writes one line per trial and prints the share of
//! exact answers by grading and rows.

use std::collections::BTreeMap;
use std::error::Error;
use std::fmt::Write;
use std::path::PathBuf;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use clap::Parser;
use sidc_studies::coupled::{Case, GRADINGS, Plan, Size, Trial, cases, trials};
use sidc_testing::plants::coupled::{FAMILIES, Family};

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
    /// Atoms of a library: N has 3^N terms, or more where the law needs more; 0 for those of the law alone
    #[arg(long, num_args = 1.., default_values_t = [10])]
    atoms: Vec<usize>,
    /// Places in the list of gradings; all without it
    #[arg(long, num_args = 1..)]
    gradings: Vec<usize>,
    /// Places in the list of families; all without it
    #[arg(long, num_args = 1..)]
    families: Vec<usize>,
    /// Steps after which a path is given up
    #[arg(long, default_value_t = 600)]
    steps: usize,
    #[arg(long)]
    out: PathBuf,
}

const HEAD: &str = "family,swing,seed,law,true_terms,atoms,rows,grading,exact,solved,terms,steps,residual,seconds\n";

fn main() -> Result<(), Box<dyn Error>> {
    let args = Args::parse();
    let families: Vec<Family> = chosen(&args.families, &FAMILIES);
    let gradings = chosen(&args.gradings, GRADINGS);
    let plan = Plan {
        rows: args.rows.clone(),
        sizes: args.atoms.iter().map(|n| size(*n)).collect(),
        gradings: gradings.iter().map(|(_, g)| *g).collect(),
        steps: args.steps,
    };
    let cases = cases(&families, args.from..args.from.saturating_add(args.seeds));
    let (next, found) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                loop {
                    let place = next.fetch_add(1, Ordering::Relaxed);
                    let Some(case) = cases.get(place) else { break };
                    let made = trials(case, &plan);
                    if let Ok(mut all) = found.lock() {
                        all.push((place, made));
                    }
                }
            });
        }
    });
    let mut found = found.into_inner().map_err(|_| "a case broke off")?;
    found.sort_by_key(|(place, _)| *place);
    let mut text = String::from(HEAD);
    let mut counts: BTreeMap<(String, usize, usize), (usize, usize)> = BTreeMap::new();
    for (place, made) in &found {
        let case = &cases[*place];
        for trial in made {
            let named = gradings.iter().position(|(_, g)| *g == trial.grading);
            let grading = named.unwrap_or_default();
            line(&mut text, case, gradings[grading].0, trial)?;
            let key = (format!("{:?}", case.swing), grading, trial.rows);
            let (exact, of) = counts.entry(key).or_default();
            *exact += usize::from(trial.outcome.exact);
            *of += 1;
        }
    }
    std::fs::write(&args.out, text)?;
    println!("swing  grading                              rows: exact of all");
    for (swing, k) in counts
        .keys()
        .map(|(s, k, _)| (s, *k))
        .collect::<std::collections::BTreeSet<_>>()
    {
        let of = |m: &usize| {
            counts
                .get(&(swing.clone(), k, *m))
                .map(|(e, n)| format!("{m}: {e}/{n}"))
        };
        let shares: Vec<String> = args.rows.iter().filter_map(of).collect();
        println!("{swing}  {:36} {}", gradings[k].0, shares.join("  "));
    }
    Ok(())
}

fn chosen<T: Clone>(places: &[usize], all: &[T]) -> Vec<T> {
    match places {
        [] => all.to_vec(),
        some => some.iter().filter_map(|k| all.get(*k).cloned()).collect(),
    }
}

fn size(atoms: usize) -> Size {
    match atoms {
        0 => Size::Own,
        n => Size::Atoms(n),
    }
}

fn line(text: &mut String, case: &Case, grading: &str, trial: &Trial) -> std::fmt::Result {
    let found = &trial.outcome;
    writeln!(
        text,
        "{},{:?},{},{},{},{},{},\"{grading}\",{},{},{},{},{:.1e},{:.3}",
        case.family.name(),
        case.swing,
        case.seed,
        trial.law,
        trial.true_terms,
        trial.atoms,
        trial.rows,
        u8::from(found.exact),
        u8::from(found.solved),
        found.terms,
        found.steps,
        found.residual,
        found.seconds,
    )
}
