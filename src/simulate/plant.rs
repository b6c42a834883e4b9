//! The found equations, compiled: rates of the state, and their Jacobian, at one point at a time.
//!
//! In: a [`Form`]. Out: the unknowns q and ẋ from the state and everything given, or what is wrong with them. M q = f is solved
//! by elimination; where M and f depend on q the same solve is repeated, which is Newton's method from the last q.

use nalgebra::DMatrix;

use super::elimination;
use super::fault::FaultKind;
use super::routine::Routine;
use crate::discover::{Form, Rate};
use crate::term::{Expr, Signal};

/// Newton steps for one point.
const NEWTON: usize = 50;
/// Relative size of the last step.
const ARRIVED: f64 = 1e-13;
/// What rounding may leave of the last step.
const CLOSE: f64 = 1e-8;
/// Condition at which equations that cannot be followed any more are called dependent.
const DEPENDENT: f64 = 1e-4;

/// A system ready to run.
#[derive(Clone, Debug, Default)]
pub(super) struct Plant {
    pub form: Form,
    /// Slots: time, state, inputs, parameters, history, unknowns.
    pub signals: Vec<Signal>,
    /// Masses by rows, then forces; forces alone if no equation knows another's unknown.
    rates: Routine,
    coupled: bool,
    /// Masses by rows, then the slopes of the right sides by state.
    slopes: Routine,
    /// Row and state of each slope.
    entries: Vec<(usize, usize)>,
    outputs: Routine,
}

/// Scratch and memory of one run: what is given, and the last unknowns.
#[derive(Clone, Debug)]
pub(super) struct Work {
    slots: Vec<f64>,
    slopes: Vec<f64>,
    outputs: Vec<f64>,
    matrix: Vec<f64>,
    column: Vec<f64>,
    /// The unknowns of the last point.
    pub q: Vec<f64>,
    /// `q` belongs to what is in the slots.
    known: bool,
    /// Points evaluated.
    pub calls: u64,
}

impl Plant {
    /// `Err` is a signal that nobody gives.
    pub fn new(form: Form) -> Result<Plant, Signal> {
        let mut signals = vec![Signal::TIME];
        for part in [&form.state, &form.inputs, &form.params, &form.history] {
            signals.extend(part);
        }
        signals.extend(&form.unknowns);
        let coupled = form.coupled();
        let masses = || form.rows.iter().flat_map(|r| r.mass.iter().cloned());
        let forces = form.rows.iter().map(|r| r.force.clone());
        let rates: Vec<Expr> = match coupled {
            true => masses().chain(forces).collect(),
            false => forces.collect(),
        };
        let (mut entries, mut slopes) = (Vec::new(), masses().collect::<Vec<_>>());
        for (i, row) in form.rows.iter().enumerate() {
            for (j, x) in form.state.iter().enumerate() {
                if row.right.mentions(*x) {
                    slopes.push(row.right.derivative(*x));
                    entries.push((i, j));
                }
            }
        }
        let outputs: Vec<Expr> = form.outputs.iter().map(|(_, e)| e.clone()).collect();
        Ok(Plant {
            rates: Routine::new(&rates, &signals)?,
            slopes: Routine::new(&slopes, &signals)?,
            outputs: Routine::new(&outputs, &signals)?,
            coupled,
            entries,
            signals,
            form,
        })
    }

    pub fn work(&self) -> Work {
        let n = self.form.rows.len();
        Work {
            slots: self.rates.slots(),
            slopes: self.slopes.slots(),
            outputs: self.outputs.slots(),
            matrix: vec![0.0; n * n],
            column: vec![0.0; n],
            q: vec![0.0; n],
            known: false,
            calls: 0,
        }
    }

    pub fn states(&self) -> usize {
        self.form.state.len()
    }

    /// Sets inputs, parameters and history, in the order of the form.
    pub fn give(&self, work: &mut Work, values: &[f64]) {
        let from = 1 + self.states();
        work.known = false;
        let slots = work.slots.iter_mut().skip(from);
        slots.zip(values).for_each(|(slot, v)| *slot = *v);
    }

    /// Sets one input by its number.
    #[inline]
    pub fn give_one(&self, work: &mut Work, input: usize, value: f64) {
        let slot = &mut work.slots[1 + self.states() + input];
        work.known &= *slot == value;
        *slot = value;
    }

