//! How residuals follow each other, and what that does to the variance of a weighted sum of them.
//!
//! In: series of residuals. Out: an autoregression u_k = e_k − Σ a_i e_{k−i} that leaves white u, its order by the Bayesian
//! criterion (Berk, Annals of Statistics 1974; as an estimate of covariances den Haan & Levin 1997). A coefficient of least
//! squares is a weighted sum of the errors, so this is its variance where errors are not white. Never judges whether they should be.

/// Longest memory looked for, in rows: so many times log₁₀ of the number of rows (Schwert 1989).
const LONGEST: f64 = 10.0;
/// A sum is followed before the first row until its weights are this part of their largest.
const FADED: f64 = 1e-3;
/// Rows before the first that it is followed over at most, or as many as there are.
const BEFORE: usize = 1000;

/// The memory of a series: none, or an autoregression.
#[derive(Clone, Debug, PartialEq)]
pub struct Memory {
    /// a_1, a_2, …: empty for white series.
    follows: Vec<f64>,
    /// Variance of u over that of e.
    fresh: f64,
}

impl Memory {
    /// Of residuals in pieces, none of which follows another; zeros where there is none.
    pub fn of(pieces: &[Vec<f64>]) -> Memory {
        let white = Memory {
            follows: Vec::new(),
            fresh: 1.0,
        };
        let rows = pieces.iter().map(Vec::len).sum::<usize>() as f64;
        let longest = (LONGEST * rows.max(1.0).log10()).min(rows / 4.0) as usize;
        let square = lagged(pieces, 0);
        if square.is_nan() || square <= 0.0 {
            return white;
        }
        let correlations: Vec<f64> = (0..=longest).map(|l| lagged(pieces, l) / square).collect();
        let cost = |m: &Memory| rows * m.fresh.ln() + m.follows.len() as f64 * rows.ln();
        let mut best = white.clone();
        let mut current = white;
        for order in 1..=longest {
            current = current.longer(&correlations, order);
            // Also false for series that one value tells all of.
            let usable = current.fresh > f64::EPSILON;
            if !usable {
                break;
            }
            if cost(&current) < cost(&best) {
                best = current.clone();
            }
        }
        best
    }

    /// One lag more, by the recursion of Levinson and Durbin. `self` has the lags before `order`.
    fn longer(&self, correlations: &[f64], order: usize) -> Memory {
        let told = self.follows.iter().zip(correlations[1..order].iter().rev());
        let told: f64 = told.map(|(a, r)| a * r).sum();
        let new = (correlations[order] - told) / self.fresh;
        let pairs = self.follows.iter().zip(self.follows.iter().rev());
        let mut follows: Vec<f64> = pairs.map(|(a, b)| a - new * b).collect();
        follows.push(new);
        Memory {
            follows,
            fresh: self.fresh * (1.0 - new * new),
        }
    }

    /// Variance of Σ w_k e_k over that of a single e, along one piece: Σ v² of the weights v with which the white u enter, found backwards
    /// from the last row. For white series Σ w².
    pub fn square(&self, weights: &[f64]) -> f64 {
        let order = self.follows.len();
        if order == 0 {
            return weights.iter().map(|w| w * w).sum();
        }
        // v_k = w_k + Σ a_i v_{k+i}, the newest in front.
        let mut later = vec![0.0; order];
        let (mut sum, mut largest) = (0.0, 0.0f64);
        let before = std::iter::repeat_n(&0.0, weights.len().max(BEFORE));
        for (k, w) in weights.iter().rev().chain(before).enumerate() {
            let followed: f64 = self.follows.iter().zip(&later).map(|(a, v)| a * v).sum();
            let v = w + followed;
            later.rotate_right(1);
            later[0] = v;
            sum += v * v;
            largest = largest.max(v.abs());
            if k >= weights.len() && later.iter().all(|v| v.abs() <= FADED * largest) {
                break;
            }
        }
        self.fresh * sum
    }
}

/// Σ e_k e_{k+lag}
fn lagged(pieces: &[Vec<f64>], lag: usize) -> f64 {
    let product =
        |p: &Vec<f64>| -> f64 { p.iter().zip(p.iter().skip(lag)).map(|(a, b)| a * b).sum() };
    pieces.iter().map(product).sum()
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
        let memory = Memory::of(&[filtered(20_000, 0.8)]);
        assert!((memory.follows[0] - 0.8).abs() < 0.02, "{memory:?}");
        // A mean of M values varies by (1 + 0.8)/(1 − 0.8)/M; one value by 1 however it came about.
        assert!((memory.square(&[1.0; 10_000]) / 1e4 / 9.0 - 1.0).abs() < 0.05);
        assert!((memory.square(&[1.0]) - 1.0).abs() < 0.01);
        // Alternating weights see nearly nothing of what is slow: (1 − 0.8)/(1 + 0.8).
        let alternating: Vec<f64> = (0..10_000).map(|k| f64::from(1 - 2 * (k % 2))).collect();
        assert!((memory.square(&alternating) / 1e4 * 9.0 - 1.0).abs() < 0.1);
    }

    #[test]
    fn a_filter_of_the_second_order_is_found_whole() {
        let white = filtered(40_000, 0.0);
        let (mut a, mut b) = (0.0, 0.0);
        let step = |u: &f64| {
            (a, b) = (1.2 * a - 0.5 * b + u, a);
            a
        };
        let memory = Memory::of(&[white.iter().map(step).collect()]);
        let [first, second] = memory.follows[..] else {
            panic!("{memory:?}");
        };
        assert!(
            (first - 1.2).abs() < 0.02 && (second + 0.5).abs() < 0.02,
            "{memory:?}"
        );
        // (1 − a₂²)(1 − r₁²) with r₁ = a₁/(1 − a₂)
        assert!(
            (memory.fresh - 0.75 * (1.0 - 0.64)).abs() < 0.02,
            "{memory:?}"
        );
    }

    #[test]
    fn a_short_series_is_not_told_a_long_memory() {
        // A quarter of seven rows is one lag, though the series is all of one wave.
        let memory = Memory::of(&[(0..7).map(|k| f64::from(k).sin()).collect()]);
        assert!(memory.follows.len() <= 1, "{memory:?}");
    }

    #[test]
    fn white_series_have_no_memory_and_nothing_has_none() {
        let white = Memory::of(&[filtered(5_000, 0.0)]);
        assert_eq!(white.follows, Vec::<f64>::new());
        assert_eq!(white.square(&[3.0, 4.0]), 25.0);
        for nothing in [
            vec![],
            vec![vec![]],
            vec![vec![0.0; 9]],
            vec![vec![f64::NAN; 9]],
        ] {
            assert_eq!(Memory::of(&nothing).square(&[2.0]), 4.0);
        }
    }

    #[test]
    fn what_repeats_itself_exactly_ends_in_finite_numbers() {
        let sine: Vec<f64> = (0..2_000).map(|k| (0.1 * f64::from(k)).sin()).collect();
        for series in [vec![1.0; 500], sine] {
            let square = Memory::of(&[series]).square(&[1.0; 500]);
            assert!(square.is_finite() && square >= 0.0, "{square}");
        }
    }
}
