//! An equation as a relation: how target − right side answers to each signal, row by row, in units of the signals' spreads.
//!
//! In: equations and the rows. Out: their slopes, and how far one is from being made of others. Two relations say the same
//! along the data if their slopes are parallel there: g₂ = f g₁ has ∇g₂ = f ∇g₁ wherever g₁ = 0, so that a factor, such as
//! cos theta, changes nothing. Judges nothing.

use nalgebra::DMatrix;

use crate::data::Samples;
use crate::discover::weights::rms;
use crate::discover::Form;
use crate::term::{Expr, Signal, Term};

/// Rows looked at.
const ROWS: usize = 200;

/// The rows looked at, and the signals that relations may answer to.
pub(super) struct Rows {
    /// Unknowns first.
    signals: Vec<Signal>,
    unknowns: usize,
    /// Spread of each signal; root mean square of an unknown.
    scales: Vec<f64>,
    /// Signals by rows.
    values: Vec<Vec<f64>>,
}

/// One equation's slopes.
#[derive(Clone)]
pub(super) struct Slopes {
    /// Row by row, a slope a signal, in units of the target.
    values: Vec<Vec<f64>>,
    /// Root mean square of their length.
    pub size: f64,
}

/// How far a relation is from being made of others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Apart {
    /// What of its slopes theirs do not give, root mean square, in units of its target.
    pub distance: f64,
    /// The same as a part of its slopes: 0 for the same relation, 1 for nothing in common.
    pub part: f64,
    /// The same as `distance`, for the unknowns' slopes alone.
    pub of_unknowns: f64,
    /// Median condition number of their mass matrix, its rows of unit length in units of the unknowns' sizes.
    pub condition: f64,
}

impl Rows {
    /// Rows of the unknowns and of other signals; `None` where some are not there.
    pub fn new(form: &Form, mut others: Vec<Signal>, samples: &Samples) -> Option<Rows> {
        others.sort_unstable();
        others.dedup();
        others.retain(|s| !form.unknowns.contains(s));
        let signals = [form.unknowns.clone(), others].concat();
        let mut rows = Rows {
            unknowns: form.unknowns.len(),
            scales: Vec::with_capacity(signals.len()),
            values: Vec::with_capacity(signals.len()),
            signals,
        };
        for (k, s) in rows.signals.iter().enumerate() {
            let all = match *s {
                Signal::TIME => &samples.time,
                s => &samples.column(s)?.values,
            };
            let about = if k < rows.unknowns { 0.0 } else { mean(all) };
            let spread: Vec<f64> = all.iter().map(|x| x - about).collect();
            rows.scales.push(rms(&spread));
            let step = (all.len() / ROWS).max(1);
            rows.values
                .push(all.iter().step_by(step).copied().collect());
        }
        Some(rows)
    }

    fn len(&self) -> usize {
        self.values.first().map_or(0, Vec::len)
    }

    /// An expression on every row.
    pub fn values_of(&self, e: &Expr) -> Vec<f64> {
        let place = |s: Signal| self.signals.iter().position(|o| *o == s);
        let value = |row: usize| {
            e.eval(&|s| {
                let values = place(s).and_then(|k| self.values.get(k));
                let value = values.and_then(|v| v.get(row));
                value.copied().unwrap_or(f64::NAN)
            })
        };
        (0..self.len()).map(value).collect()
    }

    /// Slopes of target − Σ coefficient · term; `None` where they have no finite value on any row.
    pub fn slopes<'t>(
        &self,
        target: Signal,
        terms: impl Iterator<Item = (f64, &'t Term)>,
    ) -> Option<Slopes> {
        let terms = terms.map(|(a, t)| Expr::from((-a, t.clone())));
        let relation = terms.fold(Expr::signal(target), |sum, t| sum + t);
        let slope = |(s, scale): (&Signal, &f64)| {
            let mut values = self.values_of(&relation.derivative(*s));
            values.iter_mut().for_each(|v| *v *= scale);
            values
        };
        let columns: Vec<Vec<f64>> = self.signals.iter().zip(&self.scales).map(slope).collect();
        let row = |r: usize| columns.iter().filter_map(|c| c.get(r).copied()).collect();
        let values: Vec<Vec<f64>> = (0..self.len()).map(row).collect();
        let lengths: Vec<f64> = values
            .iter()
            .map(|v| dot(v, v).sqrt())
            .filter(|l| l.is_finite())
            .collect();
        let size = rms(&lengths);
        (size > 0.0).then_some(Slopes { values, size })
    }

