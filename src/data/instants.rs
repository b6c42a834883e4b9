//! Sampling instants: are they rising, even, broken by gaps?
//!
//! In: times of one trajectory. Out: figures and repaired times. Reports nothing itself.

/// The steps between consecutive instants of one trajectory.
#[derive(Clone, Copy, Debug)]
pub(super) struct Steps {
    pub min: f64,
    pub median: f64,
    pub max: f64,
    /// A longer step is a gap.
    pub gap: f64,
}

/// Figures about the M − 1 steps; `None` below two instants.
pub(super) fn steps(time: &[f64]) -> Option<Steps> {
    let mut steps: Vec<f64> = time.windows(2).map(|w| w[1] - w[0]).collect();
    steps.sort_by(f64::total_cmp);
    let at = |q: f64| {
        let i = (q * (steps.len().saturating_sub(1)) as f64).round() as usize;
        steps.get(i).copied()
    };
    let median = at(0.5)?;
    Some(Steps {
        min: at(0.0)?,
        median,
        max: at(1.0)?,
        // Records sampled at random have long steps too; they are no gaps.
        gap: f64::max(4.5 * median, 2.0 * at(0.95)?),
    })
}

/// Numbers of the samples at rising instants, from 0. A lost sample leaves a hole in them, so that no shift reaches across it.
pub(super) fn numbers(time: &[f64]) -> Vec<f64> {
    let step = steps(time).map_or(1.0, |s| s.median);
    let later = time.windows(2).scan(0.0, |k, w| {
        // Counted from sample to sample, so that neither a gap nor a slow clock shifts those behind it.
        *k += ((w[1] - w[0]) / step).round().max(1.0);
        Some(*k)
    });
    time.first().map(|_| 0.0).into_iter().chain(later).collect()
}

/// Times that are an even grid but for their printed digits, put back on the grid.
///
/// Returns the grid and the largest correction, if every time is within half a unit of its last printed digit (a unit of less
/// than 0.3 steps; in any case 1e-6 steps) of the least-squares grid.
pub(super) fn even_grid(time: &[f64]) -> Option<(Vec<f64>, f64)> {
    let n = time.len();
    let (first, last) = (*time.first()?, *time.last()?);
    if n < 3 || last <= first {
        return None;
    }
    // Least squares t = mean + step·(k − middle); fitted twice, because the sums of a long record lose digits.
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
    // Digits as coarse as the step would make a lost sample look like rounding.
    let digits = printed
        .filter(|d| *d <= 0.3 * step)
        .map_or(0.0, |d| 0.51 * d);
    let allowed = f64::max(digits, 1e-6 * step);
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
    // Never asked of zero.
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

/// Times as they were meant: on an even grid if they are on one but for their printed digits, and those matter to 1e-4 of a step at
/// most; else as they stand.
pub fn settled(time: &[f64]) -> Vec<f64> {
    match even_grid(time) {
        Some((grid, worst)) if worst <= 1e-4 * (grid[1] - grid[0]) => grid,
        _ => time.to_vec(),
    }
}

/// Rows before which a gap in time lies.
pub fn gaps(time: &[f64]) -> Vec<usize> {
    let Some(s) = steps(time) else {
        return Vec::new();
    };
    time.windows(2)
        .enumerate()
        .filter(|(_, w)| w[1] - w[0] > s.gap)
        .map(|(i, _)| i + 1)
        .collect()
}

/// Uninterrupted ranges of rows.
pub fn pieces(time: &[f64]) -> Vec<std::ops::Range<usize>> {
    let mut ends = gaps(time);
    ends.push(time.len());
    let mut from = 0;
    let cut = ends
        .into_iter()
        .map(|to| std::mem::replace(&mut from, to)..to);
    cut.collect()
}

#[cfg(test)]
#[allow(clippy::expect_used)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_numbered_across_holes() {
        assert_eq!(
            numbers(&[0.0, 0.1, 0.2, 0.5, 0.6]),
            [0.0, 1.0, 2.0, 5.0, 6.0]
        );
        // Behind a gap of ten samples and a half, no two fall together.
        let after_gap = numbers(&[0.0, 1.0, 2.0, 12.5, 13.49, 14.49]);
        assert_eq!(after_gap, [0.0, 1.0, 2.0, 13.0, 14.0, 15.0]);
        assert!(numbers(&[]).is_empty());
    }

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

    #[test]
    fn a_long_step_is_a_gap() {
        let mut time: Vec<f64> = (0..50).map(|k| k as f64 * 0.1).collect();
        time.iter_mut().skip(30).for_each(|t| *t += 2.0);
        assert_eq!(gaps(&time), [30]);
    }
}
