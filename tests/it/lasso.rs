//! The Lasso path: every knot is checked against conditions and bounds computed here from the columns.

use proptest::prelude::*;
use sidc::Unwatched;
use sidc_solve::dictionary::Dense;
use sidc_solve::{Knot, Problem, certify, certify_lasso, lasso, lasso_path};
use sidc_testing::observers::interrupting;

use sidc_testing::pendulum_regression::{Random, Target, draw, regression};

/// Excess over a bound, relative to the penalty.
const BOUND: f64 = 1e-8;
const GAP: f64 = 1e-9;
/// Rounding error of a correlation, relative to ‖y‖.
const ROUNDING: f64 = 1e-13;
const MOST: usize = 500;

/// Columns and a target, stored independently of the library.
#[derive(Debug)]
struct Case {
    columns: Vec<Vec<f64>>,
    y: Vec<f64>,
    /// ε
    tolerance: f64,
}

#[derive(Clone, Copy, Debug)]
struct Shape {
    rows: usize,
    cols: usize,
    /// Share of a common component in all columns, which correlates them.
    common: f64,
    /// Powers of ten over which lengths of columns range.
    decades: i32,
    /// Period of the columns that are zero, or double another one.
    every: usize,
    /// Standard deviation of the noise in y.
    noise: f64,
    /// ε relative to ‖y‖.
    tolerance: f64,
    /// Approximate log10 of ‖y‖.
    size: i32,
    seed: u64,
}

fn shapes() -> impl Strategy<Value = Shape> {
    let sizes = prop_oneof![(3..25usize, 20..120usize), (20..80usize, 1..20usize)];
    let numbers = (
        prop_oneof![Just(0.0), Just(0.0), Just(1e-6), 1e-3..0.3f64],
        prop_oneof![Just(0.0), 1e-8..0.3f64],
    );
    let more = (0.0..3.0f64, 0..12i32, 3..9usize, -6..7i32, any::<u64>());
    (sizes, numbers, more).prop_map(|((rows, cols), (noise, tolerance), more)| {
        let (common, decades, every, size, seed) = more;
        Shape {
            rows,
            cols,
            common,
            decades,
            every,
            noise,
            tolerance,
            size,
            seed,
        }
    })
}

impl Shape {
    fn case(self) -> Case {
        let mut random = Random::new(self.seed);
        let shared: Vec<f64> = (0..self.rows).map(|_| random.normal()).collect();
        let mut columns: Vec<Vec<f64>> = Vec::new();
        for j in 0..self.cols {
            let power = (random.uniform() - 0.5) * f64::from(self.decades);
            let length = 10f64.powf(power);
            let entry = |s: &f64| length * (random.normal() + self.common * s);
            columns.push(match j % self.every {
                1 => vec![0.0; self.rows],
                2 => columns[j - 2].iter().map(|x| -2.0 * x).collect(),
                _ => shared.iter().map(entry).collect(),
            });
        }
        let mut y: Vec<f64> = (0..self.rows)
            .map(|_| self.noise * random.normal())
            .collect();
        for j in random.choose(self.cols.min(4), self.cols) {
            let a = random.normal() / length(&columns[j]).max(1e-100);
            add(&mut y, a, &columns[j]);
        }
        let size = 10f64.powi(self.size);
        y.iter_mut().for_each(|y| *y *= size);
        Case {
            tolerance: self.tolerance * length(&y),
            columns,
            y,
        }
    }
}

impl Case {
    fn dense(&self) -> Dense {
        Dense::new(self.y.len(), self.columns.concat())
    }

    fn left(&self, a: &[(usize, f64)]) -> Vec<f64> {
        let mut r = self.y.clone();
        a.iter()
            .for_each(|(j, a)| add(&mut r, -a, &self.columns[*j]));
        r
    }

    /// Largest |φ_jᵀr|/‖φ_j‖ over all columns.
    fn price(&self, r: &[f64]) -> f64 {
        let columns = self.columns.iter().filter(|c| length(c) > 0.0);
        columns.fold(0.0, |m, c| m.max(dot(c, r).abs() / length(c)))
    }

    /// Σ|a_j|‖φ_j‖
    fn paid(&self, a: &[(usize, f64)]) -> f64 {
        a.iter()
            .map(|(j, a)| a.abs() * length(&self.columns[*j]))
            .sum()
    }

