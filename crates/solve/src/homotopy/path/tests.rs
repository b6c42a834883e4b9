//! Every place of a path against what it is by definition, and what is taken back against a look at every knot.

use proptest::prelude::*;

use super::*;
use crate::dictionary::Dense;
use crate::reduce::minus;

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

/// A pool of these columns, the strongest first.
fn pool<'a>(dictionary: &'a Dense, target: &[f64], among: std::ops::Range<usize>) -> Pool<'a> {
    let mut whole = Pool::new(dictionary);
    whole.add(among.clone());
    let c = whole.correlations(target);
    let strongest = (0..c.len()).max_by(|a, b| c[*a].abs().total_cmp(&c[*b].abs()));
    let mut pool = Pool::new(dictionary);
    pool.add(strongest.and_then(|k| whole.number(k)));
    pool.add(among);
    pool
}

/// y − Pa
fn left(pool: &Pool, target: &[f64], a: &[(usize, f64)]) -> Vec<f64> {
    let mut left = target.to_vec();
    a.iter()
        .for_each(|(k, a)| add_scaled(&mut left, -a, pool.column(*k)));
    left
}

fn numbers(columns: usize) -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(-1.0..1.0, ROWS * (columns + 1))
}

proptest! {
    /// min ½‖Pa − y‖² + τ‖a‖₁ at every knot: |Pᵀr| ≤ τ, and τ·sign(a) where a is not zero; λ = r/τ. The end is where it should be.
    #[test]
    fn every_place_is_optimal(numbers in numbers(14), tolerance in 0.05..0.9, penalty in prop::option::of(0.02..0.5)) {
        let (dictionary, target) = problem(&numbers);
        let pool = pool(&dictionary, &target, 0..14);
        let goal = match penalty {
            Some(penalty) => Goal { tolerance: 0.0, penalty },
            None => Goal { tolerance, penalty: 0.0 },
        };
        let mut path = Path::new(&target, goal, &pool);
        prop_assume!(path.level() > goal.penalty);
        let mut before = f64::INFINITY;
        loop {
            let mut told = (0.0, 0.0);
            let level = path.level();
            let place = path.walk(&pool, 1, &mut |gap, residual| {
                told = (gap, residual);
                true
            });
            let r = left(&pool, &target, &place.coefficients);
            prop_assert!((norm(&r) - place.residual).abs() < 1e-9);
            prop_assert!(place.level <= before && place.level > 0.0);
            before = place.level;
            let correlations = pool.correlations(&r);
            for c in &correlations {
                prop_assert!(c.abs() <= place.level + 1e-9, "{c} {}", place.level);
            }
            for (k, a) in &place.coefficients {
                prop_assert!((correlations[*k] - place.level * a.signum()).abs() < 1e-8 || a.abs() < 1e-12);
            }
            let lambda: Vec<f64> = r.iter().map(|r| r / place.level).collect();
            prop_assert!(norm(&minus(&lambda, &place.lambda)) < 1e-7);
            // What was told is of the knot where the step began.
            prop_assert!(told.1 >= place.residual - 1e-12 && level >= place.level);
            match place.end {
                End::Due => {}
                End::Reached => {
                    let (is, wanted) = match penalty {
                        Some(penalty) => (place.level, penalty),
                        None => (place.residual, tolerance),
                    };
                    prop_assert!((is - wanted).abs() < 1e-9, "{is} {wanted}");
                    break;
                }
                end => prop_assert!(false, "{end:?}"),
            }
            if let Turn::Enters(k) = place.turn {
                prop_assert!(place.coefficients.iter().all(|(j, _)| *j != k));
                prop_assert!((correlations[k].abs() - place.level).abs() < 1e-9);
            }
        }
    }

    /// The gap is that between ‖a‖₁ and the bound yᵀλ − ε‖λ‖, relative to yᵀλ.
    #[test]
    fn the_gap_is_that_of_the_knot(numbers in numbers(14), tolerance in 0.05..0.5, steps in 1_usize..6) {
        let (dictionary, target) = problem(&numbers);
        let pool = pool(&dictionary, &target, 0..14);
        let goal = Goal { tolerance, penalty: 0.0 };
        let mut path = Path::new(&target, goal, &pool);
        let place = path.walk(&pool, steps, &mut |_, _| true);
        prop_assume!(place.end == End::Due);
        let mut told = f64::NAN;
        path.walk(&pool, 1, &mut |gap, _| {
            told = gap;
            false
        });
        let sum: f64 = place.coefficients.iter().map(|(_, a)| a.abs()).sum();
        let along = dot(&target, &place.lambda);
        let bound = along - tolerance * norm(&place.lambda);
        prop_assert!((told - (bound - sum) / along).abs() < 1e-8, "{told} {bound} {sum}");
    }

    /// Columns that join late end the path where it ends with them from the start; what is taken back is no more than what they change.
    #[test]
    fn late_columns_lead_to_the_same_end(numbers in numbers(24), tolerance in 0.01..0.5) {
        let (dictionary, target) = problem(&numbers);
        let goal = Goal { tolerance, penalty: 0.0 };
        let whole = pool(&dictionary, &target, 0..24);
        let mut direct = Path::new(&target, goal, &whole);
        let wanted = direct.walk(&whole, usize::MAX, &mut |_, _| true);
        prop_assume!(wanted.end == End::Reached);

        let mut few = pool(&dictionary, &target, 0..10);
        let mut path = Path::new(&target, goal, &few);
        path.walk(&few, usize::MAX, &mut |_, _| true);
        few.add(0..24);
        let broken = |end: &[f64]| (10..24).any(|k| dot(few.column(k), end).abs() > 1.0 + VIOLATION);
        let first = path.ends.chunks_exact(ROWS).position(broken);
        prop_assert_eq!(path.first_broken(&few, 10), first);
        let knot = first.unwrap_or(path.knots.len() - 1);
        let (level, active) = (path.knots[knot].level, path.knots[knot].active.clone());
        path.rewind(&few, 10);
        prop_assert_eq!(path.level(), level);
        prop_assert_eq!(&path.active, &active);
        prop_assert_eq!(path.knots.len(), knot);
        prop_assert_eq!(path.ends.len(), knot * ROWS);
        // The first column was the strongest of few: where it is not that of all, the path has to begin anew.
        if few.column(0) == whole.column(0) {
            let end = path.walk(&few, usize::MAX, &mut |_, _| true);
            prop_assert_eq!(end.end, End::Reached);
            let apart = norm(&minus(&end.lambda, &wanted.lambda));
            prop_assert!(apart < 1e-7, "{apart}");
        }
    }
}

