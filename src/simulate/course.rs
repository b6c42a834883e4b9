//! What an input does between its samples.
//!
//! In: samples of one signal along a leg, hold or linear, a delay. Out: its value and slope from any instant on until the next
//! knot. Missing samples are held or bridged, and counted.

use crate::lang::model::Between;

/// One input along one record.
#[derive(Clone, Debug)]
pub(super) struct Course {
    /// Finite, one for each row of the record.
    values: Vec<f64>,
    between: Between,
    /// Seconds by which it acts late.
    pub late: f64,
    /// Samples that were missing.
    pub missing: usize,
}

/// How one input is come by.
#[derive(Clone, Debug)]
pub(super) enum Drive {
    Course(Course),
    /// The derivative of an input that nobody measured: the slope of its course.
    Slope(Course),
    /// Nothing moves it.
    Rest,
}

impl Drive {
    /// The line that holds from `t` on.
    pub fn line(&self, time: &[f64], t: f64) -> Line {
        match self {
            Drive::Course(c) => c.line(time, t),
            Drive::Slope(c) => Line::flat(t, c.line(time, t).slope),
            Drive::Rest => Line::default(),
        }
    }

    /// Seconds by which it acts late.
    pub fn late(&self) -> f64 {
        match self {
            Drive::Course(c) | Drive::Slope(c) => c.late,
            Drive::Rest => 0.0,
        }
    }
}

/// A straight line in time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Line {
    pub from: f64,
    pub value: f64,
    pub slope: f64,
    /// Where it meets the next, and the value there without rounding.
    pub meets: (f64, f64),
}

impl Line {
    fn flat(from: f64, value: f64) -> Line {
        Line {
            from,
            value,
            slope: 0.0,
            meets: (from, value),
        }
    }

    #[inline]
    pub fn at(&self, t: f64) -> f64 {
        match self.meets {
            (end, value) if t == end => value,
            _ => self.value + self.slope * (t - self.from),
        }
    }

    /// True if `next` goes on where this one ends.
    pub fn continues(&self, next: &Line) -> bool {
        self.slope == next.slope && (self.at(next.from) == next.value)
    }
}

impl Course {
    /// `None` if no sample is finite.
    pub fn new(time: &[f64], samples: &[f64], between: Between, late: f64) -> Option<Course> {
        let mut values = samples.to_vec();
        let missing = values.iter().filter(|v| !v.is_finite()).count();
        if missing > 0 {
            bridge(time, &mut values, between)?;
        }
        (!values.is_empty()).then_some(Course {
            values,
            between,
            late,
            missing,
        })
    }

    /// The line that holds from `t` on; at a jump that of the right side.
    pub fn line(&self, time: &[f64], t: f64) -> Line {
        let own = t - self.late;
        let row = after(time, own);
        let value = |i: usize| self.values.get(i).copied().unwrap_or(0.0);
        let last = self.values.len() - 1;
        let flat = |value| Line::flat(t, value);
        match (row, self.between) {
            (0, _) => flat(value(0)),
            (i, _) if i > last => flat(value(last)),
            (i, Between::Hold) => flat(value(i - 1)),
            (i, Between::Linear) => {
                let slope = (value(i) - value(i - 1)) / (time[i] - time[i - 1]);
                if !slope.is_finite() {
                    // Steeper than a number can be: a jump at the next sample.
                    return flat(value(i - 1));
                }
                Line {
                    from: time[i - 1] + self.late,
                    value: value(i - 1),
                    slope,
                    meets: (time[i] + self.late, value(i)),
                }
            }
        }
    }

    /// The value at a row: that of discrete time.
    pub fn sample(&self, row: usize) -> f64 {
        self.values.get(row).copied().unwrap_or(f64::NAN)
    }
}

/// How many instants are not after `t`. Most records are even, and then one look will do.
fn after(time: &[f64], t: f64) -> usize {
    let guess = || {
        let (first, last) = time.first().zip(time.last())?;
        let place = (t - first) / (last - first) * (time.len() - 1) as f64;
        // Beside the row itself, where rounding leaves the place.
        let near = (place + 0.5) as usize;
        [near, near + 1].into_iter().find(|row| {
            let before = row.checked_sub(1).and_then(|k| time.get(k));
            before.is_some_and(|s| *s <= t) && time.get(*row).is_none_or(|s| *s > t)
        })
    };
    guess().unwrap_or_else(|| time.partition_point(|s| *s <= t))
}

/// Fills what is missing: held from the last sample, or on the line to the next; before the first sample it is the first.
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
            (Between::Linear, Some(a), Some(b)) => {
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
        let held = Course::new(&time, &[5.0, f64::NAN, 7.0], Between::Hold, 0.0).unwrap();
        let linear = Course::new(&time, &[5.0, f64::NAN, 7.0], Between::Linear, 0.0).unwrap();
        assert_eq!((held.missing, held.line(&time, 1.5).at(1.9)), (1, 5.0));
        assert_eq!(linear.line(&time, 1.5).at(1.75), 6.75);
        // A jump belongs to its right side, and after the record everything stays.
        assert_eq!(held.line(&time, 2.0).at(9.0), 7.0);
        let late = Course::new(&time, &[5.0, 6.0, 7.0], Between::Hold, 0.25).unwrap();
        assert_eq!(late.line(&time, 1.0).at(1.2), 5.0);
        assert_eq!(late.line(&time, 1.25).at(1.3), 6.0);
    }

    #[test]
    fn no_input_is_too_steep_or_too_large_for_a_value() {
        let time = [0.0, 1e-6, 2e-6, 3e-6];
        let samples = [1e305, -1e305, 1.0, 2.0];
        let steep = Course::new(&time, &samples, Between::Linear, 0.0).unwrap();
        assert_eq!(steep.line(&time, 0.0).at(1e-6), 1e305);
        assert_eq!(steep.line(&time, 1e-6).at(1.5e-6), -1e305);
        assert!((steep.line(&time, 2e-6).at(2.5e-6) - 1.5).abs() < 1e-9);
        let gap = [1.7e308, f64::NAN, -1.7e308, 0.0];
        let bridged = Course::new(&time, &gap, Between::Linear, 0.0).unwrap();
        assert!(bridged.sample(1).abs() < 1e300);
    }
}
