//! Contiguous stretches of long records: what supports are proposed on, before all samples decide.
//!
//! In: lengths of records. Out: where the stretches are, spread evenly; always the same ones. Never looks at values.

use std::ops::Range;

use super::problem::Problem;
use super::record::{Outside, Record};
use super::smooth::Curve;

/// Samples in all stretches; records that have no more are taken whole.
const MOST: usize = 10_000;
/// Samples of a stretch.
const LENGTH: usize = 1_000;
/// A rest shorter than this is left out.
const SHORTEST: usize = 50;

/// Record and samples of every stretch, in order.
pub(super) fn stretches(lengths: &[usize]) -> Vec<(usize, Range<usize>)> {
    let total: usize = lengths.iter().sum();
    if total <= MOST {
        return lengths.iter().map(|m| 0..*m).enumerate().collect();
    }
    let mean = total / lengths.len().max(1);
    let number = MOST / mean.clamp(SHORTEST, LENGTH);
    let mut found: Vec<(usize, Range<usize>)> = Vec::new();
    let mut start = 0;
    for (record, length) in lengths.iter().enumerate() {
        // Every stretch is about the middle of an equal share of all samples.
        let middles = (0..number).map(|w| (2 * w + 1) * total / (2 * number));
        for middle in middles.filter(|m| (start..start + length).contains(m)) {
            let last = length.saturating_sub(LENGTH);
            let from = (middle - start).saturating_sub(LENGTH / 2).min(last);
            let before = found.last().filter(|(r, _)| *r == record);
            let from = from.max(before.map_or(0, |(_, s)| s.end));
            let to = (from + LENGTH).min(*length);
            if to >= from + SHORTEST.min(*length) && to > from {
                found.push((record, from..to));
            }
        }
        start += length;
    }
    found
}

impl Problem {
    /// The same problem on stretches of its records; `None` if they are all it has.
    pub(super) fn shortened(&self) -> Option<Problem> {
        if self.samples() <= MOST {
            return None;
        }
        let (n, m) = (self.states(), self.system.laws.len());
        let lengths: Vec<usize> = self.records.iter().map(Record::len).collect();
        let (mut records, mut curves, mut origin) = (Vec::new(), Vec::new(), Vec::new());
        for (r, samples) in stretches(&lengths) {
            let (record, curve) = (&self.records[r], &self.curves[r]);
            origin.push(r);
            let outside = record.outside.iter().map(|o| Outside {
                values: o.values[samples.clone()].to_vec(),
                held: o.held,
            });
            let measured = record.measured.iter().map(|x| x[samples.clone()].to_vec());
            records.push(Record {
                trajectory: record.trajectory,
                time: record.time[samples.clone()].to_vec(),
                measured: measured.collect(),
                outside: outside.collect(),
            });
            curves.push(Curve {
                states: curve.states[samples.start * n..samples.end * n].to_vec(),
                rates: curve.rates[samples.start * m..samples.end * m].to_vec(),
                noise: curve.noise.clone(),
            });
        }
        Some(self.on(records, curves, &origin))
    }
}

#[cfg(test)]
mod tests {
    use super::{MOST, stretches};

    #[test]
    fn stretches_are_spread_evenly_and_never_overlap() {
        // Short records are taken whole.
        assert_eq!(stretches(&[30, 4000]), [(0, 0..30), (1, 0..4000)]);
        for lengths in [
            vec![100_000],
            vec![300, 40_000, 900, 20_000],
            vec![100; 1000],
        ] {
            let found = stretches(&lengths);
            let used: usize = found.iter().map(|(_, s)| s.len()).sum();
            assert!(used <= MOST && used > MOST / 2, "{used} of {lengths:?}");
            for pair in found.windows(2) {
                let [(a, left), (b, right)] = pair else {
                    continue;
                };
                assert!(a < b || left.end <= right.start, "{pair:?}");
            }
            assert!(
                found
                    .iter()
                    .all(|(r, s)| s.end <= lengths[*r] && !s.is_empty())
            );
        }
        let found = stretches(&[100_000]);
        assert_eq!(found.len(), 10);
        assert_eq!(found[0], (0, 4_500..5_500));
        assert_eq!(found[9], (0, 94_500..95_500));
    }
}
