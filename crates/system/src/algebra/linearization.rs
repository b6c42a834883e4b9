//! Linearization at a point: ẋ ≈ f + A(x − x₀) + B(u − u₀), or the next x.
//!
//! In: a form and a point. Out: matrices of numbers. Derivatives are exact: M · ∂q/∂s = ∂right/∂s (implicit function
//! theorem) is solved in numbers. Lagged samples become states. At a kink the slope is the mean of both sides.

use crate::algebra::thresholds::LINEARIZATION;
use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};

use crate::discovery::{Form, Rate};
use sidc_lang::term::Signal;

/// Values of signals; those without one are 0. A lagged sample without one has the value of its signal.
#[derive(Clone, Debug, Default)]
pub struct Point(pub BTreeMap<Signal, f64>);

impl Point {
    pub fn value(&self, s: Signal) -> f64 {
        let shifted = s.shift < 0;
        let own = self.0.get(&s).copied();
        own.or_else(|| shifted.then(|| self.0.get(&Signal::new(s.var)).copied())?)
            .unwrap_or(0.0)
    }
}

/// A linear state-space system, by signals.
#[derive(Clone, Debug, Default)]
pub struct Linear {
    /// x: states, then lagged samples that act as states.
    pub states: Vec<Signal>,
    /// What each row gives: a derivative, or the next sample.
    pub rates: Vec<Signal>,
    /// u: inputs, their derivatives, and states without an equation.
    pub inputs: Vec<Signal>,
    /// n × n, in the order of `states`.
    pub a: DMatrix<f64>,
    /// n × m
    pub b: DMatrix<f64>,
    pub discrete: bool,
    /// f: the rates at the point.
    pub at_point: Vec<f64>,
    /// f, or f − x₀ in discrete time; exactly zero where it is rounding.
    pub drift: Vec<f64>,
    pub outputs: Vec<Signal>,
    /// ∂y/∂x, p × n
    pub c: DMatrix<f64>,
    /// ∂y/∂u, p × m
    pub d: DMatrix<f64>,
    /// y at the point.
    pub output: Vec<f64>,
}

/// Why there is no linear system.
#[derive(Clone, Debug, PartialEq)]
pub enum NoLinear {
    /// M is singular at the point.
    Singular,
    /// The unknowns do not occur linearly, and Newton's method from zero finds none.
    NoSolution,
    /// The equation of this target is not finite.
    NoValue(Signal),
    /// The derivative of this target's equation by that signal is not finite.
    NoSlope(Signal, Signal),
}

/// Linearizes at a point. Every parameter needs a value there.
///
/// # Errors
/// M is singular, or a value or a derivative is not finite.
pub fn linear(form: &Form, point: &Point) -> Result<Linear, NoLinear> {
    let mut l = Linear::without_matrices(form);
    let q = unknowns(form, point)?;
    let at = |s: Signal| match form.unknowns.iter().position(|u| *u == s) {
        Some(j) => q.get(j).copied().unwrap_or(f64::NAN),
        None => point.value(s),
    };
    let signals: Vec<Signal> = l.states.iter().chain(&l.inputs).copied().collect();
    let inverse = inverse(form, &at)?;
    let right = right_slopes(form, &signals, &at)?;
    let sizes = form.rows.iter().map(|r| {
        let terms = r.right.terms();
        terms.map(|(w, t)| (w * t.eval(&at)).abs()).sum::<f64>()
    });
    let sizes = DVector::from_iterator(form.rows.len(), sizes);
    let reliable = (inverse.abs() * right.abs()).scale(LINEARIZATION.cancelled);
    let mut slopes = &inverse * right;
    slopes.zip_apply(&reliable, |x, least| {
        if x.abs() <= least {
            *x = 0.0;
        }
    });
    let local = Local {
        q: &q,
        sizes: inverse.abs() * sizes,
        slopes,
    };
    l.fill_rates(form, &local, point);
    l.fill_outputs(form, &signals, &local.slopes, &at)?;
    Ok(l)
}

/// The same with derivatives set to zero that only rounding of the point makes: that of sin θ at θ = π/2.
pub(super) fn clean(form: &Form, point: &Point) -> Result<Linear, NoLinear> {
    let mut l = linear(form, point)?;
    let moved = point
        .0
        .iter()
        .map(|(s, x)| (*s, x * (1.0 + LINEARIZATION.nudge)));
    let Ok(other) = linear(form, &Point(moved.collect())) else {
        return Ok(l);
    };
    let clear = |x: &mut f64, y: f64| {
        if x.abs() <= 4.0 * (*x - y).abs() {
            *x = 0.0;
        }
    };
    l.a.zip_apply(&other.a, clear);
    l.b.zip_apply(&other.b, clear);
    l.c.zip_apply(&other.c, clear);
    l.d.zip_apply(&other.d, clear);
    let outputs = l.output.iter_mut().zip(&other.output);
    outputs.for_each(|(x, y)| clear(x, *y));
    Ok(l)
}

