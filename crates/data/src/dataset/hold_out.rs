//! The hold-out set: rows that equations are tested on and not found from.
//!
//! In: a dataset, ranges of rows, files. Out: the dataset without them, and the held-out rows as a dataset of their own. A
//! record falls into two where a range is taken from its middle. Never looks at values.

use std::fmt;

use super::trajectories::{Dataset, Trajectory};
use sidc_lang::diagnostic::Diagnostic;

/// What to hold out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HoldOut {
    pub stretches: Vec<HoldOutRange>,
    /// Whole tables, by index.
    pub files: Vec<usize>,
}

/// A range of rows, taken from every record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HoldOutRange {
    /// from ≤ t ≤ to, an absent end is open.
    Times(Option<f64>, Option<f64>),
    /// The last part of the rows; between 0 and 1.
    Last(f64),
}

impl HoldOut {
    pub fn is_empty(&self) -> bool {
        self.stretches.is_empty() && self.files.is_empty()
    }
}

impl HoldOutRange {
    /// True if the range includes row `k`.
    fn takes(&self, t: &Trajectory, k: usize) -> bool {
        match *self {
            HoldOutRange::Times(from, to) => {
                from.is_none_or(|from| from <= t.time[k]) && to.is_none_or(|to| t.time[k] <= to)
            }
            HoldOutRange::Last(part) => k as f64 >= (1.0 - part) * t.len() as f64,
        }
    }
}

/// As it is written on the command line.
impl fmt::Display for HoldOutRange {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let end = |x: Option<f64>| x.map_or_else(String::new, |x| x.to_string());
        match *self {
            HoldOutRange::Times(from, to) => write!(f, "{}..{}", end(from), end(to)),
            HoldOutRange::Last(part) => write!(f, "{}%", 100.0 * part),
        }
    }
}

/// Moves the rows out of the dataset and returns them; the result is empty if nothing is to be held out.
///
/// # Errors
/// `empty-holdout` if a range has no rows, `nothing-left` if no rows remain.
pub fn hold_out(dataset: &mut Dataset, what: &HoldOut) -> Result<Dataset, Diagnostic> {
    let mut held = Dataset {
        trajectories: Vec::new(),
        inputs: dataset.inputs.clone(),
        rate_faults: dataset.rate_faults.clone(),
        unread: dataset.unread.clone(),
    };
    if what.is_empty() {
        return Ok(held);
    }
    let records = || dataset.trajectories.iter();
    for stretch in &what.stretches {
        if !records().any(|t| (0..t.len()).any(|k| stretch.takes(t, k))) {
            return Err(empty(stretch, dataset));
        }
    }
    let mut left = Vec::new();
    for record in records() {
        let whole = what.files.contains(&record.file);
        let takes = |k| whole || what.stretches.iter().any(|s| s.takes(record, k));
        for (taken, from, to) in runs(record.len(), takes) {
            let part = record.part(from..to);
            match taken {
                true => held.trajectories.push(part),
                false => left.push(part),
            }
        }
    }
    if left.is_empty() {
        return Err(nothing_left());
    }
    dataset.trajectories = left;
    Ok(held)
}

/// Runs of rows for which `takes` gives the same answer: the answer, start and end.
fn runs(rows: usize, takes: impl Fn(usize) -> bool) -> Vec<(bool, usize, usize)> {
    let mut out: Vec<(bool, usize, usize)> = Vec::new();
    for k in 0..rows {
        let taken = takes(k);
        match out.last_mut() {
            Some((before, _, to)) if *before == taken => *to = k + 1,
            _ => out.push((taken, k, k + 1)),
        }
    }
    out
}

fn empty(stretch: &HoldOutRange, dataset: &Dataset) -> Diagnostic {
    let message = format!("--holdout={stretch} takes no rows");
    let mut d = Diagnostic::error("empty-holdout", message);
    for t in &dataset.trajectories {
        if let (Some(from), Some(to)) = (t.time.first(), t.time.last()) {
            d = d.fact(format!("{} runs from t = {from} to t = {to}", t.name));
        }
    }
    d.help("give times that the records reach, a part such as 25%, or a file")
}

fn nothing_left() -> Diagnostic {
    Diagnostic::error(
        "nothing-left",
        "everything is held out: no rows are left to find equations from",
    )
    .help("hold out a shorter stretch, or give another data file")
}

#[cfg(test)]
mod tests {
    use super::*;
    use sidc_lang::term::{Signal, VarId};

    fn dataset(lengths: &[usize]) -> Dataset {
        let x = Signal::new(VarId(1));
        let record = |(file, n): (usize, &usize)| {
            let time: Vec<f64> = (0..*n).map(|k| k as f64 / 10.0).collect();
            Trajectory {
                name: format!("{file}.csv"),
                file,
                columns: vec![(x, time.iter().map(|t| 2.0 * t).collect())],
                time,
            }
        };
        Dataset {
            trajectories: lengths.iter().enumerate().map(record).collect(),
            inputs: Vec::new(),
            ..Dataset::default()
        }
    }

    fn times(d: &Dataset) -> Vec<(f64, f64)> {
        let ends = |t: &Trajectory| (t.time[0], t.time[t.len() - 1]);
        d.trajectories.iter().map(ends).collect()
    }

    #[test]
    fn a_stretch_in_the_middle_leaves_two_pieces() {
        let mut d = dataset(&[100]);
        let what = HoldOut {
            stretches: vec![HoldOutRange::Times(Some(3.0), Some(5.0))],
            files: vec![],
        };
        let held = hold_out(&mut d, &what).unwrap();
        assert_eq!(times(&held), [(3.0, 5.0)]);
        assert_eq!(times(&d), [(0.0, 2.9), (5.1, 9.9)]);
        let (_, column) = &held.trajectories[0].columns[0];
        assert_eq!((column.len(), column[0]), (21, 6.0));
    }

    #[test]
    fn parts_are_of_every_record_and_files_are_whole() {
        let mut d = dataset(&[100, 40, 10]);
        let what = HoldOut {
            stretches: vec![HoldOutRange::Last(0.25)],
            files: vec![2],
        };
        let held = hold_out(&mut d, &what).unwrap();
        assert_eq!(times(&held), [(7.5, 9.9), (3.0, 3.9), (0.0, 0.9)]);
        assert_eq!(times(&d), [(0.0, 7.4), (0.0, 2.9)]);
    }

    #[test]
    fn nothing_and_everything_are_faults() {
        let fault = |stretch| {
            let what = HoldOut {
                stretches: vec![stretch],
                files: vec![],
            };
            hold_out(&mut dataset(&[100]), &what).unwrap_err().code
        };
        assert_eq!(
            fault(HoldOutRange::Times(Some(20.0), None)),
            "empty-holdout"
        );
        assert_eq!(fault(HoldOutRange::Times(None, None)), "nothing-left");
    }
}
