//! The subject of a report: a result, records, and runs along them.

use std::borrow::Cow;

use sidc_data::{Dataset, Trajectory, Window};
use sidc_lang::term::{Signal, SignalNames};
use sidc_system::discovery::Discovery;
use sidc_system::result::{Document, FileEntry};
use sidc_system::simulate::{Run, Score};
use sidc_system::verdict::RunStatus;

/// All that a report shows.
#[derive(Clone, Copy)]
pub struct Subject<'a> {
    pub discovery: &'a Discovery,
    pub document: &'a Document,
    /// File name of the document, without folders.
    pub name: &'a str,
    pub dataset: &'a Dataset,
    /// Runs in the order of trajectories and their ranges; fewer if they were stopped.
    pub runs: &'a [RecordRun],
    /// The data files as they are now, in the order of [`Trajectory::file`].
    pub files: &'a [FileEntry],
}

/// A run along a record or a range of it.
#[derive(Clone, Debug)]
pub struct RecordRun {
    /// Index of the trajectory.
    pub trajectory: usize,
    /// True for a hold-out range of a record that the equations were found from.
    pub held_out: bool,
    /// `Err` says why there is none.
    pub run: Result<Run, String>,
}

/// How the equations relate to a record.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Role {
    /// They were found from it, except for its hold-out ranges.
    Used(Vec<(f64, f64)>),
    /// It was held out as a whole.
    Held,
    /// They were found without it.
    Other,
    /// A file of this name was used, but with other content.
    Changed,
}

impl Role {
    pub fn description(&self) -> &'static str {
        match self {
            Role::Used(held) if held.is_empty() => "the equations were found from it",
            Role::Used(_) => {
                "the equations were found from it, but for what is shaded, which was held out; each stretch is run anew from its own first row"
            }
            Role::Held => "held out: the equations were not found from it",
            Role::Other => "other data: the equations were not found from it",
            Role::Changed => {
                "not the file of this name that the equations were found from: its SHA-256 differs"
            }
        }
    }
}

/// A record and its runs.
#[derive(Clone)]
pub(crate) struct Record<'a> {
    pub trajectory: &'a Trajectory,
    pub runs: Vec<(bool, &'a Run)>,
}

/// The ranges of a record that are simulated separately: hold-out ranges, and those between. One unbounded range if nothing was held out.
pub fn run_windows(document: &Document, trajectory: &Trajectory) -> Vec<(bool, Window)> {
    let runs = document.validation.iter().flat_map(|v| &v.runs);
    let own = runs.filter(|r| r.record == trajectory.name);
    let mut all: Vec<(bool, Window)> = own
        .map(|r| (r.held_out, (Some(r.from), Some(r.to))))
        .collect();
    all.sort_by(|a, b| {
        a.1.0
            .partial_cmp(&b.1.0)
            .unwrap_or(std::cmp::Ordering::Equal)
    });
    let known = document.settings.data.contains(&trajectory.name);
    match known && all.iter().any(|(held, _)| *held) {
        true => all,
        false => vec![(false, (None, None))],
    }
}

impl<'a> Subject<'a> {
    /// Records with runs along them.
    pub(crate) fn records(&self) -> Vec<Record<'a>> {
        let all = self.dataset.trajectories.iter().enumerate();
        all.filter_map(|(i, trajectory)| {
            let own = self.runs.iter().filter(|a| a.trajectory == i);
            let runs: Vec<_> = own
                .filter_map(|a| Some((a.held_out, a.run.as_ref().ok()?)))
                .collect();
            (!runs.is_empty()).then_some(Record { trajectory, runs })
        })
        .collect()
    }

    /// Whether free runs depart because small differences grow.
    pub(crate) fn is_sensitive(&self) -> bool {
        let verdict = self.document.verdict.as_ref();
        verdict.is_some_and(|v| v.run.status == RunStatus::Sensitive)
    }

    pub(crate) fn role(&self, trajectory: &Trajectory) -> Role {
        let settings = &self.document.settings;
        let given = self.files.get(trajectory.file);
        if let Some(given) = given {
            let same_name = |f: &&FileEntry| f.name == given.name;
            let known = settings.files.iter().skip(1).find(same_name);
            match known {
                Some(known) if known.sha256 != given.sha256 => return Role::Changed,
                None if !settings.files.is_empty() => return Role::Other,
                _ => {}
            }
        }
        let runs = self.document.validation.iter().flat_map(|v| &v.runs);
        let own = runs.filter(|r| r.record == trajectory.name);
        let held = own.filter(|r| r.held_out).map(|r| (r.from, r.to)).collect();
        match settings.data.contains(&trajectory.name) {
            true => Role::Used(held),
            false if held.is_empty() => Role::Other,
            false => Role::Held,
        }
    }

    /// Name and unit of a signal, as on an axis: `theta (rad)`.
    pub(crate) fn axis_label(&self, s: Signal) -> String {
        let unit = self.discovery.unit(s).map(|u| u.to_string());
        let name = self.discovery.name(s);
        match unit.filter(|u| !u.is_empty() && u != "1") {
            Some(unit) => format!("{name} ({unit})"),
            None => name,
        }
    }

    /// The unit of time.
    pub(crate) fn time_label(&self) -> String {
        match self.discovery.unit(Signal::TIME) {
            _ if self.discovery.discrete => "sample".into(),
            Some(unit) => format!("t ({unit})"),
            None => "t (s)".into(),
        }
    }

    /// A time as text.
    pub(crate) fn time_text(&self, t: f64) -> String {
        let value = crate::report::markup::number(t, 6);
        match self.discovery.discrete {
            true => format!("sample {value}"),
            false => format!("t = {value} {}", self.discovery.time_unit()),
        }
    }

    /// A duration as text.
    pub(crate) fn duration_text(&self, t: f64) -> String {
        let unit = self.discovery.time_unit();
        format!("{} {unit}", crate::report::markup::number(t, 3))
    }
}

