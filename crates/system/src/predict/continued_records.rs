//! Data held out, with the rows of the data used that lead up to them: a state at their first row is found from these.
//!
//! In: data used and held out, how many rows at most. Out: records that go on without a gap, and which row of each is the first held out.

use sidc_data::{Dataset, Trajectory, contiguous_ranges};

/// Each record held out behind up to `rows` rows used, and how many these are.
pub(super) fn continued(used: &Dataset, held: &Dataset, rows: usize) -> (Dataset, Vec<usize>) {
    let mut out = held.clone();
    let mut first = Vec::new();
    for record in &mut out.trajectories {
        let begin = record.time.first().copied().unwrap_or(f64::NAN);
        let earlier = |u: &&Trajectory| {
            let same = u.file == record.file && u.name == record.name;
            same && u.time.last().is_some_and(|t| *t < begin)
        };
        let last = |u: &Trajectory| u.time.last().copied().unwrap_or(f64::NAN);
        let all = used.trajectories.iter().filter(earlier);
        let before = all.max_by(|a, b| last(a).total_cmp(&last(b)));
        let before = before.map(|u| u.part(u.len() - rows.min(u.len())..u.len()));
        let joined = before.and_then(|u| Some((u.len(), joined(&u, record)?)));
        first.push(joined.as_ref().map_or(0, |(count, _)| *count));
        if let Some((_, joined)) = joined {
            *record = joined;
        }
    }
    (out, first)
}

/// A record and one that goes on where it ends; `None` if there is a gap between them, or their signals differ.
fn joined(before: &Trajectory, next: &Trajectory) -> Option<Trajectory> {
    let signals = |t: &Trajectory| t.columns.iter().map(|c| c.0).collect::<Vec<_>>();
    let time = [&before.time[..], &next.time[..]].concat();
    let place = before.len();
    let across = |r: &std::ops::Range<usize>| r.start < place && place < r.end;
    if signals(before) != signals(next) || !contiguous_ranges(&time).iter().any(across) {
        return None;
    }
    let pairs = before.columns.iter().zip(&next.columns);
    Some(Trajectory {
        columns: pairs
            .map(|((s, a), (_, b))| (*s, [&a[..], &b[..]].concat()))
            .collect(),
        time,
        ..before.clone()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use sidc_lang::term::{Signal, VarId};

    fn record(times: std::ops::Range<usize>) -> Trajectory {
        let time: Vec<f64> = times.map(|k| k as f64).collect();
        Trajectory {
            name: "a.csv".into(),
            columns: vec![(Signal::new(VarId(1)), time.clone())],
            time,
            ..Trajectory::default()
        }
    }

    fn dataset(all: &[Trajectory]) -> Dataset {
        Dataset {
            trajectories: all.to_vec(),
            ..Dataset::default()
        }
    }

    #[test]
    fn the_rows_used_that_lead_up_to_a_record_stand_before_it() {
        let used = dataset(&[record(0..10), record(20..30)]);
        let held = dataset(&[record(10..20), record(30..35), record(60..70)]);
        let (continued, first) = continued(&used, &held, 4);
        assert_eq!(first, [4, 4, 0]);
        let begins = continued.trajectories.iter().map(|t| t.time[0]);
        assert_eq!(begins.collect::<Vec<_>>(), [6.0, 26.0, 60.0]);
        let values = continued.trajectories[0].columns[0].1.clone();
        assert_eq!(values, continued.trajectories[0].time);
    }
}
