//! Quantized readings: encoders whose step is not small against the noise.
//!
//! In: readings. Out: their [`QuantizationGrid`], and the share of readings that says something new. Rounding errors are correlated where the
//! signal is slow: a reading that repeats the one before says little, and residuals of right laws are not white.

use super::record::Record;
use super::sensor_groups::SensorGroups;
use crate::trajectory::thresholds::RECORDS;

/// The values that readings can take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct QuantizationGrid {
    pub origin: f64,
    pub step: f64,
}

impl QuantizationGrid {
    /// The reading of a sensor without noise.
    pub fn nearest(&self, x: f64) -> f64 {
        self.origin + ((x - self.origin) / self.step).round() * self.step
    }

    /// Whether rounding errors are correlated under noise of this size.
    pub fn matters(&self, noise: f64) -> bool {
        noise < RECORDS.dither * self.step
    }
}

/// The grid of a state's readings in all records, if they lie on one.
pub(crate) fn quantization_grid(records: &[Record], state: usize) -> Option<QuantizationGrid> {
    let all = records
        .iter()
        .flat_map(|r| r.measured[state].iter().copied());
    let mut values: Vec<f64> = all.filter(|x| x.is_finite()).collect();
    let readings = values.len();
    values.sort_unstable_by(f64::total_cmp);
    values.dedup();
    let (origin, last) = (*values.first()?, *values.last()?);
    if values.len() < 3 || readings < RECORDS.readings_per_value * values.len() {
        return None;
    }
    let gaps = values.windows(2).map(|w| w[1] - w[0]);
    let least = gaps.fold(f64::INFINITY, f64::min);
    let steps = ((last - origin) / least).round();
    let step = (last - origin) / steps;
    let on = |x: &f64| {
        let place = (x - origin) / step;
        (place - place.round()).abs() < RECORDS.grid_tolerance
    };
    values
        .iter()
        .all(on)
        .then_some(QuantizationGrid { origin, step })
}

/// Share of each sensor's readings that differ from the one before, groups × states; 1 where quantization does not matter.
pub(crate) fn informative_shares(
    records: &[Record],
    sensors: &SensorGroups,
    noise: &[f64],
    quantization: &[Option<QuantizationGrid>],
) -> Vec<f64> {
    let n = quantization.len();
    let share = |s: usize| {
        let coarse = |l: &QuantizationGrid| l.matters(noise[s]);
        if !quantization[s % n].as_ref().is_some_and(coarse) {
            return 1.0;
        }
        let own = |(r, _): &(usize, &Record)| sensors.of(*r).contains(&s);
        changes(records.iter().enumerate().filter(own), s % n)
    };
    (0..sensors.count()).map(share).collect()
}

fn changes<'a>(records: impl Iterator<Item = (usize, &'a Record)>, state: usize) -> f64 {
    let (mut readings, mut changes) = (0usize, 0usize);
    for (_, record) in records {
        let mut before = None;
        for x in record.measured[state].iter().filter(|x| x.is_finite()) {
            readings += 1;
            changes += usize::from(before != Some(*x));
            before = Some(*x);
        }
    }
    changes.max(1) as f64 / readings.max(1) as f64
}
