//! Points of a path against their definition, and rewinding against a look at every knot.

use proptest::prelude::*;

use super::*;
use crate::dictionary::Dense;
use crate::linalg::difference;

const ROWS: usize = 8;

/// Columns of length one, and a target of length one.
fn problem(numbers: &[f64]) -> (Dense, Vec<f64>) {
    let (target, columns) = numbers.split_at(ROWS);
    let size = norm(target);
    (
        Dense::new(ROWS, columns.to_vec()),
        target.iter().map(|y| y / size).collect(),
    )
}

/// A working set of these columns, the one of largest correlation first.
fn working_set<'a>(
    dictionary: &'a Dense,
    target: &[f64],
    among: std::ops::Range<usize>,
) -> WorkingSet<'a> {
    let mut whole = WorkingSet::new(dictionary);
    whole.add(among.clone());
    let c = whole.correlations(target);
    let strongest = (0..c.len()).max_by(|a, b| c[*a].abs().total_cmp(&c[*b].abs()));
    let mut set = WorkingSet::new(dictionary);
    set.add(strongest.and_then(|k| whole.index(k)));
    set.add(among);
    set
}

/// y − Pa
fn residual(set: &WorkingSet, target: &[f64], a: &[(usize, f64)]) -> Vec<f64> {
    let mut rest = target.to_vec();
    a.iter()
        .for_each(|(k, a)| axpy(-a, set.column(*k), &mut rest));
    rest
}

fn numbers(columns: usize) -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(-1.0..1.0, ROWS * (columns + 1))
}

proptest! {
    /// min ½‖Pa − y‖² + τ‖a‖₁ at every knot: |Pᵀr| ≤ τ, and τ·sign(a) where a is not zero; λ = r/τ. The path ends at its goal.
    #[test]
    fn every_point_is_optimal(numbers in numbers(14), tolerance in 0.05..0.9, penalty in prop::option::of(0.02..0.5)) {
        let (dictionary, target) = problem(&numbers);
        let set = working_set(&dictionary, &target, 0..14);
        let goal = match penalty {
            Some(penalty) => Goal { tolerance: 0.0, penalty },
            None => Goal { tolerance, penalty: 0.0 },
        };
        let mut path = Path::new(&target, goal, &set);
        prop_assume!(path.penalty() > goal.penalty);
        let mut before = f64::INFINITY;
        loop {
            let mut told = (0.0, 0.0);
            let start = path.penalty();
            let point = path.advance(&set, 1, &mut |gap, residual| {
                told = (gap, residual);
                true
            });
            let r = residual(&set, &target, &point.coefficients);
            prop_assert!((norm(&r) - point.residual).abs() < 1e-9);
            prop_assert!(point.penalty <= before && point.penalty > 0.0);
            before = point.penalty;
            let correlations = set.correlations(&r);
            for c in &correlations {
                prop_assert!(c.abs() <= point.penalty + 1e-9, "{c} {}", point.penalty);
            }
            for (k, a) in &point.coefficients {
                prop_assert!((correlations[*k] - point.penalty * a.signum()).abs() < 1e-8 || a.abs() < 1e-12);
            }
            let lambda: Vec<f64> = r.iter().map(|r| r / point.penalty).collect();
            prop_assert!(norm(&difference(&lambda, &point.lambda)) < 1e-7);
            // The observer gets the knot where the step began.
            prop_assert!(told.1 >= point.residual - 1e-12 && start >= point.penalty);
            match point.stop {
                Stop::PricingDue => {}
                Stop::Goal => {
                    let (is, wanted) = match penalty {
                        Some(penalty) => (point.penalty, penalty),
                        None => (point.residual, tolerance),
                    };
                    prop_assert!((is - wanted).abs() < 1e-9, "{is} {wanted}");
                    break;
                }
                end => prop_assert!(false, "{end:?}"),
            }
            if let ActiveSetChange::Enters(k) = point.change {
                prop_assert!(point.coefficients.iter().all(|(j, _)| *j != k));
                prop_assert!((correlations[k].abs() - point.penalty).abs() < 1e-9);
            }
        }
    }

    /// The gap is that between ‖a‖₁ and the bound yᵀλ − ε‖λ‖, relative to yᵀλ.
    #[test]
    fn the_gap_is_that_of_the_knot(numbers in numbers(14), tolerance in 0.05..0.5, steps in 1_usize..6) {
        let (dictionary, target) = problem(&numbers);
        let set = working_set(&dictionary, &target, 0..14);
        let goal = Goal { tolerance, penalty: 0.0 };
        let mut path = Path::new(&target, goal, &set);
        let point = path.advance(&set, steps, &mut |_, _| true);
        prop_assume!(point.stop == Stop::PricingDue);
        let mut told = f64::NAN;
        path.advance(&set, 1, &mut |gap, _| {
            told = gap;
            false
        });
        let sum: f64 = point.coefficients.iter().map(|(_, a)| a.abs()).sum();
        let along = dot(&target, &point.lambda);
        let bound = along - tolerance * norm(&point.lambda);
        prop_assert!((told - (bound - sum) / along).abs() < 1e-8, "{told} {bound} {sum}");
    }

    /// Columns that enter the working set late lead to the same end, and no more knots are taken back than they change.
    #[test]
    fn late_columns_lead_to_the_same_end(numbers in numbers(24), tolerance in 0.01..0.5) {
        let (dictionary, target) = problem(&numbers);
        let goal = Goal { tolerance, penalty: 0.0 };
        let whole = working_set(&dictionary, &target, 0..24);
        let mut direct = Path::new(&target, goal, &whole);
        let wanted = direct.advance(&whole, usize::MAX, &mut |_, _| true);
        prop_assume!(wanted.stop == Stop::Goal);

        let mut few = working_set(&dictionary, &target, 0..10);
        let mut path = Path::new(&target, goal, &few);
        path.advance(&few, usize::MAX, &mut |_, _| true);
        few.add(0..24);
        let broken = |end: &[f64]| (10..24).any(|k| dot(few.column(k), end).abs() > 1.0 + HOMOTOPY.violation);
        let first = path.ends.chunks_exact(ROWS).position(broken);
        prop_assert_eq!(path.first_violated(&few, 10), first);
        let knot = first.unwrap_or(path.knots.len() - 1);
        let (penalty, active) = (path.knots[knot].penalty, path.knots[knot].active.clone());
        path.rewind(&few, 10);
        prop_assert_eq!(path.penalty(), penalty);
        prop_assert_eq!(&path.active, &active);
        prop_assert_eq!(path.knots.len(), knot);
        prop_assert_eq!(path.ends.len(), knot * ROWS);
        // Where the first column of few is not that of all, the path has to start again.
        if few.column(0) == whole.column(0) {
            let end = path.advance(&few, usize::MAX, &mut |_, _| true);
            prop_assert_eq!(end.stop, Stop::Goal);
            let apart = norm(&difference(&end.lambda, &wanted.lambda));
            prop_assert!(apart < 1e-7, "{apart}");
        }
    }
}

