//! Least distance programming: the point v of least norm that satisfies linear inequalities (Lawson & Hanson 1974, chapter 23).
//!
//! In: inequalities `g·v ≥ h`. Out: multipliers μ ≥ 0 with v = Σ μ g, or that no point satisfies them all.

use nalgebra::DMatrix;

use crate::linalg::{RankRevealingQr, difference, norm, times};
use crate::simd::{axpy, dot};
use crate::thresholds::LINEAR_CONSTRAINTS;

/// One inequality `g·v ≥ h`.
pub(super) struct HalfSpace {
    pub normal: Vec<f64>,
    pub height: f64,
}

/// Multipliers at the least ‖v‖₂; `None` if no point is feasible. All zero if the origin is.
pub(super) fn least_distance(spaces: &[HalfSpace]) -> Option<Vec<f64>> {
    let lengths: Vec<f64> = spaces.iter().map(|s| norm(&s.normal)).collect();
    let largest = spaces.iter().map(|s| s.height.abs()).fold(0.0, f64::max);
    let mut multipliers = vec![0.0; spaces.len()];
    let nonzero: Vec<usize> = (0..spaces.len())
        .filter(|&k| lengths[k] > LINEAR_CONSTRAINTS.gradient)
        .collect();
    let zero = (0..spaces.len()).filter(|&k| lengths[k] <= LINEAR_CONSTRAINTS.gradient);
    if zero
        .map(|k| spaces[k].height)
        .any(|h| h > LINEAR_CONSTRAINTS.empty * largest)
    {
        return None;
    }
    // v is scaled by the largest distance to a violated hyperplane.
    let distance = |k: &usize| spaces[*k].height / lengths[*k];
    let unit = nonzero.iter().map(distance).fold(0.0, f64::max);
    if unit == 0.0 {
        return Some(multipliers);
    }
    let columns: Vec<Vec<f64>> = nonzero
        .iter()
        .map(|&k| {
            let normal = spaces[k].normal.iter().map(|g| g / lengths[k]);
            let height = spaces[k].height / lengths[k] / unit;
            let size = 1.0_f64.hypot(height);
            normal.chain([height]).map(|e| e / size).collect()
        })
        .collect();
    let n = columns.first().map_or(0, Vec::len);
    let mut target = vec![0.0; n];
    if let Some(last) = target.last_mut() {
        *last = 1.0;
    }
    let solution = nonnegative_least_squares(&columns, &target);
    let rest = residual(&columns, &target, &solution);
    let last = rest.last().copied().unwrap_or(0.0);
    if last <= LINEAR_CONSTRAINTS.empty {
        return None;
    }
    for ((k, column), x) in nonzero.iter().zip(&columns).zip(&solution) {
        // v = Σ x·(unit normal)/(size · last), in the unit of distance.
        let last_entry = column.last().copied().unwrap_or(0.0);
        let height = spaces[*k].height / lengths[*k] / unit;
        let size = if height != 0.0 {
            height / last_entry
        } else {
            1.0
        };
        multipliers[*k] = unit * x / (size * last * lengths[*k]);
    }
    Some(multipliers)
}

/// `min ‖E x − f‖₂ s.t. x ≥ 0`, by the active set method of Lawson & Hanson.
fn nonnegative_least_squares(columns: &[Vec<f64>], f: &[f64]) -> Vec<f64> {
    let mut x = vec![0.0; columns.len()];
    let mut passive: Vec<usize> = Vec::new();
    for _ in 0..3 * columns.len() + 10 {
        let rest = residual(columns, f, &x);
        let best = (0..columns.len())
            .filter(|k| !passive.contains(k))
            .map(|k| (dot(&columns[k], &rest), k))
            .max_by(|a, b| a.0.total_cmp(&b.0));
        match best {
            Some((gradient, k)) if gradient > LINEAR_CONSTRAINTS.gradient * norm(f) => {
                passive.push(k)
            }
            _ => return x,
        }
        while !passive.is_empty() {
            let target = passive_fit(columns, &passive, f);
            let blocking = passive.iter().zip(&target).filter(|(_, t)| **t <= 0.0);
            let step = blocking
                .map(|(&k, t)| x[k] / (x[k] - t))
                .filter(|s| s.is_finite())
                .fold(1.0, f64::min);
            for (&k, t) in passive.iter().zip(&target) {
                x[k] += step * (t - x[k]);
            }
            if target.iter().all(|t| *t > 0.0) {
                break;
            }
            let leaves = |k: &usize, t: f64| t <= 0.0 && x[*k] <= LINEAR_CONSTRAINTS.gradient;
            let remaining: Vec<usize> = passive
                .iter()
                .zip(&target)
                .filter(|(k, t)| !leaves(k, **t))
                .map(|(k, _)| *k)
                .collect();
            for k in passive.iter().filter(|k| !remaining.contains(k)) {
                x[*k] = 0.0;
            }
            if remaining.len() == passive.len() {
                return x;
            }
            passive = remaining;
        }
    }
    x
}

