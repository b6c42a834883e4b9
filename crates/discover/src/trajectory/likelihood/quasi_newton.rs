//! Minimisation of a smooth function of a few numbers by the method of Broyden, Fletcher, Goldfarb and Shanno (Nocedal & Wright 2006,
//! section 6.1), with slopes from differences.
//!
//! In: the function, a start, bounds. Out: the point found and its value. Knows nothing of what the numbers mean.

use crate::trajectory::thresholds::QUASI_NEWTON;

/// A point and the function's value there.
#[derive(Clone, Debug)]
pub(super) struct Minimum {
    pub at: Vec<f64>,
    pub value: f64,
}

/// Minimises `f` from `start` within bounds, until a step promises less than `converged`. `curvature` is a guess of the second derivatives.
pub(super) fn minimise(
    f: &mut dyn FnMut(&[f64]) -> f64,
    start: Vec<f64>,
    bounds: &[(f64, f64)],
    (curvature, converged): (f64, f64),
) -> Minimum {
    let n = start.len();
    let inside = |x: &mut Vec<f64>| {
        let all = x.iter_mut().zip(bounds);
        all.for_each(|(x, (low, high))| *x = x.clamp(*low, *high));
    };
    let mut at = start;
    inside(&mut at);
    let mut value = f(&at);
    let mut inverse = identity(n, 1.0 / curvature);
    let mut slope = slopes(f, &at, value, bounds);
    for _ in 0..QUASI_NEWTON.max_steps {
        let mut step: Vec<f64> = (0..n)
            .map(|i| -(0..n).map(|j| inverse[i * n + j] * slope[j]).sum::<f64>())
            .collect();
        let promised: f64 = -0.5 * step.iter().zip(&slope).map(|(s, g)| s * g).sum::<f64>();
        if promised.is_nan() || promised < converged {
            break;
        }
        let longest = step.iter().fold(0.0f64, |m, s| m.max(s.abs()));
        let shrink = (QUASI_NEWTON.longest_step / longest).min(1.0);
        step.iter_mut().for_each(|s| *s *= shrink);
        let Some(next) = line_search(f, (&at, value), &step, &inside) else {
            break;
        };
        let new = slopes(f, &next.at, next.value, bounds);
        let moved: Vec<f64> = next.at.iter().zip(&at).map(|(a, b)| a - b).collect();
        let turned: Vec<f64> = new.iter().zip(&slope).map(|(a, b)| a - b).collect();
        update(&mut inverse, &moved, &turned);
        (at, value, slope) = (next.at, next.value, new);
    }
    Minimum { at, value }
}

/// The first of ever shorter steps that goes downhill.
fn line_search(
    f: &mut dyn FnMut(&[f64]) -> f64,
    (at, value): (&[f64], f64),
    step: &[f64],
    inside: &dyn Fn(&mut Vec<f64>),
) -> Option<Minimum> {
    let mut length = 1.0;
    for _ in 0..QUASI_NEWTON.max_halvings {
        let mut next: Vec<f64> = at.iter().zip(step).map(|(x, s)| x + length * s).collect();
        inside(&mut next);
        let there = f(&next);
        if there < value {
            return Some(Minimum {
                at: next,
                value: there,
            });
        }
        length *= 0.5;
    }
    None
}

/// Forward differences, backward at an upper bound; 0 where the slope only leads out of the bounds.
fn slopes(
    f: &mut dyn FnMut(&[f64]) -> f64,
    at: &[f64],
    value: f64,
    bounds: &[(f64, f64)],
) -> Vec<f64> {
    let mut x = at.to_vec();
    let mut out = Vec::with_capacity(at.len());
    for (i, (low, high)) in bounds.iter().enumerate() {
        let forward = at[i] + QUASI_NEWTON.difference <= *high;
        let by = if forward { 1.0 } else { -1.0 } * QUASI_NEWTON.difference;
        x[i] = at[i] + by;
        let slope = (f(&x) - value) / by;
        x[i] = at[i];
        let leads_out = (at[i] <= *low && slope > 0.0) || (at[i] >= *high && slope < 0.0);
        out.push(if leads_out { 0.0 } else { slope });
    }
    out
}

/// The update of the inverse second derivatives, which stay positive definite.
fn update(inverse: &mut [f64], moved: &[f64], turned: &[f64]) {
    let n = moved.len();
    let along: f64 = moved.iter().zip(turned).map(|(s, y)| s * y).sum();
    if along.is_nan() || along <= f64::MIN_POSITIVE {
        return;
    }
    let hy: Vec<f64> = (0..n)
        .map(|i| (0..n).map(|j| inverse[i * n + j] * turned[j]).sum())
        .collect();
    let yhy: f64 = turned.iter().zip(&hy).map(|(y, h)| y * h).sum();
    for i in 0..n {
        for j in 0..n {
            inverse[i * n + j] += (1.0 + yhy / along) * moved[i] * moved[j] / along
                - (hy[i] * moved[j] + moved[i] * hy[j]) / along;
        }
    }
}

fn identity(n: usize, value: f64) -> Vec<f64> {
    let mut out = vec![0.0; n * n];
    out.iter_mut().step_by(n + 1).for_each(|x| *x = value);
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curved_valley_is_followed_to_its_end() {
        let mut f = |x: &[f64]| 10.0 * (x[1] - x[0] * x[0]).powi(2) + (1.0 - x[0]).powi(2);
        let bounds = [(-3.0, 3.0), (-3.0, 3.0)];
        let found = minimise(&mut f, vec![-1.0, 0.5], &bounds, (1.0, 1e-8));
        // Differences of 1e-3 see the end of the valley, which is twenty times as steep across as along it, a few hundredths off.
        let off = found.at.iter().map(|x| (x - 1.0).abs());
        assert!(off.fold(0.0, f64::max) < 0.06, "{found:?}");
        assert!(found.value < 2e-3, "{found:?}");
    }

    #[test]
    fn a_bound_is_kept() {
        let mut f = |x: &[f64]| (x[0] - 2.0).powi(2) + (x[1] + x[0]).powi(2);
        let bounds = [(-1.0, 1.0), (-0.5, 5.0)];
        let found = minimise(&mut f, vec![0.0, 0.0], &bounds, (1.0, 1e-10));
        assert!((found.at[1] + 0.5).abs() < 1e-3, "{found:?}");
        assert!((found.at[0] - 1.0).abs() < 1e-3, "{found:?}");
    }
}
