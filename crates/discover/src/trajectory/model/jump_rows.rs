//! Where the readings of a state that jumps have a jump or a kink.
//!
//! In: instants, readings. Out: breaks for the smoother. They only say where an estimate starts: the laws decide where states jump.

use nalgebra::{DMatrix, DVector};

use super::thresholds::JUMPS;
use sidc_data::{Break, MEDIAN_OF_ABS_NORMAL, median};

/// Rows between which and the row before the readings jump, if `order` is 0, or their slope does: there two parabolas follow the readings near by
/// much better than one cubic, better than one polynomial with as many coefficients, which smooth motion favours, and better than at the rows near
/// by. Where parabolas meet, the readings do not jump: their slope may, as that of a state with a held input.
pub(super) fn jump_rows(time: &[f64], readings: &[f64], order: u8) -> Vec<Break> {
    let (least, most) = (readings.iter().copied().filter(|x| x.is_finite()))
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| {
            (a.min(x), b.max(x))
        });
    let floor = (JUMPS.rounding * (most - least)).powi(2);
    let fit = |from: usize, to: usize, degree: usize| {
        Polynomial::fit(&time[from..to], &readings[from..to], degree)
    };
    // As `sidc_data::difference_noise`, at uneven instants too: what a parabola leaves of four readings has one degree of freedom, and few such
    // windows hold a jump.
    let lone = (0..time.len().saturating_sub(3)).map(|k| fit(k, k + 4, 2).left_over);
    let mut lone: Vec<f64> = lone.filter(|x| x.is_finite()).collect();
    let noise = median(&mut lone).unwrap_or(0.0) / MEDIAN_OF_ABS_NORMAL.powi(2);
    let least_left = (JUMPS.least_left * noise).max(floor);
    let is_cut = |row: usize, w: usize| row < w || row + w > time.len();
    // Near an end of the record the side towards it is shorter, and what few readings there are lies on a polynomial of lower degree.
    let gain = |row: usize, w: usize| -> f64 {
        let (from, to) = (row.saturating_sub(w), (row + w).min(time.len()));
        let sides = [(from, row), (row, to)];
        let [left, right] = sides.map(|(from, to)| to - from);
        let at_end = is_cut(row, w);
        let usable = left.min(right) > 0 && left.max(right) == w;
        if at_end && (order > 0 || !usable) {
            return 0.0;
        }
        let mut parts = Sum::default();
        for (from, to) in sides {
            parts.add(&fit(from, to, (to - from - 1).min(2)));
        }
        let mut whole = Sum::default();
        whole.add(&fit(from, to, 3));
        let bends = || !at_end && fit(from, to, 5).left_over <= parts.squares;
        match whole.squares.is_finite() && !bends() {
            true => whole.mean() / parts.mean().max(least_left),
            false => 0.0,
        }
    };
    // For each row the window in which it stands out most.
    let windows =
        || (JUMPS.windows.into_iter()).zip(JUMPS.gains.into_iter().zip(JUMPS.gains_at_end));
    let mut found: Vec<(f64, usize, usize)> = (0..time.len())
        .filter_map(|row| {
            let each = windows().map(|(w, (within, at_end))| {
                let by_chance = if is_cut(row, w) { at_end } else { within };
                (gain(row, w) / by_chance, row, w)
            });
            each.max_by(|a, b| a.0.total_cmp(&b.0))
                .filter(|best| best.0 > 1.0)
        })
        .collect();
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut peaks: Vec<(usize, usize)> = Vec::new();
    for (_, row, w) in found {
        if peaks.iter().all(|(other, _)| other.abs_diff(row) >= w) {
            peaks.push((row, w));
        }
    }
    peaks.sort_unstable();
    // Where the parabolas meet is known to a small part of a step; noise moves the best row by one.
    let place = |(row, w): (usize, usize)| {
        if is_cut(row, w) {
            return Some(row);
        }
        let (left, right) = (fit(row - w, row - 1, 2), fit(row + 1, row + w, 2));
        let apart = |k: usize| left.at(time[k]) - right.at(time[k]);
        let mut near = row - 1..row + 2;
        let met = near.find(|k| apart(k - 1) * apart(*k) <= 0.0);
        match order {
            0 => met.is_none().then_some(row),
            _ => Some(met.unwrap_or(row)),
        }
    };
    let mut rows: Vec<usize> = peaks.into_iter().filter_map(place).collect();
    rows.dedup();
    rows.into_iter()
        .map(|row| Break { row, order: 0 })
        .collect()
}

/// Sums of squares, with their degrees of freedom.
#[derive(Default)]
struct Sum {
    squares: f64,
    freedom: usize,
}

