//! Runs over segments of one record, from any row and any state.
//!
//! In: a [`Source`], the number of a trajectory. Out: the state at each row of a segment, up to a fault. Equations are compiled and
//! inputs interpolated once for all segments. Never estimates a state, compares nothing.

use std::ops::Range;

use crate::discovery::Form;
use crate::simulate::Source;
use crate::simulate::compiled::compiled_system::CompiledSystem;
use crate::simulate::contiguous_legs::legs;
use crate::simulate::diagnostics as refuse;
use crate::simulate::fault::FaultKind;
use crate::simulate::inputs::interpolation::InputSource;
use crate::simulate::inputs::sources::{self, Inputs};
use crate::simulate::integrate::continuous_time::LegSetup;
use crate::simulate::record_path::RecordPath;
use crate::simulate::run::Method;
use crate::simulate::thresholds::SEGMENTS;
use sidc_data::{Dataset, Trajectory};
use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::term::Signal;
use sidc_progress::Observer;

/// A record with everything that runs along parts of it need.
pub struct SegmentRuns {
    record: Trajectory,
    system: CompiledSystem,
    drives: Inputs,
    /// Typical sizes of the state.
    sizes: Vec<f64>,
    discrete: bool,
}

/// The state at the rows of a segment.
#[derive(Clone, Debug, Default)]
pub struct SegmentRun {
    /// State by row; fewer rows than the segment has if there is a fault.
    pub states: Vec<Vec<f64>>,
    /// What ended the run early.
    pub fault: Option<FaultKind>,
}

impl SegmentRuns {
    /// # Errors
    /// There is nothing to run, or an input is missing: one diagnostic.
    pub fn new(source: &Source, trajectory: usize) -> Result<SegmentRuns, Diagnostic> {
        let d = source.discovery;
        if d.equations.is_empty() {
            return Err(refuse::nothing(d));
        }
        let record = source.dataset.trajectories.get(trajectory);
        let record = record.filter(|t| !t.is_empty()).cloned();
        let record = record.ok_or_else(refuse::no_rows)?;
        let alone = Dataset {
            trajectories: vec![record.clone()],
            inputs: source.dataset.inputs.clone(),
            ..Dataset::default()
        };
        let system = CompiledSystem::new(Form::new(d)).map_err(|s| refuse::unknown_signal(d, s))?;
        let form = &system.form;
        let drives = sources::input_sources(d, source.model, &alone, form, &mut Vec::new())?;
        let sizes = form.state.iter().map(|s| sources::size((d, &record), *s));
        Ok(SegmentRuns {
            sizes: sizes.collect(),
            discrete: d.discrete,
            record,
            drives,
            system,
        })
    }

    /// Components of the state, in the order of [`SegmentRun::states`].
    pub fn state(&self) -> &[Signal] {
        &self.system.form.state
    }

    /// Samples before a row that the equations read.
    pub fn history(&self) -> &[Signal] {
        &self.system.form.history
    }

    /// Typical size of each component.
    pub fn sizes(&self) -> &[f64] {
        &self.sizes
    }

    pub fn record(&self) -> &Trajectory {
        &self.record
    }

    /// Rows between gaps, in each of which runs may go on.
    pub fn contiguous(&self) -> Vec<Range<usize>> {
        let driven = !self.system.form.inputs.is_empty();
        legs(&self.record.time, self.discrete, driven)
    }

    /// The inputs from a row to the next, at the middle between both; in discrete time at the row.
    pub fn inputs(&self, row: usize) -> Vec<f64> {
        let time = &self.record.time;
        let (from, to) = (time.get(row), time.get(row + 1).or(time.get(row)));
        let middle = from.zip(to).map_or(f64::NAN, |(a, b)| 0.5 * (a + b));
        let signals = self.system.form.inputs.iter();
        let value = |(source, signal): (&InputSource, &Signal)| match source {
            InputSource::SampledInput(c) if self.discrete => {
                c.sample(row.saturating_add_signed(signal.shift as isize))
            }
            _ => source.line(time, middle).at(middle),
        };
        self.drives.inputs.iter().zip(signals).map(value).collect()
    }

    /// Runs along the rows from a state at the first of them, to the accuracy of readings.
    pub fn run(&self, rows: Range<usize>, x: &[f64], observer: &mut dyn Observer) -> SegmentRun {
        let begin = rows.start;
        let Some(time) = self.record.time.get(rows) else {
            return SegmentRun::default();
        };
        let unknowns = vec![0.0; self.system.form.unknowns.len()];
        let leg = LegSetup {
            system: &self.system,
            drives: &self.drives.inputs,
            time,
            sampled: &self.record.time,
            params: &self.drives.params,
            guess: &unknowns,
            method: Method::Auto,
            step: None,
        };
        let along = RecordPath {
            record: &self.record,
            system: &self.system,
            drives: &self.drives,
            sizes: &self.sizes,
            discrete: self.discrete,
            tolerance: SEGMENTS.tolerance,
            past: &[],
        };
        let budget = SEGMENTS.evaluations + SEGMENTS.evaluations_a_row * time.len() as u64;
        let path = along.run(&leg, x, (begin, budget), observer);
        let width = x.len();
        let state = |k: usize| path.rows.row(k).and_then(|row| row.get(..width));
        SegmentRun {
            states: (0..path.rows.len())
                .filter_map(|k| state(k).map(<[f64]>::to_vec))
                .collect(),
            fault: path.fault.map(|f| f.kind),
        }
    }
}
