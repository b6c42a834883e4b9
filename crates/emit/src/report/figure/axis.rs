//! Axes: ranges, and round numbers on them.

use crate::report::markup::number;

/// The range of an axis; `low < high`, both finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Axis {
    pub low: f64,
    pub high: f64,
}

impl Axis {
    /// That range, widened if it is empty; [0, 1] if it is not finite.
    pub fn new(low: f64, high: f64) -> Axis {
        let size = low.abs().max(high.abs());
        let wide = high - low;
        if !(wide.is_finite() && size < 1e300) {
            return Axis {
                low: 0.0,
                high: 1.0,
            };
        }
        if wide <= 1e-12 * size || wide < 1e-300 {
            let half = if size > 1e-290 { 0.5 * size } else { 0.5 };
            return Axis {
                low: low - half,
                high: high + half,
            };
        }
        Axis { low, high }
    }

    /// The range of all finite values with a little margin; `None` if there are none.
    pub fn over<'a>(values: impl Iterator<Item = &'a f64>) -> Option<Axis> {
        let (low, high) = extremes(values)?;
        let room = 0.04 * (high - low);
        Some(Axis::new(low - room, high + room))
    }

    /// Position of a value, 0 to 1 within the range.
    pub fn share(&self, x: f64) -> f64 {
        (x - self.low) / (self.high - self.low)
    }

    /// The smallest range that holds both.
    pub fn with(self, other: Axis) -> Axis {
        Axis {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }

    /// About `most` round numbers in the range, with their labels; at least two, since one shows no scale.
    pub fn marks(&self, most: usize) -> Vec<(f64, String)> {
        let most = most.max(1);
        let mut finer = (most..=2 * most + 1).map(|most| self.marks_by(most));
        let two = finer.find(|marks| marks.len() >= 2);
        two.unwrap_or_else(|| self.marks_by(most))
    }

    fn marks_by(&self, most: usize) -> Vec<(f64, String)> {
        let step = round_up((self.high - self.low) / most as f64);
        let first = (self.low / step).ceil();
        let last = (self.high / step).floor();
        let count = (last - first) as usize + 1;
        (0..count.min(2 * most + 2))
            .map(|k| {
                let x = (first + k as f64) * step;
                (x, label(x, step))
            })
            .collect()
    }
}

/// Smallest and largest finite value.
pub(crate) fn extremes<'a>(values: impl Iterator<Item = &'a f64>) -> Option<(f64, f64)> {
    let mut found: Option<(f64, f64)> = None;
    for v in values.filter(|v| v.is_finite()) {
        let (low, high) = found.unwrap_or((*v, *v));
        found = Some((low.min(*v), high.max(*v)));
    }
    found
}

/// Rounded up to 1, 2 or 5 times a power of ten.
fn round_up(x: f64) -> f64 {
    let power = 10f64.powf(x.log10().floor());
    let lead = x / power;
    let round = [1.0, 2.0, 5.0].into_iter().find(|r| lead <= *r * 1.000_001);
    round.unwrap_or(10.0) * power
}

/// As many digits as the step has.
fn label(x: f64, step: f64) -> String {
    if x.abs() < 0.5 * step {
        return "0".into();
    }
    let size = x.abs().max(step);
    let digits = (size.log10().floor() - step.log10().floor()) as i32 + 1;
    number(x, digits.clamp(1, 12) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(low: f64, high: f64) -> Vec<String> {
        let marks = Axis::new(low, high).marks(5);
        marks.into_iter().map(|m| m.1).collect()
    }

    #[test]
    fn marks_are_round_and_written_short() {
        assert_eq!(labels(0.0, 10.0), ["0", "2", "4", "6", "8", "10"]);
        assert_eq!(labels(-0.31, 0.29), ["−0.2", "0", "0.2"]);
        assert_eq!(
            labels(-2e-12, 2.1e-12),
            ["−2·10⁻¹²", "−10⁻¹²", "0", "10⁻¹²", "2·10⁻¹²"]
        );
        assert_eq!(
            labels(1000.5, 1001.5),
            ["1000.6", "1000.8", "1001", "1001.2", "1001.4"]
        );
    }

    #[test]
    fn every_range_has_a_width() {
        for (low, high) in [(0.0, 0.0), (5.0, 5.0), (-1e-320, 1e-320), (-1e308, 1e308)] {
            let axis = Axis::new(low, high);
            assert!(axis.high > axis.low, "{low} {high}");
            assert!(axis.marks(5).len() < 13);
        }
        for k in 0..1000 {
            let low = 0.737 * f64::from(k % 37) - 9.0;
            let axis = Axis::new(low, low + 1.003_f64.powi(k) * 0.1);
            let marks = axis.marks(3).len();
            assert!((2..12).contains(&marks), "{axis:?}: {marks}");
        }
        assert_eq!(Axis::over([f64::NAN].iter()), None);
    }
}
