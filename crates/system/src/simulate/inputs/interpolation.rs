//! Inputs between their samples: zero-order hold, straight lines or cubics.
//!
//! In: samples of one signal, how they are interpolated, a delay. Out: the segment that holds from any
//! instant to the next knot. Missing samples are filled and counted.

use sidc_data::{Cubic, gaps};
use sidc_lang::model::Between;

/// One input along one record.
#[derive(Clone, Debug)]
pub(crate) struct SampledInput {
    /// Finite, one for each row of the record.
    values: Vec<f64>,
    between: Between,
    /// Rows before which there is a gap, which no cubic crosses.
    gaps: Vec<usize>,
    /// Delay in seconds.
    pub late: f64,
    /// How many samples were missing.
    pub missing: usize,
}

/// Where the values of one input come from.
#[derive(Clone, Debug)]
pub(crate) enum InputSource {
    SampledInput(SampledInput),
    /// The derivative of a sampled input.
    Slope(SampledInput),
    /// Constantly zero.
    Rest,
}

impl InputSource {
    /// The segment that holds from `t` on.
    pub fn line(&self, time: &[f64], t: f64) -> InputSegment {
        match self {
            InputSource::SampledInput(c) => c.line(time, t),
            InputSource::Slope(c) => c.line(time, t).derivative(),
            InputSource::Rest => InputSegment::default(),
        }
    }

    /// Delay in seconds.
    pub fn late(&self) -> f64 {
        match self {
            InputSource::SampledInput(c) | InputSource::Slope(c) => c.late,
            InputSource::Rest => 0.0,
        }
    }
}

/// A segment of a polynomial in time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct InputSegment {
    pub from: f64,
    pub value: f64,
    pub slope: f64,
    /// Factors of the second and the third power of time.
    bends: [f64; 2],
    /// The end of the segment and the value there, exact where extrapolation would round.
    pub meets: (f64, f64),
}

impl InputSegment {
    fn flat(from: f64, value: f64) -> InputSegment {
        InputSegment {
            from,
            value,
            slope: 0.0,
            bends: [0.0; 2],
            meets: (from, value),
        }
    }

    /// Its rate of change.
    fn derivative(&self) -> InputSegment {
        let (end, [square, cube]) = (self.meets.0, self.bends);
        InputSegment {
            from: self.from,
            value: self.slope,
            slope: 2.0 * square,
            bends: [3.0 * cube, 0.0],
            meets: (end, self.slope_at(end)),
        }
    }

    /// Whether its value changes.
    pub fn moves(&self) -> bool {
        self.slope != 0.0 || self.bends != [0.0; 2]
    }

    /// Its rate of change at `t`.
    pub fn slope_at(&self, t: f64) -> f64 {
        let passed = t - self.from;
        self.slope + passed * (2.0 * self.bends[0] + passed * 3.0 * self.bends[1])
    }

    #[inline]
    pub fn at(&self, t: f64) -> f64 {
        match self.meets {
            (end, value) if t == end => value,
            _ => {
                let (passed, [square, cube]) = (t - self.from, self.bends);
                self.value + passed * (self.slope + passed * (square + passed * cube))
            }
        }
    }

    /// True if `next` continues this segment without a jump or a bend.
    pub fn continues(&self, next: &InputSegment) -> bool {
        let straight = self.bends == [0.0; 2] && next.bends == [0.0; 2];
        straight && self.slope == next.slope && self.at(next.from) == next.value
    }
}

impl SampledInput {
    /// `None` if no sample is finite.
    pub fn new(time: &[f64], samples: &[f64], between: Between, late: f64) -> Option<SampledInput> {
        let mut values = samples.to_vec();
        let missing = values.iter().filter(|v| !v.is_finite()).count();
        if missing > 0 {
            bridge(time, &mut values, between)?;
        }
        let gaps = match between {
            Between::Cubic => gaps(time),
            Between::Hold | Between::Linear => Vec::new(),
        };
        (!values.is_empty()).then_some(SampledInput {
            values,
            between,
            gaps,
            late,
            missing,
        })
    }

    /// The segment that holds from `t` on. At a jump the right side counts.
    pub fn line(&self, time: &[f64], t: f64) -> InputSegment {
        let row = after(time, self.recorded(time, t));
        let value = |i: usize| self.values.get(i).copied().unwrap_or(0.0);
        let last = self.values.len() - 1;
        let flat = |value| InputSegment::flat(t, value);
        match (row, self.between) {
            (0, _) => flat(value(0)),
            (i, _) if i > last => flat(value(last)),
            (i, Between::Hold) => flat(value(i - 1)),
            (i, Between::Linear | Between::Cubic) => {
                let slope = (value(i) - value(i - 1)) / (time[i] - time[i - 1]);
                if !slope.is_finite() {
                    // A slope beyond all numbers is a jump at the next sample.
                    return flat(value(i - 1));
                }
                let straight = [value(i - 1), slope, 0.0, 0.0];
                let powers = self.cubic(time, i - 1).map_or(straight, |c| c.powers);
                InputSegment {
                    from: time[i - 1] + self.late,
                    value: value(i - 1),
                    slope: powers[1],
                    bends: [powers[2], powers[3]],
                    meets: (time[i] + self.late, value(i)),
                }
            }
        }
    }

    /// The cubic after a row; `None` where the input runs straight.
    fn cubic(&self, time: &[f64], row: usize) -> Option<Cubic> {
        let is_cubic = self.between == Between::Cubic;
        is_cubic.then(|| Cubic::within_gaps(time, &self.values, &self.gaps, row))?
    }