    /// The Karush–Kuhn–Tucker conditions over all columns, and the duality gap with λ = r/τ.
    fn is_answer(&self, knot: &Knot) -> Result<(), TestCaseError> {
        let (r, size) = (self.left(&knot.coefficients), length(&self.y));
        prop_assert!(
            (length(&r) - knot.residual).abs() <= 1e-10 * size,
            "{:e} {:e} {:?}",
            length(&r),
            knot.residual,
            knot.coefficients
        );
        // With nearly dependent columns, rounding may give a nonzero value to a coefficient that is zero at the knot. The check allows for that; λ, which the
        // certificate uses, is checked to more digits below.
        let rounding = 1e-10 * (size + self.paid(&knot.coefficients));
        let room = BOUND * knot.penalty + rounding;
        let tau = knot.penalty;
        prop_assert!(self.price(&r) <= tau + room, "{} {tau}", self.price(&r));
        for (j, a) in &knot.coefficients {
            let c = dot(&self.columns[*j], &r) / length(&self.columns[*j]);
            prop_assert!((c - tau * a.signum()).abs() <= room, "{j}: {a} {c} {tau}");
        }
        let primal = 0.5 * dot(&r, &r) + tau * self.paid(&knot.coefficients);
        let scale = 1.0 / self.price(&knot.dual).max(1.0);
        let lambda: Vec<f64> = knot.dual.iter().map(|l| l * scale).collect();
        let dual = tau * dot(&self.y, &lambda) - 0.5 * tau * tau * dot(&lambda, &lambda);
        // λ = r/τ inherits the rounding of y, magnified.
        let relative = GAP + 1e-15 * size / tau.max(f64::MIN_POSITIVE);
        let room = (relative * primal).max(rounding.powi(2));
        prop_assert!(
            (primal - dual).abs() <= room,
            "{primal:e} {dual:e} {tau:e} {size:e}"
        );
        if tau == 0.0 {
            // Basis pursuit: the residual is zero, and ‖Da‖₁ = yᵀλ.
            let (paid, bound) = (self.paid(&knot.coefficients), dot(&self.y, &lambda));
            prop_assert!(length(&r) <= 1e-9 * size && (paid - bound).abs() <= GAP * paid);
        }
        Ok(())
    }
}

fn add(y: &mut [f64], a: f64, x: &[f64]) {
    y.iter_mut().zip(x).for_each(|(y, x)| *y += a * x);
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn length(v: &[f64]) -> f64 {
    dot(v, v).sqrt()
}

fn problem<'a>(phi: &'a Dense, y: &'a [f64], tolerance: f64) -> Problem<'a> {
    Problem {
        dictionary: phi,
        target: y,
        tolerance,
    }
}

fn path(p: &Problem) -> Vec<Knot> {
    lasso_path(p, MOST, &mut Unwatched)
}

fn at(p: &Problem, penalty: f64) -> Option<Knot> {
    lasso(p, penalty, &mut Unwatched)
}

/// Coefficient · length of every column at a point between two knots.
fn between(case: &Case, from: &Knot, to: &Knot, part: f64) -> Vec<f64> {
    let mut a = vec![0.0; case.columns.len()];
    for (knot, weight) in [(from, 1.0 - part), (to, part)] {
        for (j, value) in &knot.coefficients {
            a[*j] += weight * value * length(&case.columns[*j]);
        }
    }
    a
}

fn falls(case: &Case, knots: &[Knot]) -> Result<(), TestCaseError> {
    let size = length(&case.y);
    for pair in knots.windows(2) {
        prop_assert!(pair[1].penalty <= pair[0].penalty);
        prop_assert!(pair[1].residual <= pair[0].residual + ROUNDING * size);
    }
    let Some(first) = knots.first() else {
        return Ok(());
    };
    prop_assert!(first.coefficients.is_empty());
    prop_assert!((first.residual - size).abs() <= ROUNDING * size);
    let largest = case.price(&case.y);
    prop_assert!((first.penalty - largest).abs() <= 1e-12 * largest);
    Ok(())
}

/// Supports change by one column per knot, the one that enters or leaves.
fn turns(knots: &[Knot]) -> Result<(), TestCaseError> {
    let mut active: Vec<usize> = Vec::new();
    for (i, knot) in knots.iter().enumerate() {
        if let Some(j) = knot.leaves {
            prop_assert!(active.contains(&j), "{i}: {j} leaves {active:?}");
            active.retain(|k| *k != j);
        }
        let mut support: Vec<usize> = knot.coefficients.iter().map(|(j, _)| *j).collect();
        support.sort_unstable();
        active.sort_unstable();
        // At τ = 0 a column that exact data do not need is zero up to rounding, or exactly.
        let at_hand = |j: &usize| active.contains(j);
        let same = support == active || (knot.penalty == 0.0 && support.iter().all(at_hand));
        prop_assert!(same, "{i}: {support:?} {active:?}");
        active.extend(knot.enters);
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(1000) })]

    #[test]
    fn every_knot_is_an_answer_over_all_columns(shape in shapes()) {
        let case = shape.case();
        let phi = case.dense();
        let p = problem(&phi, &case.y, case.tolerance);
        let knots = path(&p);
        prop_assert!(knots.len() < MOST);
        falls(&case, &knots)?;
        turns(&knots)?;
        for knot in &knots {
            case.is_answer(knot)?;
        }
        // If least squares reaches ε, so does the path.
        if shape.noise == 0.0 && length(&case.y) > case.tolerance {
            let last = knots.last().map_or(f64::INFINITY, |k| k.residual);
            prop_assert!(last <= case.tolerance * (1.0 + 1e-9) + 1e-9 * length(&case.y), "{last}");
        }
    }

    /// Each knot solves the constrained form with its own residual as ε, and the library's certificate proves it for the Lasso form.
    #[test]
    fn every_knot_is_certified(shape in shapes()) {
        let case = shape.case();
        let phi = case.dense();
        let size = length(&case.y);
        for knot in path(&problem(&phi, &case.y, case.tolerance)) {
            let p = problem(&phi, &case.y, knot.residual);
            let lasso = certify_lasso(&p, knot.penalty, &knot.coefficients, &knot.dual);
            prop_assert!(lasso.largest_correlation <= 1.0 + BOUND + ROUNDING * size / knot.penalty.max(1e-300));
            if knot.residual <= 1e-9 * size {
                continue;
            }
            let room = 1e-15 * size / knot.penalty;
            prop_assert!(lasso.gap.abs() <= GAP + room, "{lasso:?} {}", knot.penalty / size);
            let c = certify(&p, &knot.coefficients, &knot.dual);
            // a = 0 has norm zero, so no relative gap is defined.
            prop_assert!(c.proves_optimal || (c.primal == 0.0 && c.dual.abs() <= GAP * size), "{c:?}");
        }
    }

    #[test]
    fn answers_between_knots_are_their_interpolation(shape in shapes(), part in 0.05..0.95f64) {
        let case = shape.case();
        let phi = case.dense();
        let p = problem(&phi, &case.y, case.tolerance);
        let knots = path(&p);
        for pair in knots.windows(2) {
            let penalty = pair[0].penalty + part * (pair[1].penalty - pair[0].penalty);
            // Knots too close together cannot be distinguished.
            if pair[0].penalty - pair[1].penalty <= 1e-6 * pair[0].penalty || penalty <= 1e-9 * length(&case.y) {
                continue;
            }
            let Some(found) = at(&p, penalty) else {
                return Err(TestCaseError::fail(format!("no answer at {penalty}")));
            };
            case.is_answer(&found)?;
            let expected = between(&case, &pair[0], &pair[1], part);
            let mut found_all = vec![0.0; case.columns.len()];
            for (j, a) in &found.coefficients {
                found_all[*j] += a * length(&case.columns[*j]);
            }
            // A column and its double are one direction, so their sum is compared.
            let whole = |v: &[f64]| -> Vec<f64> {
                let mut out = vec![0.0; case.y.len()];
                for (c, a) in case.columns.iter().zip(v) {
                    add(&mut out, a / length(c).max(1e-300), c);
                }
                out
            };
            let (a, b) = (whole(&expected), whole(&found_all));
            let apart = length(&a.iter().zip(&b).map(|(a, b)| a - b).collect::<Vec<_>>());
            prop_assert!(apart <= 1e-8 * length(&case.y), "{apart}");
        }
        if let Some(first) = knots.first() {
            let none = at(&p, first.penalty * (1.0 + 1e-9));
            prop_assert!(none.is_some_and(|k| k.coefficients.is_empty()));
        }
    }
}

