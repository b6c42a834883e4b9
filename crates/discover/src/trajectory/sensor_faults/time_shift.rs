//! Problems with inputs shifted in time, and records cut to the instants for which the shifted inputs are known.
//!
//! In: a problem, inputs, a shift in samples. Out: the shifted problem. Fits nothing.

use crate::trajectory::model::{LinearizationPoint, Problem, Record};
use crate::trajectory::thresholds::DELAYS;
use sidc_data::median_step;
use sidc_lang::term::VarId;

/// The problem with inputs delayed, over the instants for which all delays within `reach` know them.
pub(crate) fn moved(problem: &Problem, inputs: &[VarId], samples: f64, reach: usize) -> Problem {
    cut(&shifted(problem, inputs, samples), reach, reach)
}

/// A point cut like the records.
pub(crate) fn cut_point(
    problem: &Problem,
    point: &LinearizationPoint,
    (front, back): (usize, usize),
) -> LinearizationPoint {
    let n = problem.states();
    let part = |(record, path): (&Record, &Vec<f64>)| {
        let (from, to) = kept(record, front, back);
        path[from * n..to * n].to_vec()
    };
    LinearizationPoint {
        paths: problem.records.iter().zip(&point.paths).map(part).collect(),
        ..point.clone()
    }
}

/// Longest delay in samples: the longest record is to keep enough of them.
pub(crate) fn reach(problem: &Problem) -> usize {
    let longest = problem.records.iter().map(Record::len).max().unwrap_or(0);
    (longest / DELAYS.max_cut).min(DELAYS.screened[DELAYS.screened.len() - 1])
}

/// Median sampling interval of all records, seconds.
pub(crate) fn step(problem: &Problem) -> Option<f64> {
    median_step(problem.records.iter().map(|r| r.time.as_slice()))
}

/// Samples of a record that stay; short records are not cut.
fn kept(record: &Record, front: usize, back: usize) -> (usize, usize) {
    let length = record.len();
    match length < DELAYS.max_cut * front.max(back) {
        true => (0, length),
        false => (front, length - back),
    }
}

/// The problem without the first `front` and the last `back` samples of its records.
pub(crate) fn cut(problem: &Problem, front: usize, back: usize) -> Problem {
    let (n, m) = (problem.states(), problem.system.laws.len());
    let mut out = problem.clone();
    for (record, curve) in out.records.iter_mut().zip(&mut out.smoothed) {
        let (from, to) = kept(record, front, back);
        *record = record.part(from..to);
        *curve = curve.part(from..to, n, m);
    }
    out.left_out.retain_mut(|l| {
        let Some((from, to)) = problem.records.get(l.record).map(|r| kept(r, front, back)) else {
            return false;
        };
        let stays = (from..to).contains(&l.sample);
        l.sample = l.sample.saturating_sub(from);
        stays
    });
    out.update_noise();
    out
}

/// The problem with inputs delayed, its records uncut.
pub(crate) fn shifted(problem: &Problem, inputs: &[VarId], samples: f64) -> Problem {
    let mut out = problem.clone();
    let seconds = samples * step(problem).unwrap_or(0.0);
    for (late, record) in out.records.iter_mut().zip(&problem.records) {
        let signals = problem.system.exogenous.iter().zip(&mut late.exogenous);
        for (i, (_, exogenous)) in signals
            .enumerate()
            .filter(|(_, (s, _))| inputs.contains(&s.var))
        {
            let at = record.time.iter().map(|t| t - seconds);
            exogenous.values = at.map(|t| value_at(record, i, t)).collect();
        }
    }
    out
}

/// Value of an exogenous signal at an instant; beyond the ends of the record, its value there.
fn value_at(record: &Record, signal: usize, at: f64) -> f64 {
    let time = &record.time;
    let next = time.partition_point(|t| *t <= at);
    if next == 0 || next == time.len() {
        return record.exogenous_at(signal, next.min(time.len().saturating_sub(1)), 0.0);
    }
    let part = (at - time[next - 1]) / (time[next] - time[next - 1]);
    match record.exogenous[signal].is_held() {
        // Delays of held inputs are whole samples; the comparison allows for rounding of time.
        true => record.exogenous_at(signal, next - usize::from(part <= 0.5), 0.0),
        false => record.exogenous_at(signal, next - 1, part),
    }
}
