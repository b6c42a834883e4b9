//! Do columns that are nearly one column hurt the solver, and does it help to take them apart first?
//!
//!     cargo run --release --example decorrelation
//!
//! A driven pendulum that stays within an angle, 39 candidate terms among which θ, sin θ, θ³ and tan θ are nearly one for small
//! angles, noise on the acceleration. Four ways, each with the solver that is the default:
//!
//! - plain: Φ as it is; the support is what the solver finds;
//! - orthogonalised: in each group of columns with a cosine above 0.99 every column is made orthogonal to those before it;
//! - grouped: the solver sees the simplest column of each group, and the best member of each group is taken afterwards;
//! - chosen: Φ as it is, and the criterion's search over all columns, which is what `sidc identify` does.
//!
//! Prints how many of twenty draws gave the true support.

#[path = "simulate/mod.rs"]
#[allow(dead_code)]
mod simulate;

use std::ops::ControlFlow;

use sidc::data::{Column, Dataset, Origin, Samples};
use sidc::dictionary::{Dense, Dictionary, compile};
use sidc::discover::{Options, discover};
use sidc::lang::source::Sources;
use sidc::pipeline::{self, Program};
use sidc::solve::{Problem, SOLVERS, polish};
use sidc::term::{Language, SignalNames};
use simulate::integrate::integrate;
use simulate::random::Random;

const MODEL: &str = "
state theta : order 2
input u : linear
ddtheta ~ <1, theta, sin(theta), theta^3, tan(theta), theta^5, sin(2*theta)> * <1, dtheta, u>
        + <cos(theta), theta^2, dtheta^2, u^2, u*dtheta> * <1, dtheta, u> + <dtheta*abs(dtheta), abs(theta), u^3>
";
const ROWS: usize = 400;
const DRAWS: u64 = 20;
/// Cosine above which two columns are one group.
const ALIKE: f64 = 0.99;
/// Part of the largest contribution under which a coefficient counts as none.
const NONE: f64 = 1e-3;
const TRUTH: [&str; 3] = ["dtheta", "sin(theta)", "u"];

fn main() {
    let Some(program) = program() else {
        println!("the model does not compile");
        return;
    };
    println!("angle   noise    plain  orthogonalised  grouped  chosen   (of {DRAWS})");
    for angle in [0.1, 0.3, 1.0] {
        for noise in [0.0, 1e-6, 1e-4, 1e-2] {
            let mut counts = [0; 4];
            for seed in 0..DRAWS {
                let samples = motion(&program, angle, noise, seed);
                for (count, right) in counts.iter_mut().zip(ways(&program, &samples, noise)) {
                    *count += usize::from(right);
                }
            }
            let [plain, apart, grouped, chosen] = counts;
            println!("{angle:5}  {noise:6.0e}  {plain:6}  {apart:14}  {grouped:7}  {chosen:6}");
        }
    }
}

fn program() -> Option<Program> {
    let mut sources = Sources::default();
    let file = sources.add("decorrelation.sid", MODEL);
    pipeline::compile(file, &sources, pipeline::MEMORY).0
}

/// Rows of a pendulum pushed by sines until it swings about `angle` far; noise relative to the acceleration's size.
fn motion(program: &Program, angle: f64, noise: f64, seed: u64) -> Samples {
    let mut random = Random::new(seed);
    let phase = random.uniform(0.0, 6.0);
    let push =
        |t: f64| angle * ((1.1 * t + phase).sin() + 0.8 * (4.3 * t).cos() + 0.5 * (0.4 * t).sin());
    let law = |t: f64, x: &[f64; 2]| [x[1], push(t) - 9.81 * x[0].sin() - 0.8 * x[1]];
    let mut x = [angle * random.uniform(0.6, 0.9), 0.0];
    let mut rows: Vec<[f64; 4]> = Vec::new();
    for k in 0..ROWS {
        let t = 0.03 * k as f64;
        rows.push([x[0], x[1], law(t, &x)[1], push(t)]);
        x = integrate(&law, t, t + 0.03, x);
    }
    let size = (rows.iter().map(|r| r[2] * r[2]).sum::<f64>() / ROWS as f64).sqrt();
    rows.iter_mut()
        .for_each(|r| r[2] += noise * size * random.normal());
    let names = ["theta", "dtheta", "ddtheta", "u"];
    let mut columns: Vec<Column> = (pipeline::needed(program).into_iter())
        .filter_map(|signal| {
            let name = program.model.name(signal);
            let at = names.iter().position(|n| *n == name)?;
            let sigma = (at == 2 && noise > 0.0).then_some(noise * size);
            Some(Column {
                signal,
                values: rows.iter().map(|r| r[at]).collect(),
                origin: Origin::Measured { noise: sigma },
            })
        })
        .collect();
    columns.sort_by_key(|c| c.signal);
    Samples {
        trajectory: vec![0; ROWS],
        time: (0..ROWS).map(|k| 0.03 * k as f64).collect(),
        columns,
    }
}

