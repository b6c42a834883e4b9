//! From a dataset to the rows that equations are found from: every needed signal, measured or estimated.
//!
//! In: a model, its dataset, the signals needed, somebody to tell of each. Out: [`Samples`], and how each signal was come by. Measured derivatives are
//! used as measured; absent ones are estimated from the highest measured one below. Nothing crosses a gap or a trajectory.

use std::ops::ControlFlow;

use crate::lang::diagnostic::Diagnostic;
use crate::lang::model::Model;
use crate::term::{Signal, SignalNames};

use super::derivatives::{self, Grid, Stopped, Stretch};
use super::{Column, Dataset, Origin, Samples, Trajectory, inputs, instants};

/// How one signal was come by, for printing.
#[derive(Clone, Debug)]
pub struct Provenance {
    pub signal: Signal,
    pub measured: bool,
    /// `measured`, or how it was estimated, in a few words.
    pub method: String,
    /// Median standard error of the estimates, in units of the signal.
    pub error: Option<f64>,
    /// Root mean square of the signal over the rows.
    pub rms: f64,
}

/// Told which signal is being prepared, at its start and some times on the way; `Break` ends the work with no rows at all.
pub type SignalMonitor<'a> = &'a mut dyn FnMut(Signal) -> ControlFlow<()>;

/// All `needed` signals at common instants, what is to be said about them, and how each was come by (sorted by signal).
///
/// Rows at which any needed signal is unknown are left out. Errors: `no-signal`, `no-samples`.
pub fn samples(
    model: &Model,
    dataset: &Dataset,
    needed: &[Signal],
    monitor: SignalMonitor,
) -> (Samples, Vec<Diagnostic>, Vec<Provenance>) {
    let mut needed = needed.to_vec();
    needed.sort();
    needed.dedup();
    let mut out = Vec::new();
    let mut columns: Vec<Gathered> = needed.iter().map(|s| Gathered::new(*s)).collect();
    let mut table = Samples::default();
    let (mut left_out, mut rows_read) = (0, 0);
    let mut often = Often::default();
    for (index, trajectory) in dataset.trajectories.iter().enumerate() {
        let source = Source::new(model, dataset, trajectory);
        let mut found: Vec<Known> = Vec::with_capacity(needed.len());
        for signal in &needed {
            let mut go_on = || monitor(*signal).is_continue();
            let known = match go_on() {
                true => source.signal(*signal, &mut often, &mut go_on),
                false => Err(Stopped),
            };
            match known {
                Ok(Some(known)) => found.push(known),
                Ok(None) => out.push(no_signal(model, trajectory, *signal)),
                Err(Stopped) => return Default::default(),
            }
        }
        if found.len() < needed.len() {
            continue;
        }
        let whole = |row: &usize| {
            found
                .iter()
                .all(|k| k.values.get(*row).is_some_and(|x| x.is_finite()))
        };
        let rows: Vec<usize> = (0..trajectory.len()).filter(whole).collect();
        rows_read += trajectory.len();
        left_out += trajectory.len() - rows.len();
        table.trajectory.extend(rows.iter().map(|_| index as u32));
        table.time.extend(pick(&trajectory.time, &rows));
        for (column, known) in columns.iter_mut().zip(found) {
            column.extend(known, &rows);
        }
    }
    if out.is_empty() && table.is_empty() {
        out.push(no_samples(rows_read));
    } else if left_out > 0 && out.is_empty() {
        // In discrete time every trajectory loses the rows that its shifts reach beyond: no word on those.
        let shifts: usize = needed
            .iter()
            .map(|s| s.shift.unsigned_abs() as usize)
            .max()
            .unwrap_or(0);
        if !model.discrete || left_out > 2 * shifts * dataset.trajectories.len() {
            out.push(rows_left_out(left_out, rows_read, model.discrete));
        }
    }
    if 2 * often.crossed > often.rows {
        out.push(input_changes_often(often));
    }
    let report: Vec<Provenance> = columns.iter().map(Gathered::provenance).collect();
    for p in &report {
        if let Some(error) = p.error.filter(|e| *e > 0.3 * p.rms) {
            out.push(noisy_derivative(model, p, error));
        }
    }
    let noisy = |c: Gathered| {
        let noise = model.noise(c.signal);
        c.into_column(noise)
    };
    table.columns = columns.into_iter().map(noisy).collect();
    (table, out, report)
}