    /// The unknowns at a point, left in `work.q`. Where one step ends the next begins: the last point is not evaluated twice.
    pub fn solve(&self, work: &mut Work, t: f64, x: &[f64]) -> Result<(), FaultKind> {
        let states = self.states();
        if work.known && work.slots[0] == t && work.slots[1..=states] == *x {
            return Ok(());
        }
        work.calls += 1;
        work.slots[0] = t;
        work.slots[1..=states].copy_from_slice(x);
        let solved = self.evaluate(work);
        work.known = solved.is_ok();
        solved
    }

    /// The unknowns at the point in the slots.
    fn evaluate(&self, work: &mut Work) -> Result<(), FaultKind> {
        if !self.coupled {
            self.rates.run(&mut work.slots);
            for (q, slot) in work.q.iter_mut().zip(&self.rates.outputs) {
                *q = work.slots[*slot];
            }
            return self.finite(&work.q);
        }
        if self.form.linear {
            self.rates.run(&mut work.slots);
            return self.eliminate(work);
        }
        match self.newton(work) {
            // The last unknowns may have led astray: once more from nothing.
            Err(FaultKind::NoSolution(_) | FaultKind::NotFinite(_)) => {
                work.q.fill(0.0);
                self.newton(work)
            }
            other => other,
        }
    }

    /// ẋ, or the next x, at a point.
    pub fn rates(
        &self,
        work: &mut Work,
        t: f64,
        x: &[f64],
        out: &mut [f64],
    ) -> Result<(), FaultKind> {
        self.solve(work, t, x)?;
        for (out, rate) in out.iter_mut().zip(&self.form.rates) {
            *out = rate.value(x, &work.q);
        }
        Ok(())
    }

    /// The next x of a map, from the point of the last `solve`.
    pub fn next(&self, work: &Work, x: &mut [f64]) {
        let before = x.to_vec();
        for (x, rate) in x.iter_mut().zip(&self.form.rates) {
            *x = rate.value(&before, &work.q);
        }
    }

    /// ∂ẋ/∂x by rows, n × n, at a point: M ∂q/∂x = ∂right/∂x.
    pub fn jacobian(
        &self,
        work: &mut Work,
        t: f64,
        x: &[f64],
        out: &mut [f64],
    ) -> Result<(), FaultKind> {
        self.solve(work, t, x)?;
        let (n, m) = (self.states(), self.form.rows.len());
        let given = 1 + n + self.given();
        work.slopes[..given].copy_from_slice(&work.slots[..given]);
        work.slopes[given..given + m].copy_from_slice(&work.q);
        self.slopes.run(&mut work.slopes);
        out.fill(0.0);
        for (i, rate) in self.form.rates.iter().enumerate() {
            if let Rate::State(j) = rate {
                out[i * n + j] = 1.0;
            }
        }
        let slopes = &self.slopes.outputs[m * m..];
        for j in 0..n {
            work.column.fill(0.0);
            for ((row, state), slot) in self.entries.iter().zip(slopes) {
                if *state == j {
                    work.column[*row] = work.slopes[*slot];
                }
            }
            for (entry, slot) in work.matrix.iter_mut().zip(&self.slopes.outputs) {
                *entry = work.slopes[*slot];
            }
            if self.coupled && !elimination::solve(&mut work.matrix, &mut work.column) {
                return Err(FaultKind::Singular);
            }
            for (i, rate) in self.form.rates.iter().enumerate() {
                if let Rate::Unknown(row) = rate {
                    out[i * n + j] = work.column[*row];
                }
            }
        }
        match out.iter().position(|v| !v.is_finite()) {
            Some(place) => Err(FaultKind::NotFinite(self.target_of(place / n))),
            None => Ok(()),
        }
    }

    /// Outputs at the point of the last `solve`.
    pub fn outputs(&self, work: &mut Work) -> Vec<f64> {
        let given = 1 + self.states() + self.given();
        let to = given + work.q.len();
        work.outputs[..given].copy_from_slice(&work.slots[..given]);
        work.outputs[given..to].copy_from_slice(&work.q);
        self.outputs.run(&mut work.outputs);
        let slots = self.outputs.outputs.iter();
        slots.map(|slot| work.outputs[*slot]).collect()
    }

    /// State and what was given at the last point.
    pub fn point(&self, work: &Work) -> Vec<(Signal, f64)> {
        let count = self.states() + self.given();
        let all = self.signals.iter().zip(&work.slots).skip(1);
        all.take(count).map(|(s, v)| (*s, *v)).collect()
    }