/// Values of the inputs `free` for which the point is an equilibrium; `None` if Newton's method finds none.
pub(super) fn equilibrium_inputs(form: &Form, point: &Point, free: &[Signal]) -> Option<Vec<f64>> {
    let mut point = point.clone();
    for _ in 0..LINEARIZATION.newton_steps {
        let l = linear(form, &point).ok()?;
        if l.is_equilibrium() {
            return Some(free.iter().map(|s| point.value(*s)).collect());
        }
        let columns = free.iter().map(|s| l.inputs.iter().position(|u| u == s));
        let columns: Option<Vec<usize>> = columns.collect();
        let b = l.b.select_columns(&columns?);
        let svd = b.try_svd(true, true, f64::EPSILON, LINEARIZATION.svd_iterations)?;
        let step = svd
            .solve(
                &-DVector::from_vec(l.drift),
                f64::EPSILON * svd.singular_values.max(),
            )
            .ok()?;
        for (s, moved) in free.iter().zip(step.iter()) {
            point.0.insert(*s, point.value(*s) + moved);
        }
    }
    None
}

/// The unknowns at the point.
struct Local<'a> {
    q: &'a [f64],
    /// ∂q/∂s: a row for each unknown, a column for each signal.
    slopes: DMatrix<f64>,
    /// Σ |M⁻¹| · |terms|, the scale of rounding in q.
    sizes: DVector<f64>,
}

/// q at the point.
fn unknowns(form: &Form, point: &Point) -> Result<Vec<f64>, NoLinear> {
    let start = vec![0.0; form.rows.len()];
    let at = |s: Signal| point.value(s);
    let found = form.solve(&at, &start);
    if let Some(q) = found.filter(|q| q.iter().all(|x| x.is_finite())) {
        return Ok(q);
    }
    let sound = |i: usize| {
        form.rows.get(i).is_some_and(|r| {
            let mut parts = r.mass.iter().chain(std::iter::once(&r.force));
            parts.all(|e| e.eval(&at).is_finite())
        })
    };
    match form.unknowns.iter().enumerate().find(|(i, _)| !sound(*i)) {
        Some((_, target)) => Err(NoLinear::NoValue(*target)),
        None if form.linear => Err(NoLinear::Singular),
        None => Err(NoLinear::NoSolution),
    }
}

/// M⁻¹ at the point.
fn inverse(form: &Form, at: &impl Fn(Signal) -> f64) -> Result<DMatrix<f64>, NoLinear> {
    let mut mass = form.mass(at);
    let n = mass.nrows();
    let mut scales = DMatrix::identity(n, n);
    for i in 0..n {
        let size = mass.row(i).amax();
        if size == 0.0 || !size.is_finite() {
            return Err(NoLinear::Singular);
        }
        mass.row_mut(i).unscale_mut(size);
        scales[(i, i)] = 1.0 / size;
    }
    if n > 0 {
        let values = mass.singular_values();
        if values.max() > LINEARIZATION.singular * values.min() {
            return Err(NoLinear::Singular);
        }
    }
    let inverse = mass.try_inverse().ok_or(NoLinear::Singular)?;
    Ok(inverse * scales)
}

/// ∂right/∂s: a row for each equation, a column for each signal.
fn right_slopes(
    form: &Form,
    signals: &[Signal],
    at: &impl Fn(Signal) -> f64,
) -> Result<DMatrix<f64>, NoLinear> {
    let mut right = DMatrix::zeros(form.rows.len(), signals.len());
    for (i, (row, target)) in form.rows.iter().zip(&form.unknowns).enumerate() {
        for (j, s) in signals.iter().enumerate() {
            let slope = row.right.derivative(*s).eval(at);
            if !slope.is_finite() {
                return Err(NoLinear::NoSlope(*target, *s));
            }
            right[(i, j)] = slope;
        }
    }
    Ok(right)
}

