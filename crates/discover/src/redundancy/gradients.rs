//! An equation as a relation g = target − right side = 0, described by its gradient on every row.
//!
//! In: equations and samples. Out: gradients by all signals, in units of the signals' spreads, and how far one is from combinations
//! of others. If g₂ = f g₁ then ∇g₂ = f ∇g₁ wherever g₁ = 0, so two relations are the same if their gradients are parallel, whatever
//! the factor f. Decides nothing.

use crate::redundancy::thresholds::REDUNDANCY;
use nalgebra::DMatrix;

use crate::statistics::rms;
use sidc_data::Samples;
use sidc_data::median;
use sidc_lang::term::{Expr, Signal, Tape, Term};
use sidc_solve::simd::dot;
use sidc_system::discovery::Form;

/// Signals on the rows where gradients are compared.
pub(crate) struct SampledSignals {
    /// The unknowns of the form first.
    signals: Vec<Signal>,
    unknowns: usize,
    /// Standard deviation of each signal; root mean square of an unknown.
    scales: Vec<f64>,
    rows: usize,
    /// Values by signal and row: signals × rows.
    values: Vec<f64>,
}

/// The gradients of one relation.
#[derive(Clone)]
pub(crate) struct Gradients {
    /// By row and signal, in units of the target.
    values: Vec<Vec<f64>>,
    /// Place of the target among the signals.
    target: usize,
    /// Root mean square of their length.
    pub size: f64,
    /// Part of it that is by the target.
    pub share: f64,
}

/// How far a relation is from combinations of others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Separation {
    /// Root mean square of the part of its gradient off the span of theirs, in units of its target.
    pub distance: f64,
    /// `distance` over the size of its gradient: 0 for the same relation, 1 for nothing in common.
    pub part: f64,
    /// `distance` for the gradients by the unknowns alone.
    pub of_unknowns: f64,
    /// Median condition number of their mass matrix, with unit rows in units of the unknowns' sizes.
    pub condition: f64,
    /// Median factor by which its residual grows when all relations are solved for their targets.
    pub growth: f64,
}

impl SampledSignals {
    /// The unknowns of the form and other signals on the rows; `None` if the samples lack one.
    pub fn new(form: &Form, mut others: Vec<Signal>, samples: &Samples) -> Option<SampledSignals> {
        others.sort_unstable();
        others.dedup();
        others.retain(|s| !form.unknowns.contains(s));
        let signals = [form.unknowns.clone(), others].concat();
        let mut rows = SampledSignals {
            unknowns: form.unknowns.len(),
            scales: Vec::with_capacity(signals.len()),
            rows: 0,
            values: Vec::new(),
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
            let step = (all.len() / REDUNDANCY.sampled_rows).max(1);
            rows.rows = all.len().div_ceil(step);
            rows.values.extend(all.iter().step_by(step));
        }
        Some(rows)
    }

    /// The values of an expression, by row.
    pub fn values_of(&self, e: &Expr) -> Vec<f64> {
        let all = self.values_of_all(std::slice::from_ref(e));
        all.into_iter().next().unwrap_or_default()
    }

    /// The values of expressions, by row; NaN where one of their signals is not among these.
    fn values_of_all(&self, expressions: &[Expr]) -> Vec<Vec<f64>> {
        let rows = self.rows;
        let mut out = vec![f64::NAN; expressions.len() * rows];
        if let Ok(tape) = Tape::new(expressions, &self.signals) {
            tape.eval(&self.values, rows, &mut out, &mut Vec::new());
        }
        out.chunks_exact(rows.max(1)).map(<[f64]>::to_vec).collect()
    }

    /// The gradients of target − Σ coefficient · term; `None` if they are zero or not finite on every row.
    pub fn gradients<'t>(
        &self,
        target: Signal,
        terms: impl Iterator<Item = (f64, &'t Term)>,
    ) -> Option<Gradients> {
        let terms = terms.map(|(a, t)| Expr::from((-a, t.clone())));
        self.gradients_of(&terms.fold(Expr::signal(target), |sum, t| sum + t), target)
    }

