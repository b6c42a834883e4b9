//! Weights of local polynomials: derivatives at one instant as sums over a window of samples.
//!
//! In: the window's times, as many as one likes, evenly spaced or not. Out: weights. Knows no values.
//!
//! A polynomial of degree p is fitted to n points by least squares (interpolated if p = n − 1) in a basis orthonormal on
//! the window, built by Stieltjes' three-term recurrence with one reorthogonalisation, so that high degrees keep their
//! digits (Gautschi, Orthogonal Polynomials, 2004, §2.2). Every basis polynomial carries its derivatives at the instant.

/// Highest derivative that is estimated.
pub(super) const ORDERS: usize = 3;

/// A polynomial orthonormal on the window: its values at the points, and itself and its derivatives at the instant.
#[derive(Clone, Debug)]
struct Basis {
    values: Vec<f64>,
    at: [f64; ORDERS + 1],
}

/// The orthonormal polynomials of degree 0…`degree` on the points `tau` (increasing), seen from `tau = 0`.
///
/// For good digits `tau` should be of order 1. `degree` < number of points.
fn orthonormal(tau: &[f64], degree: usize) -> Vec<Basis> {
    let n = tau.len();
    let mut basis: Vec<Basis> = Vec::with_capacity(degree + 1);
    let mut next = Basis {
        values: vec![1.0; n],
        at: [1.0, 0.0, 0.0, 0.0],
    };
    for _ in 0..=degree {
        for _ in 0..2 {
            for q in &basis {
                let overlap = dot(&q.values, &next.values);
                for (v, u) in next.values.iter_mut().zip(&q.values) {
                    *v -= overlap * u;
                }
                for (v, u) in next.at.iter_mut().zip(&q.at) {
                    *v -= overlap * u;
                }
            }
        }
        let norm = dot(&next.values, &next.values).sqrt();
        next.values.iter_mut().for_each(|v| *v /= norm);
        next.at.iter_mut().for_each(|v| *v /= norm);
        // (τ q)⁽ᵏ⁾ = τ q⁽ᵏ⁾ + k q⁽ᵏ⁻¹⁾, at τ = 0.
        let [a0, a1, a2, _] = next.at;
        let raised = Basis {
            values: next.values.iter().zip(tau).map(|(v, t)| v * t).collect(),
            at: [0.0, a0, 2.0 * a1, 3.0 * a2],
        };
        basis.push(std::mem::replace(&mut next, raised));
    }
    basis
}

/// The unit contrast on k + 1 points that every polynomial of degree below k is orthogonal to: a k-th divided difference.
pub(super) fn difference(tau: &[f64]) -> Vec<f64> {
    let k = tau.len().saturating_sub(1);
    orthonormal(tau, k).pop().map_or(Vec::new(), |q| q.values)
}

/// How one derivative is taken at one sample, and how its error is judged.
#[derive(Clone, Debug)]
pub(super) struct Stencil {
    /// First sample of the window, counted from the sample itself.
    pub first: isize,
    /// Estimate = Σ weights · values.
    pub weights: Vec<f64>,
    /// ‖weights‖: the estimate's standard error under unit white noise.
    pub norm: f64,
    /// Unit vector along the difference to a finer estimate: what the fit has left of the next degrees.
    pub contrast: Vec<f64>,
    /// Length of that difference.
    pub reach: f64,
}

/// Which polynomials make a stencil.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Choice {
    pub points: usize,
    pub degree: usize,
}

/// The window of `n` samples nearest to sample `i` within `a..b`; it is one-sided at the ends.
pub(super) fn window(i: usize, n: usize, a: usize, b: usize) -> usize {
    i.saturating_sub(n / 2).clamp(a, b.saturating_sub(n).max(a))
}