/// One signal along one trajectory; NaN where it is unknown.
struct Known {
    values: Vec<f64>,
    /// `None` if measured.
    estimated: Option<Estimated>,
}

/// What is known of an estimate beside its values.
struct Estimated {
    error: Vec<f64>,
    method: String,
    correlation: f64,
}

/// Rows whose derivatives had to be estimated across jumps of an input.
#[derive(Clone, Copy, Debug, Default)]
struct Often {
    crossed: usize,
    rows: usize,
}

/// A trajectory with what the estimates of all its signals share.
struct Source<'a> {
    model: &'a Model,
    trajectory: &'a Trajectory,
    grid: Grid,
    gaps: Vec<usize>,
    jumps: Vec<usize>,
    unseen: inputs::Unseen,
}

impl<'a> Source<'a> {
    fn new(model: &'a Model, dataset: &Dataset, trajectory: &'a Trajectory) -> Self {
        Source {
            model,
            trajectory,
            grid: Grid::new(&trajectory.time),
            gaps: instants::gaps(&trajectory.time),
            jumps: inputs::jumps(&dataset.inputs, trajectory),
            unseen: inputs::unseen(&dataset.inputs, trajectory),
        }
    }

    fn signal(
        &self,
        s: Signal,
        often: &mut Often,
        go_on: &mut dyn FnMut() -> bool,
    ) -> Result<Option<Known>, Stopped> {
        let measured = |values: Vec<f64>| Known {
            values,
            estimated: None,
        };
        if s.shift != 0 {
            let base = Signal { shift: 0, ..s };
            let base = self.plain(base);
            return Ok(base.map(|values| measured(self.shifted(&values, s.shift))));
        }
        if let Some(values) = self.plain(s) {
            return Ok(Some(measured(values)));
        }
        let mut lower = (0..s.der).rev().map(|der| Signal { der, ..s });
        let below = lower.find_map(|b| Some((b, self.trajectory.column(b)?)));
        match below {
            Some((below, values)) if s.der - below.der <= 3 => {
                let order = (s.der - below.der) as usize;
                let known = self.derivative(values, below, order, often, go_on)?;
                Ok(Some(known))
            }
            _ => Ok(None),
        }
    }

    fn plain(&self, s: Signal) -> Option<Vec<f64>> {
        match self.trajectory.column(s) {
            Some(values) => Some(values.to_vec()),
            None => (s == Signal::TIME).then(|| self.trajectory.time.clone()),
        }
    }

    /// The sample whose number is `by` higher, where there is one.
    fn shifted(&self, values: &[f64], by: i32) -> Vec<f64> {
        let time = &self.trajectory.time;
        let at = |row: usize| -> Option<f64> {
            let target = row.checked_add_signed(by as isize)?;
            let apart = time.get(target)? - time.get(row)?;
            (apart == by as f64)
                .then(|| values.get(target).copied())
                .flatten()
        };
        (0..values.len())
            .map(|row| at(row).unwrap_or(f64::NAN))
            .collect()
    }

    /// Highest derivative of a signal's variable: the one that inputs move at once.
    fn order(&self, s: Signal) -> usize {
        self.model.var(s.var).map_or(1, |v| v.order as usize)
    }

