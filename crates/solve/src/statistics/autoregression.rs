//! Serial correlation of residuals, and the variance of a weighted sum of correlated residuals.
//!
//! In: series of residuals. Out: an autoregression u_k = e_k − Σ a_i e_{k−i} with white u, its order by the Bayesian criterion
//! (Berk, Annals of Statistics 1974; as an estimate of covariances den Haan & Levin 1997). A least-squares coefficient is a
//! weighted sum of the errors, so this gives its variance where errors are not white.

use crate::thresholds::AUTOREGRESSION;

/// An autoregression of order zero (white residuals) or more.
#[derive(Clone, Debug, PartialEq)]
pub struct Autoregression {
    /// a_1, a_2, …; empty for white residuals.
    coefficients: Vec<f64>,
    /// Variance of u over that of e.
    innovation: f64,
}

impl Autoregression {
    /// Fits independent series of residuals. White if there are no residuals or all are zero.
    pub fn fit(series: &[Vec<f64>]) -> Autoregression {
        let white = Autoregression {
            coefficients: Vec::new(),
            innovation: 1.0,
        };
        let rows = series.iter().map(Vec::len).sum::<usize>() as f64;
        let max_order = (AUTOREGRESSION.max_order * rows.max(1.0).log10()).min(rows / 4.0) as usize;
        let square = lagged_product(series, 0);
        if square.is_nan() || square <= 0.0 {
            return white;
        }
        let correlations: Vec<f64> = (0..=max_order)
            .map(|l| lagged_product(series, l) / square)
            .collect();
        let cost =
            |m: &Autoregression| rows * m.innovation.ln() + m.coefficients.len() as f64 * rows.ln();
        let mut best = white.clone();
        let mut current = white;
        for order in 1..=max_order {
            current = current.extended(&correlations, order);
            // Also false for a series that its past determines.
            let usable = current.innovation > f64::EPSILON;
            if !usable {
                break;
            }
            if cost(&current) < cost(&best) {
                best = current.clone();
            }
        }
        best
    }

    /// One order more, by the Levinson–Durbin recursion. `self` has the lags before `order`.
    fn extended(&self, correlations: &[f64], order: usize) -> Autoregression {
        let predicted = self
            .coefficients
            .iter()
            .zip(correlations[1..order].iter().rev());
        let predicted: f64 = predicted.map(|(a, r)| a * r).sum();
        let reflection = (correlations[order] - predicted) / self.innovation;
        let pairs = self.coefficients.iter().zip(self.coefficients.iter().rev());
        let mut coefficients: Vec<f64> = pairs.map(|(a, b)| a - reflection * b).collect();
        coefficients.push(reflection);
        Autoregression {
            coefficients,
            innovation: self.innovation * (1.0 - reflection * reflection),
        }
    }

    /// Variance of Σ w_k e_k over that of a single e, along one series.
    pub fn variance(&self, weights: &[f64]) -> f64 {
        let mut sum = self.weighted_sum();
        weights.iter().rev().for_each(|w| sum.add(*w));
        sum.variance()
    }

    /// A sum of errors along one series that takes its weights one by one.
    pub fn weighted_sum(&self) -> WeightedSum<'_> {
        WeightedSum {
            errors: self,
            later: vec![0.0; self.coefficients.len()],
            square: 0.0,
            largest: 0.0,
            rows: 0,
        }
    }
}

/// Σ w_k e_k over correlated errors e. The innovations u enter it with weights v_k = w_k + Σ a_i v_{k+i}, found backwards from the last row;
/// its variance is that of u times Σ v².
#[derive(Clone, Debug)]
pub struct WeightedSum<'a> {
    errors: &'a Autoregression,
    /// Weights v of the rows after the present one, the nearest in front.
    later: Vec<f64>,
    square: f64,
    largest: f64,
    rows: usize,
}

impl WeightedSum<'_> {
    /// Takes the weight of the row before those taken so far; the last row of the series comes first.
    pub fn add(&mut self, weight: f64) {
        self.rows += 1;
        self.step(weight);
    }

    fn step(&mut self, weight: f64) {
        let later = self.errors.coefficients.iter().zip(&self.later);
        let v = weight + later.map(|(a, v)| a * v).sum::<f64>();
        if let Some(last) = self.later.last_mut() {
            *last = v;
            self.later.rotate_right(1);
        }
        self.square += v * v;
        self.largest = self.largest.max(v.abs());
    }

    /// Variance over that of a single e; for white errors Σ w². Innovations before the first row count too.
    pub fn variance(mut self) -> f64 {
        for _ in 0..self.rows.max(AUTOREGRESSION.rows_before) {
            self.step(0.0);
            let negligible = AUTOREGRESSION.negligible_weight * self.largest;
            if self.later.iter().all(|v| v.abs() <= negligible) {
                break;
            }
        }
        self.errors.innovation * self.square
    }
}