    /// When the value that acts at `t` was recorded. A knot of a delayed input is the sum of an instant and the delay; the difference must not
    /// round to before that instant, since the segment before would then hold until the next knot.
    fn recorded(&self, time: &[f64], t: f64) -> f64 {
        const ROUNDING: f64 = 1e-9;
        let own = t - self.late;
        match (self.late, time.first().zip(time.last())) {
            (0.0, _) | (_, None) => own,
            (_, Some((first, last))) => own + ROUNDING * (last - first) / time.len() as f64,
        }
    }

    /// The sample of a row, for discrete time.
    pub fn sample(&self, row: usize) -> f64 {
        self.values.get(row).copied().unwrap_or(f64::NAN)
    }
}

/// How many instants are at or before `t`. Records are mostly evenly sampled, so the place is guessed first.
fn after(time: &[f64], t: f64) -> usize {
    let guess = || {
        let (first, last) = time.first().zip(time.last())?;
        let place = (t - first) / (last - first) * (time.len() - 1) as f64;
        // Rounding may put the place one row off.
        let near = (place + 0.5) as usize;
        [near, near + 1].into_iter().find(|row| {
            let before = row.checked_sub(1).and_then(|k| time.get(k));
            before.is_some_and(|s| *s <= t) && time.get(*row).is_none_or(|s| *s > t)
        })
    };
    guess().unwrap_or_else(|| time.partition_point(|s| *s <= t))
}

/// Fills missing samples: held, or interpolated linearly. Before the first sample, its value holds.
fn bridge(time: &[f64], values: &mut [f64], between: Between) -> Option<()> {
    let known: Vec<usize> = (0..values.len())
        .filter(|i| values[*i].is_finite())
        .collect();
    let first = *known.first()?;
    for i in (0..values.len()).filter(|i| known.binary_search(i).is_err()) {
        let after = known.partition_point(|k| *k < i);
        let (last, next) = (after.checked_sub(1).map(|k| known[k]), known.get(after));
        values[i] = match (between, last, next) {
            (_, None, _) => values[first],
            (Between::Linear | Between::Cubic, Some(a), Some(b)) => {
                let share = (time[i] - time[a]) / (time[*b] - time[a]);
                let rise = values[*b] - values[a];
                match rise.is_finite() {
                    true => values[a] + share * rise,
                    false => (1.0 - share) * values[a] + share * values[*b],
                }
            }
            (_, Some(a), _) => values[a],
        };
    }
    Some(())
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn lines_hold_or_connect_and_start_late() {
        let time = [0.0, 1.0, 2.0];
        let held = SampledInput::new(&time, &[5.0, f64::NAN, 7.0], Between::Hold, 0.0).unwrap();
        let linear = SampledInput::new(&time, &[5.0, f64::NAN, 7.0], Between::Linear, 0.0).unwrap();
        assert_eq!((held.missing, held.line(&time, 1.5).at(1.9)), (1, 5.0));
        assert_eq!(linear.line(&time, 1.5).at(1.75), 6.75);
        // At a jump the right side counts; after the record the last value holds.
        assert_eq!(held.line(&time, 2.0).at(9.0), 7.0);
        let late = SampledInput::new(&time, &[5.0, 6.0, 7.0], Between::Hold, 0.25).unwrap();
        assert_eq!(late.line(&time, 1.0).at(1.2), 5.0);
        assert_eq!(late.line(&time, 1.25).at(1.3), 6.0);
    }

    #[test]
    fn cubics_follow_a_smooth_input_but_not_across_a_gap() {
        let mut time: Vec<f64> = (0..12).map(|k| 0.1 * f64::from(k)).collect();
        time.extend((0..6).map(|k| 5.0 + 0.1 * f64::from(k)));
        let samples: Vec<f64> = time.iter().map(|t| t.sin()).collect();
        let input = SampledInput::new(&time, &samples, Between::Cubic, 0.02).unwrap();
        for t in [0.05, 0.73, 1.07, 5.01, 5.33] {
            let segment = input.line(&time, t + 0.02);
            assert!((segment.at(t + 0.02) - t.sin()).abs() < 2e-5, "{t}");
            assert!(
                (segment.derivative().at(t + 0.02) - t.cos()).abs() < 2e-3,
                "{t}"
            );
            assert!((segment.slope_at(t + 0.02) - t.cos()).abs() < 2e-3, "{t}");
            assert_eq!(segment.at(segment.meets.0), segment.meets.1);
        }
        let gap = input.line(&time, 3.0);
        assert_eq!(gap.bends, [0.0; 2]);
    }

    #[test]
    fn no_input_is_too_steep_or_too_large_for_a_value() {
        let time = [0.0, 1e-6, 2e-6, 3e-6];
        let samples = [1e305, -1e305, 1.0, 2.0];
        let steep = SampledInput::new(&time, &samples, Between::Linear, 0.0).unwrap();
        assert_eq!(steep.line(&time, 0.0).at(1e-6), 1e305);
        assert_eq!(steep.line(&time, 1e-6).at(1.5e-6), -1e305);
        assert!((steep.line(&time, 2e-6).at(2.5e-6) - 1.5).abs() < 1e-9);
        let gap = [1.7e308, f64::NAN, -1.7e308, 0.0];
        let bridged = SampledInput::new(&time, &gap, Between::Linear, 0.0).unwrap();
        assert!(bridged.sample(1).abs() < 1e300);
    }
}