    fn derivative(
        &self,
        values: &[f64],
        below: Signal,
        order: usize,
        often: &mut Often,
        go_on: &mut dyn FnMut() -> bool,
    ) -> Result<Known, Stopped> {
        let noise = self.model.noise(below);
        let within = stretches(values, &self.gaps, &self.jumps);
        let mut e = derivatives::differentiate(&self.grid, values, &within, order, noise, go_on)?;
        let driven = below.der as usize + order >= self.order(below);
        let size = if driven { rms(&e.values) } else { 0.0 };
        let mut across = 0;
        if !self.jumps.is_empty() {
            // Short stretches and noise can make it better to step over a jump than to respect it: the errors decide.
            let open = stretches(values, &self.gaps, &[]);
            let wide = derivatives::differentiate(&self.grid, values, &open, order, noise, go_on)?;
            for (i, (value, error)) in wide.values.iter().zip(&wide.error).enumerate() {
                let (Some(v), Some(s)) = (e.values.get_mut(i), e.error.get_mut(i)) else {
                    continue;
                };
                // At the jump itself a window across it sees the mean of both sides and no sign of doubt:
                // what the two estimates differ by, beyond the error of the one that respects the jump, is bias.
                let bias = ((value - *v).powi(2) - *s * *s).max(0.0);
                let hidden = size * self.unseen.across.get(i).unwrap_or(&0.0);
                let bias = if v.is_nan() { 0.0 } else { bias } + hidden * hidden;
                let error = (error * error + bias).sqrt();
                if v.is_nan() && value.is_finite() || error < 0.5 * *s {
                    (*v, *s) = (*value, error);
                    across += 1;
                }
            }
            if 2 * across > values.len() {
                (e.points, e.degree) = (wide.points, wide.degree);
            }
            let short: usize = within
                .iter()
                .filter(|s| s.len() < 5)
                .map(|s| s.rows_end - s.start)
                .sum();
            often.crossed += short;
        }
        for (error, corner) in e.error.iter_mut().zip(&self.unseen.corners) {
            *error = error.hypot(size * corner);
        }
        often.rows += values.len();
        let of = self.model.name(below);
        let correlation = e.correlation();
        let method = format!(
            "local polynomial of {of}, degree {} on {} points",
            e.degree, e.points
        );
        Ok(Known {
            values: e.values,
            estimated: Some(Estimated {
                method,
                correlation,
                error: e.error,
            }),
        })
    }
}

/// Root mean square of the finite values.
fn rms(values: &[f64]) -> f64 {
    let finite = values.iter().filter(|v| v.is_finite());
    let (sum, count) = finite.fold((0.0, 0.0), |(s, n), v| (s + v * v, n + 1.0));
    (sum / f64::max(count, 1.0)).sqrt()
}

/// Uninterrupted stretches of finite values, cut at gaps, and at jumps with the sample of the jump in both.
fn stretches(values: &[f64], gaps: &[usize], jumps: &[usize]) -> Vec<Stretch> {
    let mut out = Vec::new();
    let mut start: Option<usize> = None;
    let mut close = |start: usize, end: usize, rows_end: usize| {
        out.push(Stretch {
            start,
            end,
            rows_end,
        });
    };
    let (mut gaps, mut jumps) = (gaps.iter().peekable(), jumps.iter().peekable());
    for (i, x) in values.iter().enumerate() {
        let gap = gaps.next_if(|g| **g <= i).is_some();
        let jump = jumps.next_if(|j| **j <= i).is_some();
        match start {
            Some(a) if gap || !x.is_finite() => {
                close(a, i, i);
                start = x.is_finite().then_some(i);
            }
            Some(a) if jump => {
                close(a, i + 1, i);
                start = Some(i);
            }
            None if x.is_finite() => start = Some(i),
            _ => {}
        }
    }
    if let Some(a) = start {
        close(a, values.len(), values.len());
    }
    out
}

/// A column being put together from its trajectories.
struct Gathered {
    signal: Signal,
    values: Vec<f64>,
    error: Vec<f64>,
    method: Option<String>,
    correlation: f64,
}