/// Places found in batches are the same as one by one.
#[test]
fn a_broken_knot_is_found_beyond_the_first_batch() {
    let (dictionary, target) = problem(&[1.0; ROWS * 2]);
    let pool = pool(&dictionary, &target, 0..1);
    let goal = Goal {
        tolerance: 0.0,
        penalty: 0.0,
    };
    let mut path = Path::new(&target, goal, &pool);
    for at in [0, 1, BATCH - 1, BATCH, 2 * BATCH + 5] {
        let end = |k: usize| {
            let size = if k < at { 0.5 } else { 1.5 };
            target.iter().map(move |y| size * y).collect::<Vec<f64>>()
        };
        path.ends = (0..3 * BATCH).flat_map(end).collect();
        assert_eq!(path.first_broken(&pool, 0), Some(at));
    }
    path.ends.iter_mut().for_each(|x| *x = 0.0);
    assert_eq!(path.first_broken(&pool, 0), None);
}

#[test]
fn only_nothing_left_and_nothing_paid_is_exact() {
    let (dictionary, target) = problem(&[1.0; ROWS * 2]);
    let pool = pool(&dictionary, &target, 0..1);
    for (tolerance, penalty, exact) in [(0.0, 0.0, true), (0.1, 0.0, false), (0.0, 0.1, false)] {
        let goal = Goal { tolerance, penalty };
        assert_eq!(Path::new(&target, goal, &pool).is_exact(), exact);
    }
}