impl Linear {
    /// States, inputs and outputs of a form, with empty matrices.
    pub fn without_matrices(form: &Form) -> Linear {
        let mut l = Linear {
            states: form.state.clone(),
            inputs: form.inputs.clone(),
            outputs: form.outputs.iter().map(|(s, _)| *s).collect(),
            ..Linear::default()
        };
        let mut longest: BTreeMap<_, i32> = BTreeMap::new();
        for s in &form.history {
            let back = longest.entry(s.var).or_default();
            *back = (*back).max(-s.shift);
        }
        for (var, back) in longest {
            let now = Signal::new(var);
            if !l.states.contains(&now) && !l.inputs.contains(&now) {
                l.inputs.push(now);
            }
            l.states
                .extend((1..=back).map(|k| Signal::shifted(var, -k)));
        }
        let discrete = form.unknowns.iter().any(|q| q.shift != 0);
        let (der, shift) = if discrete { (0, 1) } else { (1, 0) };
        let ahead = |s: &Signal| Signal {
            var: s.var,
            der: s.der + der,
            shift: s.shift + shift,
        };
        l.rates = l.states.iter().map(ahead).collect();
        l.discrete = discrete;
        l
    }

    fn fill_rates(&mut self, form: &Form, local: &Local<'_>, point: &Point) {
        let (n, m) = (self.states.len(), self.inputs.len());
        (self.a, self.b) = (DMatrix::zeros(n, n), DMatrix::zeros(n, m));
        for (i, rate) in self.rates.iter().enumerate() {
            let unknown = match form.rates.get(i) {
                Some(Rate::Unknown(j)) => Some(*j),
                _ => None,
            };
            if let Some(j) = unknown {
                let slopes = local.slopes.row(j);
                self.a.row_mut(i).copy_from(&slopes.columns(0, n));
                self.b.row_mut(i).copy_from(&slopes.columns(n, m));
            } else if let Some(k) = self.states.iter().position(|s| s == rate) {
                self.a[(i, k)] = 1.0;
            } else if let Some(k) = self.inputs.iter().position(|s| s == rate) {
                self.b[(i, k)] = 1.0;
            }
            let value = unknown.and_then(|j| local.q.get(j).copied());
            let size = unknown.map_or(0.0, |j| local.sizes[j]);
            self.at_point
                .push(value.unwrap_or_else(|| point.value(*rate)));
            self.drift.push(size);
        }
        self.tell_drift_from_rounding(point);
    }

    /// Sets rates to zero that come from rounding of the point: θ = π is given to 1e-16 only.
    fn tell_drift_from_rounding(&mut self, point: &Point) {
        let known = |all: &[Signal]| {
            let sizes = all.iter().map(|s| point.value(*s).abs());
            DVector::from_iterator(all.len(), sizes)
        };
        let moved = self.a.abs() * known(&self.states) + self.b.abs() * known(&self.inputs);
        let rows = self.states.iter().zip(&self.at_point).zip(moved.iter());
        let mut values = Vec::new();
        for (drift, ((state, value), moved)) in self.drift.iter_mut().zip(rows) {
            let before = if self.discrete {
                point.value(*state)
            } else {
                0.0
            };
            let size = *drift + moved + before.abs();
            let left = value - before;
            let none = left.abs() <= LINEARIZATION.at_rest * size;
            *drift = if none { 0.0 } else { left };
            values.push(if none { before } else { *value });
        }
        self.at_point = values;
    }

    fn fill_outputs(
        &mut self,
        form: &Form,
        signals: &[Signal],
        slopes: &DMatrix<f64>,
        at: &impl Fn(Signal) -> f64,
    ) -> Result<(), NoLinear> {
        let (n, m, p) = (self.states.len(), self.inputs.len(), form.outputs.len());
        let mut all = DMatrix::zeros(p, n + m);
        for (i, (target, e)) in form.outputs.iter().enumerate() {
            let value = e.eval(at);
            if !value.is_finite() {
                return Err(NoLinear::NoValue(*target));
            }
            self.output.push(value);
            for (j, s) in signals.iter().enumerate() {
                let through = form.unknowns.iter().enumerate();
                let through = through.map(|(k, q)| e.derivative(*q).eval(at) * slopes[(k, j)]);
                let slope = e.derivative(*s).eval(at) + through.sum::<f64>();
                if !slope.is_finite() {
                    return Err(NoLinear::NoSlope(*target, *s));
                }
                all[(i, j)] = slope;
            }
        }
        self.c = all.columns(0, n).into_owned();
        self.d = all.columns(n, m).into_owned();
        Ok(())
    }

    /// True if the point is an equilibrium.
    pub fn is_equilibrium(&self) -> bool {
        self.drift.iter().all(|x| *x == 0.0)
    }
}
