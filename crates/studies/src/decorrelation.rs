//! Four methods for nearly equal columns, and whether each finds a known law.
//!
//! In: an angle, a noise, a number of draws. Out: the number of draws that each method got right. Prints nothing.

use sidc::pipeline::Program;
use sidc_data::{Dataset, Samples};
use sidc_discover::{Options, discover};
use sidc_lang::term::Language;
use sidc_progress::Unwatched;
use sidc_solve::dictionary::{Dense, Dictionary};
use sidc_solve::{Problem, SOLVERS, refit};

use sidc_testing::integrate::{grid, integrate};
use sidc_testing::random::Random;

const MODEL: &str = "
state theta : order 2
input u : linear
ddtheta ~ <1, theta, sin(theta), theta^3, tan(theta), theta^5, sin(2*theta)> * <1, dtheta, u>
        + <cos(theta), theta^2, dtheta^2, u^2, u*dtheta> * <1, dtheta, u> + <dtheta*abs(dtheta), abs(theta), u^3>
";
const ROWS: usize = 400;
/// In seconds.
const STEP: f64 = 0.03;
/// Cosine above which two columns form a group.
const COLLINEAR: f64 = 0.99;
/// Fraction of the largest contribution below which a term is ignored.
const NONE: f64 = 1e-3;
const TRUTH: [&str; 3] = ["dtheta", "sin(theta)", "u"];

pub const WAYS: [&str; 4] = ["plain", "orthogonalised", "grouped", "chosen"];
pub const ANGLES: [f64; 3] = [0.1, 0.3, 1.0];
pub const NOISES: [f64; 4] = [0.0, 1e-6, 1e-4, 1e-2];

/// The number of draws that each of the [`WAYS`] got right.
pub fn right(angle: f64, noise: f64, draws: u64) -> Result<[usize; 4], String> {
    let program = Program::compile("decorrelation.sid", MODEL)?;
    let mut counts = [0; 4];
    for seed in 0..draws {
        let samples = motion(&program, angle, noise, seed)?;
        let found = ways(&program, &samples, noise)?;
        for (count, right) in counts.iter_mut().zip(found) {
            *count += usize::from(right);
        }
    }
    Ok(counts)
}

/// Rows of a pendulum that sines drive to angles of about `angle`. The noise is relative to the size of the acceleration.
fn motion(program: &Program, angle: f64, noise: f64, seed: u64) -> Result<Samples, String> {
    let mut random = Random::new(seed);
    let phase = random.uniform(0.0, 6.0);
    let push =
        |t: f64| angle * ((1.1 * t + phase).sin() + 0.8 * (4.3 * t).cos() + 0.5 * (0.4 * t).sin());
    let law = |t: f64, x: &[f64; 2]| [x[1], push(t) - 9.81 * x[0].sin() - 0.8 * x[1]];
    let mut x = [angle * random.uniform(0.6, 0.9), 0.0];
    let times = grid(ROWS, STEP);
    let [mut theta, mut dtheta, mut ddtheta] = [const { Vec::new() }; 3];
    for t in &times {
        theta.push(x[0]);
        dtheta.push(x[1]);
        ddtheta.push(law(*t, &x)[1]);
        x = integrate(&law, *t, t + STEP, x);
    }
    let size = (ddtheta.iter().map(|a| a * a).sum::<f64>() / ROWS as f64).sqrt();
    ddtheta
        .iter_mut()
        .for_each(|a| *a += noise * size * random.normal());
    let u: Vec<f64> = times.iter().map(|t| push(*t)).collect();
    let columns: [(&str, &[f64]); 4] = [
        ("theta", &theta),
        ("dtheta", &dtheta),
        ("ddtheta", &ddtheta),
        ("u", &u),
    ];
    let mut samples = program.samples(&times, &columns)?;
    if noise > 0.0 {
        samples.declare_noise(program.model.equations[0].target, noise * size);
    }
    Ok(samples)
}

/// Whether each method finds the true support.
fn ways(program: &Program, samples: &Samples, noise: f64) -> Result<[bool; 4], String> {
    let regression = program.regression("ddtheta", samples)?;
    let (phi, y) = (regression.dictionary.as_ref(), &regression.target);
    let all: Vec<(usize, f64)> = (0..phi.cols()).map(|j| (j, 0.0)).collect();
    let names: Vec<String> = program
        .terms("ddtheta", &all)
        .into_iter()
        .map(|(name, _)| name)
        .collect();
    let size = y.iter().map(|y| y * y).sum::<f64>().sqrt();
    let tolerance = size * (1.05 * noise).max(1e-9);
    let columns: Vec<Vec<f64>> = (0..phi.cols()).map(|j| unit(phi, j)).collect();
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
    // Members of a group can replace each other only as far as they agree.
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
        &mut Unwatched,
    );
    let chosen = found.is_ok_and(|d| {
        let terms = d.equations.iter().flat_map(|e| &e.terms);
        let mut found: Vec<String> = terms.map(|t| Language(&d).term(&t.term)).collect();
        found.sort();
        found == TRUTH
    });
    Ok([right(&plain), right(&apart), right(&grouped), chosen])
}

fn unit(phi: &dyn Dictionary, j: usize) -> Vec<f64> {
    let mut column = vec![0.0; phi.rows()];
    phi.column(j, &mut column);
    let length = phi.norm(j).max(f64::MIN_POSITIVE);
    column.iter_mut().for_each(|x| *x /= length);
    column
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Groups of nearly equal columns in the order of the library, so that the first of each group is its simplest.
fn groups(columns: &[Vec<f64>]) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for (j, column) in columns.iter().enumerate() {
        let near = |g: &&mut Vec<usize>| dot(&columns[g[0]], column).abs() > COLLINEAR;
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
    let solution = SOLVERS[0].solve(&problem, &mut Unwatched);
    let shares: Vec<f64> = problem.contributions(&solution.coefficients).collect();
    let most = shares.iter().copied().fold(0.0, f64::max);
    let kept = solution.coefficients.iter().zip(&shares);
    kept.filter(|(_, s)| **s > NONE * most)
        .map(|((j, _), _)| *j)
        .collect()
}

/// One member of each group, chosen by exchanging one at a time until no exchange improves the fit.
fn best_members(columns: &[Vec<f64>], y: &[f64], groups: &[&Vec<usize>]) -> Vec<usize> {
    let phi = Dense::new(y.len(), columns.concat());
    let mut best: Vec<usize> = groups.iter().map(|g| g[0]).collect();
    let mut least = refit(&phi, y, &best).residual;
    loop {
        let before = least;
        for (k, group) in groups.iter().enumerate() {
            for j in group.iter() {
                let mut next = best.clone();
                next[k] = *j;
                let residual = refit(&phi, y, &next).residual;
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