    /// How far a relation is from combinations of others whose factors may differ from row to row.
    pub fn apart(&self, one: &Slopes, others: &[&Slopes]) -> Option<Apart> {
        let (mut left, mut of_unknowns, mut lengths, mut conditions) =
            (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for (row, own) in one.values.iter().enumerate() {
            let theirs: Vec<&[f64]> = others
                .iter()
                .filter_map(|o| o.values.get(row).map(Vec::as_slice))
                .collect();
            let finite = |v: &[f64]| v.iter().all(|x| x.is_finite());
            if !finite(own) || !theirs.iter().all(|v| finite(v)) {
                continue;
            }
            let mass = |v: &'_ [f64]| -> Vec<f64> { v.iter().take(self.unknowns).copied().collect() };
            let masses: Vec<Vec<f64>> = theirs.iter().map(|v| mass(v)).collect();
            let borrowed: Vec<&[f64]> = masses.iter().map(Vec::as_slice).collect();
            lengths.push(dot(own, own).sqrt());
            left.push(rest(own.clone(), &theirs));
            of_unknowns.push(rest(mass(own), &borrowed));
            conditions.push(condition(&mass(own), &borrowed));
        }
        conditions.sort_by(f64::total_cmp);
        let distance = rms(&left);
        Some(Apart {
            distance,
            part: distance / rms(&lengths),
            of_unknowns: rms(&of_unknowns),
            condition: *conditions.get(conditions.len() / 2)?,
        })
    }
}

/// Length of what is left of `v` off the span of others, by Gram–Schmidt, twice for the digits.
fn rest(mut v: Vec<f64>, others: &[&[f64]]) -> f64 {
    let mut basis: Vec<Vec<f64>> = Vec::with_capacity(others.len());
    for other in others {
        let whole = dot(other, other).sqrt();
        let mut unit = other.to_vec();
        off(&mut unit, &basis);
        off(&mut unit, &basis);
        let length = dot(&unit, &unit).sqrt();
        if length > f64::EPSILON * whole {
            unit.iter_mut().for_each(|x| *x /= length);
            basis.push(unit);
        }
    }
    off(&mut v, &basis);
    off(&mut v, &basis);
    dot(&v, &v).sqrt()
}

fn off(v: &mut [f64], basis: &[Vec<f64>]) {
    for unit in basis {
        let along = dot(v, unit);
        v.iter_mut().zip(unit).for_each(|(x, u)| *x -= along * u);
    }
}

/// Condition number of rows scaled to unit length.
fn condition(own: &[f64], others: &[&[f64]]) -> f64 {
    let rows: Vec<&[f64]> = std::iter::once(own).chain(others.iter().copied()).collect();
    let lengths: Vec<f64> = rows.iter().map(|r| dot(r, r).sqrt()).collect();
    if lengths.contains(&0.0) {
        return f64::MAX;
    }
    let unit = |i: usize, j: usize| {
        let entry = rows.get(i).and_then(|r| r.get(j)).copied();
        entry.unwrap_or(0.0) / lengths.get(i).copied().unwrap_or(1.0)
    };
    let values = DMatrix::from_fn(rows.len(), own.len(), unit).singular_values();
    match (values.max(), values.min()) {
        (_, 0.0) => f64::MAX,
        (largest, smallest) => largest / smallest,
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

fn mean(v: &[f64]) -> f64 {
    v.iter().sum::<f64>() / v.len().max(1) as f64
}
