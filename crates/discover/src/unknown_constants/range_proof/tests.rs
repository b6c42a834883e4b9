//! Pursuits and proofs over ranges, against values tried one by one.

use super::cells::{Member, Rows, TermFamily};
use crate::dictionary::evaluate;
use crate::statistics::norm;
use crate::unknown_constants::family::Family;
use crate::unknown_constants::pursuit::{Effort, Pursuit};
use crate::unknown_constants::searched_constant::SearchedConstant;
use sidc_data::{Column, Origin, Samples};
use sidc_lang::library::{Grading, Library};
use sidc_lang::model::UnknownConstant;
use sidc_lang::term::{Expr, Func, Signal, Term, VarId};
use sidc_progress::Unwatched;
use sidc_random::Numbers;
use sidc_solve::simd::dot;
use sidc_solve::{Homotopy, Problem, Solver, dictionary::Dense};

const RANGE: (f64, f64) = (0.2, 5.0);
const ROWS: usize = 60;

fn signals() -> [Signal; 2] {
    [0, 1].map(|v| Signal::new(VarId(v)))
}

/// Rows of x, and k with one value.
fn samples(numbers: &mut Numbers, k: f64) -> Samples {
    let x: Vec<f64> = (0..ROWS).map(|_| 2.0 * numbers.next()).collect();
    let column = |signal, values| Column {
        signal,
        values,
        origin: Origin::Measured { noise: None },
    };
    let [a, b] = signals();
    Samples {
        trajectory: vec![0; ROWS],
        time: (0..ROWS).map(|m| m as f64).collect(),
        columns: vec![column(a, x), column(b, vec![k; ROWS])],
    }
}

fn term(e: Expr) -> Term {
    e.terms().next().map(|(_, t)| t.clone()).unwrap()
}

/// f(k x) for one of three functions.
fn shaped(kind: usize) -> Term {
    let [x, k] = signals().map(Expr::signal);
    let name = ["sin", "tanh", "exp"][kind % 3];
    let sign = if name == "exp" { -0.5 } else { 1.0 };
    let inner = (x * k).scale(sign);
    term(Expr::call(Func::named(name).unwrap(), vec![inner]))
}

/// <1, x, x^2> and one shape, times 1 or x.
fn library(kind: usize) -> Library {
    let x = Expr::signal(signals()[0]);
    let shape = shaped(kind);
    let x1 = term(x.clone());
    let times = x1.mul(&shape);
    Library::listed(vec![Term::one(), x1, term(x.pow(2.0)), shape, times])
}

fn at(samples: &Samples, k: f64) -> Samples {
    let mut samples = samples.clone();
    samples.columns[1].values.fill(k);
    samples
}

fn sought() -> [SearchedConstant; 1] {
    let unknown = UnknownConstant {
        var: VarId(1),
        range: Some(RANGE),
        per_run: false,
    };
    [SearchedConstant {
        place: 0,
        unknown,
        run: None,
    }]
}

fn spaced(count: usize) -> impl Iterator<Item = f64> {
    let share = move |m: usize| m as f64 / (count - 1) as f64;
    (0..count).map(move |m| RANGE.0 * (RANGE.1 / RANGE.0).powf(share(m)))
}

/// The norm over the continuum is at most that over a grid fifty times as fine, and its dual point keeps the bounds on that grid.
#[test]
fn priced_columns_do_as_well_as_a_fine_grid() {
    let mut numbers = Numbers(5);
    for round in 0..12 {
        let (library, samples, row) = (library(round), samples(&mut numbers, 1.0), [1.0; ROWS]);
        let truth = at(&samples, 0.4 + 2.0 * numbers.next().abs());
        let mut y = evaluate(&shaped(round), &truth);
        let noise: Vec<f64> = y.iter().map(|_| 0.02 * numbers.next()).collect();
        y.iter_mut().zip(&noise).for_each(|(y, e)| *y += e);
        let sought = sought();
        let family = Family {
            library: &library,
            sought: &sought,
            samples: &samples,
            row: &row,
            grading: &Grading::PLAIN,
        };
        let points: Vec<Vec<f64>> = spaced(12).map(|k| vec![k]).collect();
        let tolerance = 0.05 * norm(&y);
        let effort = Effort {
            rounds: 8,
            steps: 500,
            violation: 1e-6,
        };
        let mut pursuit = Pursuit::new(family, &points).unwrap();
        let goal = (&y[..], tolerance);
        let found = pursuit.solve(goal, effort, &mut Unwatched).unwrap();
        let mut values = Vec::new();
        for (slot, t) in library.terms() {
            let count = if slot < 3 { 1 } else { 600 };
            let columns = spaced(count.max(2)).take(count);
            values.extend(columns.flat_map(|k| evaluate(&t, &at(&samples, k))));
        }
        let fine = Dense::new(ROWS, values);
        let problem = Problem {
            dictionary: &fine,
            target: &y,
            tolerance,
        };
        let best = Homotopy.solve(&problem, &mut Unwatched);
        let best: f64 = problem.contributions(&best.coefficients).sum();
        assert!(
            found.norm <= best * (1.0 + 1e-5),
            "{round}: {} {best}",
            found.norm
        );
        use sidc_solve::dictionary::Dictionary;
        let largest = fine.price(&found.dual, 1, 0.0).largest();
        assert!(largest < 1.0 + 1e-4, "{round}: {largest}");
    }
}

/// Over a range that is proved no value breaks its bound, and where the range ends short one does, or nearly.
#[test]
fn proved_ranges_hold_value_by_value() {
    let mut numbers = Numbers(8);
    let (mut whole, mut part) = (0, 0);
    for round in 0..60 {
        let samples = samples(&mut numbers, 1.0);
        let shape = shaped(round);
        let start = 0.5 + 2.0 * numbers.next().abs();
        let mut dual: Vec<f64> = (0..ROWS).map(|_| numbers.next()).collect();
        let size = |k: f64, dual: &[f64]| {
            let column = evaluate(&shape, &at(&samples, k));
            dot(&column, dual).abs() / norm(&column)
        };
        // Some duals stay below the bound everywhere, others break it somewhere.
        let scale = [0.6, 0.9, 1.3][round % 3] / size(start, &dual).max(0.2);
        dual.iter_mut().for_each(|l| *l *= scale * 0.7);
        let family = TermFamily {
            varying: shape.clone(),
            members: vec![Member::new(&[1.0; ROWS], &[1.0; ROWS], &dual, 1.0)],
        };
        let mut rows = Rows::new(samples.clone(), signals()[1], 1.0, &family);
        let Some((from, to)) = rows.proved(start, RANGE, &mut Unwatched) else {
            assert!(size(start, &dual) > 1.0 - 1e-6, "{round}");
            continue;
        };
        let (mut inside, mut beyond) = (0.0_f64, 0.0_f64);
        for k in spaced(10_000) {
            let found = size(k, &dual);
            match from <= k && k <= to {
                true => inside = inside.max(found),
                false => beyond = beyond.max(found),
            }
        }
        assert!(inside <= 1.0 + 1e-9, "{round}: {inside} in {from}..{to}");
        match (from, to) == RANGE {
            true => whole += 1,
            false => {
                part += 1;
                assert!(beyond > 1.0 - 1e-3, "{round}: {beyond} beyond {from}..{to}");
            }
        }
    }
    assert!(whole > 10 && part > 2, "{whole} {part}");
}