/// Also in a later batch of knots.
#[test]
fn a_violated_knot_is_found_beyond_the_first_batch() {
    let (dictionary, target) = problem(&[1.0; ROWS * 2]);
    let set = working_set(&dictionary, &target, 0..1);
    let goal = Goal {
        tolerance: 0.0,
        penalty: 0.0,
    };
    let mut path = Path::new(&target, goal, &set);
    for at in [
        0,
        1,
        KNOTS_AT_ONCE - 1,
        KNOTS_AT_ONCE,
        2 * KNOTS_AT_ONCE + 5,
    ] {
        let end = |k: usize| {
            let size = if k < at { 0.5 } else { 1.5 };
            target.iter().map(move |y| size * y).collect::<Vec<f64>>()
        };
        path.ends = (0..3 * KNOTS_AT_ONCE).flat_map(end).collect();
        assert_eq!(path.first_violated(&set, 0), Some(at));
    }
    path.ends.iter_mut().for_each(|x| *x = 0.0);
    assert_eq!(path.first_violated(&set, 0), None);
}

#[test]
fn only_zero_tolerance_and_zero_penalty_are_exact() {
    let (dictionary, target) = problem(&[1.0; ROWS * 2]);
    let set = working_set(&dictionary, &target, 0..1);
    for (tolerance, penalty, exact) in [(0.0, 0.0, true), (0.1, 0.0, false), (0.0, 0.1, false)] {
        let goal = Goal { tolerance, penalty };
        assert_eq!(Path::new(&target, goal, &set).is_exact(), exact);
    }
}
