//! Weights of local polynomials: derivatives at one instant as sums over a window of samples.
//!
//! In: the window's times, as many as one likes, evenly spaced or not. Out: weights. Knows no values.
//!
//! A polynomial of degree p is fitted to n points by least squares (interpolated if p = n − 1) in a basis orthonormal on
//! the window, built by Stieltjes' three-term recurrence with reorthogonalisation, so that high degrees keep their digits
//! (Gautschi, Orthogonal Polynomials, 2004, §2.2).

use std::collections::BTreeMap;
use std::rc::Rc;

use super::Grid;

/// Highest derivative that is estimated.
const ORDERS: usize = 3;
/// Highest degree on windows of more than 15 points.
const DEGREES: usize = 10;

/// The orthonormal polynomials on a window, and how each was made from those before it.
#[derive(Debug)]
struct Basis {
    /// Values of each polynomial at the window's points.
    values: Vec<Vec<f64>>,
    /// q_k = (τ q_{k−1} − Σ overlaps_j q_j) / norm
    recurrence: Vec<(Vec<f64>, f64)>,
}

impl Basis {
    /// Degrees 0…`degree` on the points `tau`, increasing and of order 1; `degree` < number of points.
    fn new(tau: &[f64], degree: usize) -> Self {
        let mut basis = Basis {
            values: Vec::with_capacity(degree + 1),
            recurrence: Vec::with_capacity(degree + 1),
        };
        let mut next = vec![1.0; tau.len()];
        for _ in 0..=degree {
            let mut overlaps = vec![0.0; basis.values.len()];
            for _ in 0..2 {
                for (q, sum) in basis.values.iter().zip(&mut overlaps) {
                    let overlap = dot(q, &next);
                    next.iter_mut().zip(q).for_each(|(v, u)| *v -= overlap * u);
                    *sum += overlap;
                }
            }
            let norm = dot(&next, &next).sqrt();
            next.iter_mut().for_each(|v| *v /= norm);
            let raised = next.iter().zip(tau).map(|(v, t)| v * t).collect();
            basis.values.push(std::mem::replace(&mut next, raised));
            basis.recurrence.push((overlaps, norm));
        }
        basis
    }

    /// Weights of derivative `order` at `x` of the fit of `degree`, in the window's units.
    fn weights(&self, degree: usize, order: usize, x: f64) -> Vec<f64> {
        let points = self.values.first().map_or(0, Vec::len);
        let mut weights = vec![0.0; points];
        let mut made: Vec<[f64; ORDERS + 1]> = Vec::with_capacity(degree + 1);
        for ((overlaps, norm), values) in self.recurrence.iter().zip(&self.values).take(degree + 1)
        {
            // (τ q)⁽ᵏ⁾ = τ q⁽ᵏ⁾ + k q⁽ᵏ⁻¹⁾
            let mut at = match made.last() {
                Some([a0, a1, a2, a3]) => {
                    [x * a0, x * a1 + a0, x * a2 + 2.0 * a1, x * a3 + 3.0 * a2]
                }
                None => [1.0, 0.0, 0.0, 0.0],
            };
            for (overlap, before) in overlaps.iter().zip(&made) {
                at.iter_mut()
                    .zip(before)
                    .for_each(|(v, u)| *v -= overlap * u);
            }
            at.iter_mut().for_each(|v| *v /= norm);
            let slope = at.get(order).copied().unwrap_or(0.0);
            weights
                .iter_mut()
                .zip(values)
                .for_each(|(w, v)| *w += slope * v);
            made.push(at);
        }
        weights
    }
}

/// The unit contrast on k + 1 points that every polynomial of degree below k is orthogonal to: a k-th divided difference.
pub(super) fn difference(tau: &[f64]) -> Vec<f64> {
    let k = tau.len().saturating_sub(1);
    Basis::new(tau, k).values.pop().unwrap_or_default()
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

/// Which polynomials make a stencil: of degree 8 or less beyond 15 points.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Choice {
    pub points: usize,
    pub degree: usize,
}

/// The window of `n` samples nearest to sample `i` within `a..b`; it is one-sided at the ends.
pub(super) fn window(i: usize, n: usize, a: usize, b: usize) -> usize {
    i.saturating_sub(n / 2).clamp(a, b.saturating_sub(n).max(a))
}

/// A window's basis and its time scale.
#[derive(Clone, Debug)]
struct Window {
    basis: Rc<Basis>,
    /// Middle and half width, seconds.
    middle: f64,
    half: f64,
}

/// Makes stencils on one grid; windows that look alike share their basis.
pub(super) struct Stencils<'a> {
    grid: &'a Grid,
    order: usize,
    /// Even grids: one basis for each number of points.
    even: BTreeMap<usize, Rc<Basis>>,
    /// Uneven grids: the last windows used, by start and points.
    recent: Vec<((usize, usize), Window)>,
}

