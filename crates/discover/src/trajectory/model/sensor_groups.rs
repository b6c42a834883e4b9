//! Which sensors share one noise level: trajectories with enough readings have levels of their own, the others share theirs.
//!
//! In: records. Out: [`SensorGroups`], which fixes the order of everything that is known by sensor. Sees no values.

use std::ops::Range;

use super::record::Record;
use crate::trajectory::thresholds::RECORDS;

/// One sensor a state in every group of trajectories; lists by sensor go group after group.
#[derive(Clone, Debug)]
pub struct SensorGroups {
    /// Group of each record.
    group: Vec<usize>,
    groups: usize,
    states: usize,
}

impl SensorGroups {
    /// Group of a record.
    pub fn group(&self, record: usize) -> usize {
        self.group.get(record).copied().unwrap_or(0)
    }

    /// The sensors of a record, one a state.
    pub fn of(&self, record: usize) -> Range<usize> {
        let start = self.group(record) * self.states;
        start..start + self.states
    }

    /// The same sensors for parts of records; part i is of record `origin[i]`.
    pub(crate) fn for_parts(&self, origin: &[usize]) -> SensorGroups {
        SensorGroups {
            group: origin.iter().map(|r| self.group(*r)).collect(),
            ..self.clone()
        }
    }

    /// The same groups, with a sensor for each of so many states.
    pub(crate) fn with_states(&self, states: usize) -> SensorGroups {
        SensorGroups {
            states,
            ..self.clone()
        }
    }

    /// Number of groups times states.
    pub fn count(&self) -> usize {
        self.groups * self.states
    }
}

pub(crate) fn sensor_groups(records: &[Record], states: usize) -> SensorGroups {
    let trajectories = records.iter().map(|r| r.trajectory + 1).max().unwrap_or(0);
    let mut readings = vec![vec![0; states]; trajectories];
    for record in records {
        for (count, column) in readings[record.trajectory].iter_mut().zip(&record.measured) {
            *count += column.iter().filter(|x| x.is_finite()).count();
        }
    }
    let enough = |counts: &Vec<usize>| {
        let read = || counts.iter().filter(|c| **c > 0);
        read().count() > 0 && read().all(|c| *c >= RECORDS.min_readings_of_own_noise)
    };
    let few = readings.iter().any(|counts| !enough(counts));
    // Group 0 is shared, if any trajectory has too few readings.
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
    SensorGroups {
        group: records.iter().map(|r| own[r.trajectory]).collect(),
        groups: groups.max(1),
        states,
    }
}
