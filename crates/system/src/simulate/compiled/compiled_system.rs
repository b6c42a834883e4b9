//! The found equations, compiled: unknowns, rates of the state and their Jacobian at one point at a time.
//!
//! In: a [`Form`]. Out: q and ẋ for a state and the values given, or what is wrong there. M q = f is solved by
//! elimination. Where M and f depend on q, the solve is repeated from the last q, which is Newton's method.

use crate::discovery::NEWTON;
use crate::simulate::thresholds::MASS_MATRIX;
use nalgebra::DMatrix;

use crate::discovery::{Form, Rate};
use crate::simulate::compiled::compiled_switches::CompiledSwitches;
use crate::simulate::compiled::gaussian_elimination;
use crate::simulate::fault::FaultKind;
use crate::switching::{Modes, Switches};
use sidc_lang::term::{Expr, PointTape, Signal};

/// A compiled system.
#[derive(Clone, Debug, Default)]
pub(crate) struct CompiledSystem {
    pub form: Form,
    /// What the slots hold, in order: time, state, inputs, parameters, history, unknowns, sides of switches.
    pub signals: Vec<Signal>,
    /// Where laws switch; `None` where none does, and in discrete time.
    pub(super) switches: Option<CompiledSwitches>,
    /// M by rows, then f; f alone if no equation contains another's unknown.
    rates: PointTape,
    coupled: bool,
    /// M by rows, then the nonzero ∂right/∂x.
    slopes: PointTape,
    /// Row and state of each ∂right/∂x.
    entries: Vec<(usize, usize)>,
    outputs: PointTape,
}

/// Buffers of one run, and the last unknowns, from which Newton's method starts.
#[derive(Clone, Debug)]
pub(crate) struct Workspace {
    pub(super) slots: Vec<f64>,
    slopes: Vec<f64>,
    outputs: Vec<f64>,
    matrix: Vec<f64>,
    column: Vec<f64>,
    /// The unknowns of the last point.
    pub q: Vec<f64>,
    /// True if `q` belongs to the values in the slots.
    pub(super) known: bool,
    /// Guards and their gradients at the point in the slots.
    pub(super) guards: Vec<f64>,
    /// The side of every switch.
    pub modes: Modes,
    /// σ of every switch at the last point.
    pub sides: Vec<f64>,
    /// Whether the modes hold until an event; else they are those of each point.
    pub is_pinned: bool,
    /// Slopes of the inputs in time.
    pub input_slopes: Vec<f64>,
    /// Points at which the equations were evaluated.
    pub calls: u64,
}

impl CompiledSystem {
    /// `Err` is a signal that no argument gives.
    pub fn new(form: Form) -> Result<CompiledSystem, Signal> {
        let (smooth, switches) = Switches::of(&form);
        let mut signals = vec![Signal::TIME];
        for part in [&form.state, &form.inputs, &form.params, &form.history] {
            signals.extend(part);
        }
        signals.extend(&form.unknowns);
        signals.extend(switches.signals());
        let coupled = form.coupled();
        let masses = || smooth.rows.iter().flat_map(|r| r.mass.iter().cloned());
        let forces = smooth.rows.iter().map(|r| r.force.clone());
        let rates: Vec<Expr> = match coupled {
            true => masses().chain(forces).collect(),
            false => forces.collect(),
        };
        let (mut entries, mut slopes) = (Vec::new(), masses().collect::<Vec<_>>());
        for (i, row) in smooth.rows.iter().enumerate() {
            for (j, x) in form.state.iter().enumerate() {
                if row.right.mentions(*x) {
                    slopes.push(row.right.derivative(*x));
                    entries.push((i, j));
                }
            }
        }
        let outputs: Vec<Expr> = smooth.outputs.iter().map(|(_, e)| e.clone()).collect();
        Ok(CompiledSystem {
            rates: PointTape::new(&rates, &signals)?,
            slopes: PointTape::new(&slopes, &signals)?,
            outputs: PointTape::new(&outputs, &signals)?,
            switches: CompiledSwitches::new(&switches, &form, &signals)?,
            coupled,
            entries,
            signals,
            form,
        })
    }

