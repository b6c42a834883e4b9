//! Segments of long records, on which supports are proposed before all samples decide.
//!
//! In: lengths of records. Out: evenly spread contiguous segments, always the same ones. Looks at no values.

use std::ops::Range;

use super::estimation_problem::Problem;
use super::record::Record;
use crate::trajectory::thresholds::RECORDS;

/// Record and samples of every segment, in order.
pub(crate) fn segments(lengths: &[usize]) -> Vec<(usize, Range<usize>)> {
    let total: usize = lengths.iter().sum();
    if total <= RECORDS.max_searched_samples {
        return lengths.iter().map(|m| 0..*m).enumerate().collect();
    }
    let mean = total / lengths.len().max(1);
    let number = RECORDS.max_searched_samples
        / mean.clamp(RECORDS.min_segment_samples, RECORDS.segment_samples);
    let mut found: Vec<(usize, Range<usize>)> = Vec::new();
    let mut start = 0;
    for (record, length) in lengths.iter().enumerate() {
        // Each segment lies about the middle of an equal share of all samples.
        let middles = (0..number).map(|w| (2 * w + 1) * total / (2 * number));
        for middle in middles.filter(|m| (start..start + length).contains(m)) {
            let last = length.saturating_sub(RECORDS.segment_samples);
            let from = (middle - start)
                .saturating_sub(RECORDS.segment_samples / 2)
                .min(last);
            let before = found.last().filter(|(r, _)| *r == record);
            let from = from.max(before.map_or(0, |(_, s)| s.end));
            let to = (from + RECORDS.segment_samples).min(*length);
            if to >= from + RECORDS.min_segment_samples.min(*length) && to > from {
                found.push((record, from..to));
            }
        }
        start += length;
    }
    found
}

impl Problem {
    /// Whether supports are searched on segments of the records first.
    pub fn searched_in_parts(&self) -> bool {
        self.samples() > RECORDS.max_searched_samples
    }

    /// The problem of what lies between jumps, each flight a record of its own, in which nothing jumps.
    pub(crate) fn flights(&self) -> Problem {
        let (n, m) = (self.states(), self.system.laws.len());
        let (mut records, mut smoothed, mut origin) = (Vec::new(), Vec::new(), Vec::new());
        for (r, (record, curve)) in self.records.iter().zip(&self.smoothed).enumerate() {
            for samples in curve.flights(record.len()) {
                origin.push(r);
                records.push(record.part(samples.clone()));
                smoothed.push(curve.part(samples, n, m));
            }
        }
        let mut flights = self.with_parts(records, smoothed, &origin);
        flights.system.resets.clear();
        flights
    }

    /// The problem on segments of its records; `None` if those are whole already.
    pub(crate) fn on_segments(&self) -> Option<Problem> {
        if !self.searched_in_parts() {
            return None;
        }
        let (n, m) = (self.states(), self.system.laws.len());
        let lengths: Vec<usize> = self.records.iter().map(Record::len).collect();
        let (mut records, mut smoothed, mut origin) = (Vec::new(), Vec::new(), Vec::new());
        for (r, samples) in segments(&lengths) {
            origin.push(r);
            records.push(self.records[r].part(samples.clone()));
            smoothed.push(self.smoothed[r].part(samples, n, m));
        }
        Some(self.with_parts(records, smoothed, &origin))
    }
}

#[cfg(test)]
mod tests {
    use super::{RECORDS, segments};

    #[test]
    fn segments_are_spread_evenly_and_never_overlap() {
        // Short records are taken whole.
        assert_eq!(segments(&[30, 4000]), [(0, 0..30), (1, 0..4000)]);
        for lengths in [
            vec![100_000],
            vec![300, 40_000, 900, 20_000],
            vec![100; 1000],
        ] {
            let found = segments(&lengths);
            let used: usize = found.iter().map(|(_, s)| s.len()).sum();
            assert!(
                used <= RECORDS.max_searched_samples && used > RECORDS.max_searched_samples / 2,
                "{used} of {lengths:?}"
            );
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
        let found = segments(&[100_000]);
        assert_eq!(found.len(), 10);
        assert_eq!(found[0], (0, 4_500..5_500));
        assert_eq!(found[9], (0, 94_500..95_500));
    }
}
