//! How time and memory grow with rows M and terms N, from a model's text to the proof: one Markdown row per case.
//!
//! ```sh
//! cargo run --release -p sidc-studies --bin scaling                     # the whole table
//! cargo run --release -p sidc-studies --bin scaling -- double 13 200    # one case: 13 atoms, 200 rows
//! ```
//!
//! In: models/data/double_pendulum.csv, and a cart-pendulum simulated here. Out: a table. Each case runs in its own process, so that its peak of resident
//! memory can be measured. Measures speed; of the answer it checks only whether it is the law.

mod cases;
mod counted;

use std::error::Error;
use std::ops::ControlFlow;
use std::process::Command;
use std::time::{Duration, Instant};

use cases::{Case, Plant};
use counted::Counted;
use sidc_discover::dictionary;
use sidc_lang::library::Library;
use sidc_lang::model::Model;
use sidc_lang::term::Language;
use sidc_progress::{Activity, Stage, Stop};
use sidc_solve::{Certificate, Homotopy, Problem, Solution, Solver, certify};

/// Largest relative error of a coefficient that counts as exact.
const EXACT: f64 = 1e-8;
/// Terms of a wrong answer that are shown, on standard error.
const SHOWN: usize = 10;
/// Number of timed pricings, and of additional ones if they are short; the shortest counts.
const REPEATS: (usize, usize) = (3, 50);
const SHORT: Duration = Duration::from_millis(10);

const HEAD: &str = "\
| N | M | library (ms) | Φ (ms) | pricing (ms) | GFlop/s | rounds | pricings | steps | w | GFlop/s a step | solve (ms) | of it pricing | \
Φ (MB) | peak (MB) | gap | terms | law | unique |
|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---|---|";

type Outcome<T> = Result<T, Box<dyn Error>>;

fn main() -> Outcome<()> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = args.iter().map(String::as_str).collect();
    match words[..] {
        [] => table(),
        [plant, atoms, rows] => {
            let case = case(plant, atoms.parse()?, rows.parse()?)?;
            println!("{}", row(&case)?);
            Ok(())
        }
        _ => Err("scaling [cart|double ATOMS ROWS]".into()),
    }
}

fn case(plant: &str, atoms: usize, rows: usize) -> Outcome<Case> {
    let plant = match plant {
        "cart" => Plant::Cart,
        "double" => Plant::Double,
        other => return Err(format!("no plant `{other}`: cart, double").into()),
    };
    Case::new(plant, atoms, rows).ok_or_else(|| "no such library".into())
}

/// Runs every case in a child process.
fn table() -> Outcome<()> {
    let this = std::env::current_exe()?;
    let start = Instant::now();
    for (plant, title, libraries) in cases::ALL {
        println!("\n{title}\n\n{HEAD}");
        for (atoms, rows) in *libraries {
            for rows in *rows {
                let child = Command::new(&this)
                    .args([plant.to_string(), atoms.to_string(), rows.to_string()])
                    .output()?;
                if !child.status.success() {
                    return Err(String::from_utf8_lossy(&child.stderr).into());
                }
                print!("{}", String::from_utf8_lossy(&child.stdout));
            }
        }
    }
    println!("\n{:.0} s in all", start.elapsed().as_secs_f64());
    Ok(())
}

/// The times of one case.
struct Times {
    library: Duration,
    fill: Duration,
    pricing: Duration,
    solve: Duration,
}

