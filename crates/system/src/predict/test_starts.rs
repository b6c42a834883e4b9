//! Starts all along the data, evenly spread.
//!
//! In: records, the first row of each that may be a start, how many rows a start needs before it, how far ahead there must be a reading.
//! Out: records and rows. Never looks at values.

use super::horizon::row_ahead;
use crate::simulate::SegmentRuns;

/// A row from which is predicted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct TestStart {
    pub record: usize,
    pub row: usize,
    /// The end of the uninterrupted rows it stands in.
    pub end: usize,
}

/// At most `count` starts with so many rows before them and a reading `ahead` of them. `first`: the first row of each record that may be
/// one; rows before it only serve to find its state. Empty for all rows.
pub(super) fn test_starts(
    records: &[SegmentRuns],
    (first, before): (&[usize], usize),
    (ahead, step): (f64, f64),
    count: usize,
) -> Vec<TestStart> {
    let mut all = Vec::new();
    for (record, runs) in records.iter().enumerate() {
        let time = &runs.record().time;
        for rows in runs.contiguous() {
            let end = rows.end;
            let fits = |row: &usize| row_ahead(time, *row, ahead, step).is_some_and(|k| k < end);
            let earliest = first.get(record).copied().unwrap_or(0);
            let rows = (earliest.max(rows.start + before)..end).filter(fits);
            all.extend(rows.map(|row| TestStart { record, row, end }));
        }
    }
    let count = count.min(all.len());
    let place = |k: usize| (2 * k + 1) * all.len() / (2 * count.max(1));
    (0..count)
        .filter_map(|k| all.get(place(k)).copied())
        .collect()
}
