//! The numbers that are sought: a value of each unknown constant for all runs, or one for each run.
//!
//! In: a model, samples. Out: the list of these numbers, and samples with their values. Finds none.

use sidc_data::{ConstantValue, Dataset, Samples};
use sidc_lang::model::{Model, UnknownConstant};
use sidc_lang::term::Signal;

/// One number that is sought.
#[derive(Clone, Copy, Debug)]
pub struct SearchedConstant {
    /// The place of the constant among those of the model.
    pub place: usize,
    pub unknown: UnknownConstant,
    /// The trajectory whose value it is; `None` where all share it.
    pub run: Option<u32>,
}

/// The numbers that are sought on some samples: constants in order of declaration, those that differ from run to run by run.
pub fn sought(model: &Model, samples: &Samples) -> Vec<SearchedConstant> {
    let mut runs = samples.trajectory.clone();
    runs.dedup();
    runs.sort_unstable();
    runs.dedup();
    let each = model.unknowns.iter().enumerate();
    let values = each.flat_map(|(place, unknown)| {
        let runs = match unknown.per_run {
            true => runs.iter().copied().map(Some).collect(),
            false => vec![None],
        };
        let one = move |run| SearchedConstant {
            place,
            unknown: *unknown,
            run,
        };
        runs.into_iter().map(one)
    });
    values.collect()
}

/// One value of each constant for all runs.
pub(super) fn shared(model: &Model) -> Vec<SearchedConstant> {
    let each = model.unknowns.iter().enumerate();
    let one = |(place, unknown): (usize, &UnknownConstant)| SearchedConstant {
        place,
        unknown: *unknown,
        run: None,
    };
    each.map(one).collect()
}

impl SearchedConstant {
    pub fn signal(&self) -> Signal {
        Signal::new(self.unknown.var)
    }

    /// Whether it is the value in this trajectory.
    pub fn holds_in(&self, trajectory: u32) -> bool {
        self.run.is_none_or(|run| run == trajectory)
    }
}

/// The samples with these values.
pub fn with_values(samples: &Samples, sought: &[SearchedConstant], values: &[f64]) -> Samples {
    let mut samples = samples.clone();
    set_values(&mut samples, sought, values);
    samples
}

pub(super) fn set_values(samples: &mut Samples, sought: &[SearchedConstant], values: &[f64]) {
    let trajectory = &samples.trajectory;
    for (s, value) in sought.iter().zip(values) {
        let own = samples.columns.iter_mut().find(|c| c.signal == s.signal());
        let cells = own.into_iter().flat_map(|c| &mut c.values);
        let cells = cells.zip(trajectory).filter(|(_, run)| s.holds_in(**run));
        cells.for_each(|(cell, _)| *cell = *value);
    }
}

/// The values that samples have; `None` where they lack a column or a run.
pub fn values_of(samples: &Samples, sought: &[SearchedConstant]) -> Option<Vec<f64>> {
    let one = |s: &SearchedConstant| {
        let mut rows = samples.trajectory.iter();
        let row = rows.position(|run| s.holds_in(*run))?;
        samples.column(s.signal())?.values.get(row).copied()
    };
    sought.iter().map(one).collect()
}

/// The values with the names of their runs. Other runs take the mean.
pub fn named_values(
    dataset: &Dataset,
    sought: &[SearchedConstant],
    values: &[f64],
) -> Vec<ConstantValue> {
    let mut all = Vec::new();
    for (s, value) in sought.iter().zip(values) {
        let run = s.run.and_then(|run| dataset.trajectories.get(run as usize));
        let (signal, run) = (s.signal(), run.map(|t| t.name.clone()));
        all.push(ConstantValue {
            signal,
            run,
            value: *value,
        });
    }
    all
}