impl<'a> Record<'a> {
    /// Readings of a signal, if there are any.
    pub fn measured(&self, s: Signal) -> Option<&'a [f64]> {
        let column = self.trajectory.column(s)?;
        column.iter().any(|v| v.is_finite()).then_some(column)
    }

    /// The readings of a signal at these times; NaN where there is none.
    pub fn read_at(&self, s: Signal, instants: &[f64]) -> Option<Vec<f64>> {
        let (column, time) = (self.measured(s)?, &self.trajectory.time);
        let at = |t: &f64| {
            let row = time.partition_point(|known| known < t);
            let read = time.get(row).filter(|known| *known == t);
            read.and_then(|_| column.get(row))
                .copied()
                .unwrap_or(f64::NAN)
        };
        Some(instants.iter().map(at).collect())
    }

    /// Signals that are simulated.
    pub fn simulated(&self) -> Vec<Signal> {
        let first = self.runs.first().map(|(_, run)| &run.simulated);
        first.into_iter().flatten().map(|(s, _)| *s).collect()
    }

    /// Inputs that were applied.
    pub fn inputs(&self) -> Vec<Signal> {
        let first = self.runs.first().map(|(_, run)| &run.inputs);
        first.into_iter().flatten().map(|(s, _)| *s).collect()
    }

    pub fn scores(&self, s: Signal) -> impl Iterator<Item = (bool, &'a Run, &'a Score)> {
        self.runs.iter().flat_map(move |(held, run)| {
            let own = run.scores.iter().filter(move |score| score.signal == s);
            own.map(|score| (*held, *run, score))
        })
    }

    /// Times and values of a column of all runs, one after the other, separated by a NaN.
    fn joined(
        &self,
        column: impl Fn(&Run) -> Option<Cow<'_, [f64]>>,
    ) -> Option<(Vec<f64>, Vec<f64>)> {
        let (mut time, mut values) = (Vec::new(), Vec::new());
        for (_, run) in &self.runs {
            let Some(own) = column(run) else { continue };
            if let Some(last) = time.last().copied() {
                time.push(last);
                values.push(f64::NAN);
            }
            let rows = own.len().min(run.time.len());
            time.extend(run.time.iter().take(rows));
            values.extend(own.iter().take(rows));
        }
        values
            .iter()
            .any(|v| v.is_finite())
            .then_some((time, values))
    }

    /// Times and values of a simulated signal.
    pub fn column(&self, s: Signal) -> Option<(Vec<f64>, Vec<f64>)> {
        self.joined(|run| run.column(s).map(Cow::Borrowed))
    }

    /// Times and values of an input as applied.
    pub fn input(&self, s: Signal) -> Option<(Vec<f64>, Vec<f64>)> {
        self.joined(|run| {
            let found = run.inputs.iter().find(|(name, _)| *name == s);
            found.map(|(_, values)| Cow::Borrowed(values.as_slice()))
        })
    }

    /// Times and residuals, simulated minus measured; NaN where either is missing or the start was fitted.
    pub fn residual(&self, s: Signal) -> Option<(Vec<f64>, Vec<f64>)> {
        self.joined(|run| residual(run, s).map(Cow::Owned))
    }
}

fn residual(run: &Run, s: Signal) -> Option<Vec<f64>> {
    let simulated = run.column(s)?;
    let (_, measured) = run.measured.iter().find(|(m, _)| *m == s)?;
    let mut out: Vec<f64> = (simulated.iter().zip(measured))
        .map(|(a, b)| a - b)
        .collect();
    for leg in &run.legs {
        let settled = leg.rows.start..leg.rows.start + leg.settled;
        if let Some(rows) = out.get_mut(settled) {
            rows.fill(f64::NAN);
        }
    }
    Some(out)
}
