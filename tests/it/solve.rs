//! Solvers on problems with a known answer.

use std::ops::ControlFlow;

use sidc::dictionary::{Dense, Dictionary};
use sidc::solve::{Problem, SOLVERS, Solution, Status, least_squares};

use crate::pendulum::{Random, Regression, Target, draw, regression};

const POWERS: [usize; 8] = [3; 8];

fn solve(solver: usize, dictionary: &dyn Dictionary, target: &[f64], tolerance: f64) -> Solution {
    let problem = Problem {
        dictionary,
        target,
        tolerance,
    };
    SOLVERS[solver].solve(&problem, &mut |p| {
        if std::env::var("TRACE").is_ok() {
            eprintln!("{p:?}");
        }
        ControlFlow::Continue(())
    })
}

/// Largest coefficient error relative to its truth, and the largest false one in unit columns relative to the largest.
fn errors(r: &Regression, a: &[f64]) -> (f64, f64) {
    let norms = r.dictionary.norms();
    let largest = r
        .truth
        .iter()
        .fold(0.0_f64, |m, (j, c)| m.max(c.abs() * norms[*j]));
    let right = r
        .truth
        .iter()
        .fold(0.0_f64, |m, (j, c)| m.max((a[*j] - c).abs() / c.abs()));
    let wrong = (0..a.len())
        .filter(|j| r.truth.iter().all(|(k, _)| k != j))
        .fold(0.0_f64, |m, j| m.max(a[j].abs() * norms[j]));
    (right, wrong / largest)
}

/// Standard normal entries, column j scaled by `scale(j)`.
fn gaussian(rows: usize, cols: usize, seed: u64, scale: impl Fn(usize) -> f64) -> Dense {
    let mut random = Random::new(seed);
    Dense::new(
        rows,
        (0..rows * cols)
            .map(|k| scale(k / rows) * random.normal())
            .collect(),
    )
}

/// Φ a for a few (column, coefficient) pairs.
fn combine(dictionary: &dyn Dictionary, terms: &[(usize, f64)]) -> Vec<f64> {
    let mut out = vec![0.0; dictionary.rows()];
    let mut column = vec![0.0; dictionary.rows()];
    for (j, c) in terms {
        dictionary.column(*j, &mut column);
        out.iter_mut().zip(&column).for_each(|(o, x)| *o += c * x);
    }
    out
}

