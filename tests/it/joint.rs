//! Coupled problems compared with independent checks: all active sets, and weak duality.

use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;
use sidc::Unwatched;
use sidc_solve::dictionary::Dense;
use sidc_solve::{
    ConstrainedProblem, ConstrainedSolution, LinearConstraint, Outcome, Problem, RegressionBlock,
    Sense, certify_constrained, constrained_least_squares, least_residuals, solve_constrained,
};

/// Deterministic numbers from −1 to 1.
fn numbers(n: usize, mut seed: u64) -> Vec<f64> {
    let step = |_| {
        seed = seed
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    (0..n + 3).map(step).skip(3).collect()
}

fn row(entries: &[(usize, usize, f64)], sense: Sense, right: f64) -> LinearConstraint {
    LinearConstraint {
        entries: entries.to_vec(),
        sense,
        right,
    }
}

/// Two blocks, each with `rows` rows and `cols` columns.
struct Pair {
    rows: usize,
    cols: usize,
    values: [Vec<f64>; 2],
    targets: [Vec<f64>; 2],
}

impl Pair {
    fn random(rows: usize, cols: usize, seed: u64) -> Pair {
        let block = |k| numbers(rows * cols, seed * 4 + k);
        let target = |k| numbers(rows, seed * 4 + k + 2);
        Pair {
            rows,
            cols,
            values: [block(0), block(1)],
            targets: [target(0), target(1)],
        }
    }

    fn blocks(&self) -> Vec<RegressionBlock> {
        (0..2)
            .map(|b| RegressionBlock {
                columns: (0..self.cols).collect(),
                values: DMatrix::from_fn(self.rows, self.cols, |i, j| {
                    self.values[b][j * self.rows + i]
                }),
                target: self.targets[b].clone(),
                outside: 0.0,
                weight: 1.0,
                variance: 1.0,
            })
            .collect()
    }
}

/// The constrained minimum, by trying every set of active inequalities.
fn brute_force(pair: &Pair, rows: &[LinearConstraint]) -> Option<DVector<f64>> {
    let (m, n) = (pair.rows, pair.cols);
    let a = DMatrix::from_fn(2 * m, 2 * n, |i, j| match (i / m, j / n) {
        (b, c) if b == c => pair.values[b][(j % n) * m + i % m],
        _ => 0.0,
    });
    let y = DVector::from_fn(2 * m, |i, _| pair.targets[i / m][i % m]);
    let plane = |r: &LinearConstraint| {
        let mut c = DVector::zeros(2 * n);
        r.entries.iter().for_each(|(b, j, w)| c[b * n + j] += w);
        (c, r.right)
    };
    let inequalities: Vec<usize> = (0..rows.len())
        .filter(|k| rows[*k].sense != Sense::Equal)
        .collect();
    let mut best: Option<(f64, DVector<f64>)> = None;
    for mask in 0..1u32 << inequalities.len() {
        let active: Vec<usize> = (0..rows.len())
            .filter(|k| {
                let at = inequalities.iter().position(|i| i == k);
                at.is_none_or(|i| mask & (1 << i) != 0)
            })
            .collect();
        let p = active.len();
        let mut kkt = DMatrix::zeros(2 * n + p, 2 * n + p);
        let mut right = DVector::zeros(2 * n + p);
        kkt.view_mut((0, 0), (2 * n, 2 * n))
            .copy_from(&(a.transpose() * &a));
        right.rows_mut(0, 2 * n).copy_from(&(a.transpose() * &y));
        for (k, &r) in active.iter().enumerate() {
            let (c, d) = plane(&rows[r]);
            kkt.view_mut((2 * n + k, 0), (1, 2 * n))
                .copy_from(&c.transpose());
            kkt.view_mut((0, 2 * n + k), (2 * n, 1)).copy_from(&c);
            right[2 * n + k] = d;
        }
        let Some(z) = kkt.lu().solve(&right) else {
            continue;
        };
        let x = z.rows(0, 2 * n).into_owned();
        let obeys = rows.iter().all(|r| {
            let (c, d) = plane(r);
            match r.sense {
                Sense::Equal => (c.dot(&x) - d).abs() < 1e-8,
                _ => c.dot(&x) <= d + 1e-9,
            }
        });
        let value = (&a * &x - &y).norm_squared();
        if obeys && best.as_ref().is_none_or(|(v, _)| value < *v) {
            best = Some((value, x));
        }
    }
    best.map(|(_, x)| x)
}

/// An equality across the blocks and three inequalities, with a common feasible point.
fn random_rows(cols: usize, seed: u64) -> Vec<LinearConstraint> {
    let w = numbers(12, seed + 77);
    let inside = numbers(2 * cols, seed + 78);
    let place = |k: usize| ((k / cols) % 2, k % cols);
    let make = |sense, picks: &[(usize, f64)], slack: f64| {
        let entries: Vec<(usize, usize, f64)> = picks
            .iter()
            .map(|(k, w)| (place(*k).0, place(*k).1, *w))
            .collect();
        let at = |(b, j, w): &(usize, usize, f64)| w * inside[b * cols + j];
        let right = entries.iter().map(at).sum::<f64>() + slack;
        LinearConstraint {
            entries,
            sense,
            right,
        }
    };
    vec![
        make(Sense::Equal, &[(0, 1.0), (cols, w[0])], 0.0),
        make(Sense::AtMost, &[(1, w[1])], 0.0),
        make(Sense::AtMost, &[(cols + 1, w[2]), (0, w[3])], 0.1),
        make(Sense::Below, &[(2, w[4]), (cols + 2, w[5])], 0.05),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, ..ProptestConfig::default() })]

    #[test]
    fn constrained_least_squares_is_the_best_of_all_active_sets(seed in 0u64..1_000_000) {
        let pair = Pair::random(9, 4, seed);
        let rows = random_rows(4, seed);
        let all: Vec<usize> = (0..4).collect();
        let found = constrained_least_squares(&pair.blocks(), &[all.clone(), all], &rows).unwrap();
        let wanted = brute_force(&pair, &rows).unwrap();
        for (k, a) in found.values.iter().flatten().enumerate() {
            prop_assert!((a - wanted[k]).abs() < 1e-7 * (1.0 + wanted.norm()), "{k}: {a} {}", wanted[k]);
        }
        let equality = &rows[0];
        let left: f64 = equality.entries.iter().map(|(b, j, w)| w * found.values[*b][*j]).sum();
        prop_assert!((left - equality.right).abs() < 1e-14 * (1.0 + wanted.norm()));
    }

    #[test]
    fn joint_answers_are_proved_optimal_by_weak_duality(seed in 0u64..1_000_000, noisy in any::<bool>()) {
        let (rows, cols) = (12, 30);
        let pair = Pair::random(rows, cols, seed);
        let phis = [0, 1].map(|b| Dense::new(rows, pair.values[b].clone()));
        let problem = |b: usize| Problem {
            dictionary: &phis[b],
            target: &pair.targets[b],
            tolerance: if noisy { 0.3 } else { 0.0 },
        };
        let joint = ConstrainedProblem { blocks: vec![problem(0), problem(1)], rows: random_rows(cols, seed) };
        let found = solve_constrained(&joint, &[], &mut Unwatched);
        prop_assert_eq!(found.outcome, Outcome::Solved);
        let proof = certify_constrained(&joint, &found.coefficients, &found.duals, &found.multipliers);
        // Clarabel stops at 1e-8, so the constraints are violated by as much.
        prop_assert!(proof.gap.abs() < 1e-5, "{proof:?}");
        let (primal, dual, prices) = by_definition(&joint, &found);
        let largest = prices.iter().flatten().fold(0.0, |m: f64, (p, _)| m.max(*p));
        prop_assert!((proof.primal / primal - 1.0).abs() < 1e-12);
        prop_assert!((proof.largest_correlation / largest - 1.0).abs() < 1e-12);
        prop_assert!((proof.dual / dual * largest.max(1.0) - 1.0).abs() < 1e-9);
        for (margin, prices) in proof.margins.iter().zip(&prices) {
            let off = prices.iter().filter(|(_, on)| !on).fold(0.0, |m: f64, (p, _)| m.max(*p));
            prop_assert!((margin - (1.0 - off / largest.max(1.0))).abs() < 1e-12);
        }
        // A dual point three times as long proves no more, since it has to be scaled back.
        let thrice = |v: &[f64]| v.iter().map(|x| 3.0 * x).collect::<Vec<f64>>();
        let duals: Vec<Vec<f64>> = found.duals.iter().map(|d| thrice(d)).collect();
        let longer = certify_constrained(&joint, &found.coefficients, &duals, &thrice(&found.multipliers));
        prop_assert!((longer.largest_correlation / (3.0 * largest) - 1.0).abs() < 1e-9);
        prop_assert!((longer.dual - dual / largest).abs() < 1e-9 * dual.abs().max(1.0));
    }
}

