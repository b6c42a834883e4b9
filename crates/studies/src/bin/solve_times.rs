//! Our side of `benches/peers.py`: exports a regression problem, and times our solvers on it.
//!
//! In: a folder, and what to do there. Out: `problem.f64` (little-endian doubles: Φ column by column, then y) with `problem.json` (rows, cols, the true
//! terms), or one line of JSON with time, status and coefficients. Judges no answer.
//!
//! ```sh
//! cargo run --release -p sidc-studies --bin solve_times -- list
//! cargo run --release -p sidc-studies --bin solve_times -- export target/peers/one 375 cart 0
//! cargo run --release -p sidc-studies --bin solve_times -- solve target/peers/one clarabel
//! ```

use std::error::Error;
use std::fs;
use std::path::Path;
use std::time::Instant;

use serde_json::{Value, json};
use sidc_progress::Unwatched;
use sidc_solve::dictionary::Dense;
use sidc_solve::{Problem, SOLVERS, Solution, certify};

use sidc_testing::pendulum_regression::{Target, draw, regression};

/// Eight atoms with exponents 0 to 2: 6,561 terms.
const CAPS: [usize; 8] = [3; 8];
/// A run shorter than this, in seconds, is repeated; the shortest of [`REPEATS`] counts.
const SHORT: f64 = 1.0;
const REPEATS: usize = 3;

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = args.iter().map(String::as_str).collect();
    let told = match words[..] {
        ["list"] => list(),
        ["export", folder, rows, target, seed] => export(
            Path::new(folder),
            rows.parse()?,
            which(target)?,
            seed.parse()?,
        )?,
        ["solve", folder, solver] => solve(Path::new(folder), solver)?,
        _ => return Err("list | export DIR ROWS cart|pendulum SEED | solve DIR SOLVER".into()),
    };
    println!("{told}");
    Ok(())
}

/// Every registered solver, the default first.
fn list() -> Value {
    let about = |s: &&dyn sidc_solve::Solver| json!({"name": s.name(), "exact": s.exact()});
    SOLVERS.iter().map(about).collect()
}

fn which(target: &str) -> Result<Target, Box<dyn Error>> {
    match target {
        "cart" => Ok(Target::Cart),
        "pendulum" => Ok(Target::Pendulum),
        other => Err(format!("no equation `{other}`: cart, pendulum").into()),
    }
}

fn export(folder: &Path, rows: usize, target: Target, seed: u64) -> Result<Value, Box<dyn Error>> {
    let r = regression(&draw(rows, seed), target, CAPS);
    let numbers = r.dictionary.values().iter().chain(&r.target);
    let bytes: Vec<u8> = numbers.flat_map(|x| x.to_le_bytes()).collect();
    let header = json!({
        "rows": rows,
        "cols": r.dictionary.values().len() / rows,
        "layout": "little-endian f64; columns of the matrix one after another, then the target",
        "truth": r.truth,
    });
    fs::create_dir_all(folder)?;
    fs::write(folder.join("problem.f64"), bytes)?;
    fs::write(folder.join("problem.json"), header.to_string())?;
    Ok(header)
}

fn read(folder: &Path) -> Result<(Dense, Vec<f64>), Box<dyn Error>> {
    let header: Value = serde_json::from_str(&fs::read_to_string(folder.join("problem.json"))?)?;
    let rows = header["rows"].as_u64().ok_or("no rows in problem.json")? as usize;
    let bytes = fs::read(folder.join("problem.f64"))?;
    let number = |b: &[u8]| b.try_into().map(f64::from_le_bytes);
    let mut numbers = bytes
        .chunks_exact(8)
        .map(number)
        .collect::<Result<Vec<f64>, _>>()?;
    let target = numbers.split_off(numbers.len().saturating_sub(rows));
    Ok((Dense::new(rows, numbers), target))
}

fn solve(folder: &Path, name: &str) -> Result<Value, Box<dyn Error>> {
    let (phi, target) = read(folder)?;
    let mut solvers = SOLVERS.iter();
    let solver = solvers.find(|s| s.name() == name).ok_or("no such solver")?;
    let problem = Problem {
        dictionary: &phi,
        target: &target,
        tolerance: 0.0,
    };
    let run = || -> (f64, Solution) {
        let start = Instant::now();
        let solution = solver.solve(&problem, &mut Unwatched);
        (start.elapsed().as_secs_f64(), solution)
    };
    let (mut seconds, solution) = run();
    for _ in 1..REPEATS {
        if seconds < SHORT {
            seconds = seconds.min(run().0);
        }
    }
    let start = Instant::now();
    let proof = certify(&problem, &solution.coefficients, &solution.dual);
    Ok(json!({
        "seconds": seconds,
        "status": format!("{:?}", solution.status),
        "iterations": solution.iterations,
        "proved": proof.proves_optimal,
        "proof_seconds": start.elapsed().as_secs_f64(),
        "coefficients": solution.coefficients,
    }))
}