    /// The gradients of a sum that is zero where a relation holds. `target` is an unknown in it.
    pub fn gradients_of(&self, relation: &Expr, target: Signal) -> Option<Gradients> {
        let slopes = self.signals.iter().map(|s| relation.derivative(*s));
        let slopes: Vec<Expr> = slopes.collect();
        let mut columns = self.values_of_all(&slopes);
        for (column, scale) in columns.iter_mut().zip(&self.scales) {
            column.iter_mut().for_each(|v| *v *= scale);
        }
        let row = |r: usize| columns.iter().filter_map(|c| c.get(r).copied()).collect();
        let values: Vec<Vec<f64>> = (0..self.rows).map(row).collect();
        let lengths: Vec<f64> = values
            .iter()
            .map(|v| dot(v, v).sqrt())
            .filter(|l| l.is_finite())
            .collect();
        let size = rms(&lengths);
        let target = self.signals.iter().position(|o| *o == target)?;
        let own = columns.get(target).map_or(0.0, |c| rms(c));
        (size > 0.0).then_some(Gradients {
            values,
            target,
            size,
            share: own / size,
        })
    }

    /// How far a relation is from combinations of others, with factors that may differ from row to row.
    pub fn separation(&self, one: &Gradients, others: &[&Gradients]) -> Option<Separation> {
        let (mut left, mut of_unknowns, mut lengths) = (Vec::new(), Vec::new(), Vec::new());
        let (mut conditions, mut growths) = (Vec::new(), Vec::new());
        let targets: Vec<usize> = std::iter::once(one)
            .chain(others.iter().copied())
            .map(|s| s.target)
            .collect();
        for (row, own) in one.values.iter().enumerate() {
            let theirs: Vec<&[f64]> = others
                .iter()
                .filter_map(|o| o.values.get(row).map(Vec::as_slice))
                .collect();
            let finite = |v: &[f64]| v.iter().all(|x| x.is_finite());
            if !finite(own) || !theirs.iter().all(|v| finite(v)) {
                continue;
            }
            let mass =
                |v: &'_ [f64]| -> Vec<f64> { v.iter().take(self.unknowns).copied().collect() };
            let masses: Vec<Vec<f64>> = theirs.iter().map(|v| mass(v)).collect();
            let borrowed: Vec<&[f64]> = masses.iter().map(Vec::as_slice).collect();
            lengths.push(dot(own, own).sqrt());
            left.push(residual_norm(own.clone(), &theirs));
            of_unknowns.push(residual_norm(mass(own), &borrowed));
            conditions.push(condition(&mass(own), &borrowed));
            growths.push(growth(own, &theirs, &targets));
        }
        let distance = rms(&left);
        Some(Separation {
            distance,
            part: distance / rms(&lengths),
            of_unknowns: rms(&of_unknowns),
            condition: median(&mut conditions)?,
            growth: median(&mut growths)?,
        })
    }
}

/// Length of the part of `v` off the span of others, by Gram–Schmidt, repeated once to keep the digits.
fn residual_norm(mut v: Vec<f64>, others: &[&[f64]]) -> f64 {
    let mut basis: Vec<Vec<f64>> = Vec::with_capacity(others.len());
    for other in others {
        let whole = dot(other, other).sqrt();
        let mut unit = other.to_vec();
        project_out(&mut unit, &basis);
        project_out(&mut unit, &basis);
        let length = dot(&unit, &unit).sqrt();
        if length > f64::EPSILON * whole {
            unit.iter_mut().for_each(|x| *x /= length);
            basis.push(unit);
        }
    }
    project_out(&mut v, &basis);
    project_out(&mut v, &basis);
    dot(&v, &v).sqrt()
}