#[test]
fn what_misses_a_row_or_its_bound_by_a_little_is_not_feasible() {
    let phi = Dense::new(2, vec![1.0, 0.0, 0.0, 2.0]);
    let problem = |tolerance: f64| Problem {
        dictionary: &phi,
        target: &[30.0, 40.0],
        tolerance,
    };
    let joint = ConstrainedProblem {
        blocks: vec![problem(0.0), problem(0.5)],
        rows: vec![
            row(&[(0, 0, 2.0), (1, 0, -1.0)], Sense::Equal, 30.0),
            row(&[(0, 1, 1.0)], Sense::AtMost, 20.0),
            row(&[(1, 1, -1.0)], Sense::Below, -19.9),
        ],
    };
    let feasible = |a: [f64; 2], b: [f64; 2]| {
        let found = [a, b].map(|[x, y]| vec![(0, x), (1, y)]);
        let (duals, multipliers) = (vec![vec![0.0; 2]; 2], vec![0.0; 3]);
        certify_constrained(&joint, &found, &duals, &multipliers).feasible
    };
    assert!(feasible([30.0, 20.0], [30.0, 20.0]));
    // Equal to rounding for the first target, and within 0.5 of the second.
    assert!(feasible([30.0 + 1e-5, 20.0], [30.0 + 2e-5, 20.2]));
    assert!(!feasible([30.0 + 1e-3, 20.0], [30.0 + 2e-3, 20.0]));
    assert!(!feasible([30.0, 20.0], [30.0, 20.2501]));
    // Each constraint violated in turn.
    assert!(!feasible([30.0, 20.0], [30.0 + 1e-3, 20.0]));
    assert!(!feasible([30.0, 20.0 + 2.4e-5], [30.0, 20.0]));
    assert!(!feasible([30.0, 20.0], [30.0, 19.899]));
}

