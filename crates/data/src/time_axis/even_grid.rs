//! Times that were an even grid before they were rounded in print.
//!
//! In: the times of one trajectory. Out: the least-squares grid, if the rounding of the digits explains all deviations from it.
//! Moves no other times.

use super::thresholds::TIME_AXIS;

/// Instants, and the step if they are even.
pub(crate) struct TimeGrid {
    time: Vec<f64>,
    step: Option<f64>,
}

impl TimeGrid {
    /// Puts the times on an even grid if only their printed digits keep them off it, by little of a step.
    pub(crate) fn new(time: &[f64]) -> Self {
        if let Some((even, worst)) = even_grid(time) {
            let step = even.get(1).zip(even.first()).map_or(0.0, |(b, a)| b - a);
            if worst <= TIME_AXIS.even * step {
                return TimeGrid {
                    time: even,
                    step: Some(step),
                };
            }
        }
        TimeGrid {
            time: time.to_vec(),
            step: None,
        }
    }

    /// The instants, repaired where only their printed digits were uneven.
    pub(crate) fn time(&self) -> &[f64] {
        &self.time
    }

    pub(crate) fn is_even(&self) -> bool {
        self.step.is_some()
    }
}

/// The times on an even grid if only their printed digits keep them off it, by little of a step; else as they are.
pub fn snap_to_even_grid(time: &[f64]) -> Vec<f64> {
    TimeGrid::new(time).time
}

/// The least-squares grid and the largest correction, if every time is within half a unit of its last printed digit of it.
pub(crate) fn even_grid(time: &[f64]) -> Option<(Vec<f64>, f64)> {
    let n = time.len();
    let (first, last) = (*time.first()?, *time.last()?);
    if n < 3 || last <= first {
        return None;
    }
    // Least squares t = mean + step·(k − middle). Fitted twice, because the sums of a long record lose digits.
    let middle = (n - 1) as f64 / 2.0;
    let spread: f64 = (0..n).map(|k| (k as f64 - middle).powi(2)).sum();
    let (mut mean, mut step) = (0.5 * (first + last), (last - first) / (n - 1) as f64);
    for _ in 0..2 {
        let (mut offset, mut slope) = (0.0, 0.0);
        for (k, t) in time.iter().enumerate() {
            let d = k as f64 - middle;
            let left = t - (mean + step * d);
            offset += left;
            slope += left * d;
        }
        mean += offset / n as f64;
        step += slope / spread;
    }
    let grid: Vec<f64> = (0..n).map(|k| mean + step * (k as f64 - middle)).collect();
    let worst = time
        .iter()
        .zip(&grid)
        .map(|(t, g)| (t - g).abs())
        .fold(0.0, f64::max);
    let printed = last_decimal(time).or_else(|| last_significant(time));
    let digits = printed
        .filter(|d| *d <= TIME_AXIS.coarsest_digit * step)
        .map_or(0.0, |d| TIME_AXIS.rounding * d);
    let allowed = f64::max(digits, TIME_AXIS.tolerance * step);
    (worst <= allowed).then_some((grid, worst))
}

/// The unit of the last decimal that the values use; `None` if they use more than six.
fn last_decimal(values: &[f64]) -> Option<f64> {
    (0..=6).map(|k| 10f64.powi(k)).find_map(|scale| {
        let whole = |v: &f64| {
            let x = v * scale;
            (x - x.round()).abs() <= 1e-9 * x.abs().max(1.0)
        };
        values.iter().all(whole).then_some(1.0 / scale)
    })
}

/// The unit of the last significant digit of the largest value; `None` if the values use more than twelve digits.
fn last_significant(values: &[f64]) -> Option<f64> {
    // `x` is never zero.
    let unit = |x: f64, digits: i32| 10f64.powi(x.abs().log10().floor() as i32 + 1 - digits);
    let largest = values
        .iter()
        .fold(f64::MIN_POSITIVE, |m: f64, x| m.max(x.abs()));
    (6..=12).find_map(|digits| {
        let whole = |v: &f64| {
            let of = if *v == 0.0 { 1.0 } else { *v };
            let k = v / unit(of, digits);
            (k - k.round()).abs() <= 1e-15 * k.abs() + 1e-4
        };
        values.iter().all(whole).then(|| unit(largest, digits))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounded_grids_are_recognised() {
        let rounded: Vec<f64> = (0..200)
            .map(|k| (k as f64 / 60.0 * 1000.0).round() / 1000.0)
            .collect();
        let (grid, worst) = even_grid(&rounded).expect("an even grid");
        assert!(worst <= 5.1e-4);
        assert!((grid[199] - 199.0 / 60.0).abs() < 2e-4);
        let nine_digits: Vec<f64> = (0..4000)
            .map(|k| {
                format!("{:.8e}", 0.0316412345 * k as f64)
                    .parse()
                    .unwrap_or(0.0)
            })
            .collect();
        let (_, worst) = even_grid(&nine_digits).expect("an even grid");
        assert!(worst > 1e-8);
        let long: Vec<f64> = (0..1_000_000).map(|k| k as f64 / 1000.0).collect();
        assert!(even_grid(&long).expect("an even grid").1 < 1e-10);
        let irregular: Vec<f64> = (0..200).map(|k| (k as f64).powf(1.1)).collect();
        assert!(even_grid(&irregular).is_none());
    }
}