impl<'a> Stencils<'a> {
    pub(super) fn new(grid: &'a Grid, order: usize) -> Self {
        Stencils {
            grid,
            order,
            even: BTreeMap::new(),
            recent: Vec::new(),
        }
    }

    /// Judged stencil at sample `i` of the stretch `a..b` (b − a ≥ points > degree ≥ 1).
    ///
    /// The finer estimate is two degrees higher: on the same window if it has the points, else on the next wider one. In a
    /// stretch too short for either, the coarser estimate two degrees lower stands in, which overrates the error (one degree
    /// lower would not do: in the middle of a window it has the same slope).
    pub(super) fn at(&mut self, i: usize, (a, b): (usize, usize), choice: Choice) -> Stencil {
        let Choice { points, degree } = choice;
        let fine_points = points.max(degree + 3);
        let (wide, other) = if fine_points <= b - a {
            (fine_points, degree + 2)
        } else {
            (points, degree.saturating_sub(2))
        };
        let start = window(i, wide, a, b);
        let inner = window(i, points, a, b);
        let mut weights = vec![0.0; wide];
        let fitted = self.weights(i, inner, choice);
        for (w, f) in weights.iter_mut().skip(inner - start).zip(fitted) {
            *w = f;
        }
        let judge = if other < self.order {
            // A polynomial of lower degree has no such derivative: the whole estimate is in doubt.
            vec![0.0; wide]
        } else {
            let choice = Choice {
                points: wide,
                degree: other,
            };
            self.weights(i, start, choice)
        };
        let mut contrast: Vec<f64> = judge.iter().zip(&weights).map(|(j, w)| j - w).collect();
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

    fn weights(&mut self, i: usize, start: usize, choice: Choice) -> Vec<f64> {
        let Window {
            basis,
            middle,
            half,
        } = self.window(start, choice.points);
        let here = self.grid.time.get(i).copied().unwrap_or(0.0);
        let x = (here - middle) / half;
        let scale = half.powi(-(self.order as i32));
        let mut weights = basis.weights(choice.degree, self.order, x);
        weights.iter_mut().for_each(|w| *w *= scale);
        weights
    }

    fn window(&mut self, start: usize, points: usize) -> Window {
        if let Some((_, w)) = self.recent.iter().find(|(k, _)| *k == (start, points)) {
            return w.clone();
        }
        let time = self.grid.time.get(start..start + points).unwrap_or(&[]);
        let (first, last) = match (time.first(), time.last()) {
            (Some(f), Some(l)) => (*f, *l),
            _ => (-1.0, 1.0),
        };
        let (middle, half) = (0.5 * (first + last), 0.5 * (last - first));
        let degree = if points <= 15 { points - 1 } else { DEGREES };
        let basis = if self.grid.step.is_some() {
            let even = || {
                let n = (points - 1) as f64;
                let tau: Vec<f64> = (0..points).map(|j| 2.0 * j as f64 / n - 1.0).collect();
                Rc::new(Basis::new(&tau, degree))
            };
            self.even.entry(points).or_insert_with(even).clone()
        } else {
            let tau: Vec<f64> = time.iter().map(|t| (t - middle) / half).collect();
            Rc::new(Basis::new(&tau, degree))
        };
        let window = Window {
            basis,
            middle,
            half,
        };
        // The two windows of one stencil, and those of its neighbour at an end of the record.
        if self.recent.len() >= 4 {
            self.recent.remove(0);
        }
        self.recent.push(((start, points), window.clone()));
        window
    }
}

/// Σ aᵢ bᵢ in four interleaved sums: the order is fixed, and the processor need not wait for each addition.
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (mut x, mut y) = (a.chunks_exact(4), b.chunks_exact(4));
    let mut sums = [0.0; 4];
    for (p, q) in x.by_ref().zip(y.by_ref()) {
        for ((s, u), v) in sums.iter_mut().zip(p).zip(q) {
            *s += u * v;
        }
    }
    let rest = x.remainder().iter().zip(y.remainder());
    let [a, b, c, d] = sums;
    (a + b) + (c + d) + rest.map(|(u, v)| u * v).sum::<f64>()
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
        let s = Stencils::new(&Grid::new(&time), 1).at(4, (0, 9), choice);
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
            prop_assume!(choice.points <= 15 || choice.degree + 2 <= DEGREES);
            let value = |t: f64, d: usize| -> f64 {
                (d..=choice.degree)
                    .map(|p| {
                        let falling: f64 = (p - d + 1..=p).map(|q| q as f64).product();
                        coefficients[p] * falling * t.powi((p - d) as i32)
                    })
                    .sum()
            };
            let s = Stencils::new(&Grid::new(&time), order).at(i, (0, 24), choice);
            let got = apply(&s, i, &|j| value(time[j], 0));
            let size: f64 = s.weights.iter().map(|w| w.abs()).sum::<f64>() * 1e3;
            prop_assert!((got - value(time[i], order)).abs() < 1e-14 * size + 1e-12);
        }
    }
}