/// Σ ‖D a‖₁/‖y‖, the bound of the dual point unscaled, and for each block the price of every column and whether it is on the support.
fn by_definition(
    joint: &ConstrainedProblem,
    found: &ConstrainedSolution,
) -> (f64, f64, Vec<Vec<(f64, bool)>>) {
    let (mut primal, mut dual, mut all) = (0.0, 0.0, Vec::new());
    let multiplier = |k: usize| match joint.rows[k].sense {
        Sense::Equal => found.multipliers[k],
        _ => found.multipliers[k].min(0.0),
    };
    for (k, row) in joint.rows.iter().enumerate() {
        dual += multiplier(k) * row.right;
    }
    for (b, problem) in joint.blocks.iter().enumerate() {
        let lambda = DVector::from_column_slice(&found.duals[b]);
        let y = DVector::from_column_slice(problem.target);
        dual += y.dot(&lambda) - problem.tolerance * lambda.norm();
        let mut prices = Vec::new();
        for j in 0..problem.dictionary.cols() {
            let mut column = vec![0.0; y.len()];
            problem.dictionary.column(j, &mut column);
            let column = DVector::from_vec(column);
            let mut pull = column.dot(&lambda);
            for (k, row) in joint.rows.iter().enumerate() {
                let here = row.entries.iter().filter(|(of, c, _)| (*of, *c) == (b, j));
                pull += here.map(|(_, _, w)| multiplier(k) * w).sum::<f64>();
            }
            let on = found.coefficients[b].iter().find(|(c, _)| *c == j);
            primal += on.map_or(0.0, |(_, a)| a.abs()) * column.norm() / y.norm();
            prices.push((pull.abs() * y.norm() / column.norm(), on.is_some()));
        }
        all.push(prices);
    }
    (primal, dual, all)
}

