//! Encoders: sensors whose readings are multiples of a step, not small against the noise.
//!
//! In: readings. Out: the [`Lattice`] they lie on, and how much news they are. Rounding errors follow each other where the signal is
//! slow: a reading that repeats the one before says little that is new, and residuals of a right law are not white.

use super::record::Record;
use super::sensors::Sensors;

/// Values that a sensor's readings take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lattice {
    pub origin: f64,
    pub step: f64,
}

/// Distance from the lattice, in steps, that print makes.
const PRINT: f64 = 0.05;
/// A lattice has so many readings a value.
const CROWDED: usize = 2;
/// Noise over step above which the errors of rounding are as good as white (dither).
const DITHERED: f64 = 0.5;

impl Lattice {
    /// What a sensor without noise would read.
    pub fn nearest(&self, x: f64) -> f64 {
        self.origin + ((x - self.origin) / self.step).round() * self.step
    }

    /// Whether noise of this size leaves errors of rounding that follow each other.
    pub fn matters(&self, noise: f64) -> bool {
        noise < DITHERED * self.step
    }
}

/// The lattice of a state's readings, all records together.
pub(super) fn lattice(records: &[Record], state: usize) -> Option<Lattice> {
    let all = records
        .iter()
        .flat_map(|r| r.measured[state].iter().copied());
    let mut values: Vec<f64> = all.filter(|x| x.is_finite()).collect();
    let readings = values.len();
    values.sort_unstable_by(f64::total_cmp);
    values.dedup();
    let (origin, last) = (*values.first()?, *values.last()?);
    if values.len() < 3 || readings < CROWDED * values.len() {
        return None;
    }
    let gaps = values.windows(2).map(|w| w[1] - w[0]);
    let least = gaps.fold(f64::INFINITY, f64::min);
    let steps = ((last - origin) / least).round();
    let step = (last - origin) / steps;
    let on = |x: &f64| {
        let place = (x - origin) / step;
        (place - place.round()).abs() < PRINT
    };
    values.iter().all(on).then_some(Lattice { origin, step })
}

/// Share of each sensor's readings that differ from those before, groups × states: 1 for sensors without steps that matter.
pub(super) fn news(
    records: &[Record],
    sensors: &Sensors,
    noise: &[f64],
    lattices: &[Option<Lattice>],
) -> Vec<f64> {
    let n = lattices.len();
    let share = |s: usize| {
        let coarse = |l: &Lattice| l.matters(noise[s]);
        if !lattices[s % n].as_ref().is_some_and(coarse) {
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
