//! Which sensors read which record: files of enough readings have sensors of their own, the others share theirs.
//!
//! In: records. Out: [`Sensors`], the order of everything that is known by sensor. Never sees a value's size.

use std::ops::Range;

use super::record::Record;

/// Readings of a state that tell its noise to a tenth.
const ENOUGH: usize = 50;

/// Sensors, one a state in every group of trajectories; what is known of them is listed group after group.
#[derive(Clone, Debug)]
pub struct Sensors {
    /// Group of each record.
    group: Vec<usize>,
    groups: usize,
    states: usize,
}

impl Sensors {
    /// Group of a record.
    pub fn group(&self, record: usize) -> usize {
        self.group.get(record).copied().unwrap_or(0)
    }

    /// Places of the sensors that read a record, one a state.
    pub fn of(&self, record: usize) -> Range<usize> {
        let start = self.group(record) * self.states;
        start..start + self.states
    }

    /// The same sensors for parts of records, given where each is from.
    pub(super) fn on(&self, origin: &[usize]) -> Sensors {
        Sensors {
            group: origin.iter().map(|r| self.group(*r)).collect(),
            ..self.clone()
        }
    }

    /// Number of groups times states.
    pub fn count(&self) -> usize {
        self.groups * self.states
    }
}

pub(super) fn groups(records: &[Record], states: usize) -> Sensors {
    let trajectories = records.iter().map(|r| r.trajectory + 1).max().unwrap_or(0);
    let mut readings = vec![vec![0; states]; trajectories];
    for record in records {
        for (count, column) in readings[record.trajectory].iter_mut().zip(&record.measured) {
            *count += column.iter().filter(|x| x.is_finite()).count();
        }
    }
    let enough = |counts: &Vec<usize>| {
        let read = || counts.iter().filter(|c| **c > 0);
        read().count() > 0 && read().all(|c| *c >= ENOUGH)
    };
    let few = readings.iter().any(|counts| !enough(counts));
    // Trajectories of few readings are group 0.
    let mut groups = usize::from(few);
    let own: Vec<usize> = (readings.iter())
        .map(|counts| match enough(counts) {
            true => {
                groups += 1;
                groups - 1
            }
            false => 0,
        })
        .collect();
    Sensors {
        group: records.iter().map(|r| own[r.trajectory]).collect(),
        groups: groups.max(1),
        states,
    }
}
