//! Values and derivatives between samples, by the polynomial through the nearest ones (Fornberg, Math. Comp. 51, 1988).
//!
//! In: instants of a segment. Out: weights of its samples. Sees no values.

use super::thresholds::STENCIL_POINTS;

/// Number of derivatives, from order 0 to order 3.
pub(super) const DERIVATIVES: usize = 4;

/// Weights of `stencil_points` samples from `first` on, for each order of derivative.
pub(super) struct Stencil {
    pub first: usize,
    pub weights: [[f64; STENCIL_POINTS]; DERIVATIVES],
}

impl Stencil {
    /// At instant `at`, between sample `interval` and the next; the segment has at least `stencil_points` samples.
    pub fn new(time: &[f64], interval: usize, at: f64) -> Stencil {
        let half = STENCIL_POINTS / 2 - 1;
        let first = interval
            .saturating_sub(half)
            .min(time.len().saturating_sub(STENCIL_POINTS));
        Stencil {
            first,
            weights: fornberg(&time[first..first + STENCIL_POINTS], at),
        }
    }

    /// The derivative of this order of the polynomial through `values`.
    pub fn apply(&self, order: usize, values: &[f64]) -> f64 {
        let window = &values[self.first..self.first + STENCIL_POINTS];
        self.weights[order]
            .iter()
            .zip(window)
            .map(|(w, v)| w * v)
            .sum()
    }
}

/// Weights for every order at `at`, by Fornberg's recursion and in his letters.
fn fornberg(x: &[f64], at: f64) -> [[f64; STENCIL_POINTS]; DERIVATIVES] {
    let mut c = [[0.0; STENCIL_POINTS]; DERIVATIVES];
    c[0][0] = 1.0;
    let (mut c1, mut c4) = (1.0, x[0] - at);
    for i in 1..STENCIL_POINTS {
        let most = i.min(DERIVATIVES - 1);
        let (mut c2, c5) = (1.0, c4);
        c4 = x[i] - at;
        for j in 0..i {
            let c3 = x[i] - x[j];
            c2 *= c3;
            if j == i - 1 {
                for k in (1..=most).rev() {
                    c[k][i] = c1 * (k as f64 * c[k - 1][i - 1] - c5 * c[k][i - 1]) / c2;
                }
                c[0][i] = -c1 * c5 * c[0][i - 1] / c2;
            }
            for k in (1..=most).rev() {
                c[k][j] = (c4 * c[k][j] - k as f64 * c[k - 1][j]) / c3;
            }
            c[0][j] = c4 * c[0][j] / c3;
        }
        c1 = c2;
    }
    c
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_of_degree_seven_and_their_derivatives_are_exact_on_uneven_times() {
        let time: Vec<f64> = (0..20).map(|i| f64::from(i).powf(1.1)).collect();
        let (at, interval) = (7.3, 6);
        let f = |t: f64| 0.3 * (t - 6.0).powi(7) + t * t;
        let values: Vec<f64> = time.iter().map(|t| f(*t)).collect();
        let stencil = Stencil::new(&time, interval, at);
        let s: f64 = at - 6.0;
        let wanted = [
            f(at),
            2.1 * s.powi(6) + 2.0 * at,
            12.6 * s.powi(5) + 2.0,
            63.0 * s.powi(4),
        ];
        for (order, wanted) in wanted.into_iter().enumerate() {
            let got = stencil.apply(order, &values);
            assert!((got - wanted).abs() < 1e-9 * wanted.abs(), "{order}: {got}");
        }
    }
}