fn row(case: &Case) -> Outcome<String> {
    let start = Instant::now();
    let program = case.program()?;
    let library_time = start.elapsed();
    let library = program.libraries.first().and_then(Option::as_ref);
    let library = library.ok_or("no library")?;
    let (samples, target) = case.samples(&program)?;
    let start = Instant::now();
    let phi = dictionary::compile(library, &samples, None).map_err(|_| "a term is not finite")?;
    let fill = start.elapsed();
    let counted = Counted::new(phi.as_ref());
    let problem = Problem {
        dictionary: &counted,
        target: &target,
        tolerance: 0.0,
    };
    let mut rounds = 0;
    let start = Instant::now();
    let solution = Homotopy.solve(&problem, &mut |activity: Activity| {
        if let Activity::Stage(Stage::Solving(p)) = activity {
            rounds = rounds.max(p.round);
        }
        ControlFlow::<Stop>::Continue(())
    });
    let solve = start.elapsed();
    let (in_pricing, pricings, pool) = counted.taken();
    let certificate = certify(&problem, &solution.coefficients, &solution.dual);
    let times = Times {
        library: library_time,
        fill,
        pricing: pricing(phi.as_ref(), &solution.dual),
        solve,
    };
    let flops = 2.0 * (samples.len() * library.slots()) as f64;
    let step_flops = 4.0 * (samples.len() * pool * solution.iterations) as f64;
    let terms = terms(&program.model, library, &solution, &certificate);
    let found = is_law(case.law(), &terms);
    for (name, coefficient) in terms.iter().filter(|_| !found).take(SHOWN) {
        eprintln!("{coefficient:+.6} {name}");
    }
    Ok(format!(
        "| {} | {} | {} | {} | {} | {:.0} | {rounds} | {pricings} | {} | {pool} | {:.1} | {} | {:.0} % | {} | {} | {:.1e} | {} | {} | {} |",
        grouped(library.len()),
        grouped(samples.len()),
        ms(times.library),
        ms(times.fill),
        ms(times.pricing),
        flops / times.pricing.as_secs_f64() / 1e9,
        solution.iterations,
        step_flops / times.solve.saturating_sub(in_pricing).as_secs_f64() / 1e9,
        ms(times.solve),
        100.0 * in_pricing.as_secs_f64() / times.solve.as_secs_f64(),
        megabytes(dictionary::bytes(library, samples.len()) as f64),
        peak().map_or("-".into(), megabytes),
        certificate.gap,
        terms.len(),
        yes(found),
        yes(certificate.proves_unique),
    ))
}

/// The shortest of several pricings: on a shared machine a pricing may wait for its second core.
fn pricing(phi: &dyn sidc_solve::dictionary::Dictionary, dual: &[f64]) -> Duration {
    let look = |_| {
        let start = Instant::now();
        std::hint::black_box(phi.price(dual, 256, 0.9));
        start.elapsed()
    };
    let few = (0..REPEATS.0).map(look).min().unwrap_or_default();
    if few > SHORT {
        return few;
    }
    (0..REPEATS.1).map(look).fold(few, Duration::min)
}

/// The support with its coefficients.
fn terms(
    model: &Model,
    library: &Library,
    solution: &Solution,
    certificate: &Certificate,
) -> Vec<(String, f64)> {
    let columns = certificate.support.iter();
    let named = |j: &usize| {
        let term = library.term(*j)?;
        Some((Language(model).term(&term), solution.coefficient(*j)))
    };
    columns.filter_map(named).collect()
}

/// True for the law's terms and no others, each coefficient within [`EXACT`].
fn is_law(law: &[(&str, f64)], terms: &[(String, f64)]) -> bool {
    let matches = |(name, found): &(String, f64)| {
        let truth = law.iter().find(|(n, _)| n == name);
        truth.is_some_and(|(_, c)| ((found - c) / c).abs() <= EXACT)
    };
    terms.len() == law.len() && terms.iter().all(matches)
}

/// The peak of resident memory of this process in bytes; `None` if the system does not report it.
fn peak() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"))?;
    let kib: f64 = line.split_whitespace().next()?.parse().ok()?;
    Some(1024.0 * kib)
}

fn ms(time: Duration) -> String {
    significant(1e3 * time.as_secs_f64())
}

fn megabytes(bytes: f64) -> String {
    significant(bytes / 1e6)
}

/// At least two digits, but no more than the measurement justifies.
fn significant(x: f64) -> String {
    match x {
        x if x < 1.0 => format!("{x:.2}"),
        x if x < 10.0 => format!("{x:.1}"),
        x => grouped(x.round() as usize),
    }
}

fn grouped(n: usize) -> String {
    let digits = n.to_string();
    let groups = digits.as_bytes().rchunks(3).rev();
    let groups: Vec<_> = groups.map(String::from_utf8_lossy).collect();
    groups.join(",")
}

fn yes(is: bool) -> &'static str {
    if is { "yes" } else { "no" }
}
