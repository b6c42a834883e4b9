//! Trajectories as they were measured, and how each input moves between samples.

use sidc_lang::model::{Between, Model};
use sidc_lang::term::{Signal, VarId};

use super::rate_fault::RateFault;

/// All trajectories, in the order of files, then of appearance.
#[derive(Clone, Debug, Default)]
pub struct Dataset {
    pub trajectories: Vec<Trajectory>,
    /// How each measured input moves between samples, in the order of declaration.
    pub inputs: Vec<Input>,
    /// Rates that contradict the samples of their states.
    pub rate_faults: Vec<RateFault>,
    /// Headers of the columns that move and that the model does not read, in the order of files.
    pub unread: Vec<String>,
}

/// An input's intersample behaviour, declared or inferred from its record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Input {
    pub var: VarId,
    pub between: Between,
    pub declared: bool,
}

/// The value of a constant, in all runs or in one.
#[derive(Clone, Debug, PartialEq)]
pub struct ConstantValue {
    pub signal: Signal,
    /// The name of the run whose value it is.
    pub run: Option<String>,
    pub value: f64,
}

impl Trajectory {
    /// Gives every unknown constant that has no column a constant one, with the value from which its search starts.
    pub(crate) fn start_unknowns(&mut self, model: &Model) {
        for unknown in &model.unknowns {
            let signal = Signal::new(unknown.var);
            if self.columns.iter().all(|(s, _)| *s != signal) {
                let column = vec![unknown.start(); self.time.len()];
                self.columns.push((signal, column));
            }
        }
        self.columns.sort_by_key(|(s, _)| *s);
    }
}

impl Dataset {
    /// The records for a model that has further unknown constants.
    #[must_use]
    pub fn with_unknowns_of(mut self, model: &Model) -> Dataset {
        let all = self.trajectories.iter_mut();
        all.for_each(|t| t.start_unknowns(model));
        self
    }

    /// The records with these values in the columns of constants. A run without a value gets the mean of the others. Runs of the same
    /// name, from files in several folders, are told apart by their order.
    pub fn with_constants(&self, values: &[ConstantValue]) -> Dataset {
        let mut data = self.clone();
        let mut seen: Vec<String> = Vec::new();
        for trajectory in &mut data.trajectories {
            let place = seen.iter().filter(|n| **n == trajectory.name).count();
            seen.push(trajectory.name.clone());
            for (signal, column) in &mut trajectory.columns {
                let all = || values.iter().filter(|v| v.signal == *signal);
                let named = || all().filter(|v| v.run.as_ref() == Some(&trajectory.name));
                let own = named().nth(place).or_else(|| named().next());
                let mean = all().map(|v| v.value).sum::<f64>() / all().count().max(1) as f64;
                if all().next().is_some() {
                    column.fill(own.map_or(mean, |v| v.value));
                }
            }
        }
        data
    }

    /// How an input moves between samples; `None` if the variable is not a measured input.
    pub fn between(&self, var: VarId) -> Option<Between> {
        self.inputs.iter().find(|i| i.var == var).map(|i| i.between)
    }

    /// How a signal moves between samples: straight, unless it is a measured input that does not.
    pub fn between_samples(&self, signal: Signal) -> Between {
        let input = self.between(signal.var).filter(|_| signal.der == 0);
        input.unwrap_or(Between::Linear)
    }

    /// Whether some record has a column of this signal.
    pub fn has(&self, s: Signal) -> bool {
        self.trajectories.iter().any(|t| t.column(s).is_some())
    }

    /// The same records as if these signals had not been measured.
    pub fn without(&self, signals: &[Signal]) -> Dataset {
        let mut rest = self.clone();
        for trajectory in &mut rest.trajectories {
            trajectory.columns.retain(|(s, _)| !signals.contains(s));
        }
        rest.rate_faults.retain(|f| !signals.contains(&f.signal));
        rest
    }
}

/// One uninterrupted record.
#[derive(Clone, Debug, Default)]
pub struct Trajectory {
    /// File name without folders, and the run's id if one file holds several.
    pub name: String,
    /// Index of its file.
    pub file: usize,
    /// Seconds, strictly rising; sample numbers in discrete time. Length M.
    pub time: Vec<f64>,
    /// Measured signals in model units, each of length M; NaN marks a missing value. Sorted by signal.
    pub columns: Vec<(Signal, Vec<f64>)>,
}

impl Trajectory {
    pub fn len(&self) -> usize {
        self.time.len()
    }

    pub fn is_empty(&self) -> bool {
        self.time.is_empty()
    }

    /// The given rows as a trajectory of their own.
    ///
    /// # Panics
    /// If the range exceeds the trajectory.
    pub fn part(&self, rows: std::ops::Range<usize>) -> Trajectory {
        let cut = |v: &[f64]| v[rows.clone()].to_vec();
        Trajectory {
            name: self.name.clone(),
            file: self.file,
            time: cut(&self.time),
            columns: self.columns.iter().map(|(s, v)| (*s, cut(v))).collect(),
        }
    }

    pub fn column(&self, s: Signal) -> Option<&[f64]> {
        self.columns
            .iter()
            .find(|(c, _)| *c == s)
            .map(|(_, v)| v.as_slice())
    }
}
