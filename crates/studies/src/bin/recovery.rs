//! How few rows basis pursuit needs: exact recovery of cart-pendulums from 6,561 terms, down to where it fails.
//!
//! ```sh
//! cargo run --release -p sidc-studies --bin recovery -- --draws 50 --rows 15 20 30 40 60 100 --svg docs/recovery.svg
//! ```
//!
//! Every draw has its own plant (masses, rod, frictions), start and force. Rows are drawn at random from 15 s of motion at 100 Hz. "Exact" means the true
//! support, nothing else, and every coefficient to 1e-8.

use std::error::Error;
use std::path::PathBuf;
use std::time::Instant;

use clap::Parser;
use sidc::pipeline;
use sidc::pipeline::Program;
use sidc_data::{Dataset, Samples};
use sidc_discover::{Options, discover};
use sidc_lang::term::{Language, SignalNames};
use sidc_progress::Unwatched;
use sidc_solve::{SOLVERS, solver};
use sidc_studies::success_plot::{Curve, svg};
use sidc_system::discovery::{Discovery, Status};
use sidc_testing::integrate::grid;
use sidc_testing::plants::cart_pendulum::{Plant, State};
use sidc_testing::plants::run::{columns, run};
use sidc_testing::random::Random;

const MODEL: &str = "
state y, theta : order 2
input F : hold
ddy     ~ powers(y, dy, ddtheta, theta, dtheta, sin theta, cos theta, F; 2)
ddtheta ~ powers(y, dy, ddy, theta, dtheta, sin theta, cos theta, F; 2)
";
const RATE: f64 = 100.0;
const SECONDS: f64 = 15.0;
const EXACT: f64 = 1e-8;

#[derive(Parser)]
struct Args {
    /// Rows drawn from the motion
    #[arg(long, num_args = 1.., default_values_t = [15, 20, 25, 30, 40, 60, 100])]
    rows: Vec<usize>,
    /// Plants for each number of rows
    #[arg(long, default_value_t = 50)]
    draws: u64,
    #[arg(long, default_value = SOLVERS[0].name())]
    solver: String,
    /// Also draw the table as a picture
    #[arg(long)]
    svg: Option<PathBuf>,
}

/// The outcome of one draw for its two equations.
struct Outcome {
    exact: [bool; 2],
    /// Whether an equation passes that is not exact, which must never happen.
    wrong_pass: bool,
    error: f64,
    seconds: f64,
}

fn main() -> Result<(), Box<dyn Error>> {
    let args = Args::parse();
    let solver = solver(&args.solver).ok_or("no such solver")?;
    let program = Program::compile("recovery.sid", MODEL)?;
    println!(
        "rows  ddy exact  ddtheta exact  both  passed but wrong  worst coefficient of exact  median s"
    );
    let mut successes = [Vec::new(), Vec::new()];
    for &rows in &args.rows {
        let mut outcomes = Vec::new();
        for draw in 0..args.draws {
            let options = Options {
                method: Default::default(),
                solver,
                samples: Some(rows),
                seed: draw,
                memory: pipeline::MEMORY,
                path: false,
                robust: false,
                ranks: false,
                sparsest: false,
            };
            outcomes.push(one(&program, draw, &options)?);
        }
        print_row(rows, &outcomes);
        for (i, all) in successes.iter_mut().enumerate() {
            all.push(outcomes.iter().filter(|o| o.exact[i]).count());
        }
    }
    if let Some(path) = &args.svg {
        std::fs::write(path, picture(&args, successes))?;
    }
    Ok(())
}

fn picture(args: &Args, [cart, pendulum]: [Vec<usize>; 2]) -> String {
    let curves = [
        Curve {
            name: "angular acceleration (3 terms)",
            class: "a",
            successes: pendulum,
        },
        Curve {
            name: "cart's acceleration (4 terms)",
            class: "b",
            successes: cart,
        },
    ];
    let title = format!(
        "Pendulum on a cart: 6,561 candidate terms, {} random plants",
        args.draws
    );
    svg(&title, &args.rows, args.draws as usize, &curves)
}