impl Sum {
    fn add(&mut self, of: &Polynomial) {
        self.squares += of.left_over;
        self.freedom += of.freedom;
    }

    fn mean(&self) -> f64 {
        self.squares / self.freedom.max(1) as f64
    }
}

/// A polynomial through readings.
pub(super) struct Polynomial {
    middle: f64,
    half: f64,
    coefficients: DVector<f64>,
    /// The sum of squares that it leaves; infinite where a reading is missing.
    left_over: f64,
    freedom: usize,
}

impl Polynomial {
    pub(super) fn fit(time: &[f64], readings: &[f64], degree: usize) -> Polynomial {
        let (first, last) = (time[0], time[time.len() - 1]);
        let middle = (first + last) / 2.0;
        let half = if last > first {
            (last - first) / 2.0
        } else {
            1.0
        };
        let power = |i: usize, d: usize| ((time[i] - middle) / half).powi(d as i32);
        let powers = DMatrix::from_fn(time.len(), degree + 1, power);
        let readings = DVector::from_column_slice(readings);
        let qr = powers.clone().qr();
        let right = qr.q().transpose() * &readings;
        let solved = qr.r().solve_upper_triangular(&right);
        let coefficients = solved.unwrap_or_else(|| DVector::zeros(degree + 1));
        let left_over = (readings - powers * &coefficients).norm_squared();
        Polynomial {
            middle,
            half,
            coefficients,
            freedom: time.len() - degree - 1,
            left_over: if left_over.is_finite() {
                left_over
            } else {
                f64::INFINITY
            },
        }
    }

    /// The second derivative of a parabola.
    pub(super) fn curvature(&self) -> f64 {
        2.0 * self.coefficients[2] / (self.half * self.half)
    }

    fn at(&self, time: f64) -> f64 {
        let x = (time - self.middle) / self.half;
        let all = self.coefficients.iter().rev();
        all.fold(0.0, |sum, c| sum * x + c)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(order: u8, of: impl Fn(f64) -> f64) -> Vec<usize> {
        let time: Vec<f64> = (0..200).map(|k| 0.01 * f64::from(k)).collect();
        let noise = |k: usize| 1e-4 * f64::sin(12.9898 * k as f64 * k as f64 + 78.233);
        let readings: Vec<f64> = (time.iter().enumerate())
            .map(|(k, t)| of(*t) + noise(k))
            .collect();
        jump_rows(&time, &readings, order)
            .iter()
            .map(|b| b.row)
            .collect()
    }

    #[test]
    fn jumps_and_kinks_are_found_and_bends_are_not() {
        assert_eq!(rows(1, |t| (t - 0.805).abs()), [81]);
        assert_eq!(
            rows(1, |t| (t - 0.805).abs() + (t - 1.404).abs()),
            [81, 141]
        );
        assert_eq!(rows(1, |t| (5.0 * t).sin()), [0; 0]);
        assert_eq!(rows(0, |t| if t < 1.203 { t } else { 0.3 }), [121]);
        assert_eq!(rows(0, |t| (t - 0.805).abs()), [0; 0]);
        assert_eq!(rows(0, |t| if t < 1.985 { 1.0 } else { 0.5 }), [199]);
        assert_eq!(rows(0, |t| if t < 0.015 { 1.0 } else { 0.5 }), [2]);
    }

    /// A relay that switches every seven readings.
    #[test]
    fn jumps_near_each_other_are_found() {
        let time: Vec<f64> = (0..210).map(f64::from).collect();
        let readings: Vec<f64> = (0..210).map(|k| f64::from(k / 7 % 2)).collect();
        let found = jump_rows(&time, &readings, 0);
        let rows: Vec<usize> = found.iter().map(|b| b.row).collect();
        let switched: Vec<usize> = (1..30).map(|k| 7 * k).collect();
        assert_eq!(rows, switched);
    }

    /// Four rounded readings in a row often lie on one parabola by chance.
    #[test]
    fn rounded_readings_have_no_more_kinks() {
        let ball = |t: f64| {
            let s = t % 1.0;
            let height = 5.0 * s * (1.0 - s);
            (height * 1000.0).round() / 1000.0
        };
        let time: Vec<f64> = (0..200).map(|k| 0.0101 * f64::from(k)).collect();
        let readings: Vec<f64> = time.iter().map(|t| ball(*t)).collect();
        let found = jump_rows(&time, &readings, 1);
        let rows: Vec<usize> = found.iter().map(|b| b.row).collect();
        assert_eq!(rows, [100]);
    }
}