fn project_out(v: &mut [f64], basis: &[Vec<f64>]) {
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

/// The growth of the residual of the first relation when all are solved for their targets: the first diagonal entry of the inverse
/// mass matrix times that of the mass matrix.
fn growth(own: &[f64], others: &[&[f64]], targets: &[usize]) -> f64 {
    let rows: Vec<&[f64]> = std::iter::once(own).chain(others.iter().copied()).collect();
    let at = |i: usize, j: usize| {
        let row = rows.get(i);
        let entry = row.and_then(|r| r.get(*targets.get(j)?)).copied();
        entry.unwrap_or(f64::NAN)
    };
    let mass = DMatrix::from_fn(rows.len(), rows.len(), at);
    let inverse = mass.try_inverse().map(|m| (m[(0, 0)] * at(0, 0)).abs());
    inverse.filter(|g| g.is_finite()).unwrap_or(f64::MAX)
}

fn mean(v: &[f64]) -> f64 {
    v.iter().sum::<f64>() / v.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use sidc_data::{Column, Origin};
    use sidc_lang::term::{Func, VarId};

    const Q: [Signal; 2] = [
        Signal::derivative(VarId(1), 2),
        Signal::derivative(VarId(2), 2),
    ];
    const ANGLE: Signal = Signal::new(VarId(2));

    /// An arbitrary motion: gradients can be compared whether or not the relations hold.
    fn rows() -> SampledSignals {
        let form = Form {
            unknowns: Q.to_vec(),
            ..Form::default()
        };
        let wave = |w: f64| (0..50).map(move |k| (w * f64::from(k)).sin()).collect();
        let column = |(signal, values)| Column {
            signal,
            values,
            origin: Origin::Measured { noise: None },
        };
        let mut columns: Vec<Column> = [(Q[0], wave(0.7)), (Q[1], wave(0.4)), (ANGLE, wave(0.3))]
            .map(column)
            .into();
        columns.sort_by_key(|c| c.signal);
        let samples = Samples {
            trajectory: vec![0; 50],
            time: (0..50).map(f64::from).collect(),
            columns,
        };
        SampledSignals::new(&form, vec![ANGLE], &samples).unwrap()
    }

    fn cos() -> Term {
        let angle = Expr::signal(ANGLE);
        Expr::call(Func::named("cos").unwrap(), vec![angle])
            .into_term()
            .1
    }

    fn gradients(rows: &SampledSignals, target: Signal, terms: &[(f64, Term)]) -> Gradients {
        rows.gradients(target, terms.iter().map(|(a, t)| (*a, t)))
            .unwrap()
    }

    #[test]
    fn a_relation_solved_for_another_target_is_the_same() {
        let rows = rows();
        // q₁ = −2 q₀ cos θ, and q₀ = −q₁/(2 cos θ).
        let first = gradients(&rows, Q[1], &[(-2.0, Term::signal(Q[0]).mul(&cos()))]);
        let over = Term::signal(Q[1]).mul(&cos().pow(-1.0));
        let second = gradients(&rows, Q[0], &[(-0.5, over.clone())]);
        // Gradients by θ differ by a multiple of the relation itself, which is not zero on these rows, so they are not compared.
        let separation = rows.separation(&second, &[&first]).unwrap();
        assert!(
            separation.of_unknowns < 1e-12 * second.size,
            "{separation:?}"
        );
        assert!(
            separation.condition > 1e12 && separation.growth > 1e12,
            "{separation:?}"
        );
        let third = gradients(&rows, Q[0], &[(-0.25, over)]);
        let separation = rows.separation(&third, &[&first]).unwrap();
        assert!((separation.growth - 2.0).abs() < 1e-9, "{separation:?}");
    }

    #[test]
    fn a_combination_of_two_relations_is_separated_from_each() {
        let rows = rows();
        let angle = Term::signal(ANGLE);
        let first = gradients(&rows, Q[0], &[(3.0, angle.clone())]);
        let second = gradients(&rows, Q[1], &[(-1.0, angle.clone())]);
        let both = gradients(&rows, Q[0], &[(1.0, Term::signal(Q[1])), (4.0, angle)]);
        let part = |others: &[&Gradients]| rows.separation(&both, others).unwrap().part;
        assert!(part(&[&first]) > 0.1 && part(&[&second]) > 0.1);
        assert!(part(&[&first, &second]) < 1e-12);
    }
}