    /// Inputs, parameters and history.
    fn given(&self) -> usize {
        let f = &self.form;
        f.inputs.len() + f.params.len() + f.history.len()
    }

    /// Targets of the equations that (nearly) depend on each other where the masses were last evaluated; none if all is well.
    pub fn dependent(&self, work: &Work) -> Vec<Signal> {
        let n = work.q.len();
        let Some(masses) = self.rates.outputs.get(..n * n).filter(|_| self.coupled) else {
            return Vec::new();
        };
        let mut mass = DMatrix::from_fn(n, n, |i, j| work.slots[masses[i * n + j]]);
        for mut row in mass.row_iter_mut() {
            let size = row.amax();
            row /= size;
        }
        if mass.iter().any(|m| !m.is_finite()) {
            return Vec::new();
        }
        let svd = mass.svd(true, false);
        let values = svd.singular_values.iter().enumerate();
        let Some((k, least)) = values.min_by(|a, b| a.1.total_cmp(b.1)) else {
            return Vec::new();
        };
        if *least > DEPENDENT * svd.singular_values.amax() {
            return Vec::new();
        }
        let shares: Vec<f64> = match &svd.u {
            Some(u) => u.column(k).iter().map(|x| x.abs()).collect(),
            None => Vec::new(),
        };
        let named = self.form.unknowns.iter().zip(&shares);
        named.filter(|(_, x)| **x > 0.1).map(|(s, _)| *s).collect()
    }

    /// The equation that moves a state, at the end of its chain.
    pub fn target_of(&self, state: usize) -> Signal {
        let rates = self.form.rates.iter().skip(state);
        let unknown = rates.filter_map(|r| match r {
            Rate::Unknown(i) => self.form.unknowns.get(*i),
            Rate::State(_) => None,
        });
        unknown.copied().next().unwrap_or(Signal::TIME)
    }

    /// One solve with the masses and forces in the slots.
    fn eliminate(&self, work: &mut Work) -> Result<(), FaultKind> {
        let n = work.q.len();
        let (masses, forces) = self.rates.outputs.split_at(n * n);
        for (m, slot) in work.matrix.iter_mut().zip(masses) {
            *m = work.slots[*slot];
        }
        for (f, slot) in work.q.iter_mut().zip(forces) {
            *f = work.slots[*slot];
        }
        if elimination::solve(&mut work.matrix, &mut work.q) {
            return self.finite(&work.q);
        }
        // What is not finite is told from what is singular by the row it stands in.
        for (row, f) in forces.iter().enumerate() {
            let mut entries = masses[row * n..(row + 1) * n].iter().chain([f]);
            if entries.any(|slot| !work.slots[*slot].is_finite()) {
                return Err(FaultKind::NotFinite(self.form.unknowns[row]));
            }
        }
        Err(FaultKind::Singular)
    }

    fn newton(&self, work: &mut Work) -> Result<(), FaultKind> {
        let from = 1 + self.states() + self.given();
        let mut last = f64::INFINITY;
        let mut worst = 0;
        for _ in 0..NEWTON {
            let to = from + work.q.len();
            work.slots[from..to].copy_from_slice(&work.q);
            self.rates.run(&mut work.slots);
            self.eliminate(work)?;
            let before = &work.slots[from..to];
            let size = work.q.iter().fold(0.0, |m: f64, q| m.max(q.abs()));
            let mut moved = 0.0;
            for (i, (q, b)) in work.q.iter().zip(before).enumerate() {
                if (q - b).abs() > moved {
                    (moved, worst) = ((q - b).abs(), i);
                }
            }
            // Rounding ends the way as well as a step of nothing.
            if moved <= ARRIVED * size || (moved >= last && moved <= CLOSE * size) {
                return Ok(());
            }
            last = moved;
        }
        let target = self.form.unknowns.get(worst).copied();
        Err(FaultKind::NoSolution(target.unwrap_or(Signal::TIME)))
    }

    fn finite(&self, q: &[f64]) -> Result<(), FaultKind> {
        match q.iter().position(|v| !v.is_finite()) {
            None => Ok(()),
            Some(row) => Err(FaultKind::NotFinite(
                self.form.unknowns.get(row).copied().unwrap_or(Signal::TIME),
            )),
        }
    }
}
