//! Stencils of local polynomials: a derivative at one instant as a weighted sum over a window of samples.
//!
//! In: the times of a window, evenly spaced or not. Out: weights. Knows no values.
//!
//! A polynomial of degree p is fitted to n points by least squares, or interpolates them if p = n − 1 (Savitzky and Golay
//! 1964, Analytical Chemistry 36, for even times).

use std::collections::BTreeMap;
use std::rc::Rc;

use super::orthonormal_polynomials::{OrthonormalBasis, dot};
use crate::time_axis::TimeGrid;

/// Highest degree on windows of more than 15 points.
const MAX_LEAST_SQUARES_DEGREE: usize = 10;

/// How one derivative is estimated at one sample, and how its error is seen.
#[derive(Clone, Debug)]
pub(super) struct Stencil {
    /// First sample of the window, counted from the sample itself.
    pub first: isize,
    /// Estimate = Σ weights · values.
    pub weights: Vec<f64>,
    /// ‖weights‖: the estimate's standard error under unit white noise.
    pub norm: f64,
    /// Unit vector along the difference to the weights of a finer fit: it shows what the fit missed of the next degrees.
    pub contrast: Vec<f64>,
    /// Length of that difference.
    pub contrast_norm: f64,
}

/// A local polynomial: its number of points and its degree, which is at most 8 beyond 15 points.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct LocalFit {
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
    basis: Rc<OrthonormalBasis>,
    /// Middle and half width, seconds.
    middle: f64,
    half: f64,
}

/// Computes stencils on one grid; equal windows share their basis.
pub(super) struct Stencils<'a> {
    grid: &'a TimeGrid,
    order: usize,
    /// Even grids: one basis for each number of points.
    even: BTreeMap<usize, Rc<OrthonormalBasis>>,
    /// Uneven grids: the last windows used, by start and points.
    recent: Vec<((usize, usize), Window)>,
}

impl<'a> Stencils<'a> {
    pub(super) fn new(grid: &'a TimeGrid, order: usize) -> Self {
        Stencils {
            grid,
            order,
            even: BTreeMap::new(),
            recent: Vec::new(),
        }
    }

    /// Stencil at sample `i` of the segment `a..b` (b − a ≥ points > degree ≥ 1).
    ///
    /// The finer fit has two degrees more, on the same window if that has enough points, else on the next wider one. In a
    /// segment too short for either, a fit two degrees lower is used, which overrates the error. One degree lower would not do:
    /// in the middle of a window it has the same slope.
    pub(super) fn at(&mut self, i: usize, (a, b): (usize, usize), choice: LocalFit) -> Stencil {
        let LocalFit { points, degree } = choice;
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
            // A polynomial of lower degree has no such derivative, so the whole estimate is in doubt.
            vec![0.0; wide]
        } else {
            let choice = LocalFit {
                points: wide,
                degree: other,
            };
            self.weights(i, start, choice)
        };
        let mut contrast: Vec<f64> = judge.iter().zip(&weights).map(|(j, w)| j - w).collect();
        let contrast_norm = dot(&contrast, &contrast).sqrt();
        if contrast_norm > 0.0 {
            contrast.iter_mut().for_each(|c| *c /= contrast_norm);
        }
        Stencil {
            first: start as isize - i as isize,
            norm: dot(&weights, &weights).sqrt(),
            weights,
            contrast,
            contrast_norm,
        }
    }

    fn weights(&mut self, i: usize, start: usize, choice: LocalFit) -> Vec<f64> {
        let Window {
            basis,
            middle,
            half,
        } = self.window(start, choice.points);
        let here = self.grid.time().get(i).copied().unwrap_or(0.0);
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
        let time = self.grid.time().get(start..start + points).unwrap_or(&[]);
        let (first, last) = match (time.first(), time.last()) {
            (Some(f), Some(l)) => (*f, *l),
            _ => (-1.0, 1.0),
        };
        let (middle, half) = (0.5 * (first + last), 0.5 * (last - first));
        let degree = if points <= 15 {
            points - 1
        } else {
            MAX_LEAST_SQUARES_DEGREE
        };
        let basis = if self.grid.is_even() {
            let even = || {
                let n = (points - 1) as f64;
                let tau: Vec<f64> = (0..points).map(|j| 2.0 * j as f64 / n - 1.0).collect();
                Rc::new(OrthonormalBasis::new(&tau, degree))
            };
            self.even.entry(points).or_insert_with(even).clone()
        } else {
            let tau: Vec<f64> = time.iter().map(|t| (t - middle) / half).collect();
            Rc::new(OrthonormalBasis::new(&tau, degree))
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
        let choice = LocalFit {
            points: 5,
            degree: 4,
        };
        let s = Stencils::new(&TimeGrid::new(&time), 1).at(4, (0, 9), choice);
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
            let choice = LocalFit { points: 2 * half + 1 + extra, degree: 2 * half };
            prop_assume!(choice.degree >= order);
            prop_assume!(choice.points <= 15 || choice.degree + 2 <= MAX_LEAST_SQUARES_DEGREE);
            // About the point itself, so that no power of a large time hides the weights' own error.
            let value = |t: f64, d: usize| -> f64 {
                (d..=choice.degree)
                    .map(|p| {
                        let falling: f64 = (p - d + 1..=p).map(|q| q as f64).product();
                        coefficients[p] * falling * (t - time[i]).powi((p - d) as i32)
                    })
                    .sum()
            };
            let s = Stencils::new(&TimeGrid::new(&time), order).at(i, (0, 24), choice);
            let got = apply(&s, i, &|j| value(time[j], 0));
            let first = (i as isize + s.first) as usize;
            let window = &time[first..first + s.weights.len()];
            let length = window.iter().map(|t| value(*t, 0).powi(2)).sum::<f64>().sqrt();
            // ‖weights‖ · ‖values‖ bounds what rounding does: 180,000 draws stayed below 5.3e-16 of it.
            prop_assert!((got - value(time[i], order)).abs() < 1e-14 * s.norm * length);
        }
    }
}