impl Gathered {
    fn new(signal: Signal) -> Self {
        Gathered {
            signal,
            values: Vec::new(),
            error: Vec::new(),
            method: None,
            correlation: 1.0,
        }
    }

    fn extend(&mut self, known: Known, rows: &[usize]) {
        self.values.extend(pick(&known.values, rows));
        match known.estimated {
            Some(e) => {
                self.error.extend(pick(&e.error, rows));
                self.method.get_or_insert(e.method);
                self.correlation = self.correlation.max(e.correlation);
            }
            None => self.error.extend(rows.iter().map(|_| 0.0)),
        }
    }

    fn provenance(&self) -> Provenance {
        let mut errors = self.error.clone();
        errors.sort_by(f64::total_cmp);
        let squares: f64 = self.values.iter().map(|x| x * x).sum();
        Provenance {
            signal: self.signal,
            measured: self.method.is_none(),
            method: self.method.clone().unwrap_or("measured".into()),
            error: self
                .method
                .as_ref()
                .and_then(|_| errors.get(errors.len() / 2).copied()),
            rms: (squares / self.values.len().max(1) as f64).sqrt(),
        }
    }

    fn into_column(self, noise: Option<f64>) -> Column {
        Column {
            signal: self.signal,
            values: self.values,
            origin: match self.method {
                None => Origin::Measured { noise },
                Some(method) => Origin::Estimated {
                    error: self.error,
                    method,
                    correlation: self.correlation,
                },
            },
        }
    }
}

fn pick(values: &[f64], rows: &[usize]) -> Vec<f64> {
    rows.iter()
        .map(|r| values.get(*r).copied().unwrap_or(f64::NAN))
        .collect()
}

fn no_signal(model: &Model, trajectory: &Trajectory, signal: Signal) -> Diagnostic {
    let name = model.name(signal);
    let base = model.name(Signal::new(signal.var));
    let d = Diagnostic::error(
        "no-signal",
        format!(
            "{}: {name} is neither measured nor derivable",
            trajectory.name
        ),
    );
    if signal.der > 3 {
        return d.help(format!("derivatives are estimated up to three orders above a measured one; measure one nearer to {name}"));
    }
    d.help(format!("data {{ {base} = \"HEADER\" }}"))
}

fn no_samples(rows: usize) -> Diagnostic {
    Diagnostic::error(
        "no-samples",
        format!("none of the {rows} rows has all the signals that the equations need"),
    )
    .help("look for empty cells, or for records too short to take derivatives or shifts")
}

fn rows_left_out(count: usize, all: usize, discrete: bool) -> Diagnostic {
    let why = if discrete {
        "a value is missing, or a shift reaches beyond the record"
    } else {
        "a value is missing, or too few samples stand between gaps or jumps of an input"
    };
    Diagnostic::note(
        "rows-left-out",
        format!("{count} of {all} rows lack a signal and are left out"),
    )
    .fact(why)
}

fn input_changes_often(often: Often) -> Diagnostic {
    let percent = 100.0 * often.crossed as f64 / often.rows.max(1) as f64;
    Diagnostic::warning(
        "input-changes-often",
        format!("{percent:.0} % of the rows lie between jumps of an input fewer than 5 samples apart"),
    )
    .fact("derivatives there are estimated across the jumps, with large errors")
    .help("sample faster than the input is set, measure the derivatives, or declare the input linear if it is smooth")
}

fn noisy_derivative(model: &Model, p: &Provenance, error: f64) -> Diagnostic {
    let name = model.name(p.signal);
    Diagnostic::warning(
        "noisy-derivative",
        format!(
            "the estimate of {name} is off by about {:.0} % of its size",
            100.0 * error / p.rms
        ),
    )
    .fact(format!(
        "typical error {error:.3e}, rms of {name} {:.3e}",
        p.rms
    ))
    .help(format!(
        "measure {name}, sample faster, or declare the sensor's noise"
    ))
}
