//! Integrals of a sampled function over each of its steps, by polynomials through 2, 4 or 6 samples.
//!
//! In: instants, values, a number of samples. Out: one integral for each step. Steps may be uneven; no sample beyond the ends is used.

/// The most samples that a rule takes.
const MOST: usize = 6;

/// The integral over every step `k … k + 1` of the polynomial through `points` samples around it; one entry less than samples.
pub(super) fn over_steps(time: &[f64], values: &[f64], points: usize) -> Vec<f64> {
    let points = points.min(MOST).min(time.len());
    let mut last: Option<(usize, [f64; MOST])> = None;
    let even = is_even(time);
    (0..time.len().saturating_sub(1))
        .map(|k| {
            let first = (k + 1).saturating_sub(points / 2).min(time.len() - points);
            let step = time[k + 1] - time[k];
            let weights = match last {
                Some((place, weights)) if even && place == k - first => weights,
                _ => unit_weights(&time[first..first + points], time[k], step),
            };
            last = Some((k - first, weights));
            let window = &values[first..first + points];
            step * weights.iter().zip(window).map(|(w, x)| w * x).sum::<f64>()
        })
        .collect()
}

/// Whether all steps are alike to rounding.
pub(super) fn is_even(time: &[f64]) -> bool {
    let (Some(first), Some(last)) = (time.first(), time.last()) else {
        return true;
    };
    let mean = (last - first) / (time.len().max(2) - 1) as f64;
    time.windows(2)
        .all(|w| (w[1] - w[0] - mean).abs() <= 1e-6 * mean)
}

/// Weights of the samples at `time` for the integral of their polynomial from `start` over one `step`, in steps.
fn unit_weights(time: &[f64], start: f64, step: f64) -> [f64; MOST] {
    let n = time.len();
    // Σ w_j s_j^i = 1/(i + 1): the powers are integrated exactly.
    let mut rows = [[0.0; MOST + 1]; MOST];
    for (i, row) in rows.iter_mut().enumerate().take(n) {
        for (entry, t) in row.iter_mut().zip(time) {
            *entry = ((t - start) / step).powi(i as i32);
        }
        row[MOST] = 1.0 / (i + 1) as f64;
    }
    for c in 0..n {
        let largest = |a: &usize, b: &usize| rows[*a][c].abs().total_cmp(&rows[*b][c].abs());
        let pivot = (c..n).max_by(largest).unwrap_or(c);
        rows.swap(c, pivot);
        let own = rows[c];
        for (r, row) in rows.iter_mut().enumerate().take(n) {
            if r != c {
                let factor = row[c] / own[c];
                row.iter_mut().zip(own).for_each(|(x, y)| *x -= factor * y);
            }
        }
    }
    let mut out = [0.0; MOST];
    for c in 0..n {
        out[c] = rows[c][MOST] / rows[c][c];
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_below_the_number_of_points_are_integrated_exactly() {
        let even: Vec<f64> = (0..12).map(|k| 0.1 * f64::from(k)).collect();
        let uneven: Vec<f64> = even.iter().map(|t| t + 0.02 * (37.0 * t).sin()).collect();
        for time in [even, uneven] {
            for points in [2, 4, 6] {
                let degree = points as i32 - 1;
                let values: Vec<f64> = time.iter().map(|t| t.powi(degree)).collect();
                let whole = |t: f64| t.powi(degree + 1) / f64::from(degree + 1);
                for (k, area) in over_steps(&time, &values, points).into_iter().enumerate() {
                    let exact = whole(time[k + 1]) - whole(time[k]);
                    assert!((area - exact).abs() < 1e-12, "{points} points, step {k}");
                }
            }
        }
    }
}