fn residual(columns: &[Vec<f64>], f: &[f64], x: &[f64]) -> Vec<f64> {
    let mut rest = f.to_vec();
    for (column, x) in columns.iter().zip(x) {
        rest.iter_mut().zip(column).for_each(|(r, c)| *r -= x * c);
    }
    rest
}

/// Least squares on the passive columns, with one step of refinement.
fn passive_fit(columns: &[Vec<f64>], passive: &[usize], f: &[f64]) -> Vec<f64> {
    let matrix = DMatrix::from_fn(f.len(), passive.len(), |i, k| columns[passive[k]][i]);
    let Some(fit) = RankRevealingQr::new(&matrix) else {
        return vec![0.0; passive.len()];
    };
    let mut x = fit.solve(f);
    let again = fit.solve(&difference(f, &times(&matrix, &x)));
    axpy(1.0, &again, &mut x);
    x
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn space(normal: &[f64], height: f64) -> HalfSpace {
        HalfSpace {
            normal: normal.to_vec(),
            height,
        }
    }

    #[test]
    fn a_corner_is_touched_by_both_its_sides() {
        let far = space(&[1.0, 1.0], -7.0);
        let spaces = [space(&[1.0, 0.0], 3.0), space(&[0.0, 2.0], 8.0), far];
        let m = least_distance(&spaces).unwrap();
        // v = (3, 4) = 3 (1, 0) + 2 (0, 2)
        assert!((m[0] - 3.0).abs() < 1e-12 && (m[1] - 2.0).abs() < 1e-12 && m[2] == 0.0);
    }

    #[test]
    fn opposite_sides_leave_nothing() {
        let spaces = [space(&[1.0, 0.0], 2.0), space(&[-1.0, 0.0], -1.0)];
        assert_eq!(least_distance(&spaces), None);
        let spaces = [space(&[1.0, 0.0], 1.0), space(&[-1.0, 0.0], -1e6)];
        assert!(least_distance(&spaces).is_some());
    }

    proptest! {
        /// v = Σ multiplier · normal obeys all rows, multipliers are not negative, and rows with one are touched: so it is the least.
        #[test]
        fn the_least_obeys_and_touches(rows in prop::collection::vec(prop::collection::vec(-2.0..2.0, 4), 1..7)) {
            let spaces: Vec<HalfSpace> = rows.iter().map(|r| space(&r[..3], r[3])).collect();
            let Some(multipliers) = least_distance(&spaces) else {
                return Ok(());
            };
            let v: Vec<f64> = (0..3)
                .map(|i| spaces.iter().zip(&multipliers).map(|(s, m)| m * s.normal[i]).sum())
                .collect();
            let size = 1.0 + norm(&v);
            for (s, m) in spaces.iter().zip(&multipliers) {
                let beyond = dot(&s.normal, &v) - s.height;
                prop_assert!(*m >= 0.0 && beyond > -1e-7 * size, "{m} {beyond}");
                prop_assert!(m * beyond.abs() < 1e-6 * size * size, "{m} {beyond}");
            }
        }

        /// Nonnegative least squares: no gradient where there is a share, none that would help where there is none.
        #[test]
        fn nonnegative_fits_are_optimal(numbers in prop::collection::vec(-1.0..1.0, 5 * 7)) {
            let columns: Vec<Vec<f64>> = numbers.chunks(5).skip(1).map(<[f64]>::to_vec).collect();
            let x = nonnegative_least_squares(&columns, &numbers[..5]);
            let rest = residual(&columns, &numbers[..5], &x);
            for (column, x) in columns.iter().zip(&x) {
                let gradient = dot(column, &rest);
                prop_assert!(*x >= 0.0 && gradient < 1e-8, "{x} {gradient}");
                prop_assert!(x * gradient.abs() < 1e-8 * (1.0 + x * x), "{x} {gradient}");
            }
        }
    }
}