fn one(program: &Program, draw: u64, options: &Options) -> Result<Outcome, Box<dyn Error>> {
    let mut random = Random::new(1000 + draw);
    let plant = plant(&mut random);
    let samples = motion(program, &plant, &mut random)?;
    let start = Instant::now();
    let found = discover(
        &program.model,
        &program.libraries,
        (&Dataset::default(), &samples),
        options,
        &mut Unwatched,
    )
    .map_err(|_| "a term is not finite")?;
    let seconds = start.elapsed().as_secs_f64();
    let errors = plant
        .laws()
        .map(|(target, terms)| error(&found, target, &terms));
    let exact = errors.map(|e| e <= EXACT);
    let passed = |target: &str| {
        found
            .equations
            .iter()
            .any(|e| found.name(e.target) == target && e.status == Status::Pass)
    };
    Ok(Outcome {
        exact,
        wrong_pass: (passed("ddy") && !exact[0]) || (passed("ddtheta") && !exact[1]),
        error: errors
            .into_iter()
            .filter(|e| *e <= EXACT)
            .fold(0.0, f64::max),
        seconds,
    })
}

fn plant(random: &mut Random) -> Plant {
    Plant {
        cart: random.uniform(0.3, 1.5),
        bob: random.uniform(0.1, 0.6),
        rod: random.uniform(0.25, 0.9),
        pivot_friction: random.uniform(0.002, 0.03),
        cart_friction: random.uniform(0.02, 0.3),
        gravity: 9.81,
    }
}

/// Largest relative error of a coefficient; infinite for a wrong support.
fn error(found: &Discovery, target: &str, truth: &[(&str, f64)]) -> f64 {
    let Some(e) = found
        .equations
        .iter()
        .find(|e| found.name(e.target) == target)
    else {
        return f64::INFINITY;
    };
    if e.terms.len() != truth.len() {
        return f64::INFINITY;
    }
    e.terms.iter().fold(0.0, |worst, t| {
        let name = Language(found).term(&t.term);
        match truth.iter().find(|(n, _)| *n == name) {
            Some((_, c)) => f64::max(worst, ((t.coefficient - c) / c).abs()),
            None => f64::INFINITY,
        }
    })
}

/// The exact values of every signal of the model over the whole motion.
fn motion(
    program: &Program,
    plant: &Plant,
    random: &mut Random,
) -> Result<Samples, Box<dyn Error>> {
    let rows = (SECONDS * RATE) as usize;
    let force = random.square(rows, (10, 60), 8.0);
    let start: State = [0.0, 0.0, random.uniform(-0.5, 0.5), 0.0];
    let times = grid(rows + 1, 1.0 / RATE);
    let table = run(plant, start, &times, |k, _| force[k]);
    let columns = columns(&table);
    let columns: Vec<(&str, &[f64])> = columns.iter().map(|(n, v)| (*n, &v[..])).collect();
    let time: Vec<f64> = table.iter().map(|r| r.time).collect();
    Ok(program.samples(&time, &columns)?)
}

fn print_row(rows: usize, outcomes: &[Outcome]) {
    let count = |f: &dyn Fn(&Outcome) -> bool| outcomes.iter().filter(|o| f(o)).count();
    let mut seconds: Vec<f64> = outcomes.iter().map(|o| o.seconds).collect();
    seconds.sort_by(f64::total_cmp);
    println!(
        "{rows:4}  {:5}/{n:<3}  {:9}/{n:<3}  {:3}  {:16}  {:26.1e}  {:8.2}",
        count(&|o| o.exact[0]),
        count(&|o| o.exact[1]),
        count(&|o| o.exact[0] && o.exact[1]),
        count(&|o| o.wrong_pass),
        outcomes.iter().map(|o| o.error).fold(0.0, f64::max),
        seconds[seconds.len() / 2],
        n = outcomes.len()
    );
}