/// Judged stencil of derivative `order` at sample `i` of the stretch `a..b` (b − a ≥ points > degree ≥ 1).
///
/// The finer estimate is two degrees higher: on the same window if it has the points, else on the next wider one. In a
/// stretch too short for either, the coarser estimate one degree lower stands in, which overrates the error.
pub(super) fn stencil(
    time: &[f64],
    i: usize,
    (a, b): (usize, usize),
    choice: Choice,
    order: usize,
) -> Stencil {
    let Choice { points, degree } = choice;
    let length = b - a;
    let fine_points = points.max(degree + 3);
    let (wide, other) = if fine_points <= length {
        (fine_points, degree + 2)
    } else {
        (points, degree - 1)
    };
    let start = window(i, wide, a, b);
    let inner = window(i, points, a, b) - start;
    let taus = scaled(time, i, start, wide);
    let narrow = taus.0.get(inner..inner + points).unwrap_or(&[]);
    let scale = taus.1.powi(-(order as i32));
    let mut weights = vec![0.0; wide];
    let fitted = fit_weights(narrow, degree, order);
    for (w, f) in weights.iter_mut().skip(inner).zip(fitted) {
        *w = f * scale;
    }
    let judge = if other < order {
        // A polynomial of lower degree has no such derivative: the whole estimate is in doubt.
        vec![0.0; wide]
    } else {
        fit_weights(&taus.0, other, order)
    };
    let mut contrast: Vec<f64> = judge
        .iter()
        .zip(&weights)
        .map(|(j, w)| j * scale - w)
        .collect();
    let reach = dot(&contrast, &contrast).sqrt();
    if reach > 0.0 {
        contrast.iter_mut().for_each(|c| *c /= reach);
    }
    Stencil {
        first: start as isize - i as isize,
        norm: dot(&weights, &weights).sqrt(),
        weights,
        contrast,
        reach,
    }
}

/// Times of a window about sample `i`, in units of half its width, and that unit in seconds.
fn scaled(time: &[f64], i: usize, start: usize, n: usize) -> (Vec<f64>, f64) {
    let here = time.get(i).copied().unwrap_or(0.0);
    let window = time.get(start..start + n).unwrap_or(&[]);
    let ends = window.first().zip(window.last());
    let unit = ends
        .map_or(1.0, |(f, l)| 0.5 * (l - f))
        .max(f64::MIN_POSITIVE);
    (window.iter().map(|t| (t - here) / unit).collect(), unit)
}

fn fit_weights(tau: &[f64], degree: usize, order: usize) -> Vec<f64> {
    let mut weights = vec![0.0; tau.len()];
    for q in orthonormal(tau, degree) {
        let slope = q.at.get(order).copied().unwrap_or(0.0);
        for (w, v) in weights.iter_mut().zip(&q.values) {
            *w += slope * v;
        }
    }
    weights
}

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn apply(s: &Stencil, i: usize, f: &dyn Fn(usize) -> f64) -> f64 {
        let first = (i as isize + s.first) as usize;
        s.weights
            .iter()
            .enumerate()
            .map(|(j, w)| w * f(first + j))
            .sum()
    }

    #[test]
    fn five_points_give_the_classical_weights() {
        let time: Vec<f64> = (0..9).map(|k| k as f64).collect();
        let choice = Choice {
            points: 5,
            degree: 4,
        };
        let s = stencil(&time, 4, (0, 9), choice, 1);
        let want = [
            0.0,
            1.0 / 12.0,
            -8.0 / 12.0,
            0.0,
            8.0 / 12.0,
            -1.0 / 12.0,
            0.0,
        ];
        for (w, v) in s.weights.iter().zip(want) {
            assert!((w - v).abs() < 1e-14, "{:?}", s.weights);
        }
    }

    proptest! {
        /// Derivatives of polynomials up to the stencil's degree are exact on uneven times, ends included.
        #[test]
        fn exact_on_polynomials(
            steps in prop::collection::vec(0.5f64..1.5, 24),
            coefficients in prop::collection::vec(-1.0f64..1.0, 13),
            i in 0usize..24,
            half in 1usize..7,
            extra in 0usize..8,
            order in 1usize..=3,
        ) {
            let mut t = 0.0;
            let time: Vec<f64> = steps.iter().map(|s| { t += 0.1 * s; t }).collect();
            let choice = Choice { points: 2 * half + 1 + extra, degree: 2 * half };
            prop_assume!(choice.degree >= order);
            let value = |t: f64, d: usize| -> f64 {
                (d..=choice.degree)
                    .map(|p| {
                        let falling: f64 = (p - d + 1..=p).map(|q| q as f64).product();
                        coefficients[p] * falling * t.powi((p - d) as i32)
                    })
                    .sum()
            };
            let s = stencil(&time, i, (0, 24), choice, order);
            let got = apply(&s, i, &|j| value(time[j], 0));
            let size: f64 = s.weights.iter().map(|w| w.abs()).sum::<f64>() * 1e3;
            prop_assert!((got - value(time[i], order)).abs() < 1e-14 * size + 1e-12);
        }
    }
}