/// Σ e_k e_{k+lag}
fn lagged_product(series: &[Vec<f64>], lag: usize) -> f64 {
    let product =
        |p: &Vec<f64>| -> f64 { p.iter().zip(p.iter().skip(lag)).map(|(a, b)| a * b).sum() };
    series.iter().map(product).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use sidc_random::Numbers;

    /// x_k = 0.8 x_{k−1} + noise, variance about 1.
    fn filtered(rows: usize, memory: f64) -> Vec<f64> {
        let mut numbers = Numbers(7);
        let mut x = 0.0;
        let noise = (3.0 * (1.0 - memory * memory)).sqrt();
        let step = |_| {
            x = memory * x + noise * numbers.next();
            x
        };
        (0..rows).map(step).collect()
    }

    #[test]
    fn a_filter_of_the_first_order_is_found() {
        let fitted = Autoregression::fit(&[filtered(20_000, 0.8)]);
        assert!((fitted.coefficients[0] - 0.8).abs() < 0.02, "{fitted:?}");
        // A mean of M values varies by (1 + 0.8)/(1 − 0.8)/M; one value by 1 however it came about.
        assert!((fitted.variance(&[1.0; 10_000]) / 1e4 / 9.0 - 1.0).abs() < 0.05);
        assert!((fitted.variance(&[1.0]) - 1.0).abs() < 0.01);
        // Alternating weights see nearly nothing of what is slow: (1 − 0.8)/(1 + 0.8).
        let alternating: Vec<f64> = (0..10_000).map(|k| f64::from(1 - 2 * (k % 2))).collect();
        assert!((fitted.variance(&alternating) / 1e4 * 9.0 - 1.0).abs() < 0.1);
    }

    #[test]
    fn a_filter_of_the_second_order_is_found_whole() {
        let white = filtered(40_000, 0.0);
        let (mut a, mut b) = (0.0, 0.0);
        let step = |u: &f64| {
            (a, b) = (1.2 * a - 0.5 * b + u, a);
            a
        };
        let fitted = Autoregression::fit(&[white.iter().map(step).collect()]);
        let [first, second] = fitted.coefficients[..] else {
            panic!("{fitted:?}");
        };
        assert!(
            (first - 1.2).abs() < 0.02 && (second + 0.5).abs() < 0.02,
            "{fitted:?}"
        );
        // (1 − a₂²)(1 − r₁²) with r₁ = a₁/(1 − a₂)
        assert!(
            (fitted.innovation - 0.75 * (1.0 - 0.64)).abs() < 0.02,
            "{fitted:?}"
        );
    }

    #[test]
    fn a_short_series_gets_a_low_order() {
        // A quarter of seven rows is one lag, though the series is all of one wave.
        let fitted = Autoregression::fit(&[(0..7).map(|k| f64::from(k).sin()).collect()]);
        assert!(fitted.coefficients.len() <= 1, "{fitted:?}");
    }

    #[test]
    fn white_and_empty_series_have_order_zero() {
        let white = Autoregression::fit(&[filtered(5_000, 0.0)]);
        assert_eq!(white.coefficients, Vec::<f64>::new());
        assert_eq!(white.variance(&[3.0, 4.0]), 25.0);
        for nothing in [
            vec![],
            vec![vec![]],
            vec![vec![0.0; 9]],
            vec![vec![f64::NAN; 9]],
        ] {
            assert_eq!(Autoregression::fit(&nothing).variance(&[2.0]), 4.0);
        }
    }

    #[test]
    fn periodic_series_give_finite_variances() {
        let sine: Vec<f64> = (0..2_000).map(|k| (0.1 * f64::from(k)).sin()).collect();
        for series in [vec![1.0; 500], sine] {
            let square = Autoregression::fit(&[series]).variance(&[1.0; 500]);
            assert!(square.is_finite() && square >= 0.0, "{square}");
        }
    }
}