fn length(v: &[f64]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn residual(dictionary: &dyn Dictionary, a: &[f64], y: &[f64]) -> f64 {
    let terms: Vec<(usize, f64)> = a
        .iter()
        .copied()
        .enumerate()
        .filter(|(_, c)| *c != 0.0)
        .collect();
    let fit = combine(dictionary, &terms);
    length(&fit.iter().zip(y).map(|(f, y)| f - y).collect::<Vec<_>>())
}

/// Relative gap between ‖Da‖₁ and yᵀλ − ε‖λ‖ after scaling λ to be feasible.
fn gap(dictionary: &dyn Dictionary, s: &Solution, y: &[f64], tolerance: f64) -> f64 {
    let mut c = vec![0.0; dictionary.cols()];
    dictionary.correlate(&s.dual, &mut c);
    let norms = dictionary.norms();
    let worst = c
        .iter()
        .zip(norms)
        .filter(|(_, n)| **n > 0.0)
        .fold(1.0_f64, |m, (c, n)| m.max(c.abs() / n));
    let dual = (s.dual.iter().zip(y).map(|(l, y)| l * y).sum::<f64>()
        - tolerance * length(&s.dual))
        / worst;
    let primal: f64 = s
        .coefficients
        .iter()
        .zip(norms)
        .map(|(a, n)| a.abs() * n)
        .sum();
    (primal - dual) / primal
}

#[test]
fn forty_samples_of_the_pendulum_give_both_equations() {
    for seed in [0, 3] {
        for target in [Target::Cart, Target::Pendulum] {
            let r = regression(&draw(40, seed), target, POWERS);
            let s = solve(0, &r.dictionary, &r.target, 0.0);
            assert_eq!(s.status, Status::Solved);
            let (right, wrong) = errors(&r, &s.coefficients);
            assert!(
                right < 1e-8 && wrong < 1e-8,
                "{seed} {target:?}: {right:e} {wrong:e}"
            );
            assert!(gap(&r.dictionary, &s, &r.target, 0.0).abs() < 1e-8);
        }
    }
}

#[test]
fn noise_bound_is_met_with_a_small_gap() {
    for (rows, cols, seed) in [(30, 80, 1), (60, 25, 2), (200, 40, 3), (12, 300, 4)] {
        let phi = gaussian(rows, cols, seed, |_| 1.0);
        let mut random = Random::new(seed + 50);
        let clean = combine(&phi, &[(2, 1.0), (7, -2.0), (11, 0.5)]);
        let y: Vec<f64> = clean.iter().map(|c| c + 0.1 * random.normal()).collect();
        for part in [0.5, 1.0, 3.0] {
            let floor = if rows > cols {
                least_squares(&phi, &y).residual
            } else {
                0.0
            };
            let tolerance = floor + part * 0.1 * (rows as f64).sqrt();
            let s = solve(0, &phi, &y, tolerance);
            eprintln!("{rows} {cols} {part}: {} iterations", s.iterations);
            assert_eq!(s.status, Status::Solved, "{rows} {cols} {part}");
            let r = residual(&phi, &s.coefficients, &y);
            assert!(
                (r / tolerance - 1.0).abs() < 1e-5,
                "{rows} {cols} {part}: {r} for {tolerance}"
            );
            let gap = gap(&phi, &s, &y, tolerance);
            assert!(gap.abs() < 1e-6, "{rows} {cols} {part}: gap {gap:e}");
        }
    }
}

#[test]
fn dependent_rows_contradicting_each_other_are_inconsistent() {
    let phi = gaussian(10, 30, 5, |_| 1.0);
    let mut values = Vec::new();
    for column in phi.values().chunks(10) {
        values.extend_from_slice(column);
        values.push(column[0] + column[1]);
    }
    let phi = Dense::new(11, values);
    let mut y = combine(&phi, &[(3, 1.0), (4, 2.0)]);
    assert_eq!(solve(0, &phi, &y, 0.0).status, Status::Solved);
    y[10] += 1.0;
    let Status::Inconsistent { residual } = solve(0, &phi, &y, 0.0).status else {
        unreachable!("contradiction not seen")
    };
    assert!((residual - 1.0 / 3.0_f64.sqrt()).abs() < 1e-9);
}

#[test]
#[ignore]
fn survey_noise() {
    for (rows, target, level) in [
        (40, Target::Cart, 1e-1),
        (40, Target::Pendulum, 1e-2),
        (40, Target::Cart, 1e-3),
        (60, Target::Pendulum, 1e-5),
        (60, Target::Cart, 1e-8),
    ] {
        for seed in 0..2 {
            let r = regression(&draw(rows, seed), target, POWERS);
            let mut random = Random::new(seed);
            let noise: Vec<f64> = r.target.iter().map(|_| random.normal()).collect();
            let size = level * length(&r.target) / length(&noise);
            let y: Vec<f64> = r
                .target
                .iter()
                .zip(&noise)
                .map(|(y, n)| y + size * n)
                .collect();
            for part in [1.0] {
                let tolerance = part * level * length(&r.target);
                let t = std::time::Instant::now();
                let s = solve(0, &r.dictionary, &y, tolerance);
                println!(
                    "pendulum {rows} {target:?} {level:e} {seed}: {:?} {} it {:.3} s excess {:.1e} gap {:.1e}",
                    s.status,
                    s.iterations,
                    t.elapsed().as_secs_f64(),
                    residual(&r.dictionary, &s.coefficients, &y) / tolerance - 1.0,
                    gap(&r.dictionary, &s, &y, tolerance)
                );
            }
        }
    }
}