#[test]
fn columns_far_from_the_start_are_priced_in() {
    // Each block starts with a third of its 600 columns.
    let (rows, cols) = (40, 600);
    let pair = Pair::random(rows, cols, 5);
    let phis = [0, 1].map(|b| Dense::new(rows, pair.values[b].clone()));
    let column = |b: usize, j: usize| &pair.values[b][j * rows..(j + 1) * rows];
    let y = [0, 1].map(|b| -> Vec<f64> {
        let (p, q) = (column(b, 500), column(b, 77));
        p.iter().zip(q).map(|(p, q)| 2.0 * p - q).collect()
    });
    let problem = |b: usize| Problem {
        dictionary: &phis[b],
        target: &y[b],
        tolerance: 0.0,
    };
    let tie = row(&[(0, 500, 1.0), (1, 500, -1.0)], Sense::Equal, 0.0);
    let sign = row(&[(0, 77, 1.0)], Sense::Below, 0.0);
    let joint = ConstrainedProblem {
        blocks: vec![problem(0), problem(1)],
        rows: vec![tie, sign],
    };
    let found = solve_constrained(&joint, &[], &mut Unwatched);
    assert_eq!(found.outcome, Outcome::Solved);
    for a in &found.coefficients {
        let large: Vec<usize> = a
            .iter()
            .filter(|(_, v)| v.abs() > 1e-3)
            .map(|(j, _)| *j)
            .collect();
        assert_eq!(large, vec![77, 500]);
    }
    let exact: Vec<Vec<(usize, f64)>> = vec![vec![(77, -1.0), (500, 2.0)]; 2];
    let proof = certify_constrained(&joint, &exact, &found.duals, &found.multipliers);
    assert!(proof.proves_optimal, "{proof:?}");
    let wrong: Vec<Vec<(usize, f64)>> = vec![vec![(77, -1.0), (500, 2.0)], vec![(77, -1.0)]];
    assert!(!certify_constrained(&joint, &wrong, &found.duals, &found.multipliers).feasible);
}

#[test]
fn data_that_no_column_can_reconcile_are_infeasible() {
    let phi = Dense::new(3, vec![1.0, 1.0, 1.0, 0.0, 1.0, 2.0]);
    let y = [1.0, 3.0, 5.0];
    let joint = ConstrainedProblem {
        blocks: vec![Problem {
            dictionary: &phi,
            target: &y,
            tolerance: 1e-6,
        }],
        rows: vec![row(&[(0, 1, 1.0)], Sense::Equal, 0.0)],
    };
    let found = solve_constrained(&joint, &[], &mut Unwatched);
    assert_eq!(found.outcome, Outcome::Infeasible);
    // The residual of (1, 3, 5) from its mean: √8 relative to √35.
    let left = least_residuals(&joint, &[])[0];
    assert!((left - (8.0_f64 / 35.0).sqrt()).abs() < 1e-6, "{left}");
}