#[test]
fn a_path_on_many_columns_is_that_of_the_stored_matrix() {
    let r = regression(&draw(60, 4), Target::Pendulum, [2; 8]);
    let p = problem(&r.dictionary, &r.target, 0.0);
    let knots = path(&p);
    assert!(knots.len() > 5, "{}", knots.len());
    for knot in &knots {
        let c = certify_lasso(&p, knot.penalty, &knot.coefficients, &knot.dual);
        assert!(c.gap.abs() < GAP, "{c:?}");
    }
    let last = knots.last().unwrap();
    assert!(last.residual < 1e-12 * length(&r.target));
    let c = certify(&p, &last.coefficients, &last.dual);
    assert!(c.proves_optimal, "{c:?}");
}

#[test]
fn a_path_may_be_cut() {
    let r = regression(&draw(60, 4), Target::Pendulum, [2; 8]);
    let p = problem(&r.dictionary, &r.target, 0.0);
    let whole = path(&p);
    let few = lasso_path(&p, 4, &mut Unwatched);
    assert_eq!(few.len(), 4);
    let penalties = |k: &[Knot]| -> Vec<f64> { k.iter().map(|k| k.penalty).collect() };
    assert_eq!(penalties(&few), penalties(&whole[..4]));
    let mut told = 0;
    let mut observer = interrupting(|_| {
        told += 1;
        told > 3
    });
    let stopped = lasso_path(&p, MOST, &mut observer);
    assert!(!stopped.is_empty() && stopped.len() < whole.len());
    assert!(lasso(&p, 1e-3, &mut interrupting(|_| true)).is_none());
    for penalty in [0.0, -1.0, f64::NAN] {
        assert!(at(&p, penalty).is_none());
    }
    let beyond = problem(&r.dictionary, &r.target, 1e9);
    assert!(path(&beyond).is_empty());
}