/// Whether each way finds the truth.
fn ways(program: &Program, samples: &Samples, noise: f64) -> [bool; 4] {
    let Some(Some(library)) = program.libraries.first() else {
        return [false; 4];
    };
    let target = program.model.equations[0].target;
    let (Ok(phi), Some(y)) = (compile(library, samples, None), samples.column(target)) else {
        return [false; 4];
    };
    let names: Vec<String> = (0..phi.cols())
        .map(|j| Language(&program.model).term(&library.term(j).unwrap_or_default()))
        .collect();
    let y = &y.values;
    let size = y.iter().map(|y| y * y).sum::<f64>().sqrt();
    let tolerance = size * (1.05 * noise).max(1e-9);
    let columns: Vec<Vec<f64>> = (0..phi.cols()).map(|j| unit(phi.as_ref(), j)).collect();
    let groups = groups(&columns);
    let right = |support: &[usize]| {
        let mut found: Vec<&str> = support.iter().map(|j| names[*j].as_str()).collect();
        found.sort_unstable();
        found == TRUTH
    };
    let plain = solved(&columns, y, tolerance);
    let apart = solved(&orthogonalised(&columns, &groups), y, tolerance);
    let first: Vec<usize> = groups.iter().map(|g| g[0]).collect();
    let seen: Vec<Vec<f64>> = first.iter().map(|j| columns[*j].clone()).collect();
    // Members of a group stand for each other only so far as they are alike.
    let loose = tolerance.max(0.02 * size);
    let members: Vec<&Vec<usize>> = solved(&seen, y, loose)
        .iter()
        .map(|k| &groups[*k])
        .collect();
    let grouped = best_members(&columns, y, &members);
    let options = Options::default();
    let found = discover(
        &program.model,
        &program.libraries,
        (&Dataset::default(), samples),
        &options,
        &mut |_| ControlFlow::Continue(()),
    );
    let chosen = found.is_ok_and(|d| {
        let terms = d.equations.iter().flat_map(|e| &e.terms);
        let mut found: Vec<String> = terms.map(|t| Language(&d).term(&t.term)).collect();
        found.sort();
        found == TRUTH
    });
    [right(&plain), right(&apart), right(&grouped), chosen]
}

fn unit(phi: &dyn Dictionary, j: usize) -> Vec<f64> {
    let mut column = vec![0.0; phi.rows()];
    phi.column(j, &mut column);
    let length = phi.norms()[j].max(f64::MIN_POSITIVE);
    column.iter_mut().for_each(|x| *x /= length);
    column
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Columns that are alike, in the order of the library: the first of each group is its simplest.
fn groups(columns: &[Vec<f64>]) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for (j, column) in columns.iter().enumerate() {
        let near = |g: &&mut Vec<usize>| dot(&columns[g[0]], column).abs() > ALIKE;
        match groups.iter_mut().find(near) {
            Some(group) => group.push(j),
            None => groups.push(vec![j]),
        }
    }
    groups
}

fn orthogonalised(columns: &[Vec<f64>], groups: &[Vec<usize>]) -> Vec<Vec<f64>> {
    let mut out = columns.to_vec();
    for group in groups {
        for (k, j) in group.iter().enumerate() {
            for before in &group[..k] {
                let along = dot(&out[*before], &out[*j]);
                let direction = out[*before].clone();
                out[*j]
                    .iter_mut()
                    .zip(&direction)
                    .for_each(|(x, d)| *x -= along * d);
            }
            let length = dot(&out[*j], &out[*j]).sqrt();
            if length > 1e-12 {
                out[*j].iter_mut().for_each(|x| *x /= length);
            }
        }
    }
    out
}

/// The support that the solver finds.
fn solved(columns: &[Vec<f64>], y: &[f64], tolerance: f64) -> Vec<usize> {
    let phi = Dense::new(y.len(), columns.concat());
    let problem = Problem {
        dictionary: &phi,
        target: y,
        tolerance,
    };
    let solution = SOLVERS[0].solve(&problem, &mut |_| ControlFlow::Continue(()));
    let shares: Vec<f64> = problem.shares(&solution.coefficients).collect();
    let most = shares.iter().copied().fold(0.0, f64::max);
    let kept = solution.coefficients.iter().zip(&shares);
    kept.filter(|(_, s)| **s > NONE * most)
        .map(|((j, _), _)| *j)
        .collect()
}

/// One member of each group, those that fit best together, changed one at a time.
fn best_members(columns: &[Vec<f64>], y: &[f64], groups: &[&Vec<usize>]) -> Vec<usize> {
    let phi = Dense::new(y.len(), columns.concat());
    let mut best: Vec<usize> = groups.iter().map(|g| g[0]).collect();
    let mut least = polish(&phi, y, &best).residual;
    loop {
        let before = least;
        for (k, group) in groups.iter().enumerate() {
            for j in group.iter() {
                let mut next = best.clone();
                next[k] = *j;
                let residual = polish(&phi, y, &next).residual;
                if residual < least {
                    (least, best) = (residual, next);
                }
            }
        }
        if least >= before {
            return best;
        }
    }
}