    pub fn work(&self) -> Workspace {
        let n = self.form.rows.len();
        let switches = self.switches.as_ref();
        let count = switches.map_or(0, |s| s.count);
        Workspace {
            guards: switches.map(CompiledSwitches::slots).unwrap_or_default(),
            modes: switches.map(|s| s.first_modes.clone()).unwrap_or_default(),
            sides: vec![0.0; count],
            is_pinned: false,
            input_slopes: vec![0.0; self.form.inputs.len()],
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
    pub fn give(&self, work: &mut Workspace, values: &[f64]) {
        let from = 1 + self.states();
        work.known = false;
        let slots = work.slots.iter_mut().skip(from);
        slots.zip(values).for_each(|(slot, v)| *slot = *v);
    }

    /// Sets one input by its number.
    #[inline]
    pub fn give_one(&self, work: &mut Workspace, input: usize, value: f64) {
        let slot = &mut work.slots[1 + self.states() + input];
        work.known &= *slot == value;
        *slot = value;
    }

    /// Computes the unknowns at a point into `work.q`. The last point is not evaluated again: steps end where the next
    /// begin.
    pub fn solve(&self, work: &mut Workspace, t: f64, x: &[f64]) -> Result<(), FaultKind> {
        let states = self.states();
        if work.known && work.slots[0] == t && work.slots[1..=states] == *x {
            return Ok(());
        }
        work.calls += 1;
        work.slots[0] = t;
        work.slots[1..=states].copy_from_slice(x);
        let solved = match &self.switches {
            None => self.evaluate(work),
            Some(switches) => self.evaluate_switched(switches, work),
        };
        work.known = solved.is_ok();
        solved
    }

    /// Computes the unknowns for the values in the slots.
    pub(super) fn evaluate(&self, work: &mut Workspace) -> Result<(), FaultKind> {
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
            // The last unknowns may be a bad start: try again from zero.
            Err(FaultKind::NoSolution(_) | FaultKind::NotFinite(_)) => {
                work.q.fill(0.0);
                self.newton(work)
            }
            other => other,
        }
    }

    /// ẋ, or the next x, at a point; `out` has length n.
    pub fn rates(
        &self,
        work: &mut Workspace,
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

    /// The next x of a discrete-time system, after `solve`.
    pub fn next(&self, work: &Workspace, x: &mut [f64]) {
        let before = x.to_vec();
        for (x, rate) in x.iter_mut().zip(&self.form.rates) {
            *x = rate.value(&before, &work.q);
        }
    }

    /// ∂ẋ/∂x at a point, n × n by rows, from M ∂q/∂x = ∂right/∂x (implicit function theorem).
    pub fn jacobian(
        &self,
        work: &mut Workspace,
        t: f64,
        x: &[f64],
        out: &mut [f64],
    ) -> Result<(), FaultKind> {
        self.solve(work, t, x)?;
        let (n, m) = (self.states(), self.form.rows.len());
        let given = 1 + n + self.given();
        work.slopes[..given].copy_from_slice(&work.slots[..given]);
        work.slopes[given..given + m].copy_from_slice(&work.q);
        let last = given + m..given + m + work.sides.len();
        work.slopes[last].copy_from_slice(&work.sides);
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
            if self.coupled && !gaussian_elimination::solve(&mut work.matrix, &mut work.column) {
                return Err(FaultKind::Singular);
            }
            for (i, rate) in self.form.rates.iter().enumerate() {
                if let Rate::Unknown(row) = rate {
                    out[i * n + j] = work.column[*row];
                }
            }
        }
        if let Some(switches) = self.switches.as_ref().filter(|_| work.modes.any_is_held()) {
            self.hold_guards(switches, work, out)?;
        }
        match out.iter().position(|v| !v.is_finite()) {
            Some(place) => Err(FaultKind::NotFinite(self.target_of(place / n))),
            None => Ok(()),
        }
    }

    /// Outputs at the point of the last `solve`.
    pub fn outputs(&self, work: &mut Workspace) -> Vec<f64> {
        let given = 1 + self.states() + self.given();
        let to = given + work.q.len();
        work.outputs[..given].copy_from_slice(&work.slots[..given]);
        work.outputs[given..to].copy_from_slice(&work.q);
        let last = to..to + work.sides.len();
        work.outputs[last].copy_from_slice(&work.sides);
        self.outputs.run(&mut work.outputs);
        let slots = self.outputs.outputs.iter();
        slots.map(|slot| work.outputs[*slot]).collect()
    }

    /// State, inputs, parameters and history at the last point.
    pub fn point(&self, work: &Workspace) -> Vec<(Signal, f64)> {
        let count = self.states() + self.given();
        let all = self.signals.iter().zip(&work.slots).skip(1);
        all.take(count).map(|(s, v)| (*s, *v)).collect()
    }

    /// How many inputs, parameters and lagged samples there are.
    pub(super) fn given(&self) -> usize {
        let f = &self.form;
        f.inputs.len() + f.params.len() + f.history.len()
    }

    /// Targets of equations that are nearly dependent where M was last evaluated, by the left singular vector of the
    /// smallest singular value; empty if M is well conditioned.
    pub fn dependent(&self, work: &Workspace) -> Vec<Signal> {
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
        if *least > MASS_MATRIX.dependent * svd.singular_values.amax() {
            return Vec::new();
        }
        let shares: Vec<f64> = match &svd.u {
            Some(u) => u.column(k).iter().map(|x| x.abs()).collect(),
            None => Vec::new(),
        };
        let named = self.form.unknowns.iter().zip(&shares);
        named.filter(|(_, x)| **x > 0.1).map(|(s, _)| *s).collect()
    }

    /// The target of the equation that moves a state: the end of its chain of integrators.
    pub fn target_of(&self, state: usize) -> Signal {
        let rates = self.form.rates.iter().skip(state);
        let unknown = rates.filter_map(|r| match r {
            Rate::Unknown(i) => self.form.unknowns.get(*i),
            Rate::State(_) => None,
        });
        unknown.copied().next().unwrap_or(Signal::TIME)
    }

    /// Solves M q = f for the values in the slots.
    fn eliminate(&self, work: &mut Workspace) -> Result<(), FaultKind> {
        let n = work.q.len();
        let (masses, forces) = self.rates.outputs.split_at(n * n);
        for (m, slot) in work.matrix.iter_mut().zip(masses) {
            *m = work.slots[*slot];
        }
        for (f, slot) in work.q.iter_mut().zip(forces) {
            *f = work.slots[*slot];
        }
        if gaussian_elimination::solve(&mut work.matrix, &mut work.q) {
            return self.finite(&work.q);
        }
        // A row that is not finite is named; only then is the matrix called singular.
        for (row, f) in forces.iter().enumerate() {
            let mut entries = masses[row * n..(row + 1) * n].iter().chain([f]);
            if entries.any(|slot| !work.slots[*slot].is_finite()) {
                return Err(FaultKind::NotFinite(self.form.unknowns[row]));
            }
        }
        Err(FaultKind::Singular)
    }

    fn newton(&self, work: &mut Workspace) -> Result<(), FaultKind> {
        let from = 1 + self.states() + self.given();
        let mut last = f64::INFINITY;
        let mut worst = 0;
        for _ in 0..NEWTON.iterations {
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
            // Either the step is small, or it grows again at the level of rounding.
            if moved <= MASS_MATRIX.newton_step * size
                || (moved >= last && moved <= MASS_MATRIX.newton_rounding * size)
            {
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
