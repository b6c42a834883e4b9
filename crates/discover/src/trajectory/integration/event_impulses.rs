//! What unknown constants in guards and jumps do at events: impulses among the columns.
//!
//! In: an interval at an event. Out: the same with the effect of the impulse in its state and in U.

use super::compiled_laws::{Diverged, LocalLinearization};
use super::events::Passage;
use super::shooting::{IntervalBlock, values};
use super::workspace::Workspace;

/// What a unit impulse of a guard does.
pub(super) struct ImpulseEffect {
    /// What a unit of each law's right side adds to the states, states × laws.
    gains: Vec<f64>,
    grown: GrownColumns,
}

/// What a unit of an impulse adds to the columns of U, and to the active ones.
pub(super) struct GrownColumns {
    pub columns: Vec<f64>,
    pub active: Vec<f64>,
}

impl Passage<'_> {
    /// What a unit of a guard's impulse in the columns does to the rates at the present point; `None` where no column has it.
    pub(super) fn impulse(
        &self,
        switch: usize,
        work: &mut Workspace,
    ) -> Result<Option<ImpulseEffect>, Diverged> {
        let Some(row) = self.switches.impulse(switch) else {
            return Ok(None);
        };
        let integrator = self.integrator;
        let mut gains = Vec::new();
        integrator.gain(&work.local[0], None, 1.0, &[1.0], &mut gains);
        let grown = self.grown_columns(row, work)?;
        Ok(Some(ImpulseEffect { gains, grown }))
    }

    /// What a unit of the signal in this row of the present point adds to the columns.
    pub(super) fn grown_columns(
        &self,
        row: usize,
        work: &mut Workspace,
    ) -> Result<GrownColumns, Diverged> {
        let integrator = self.integrator;
        let (mut columns, mut active) = (Vec::new(), Vec::new());
        let mut local = LocalLinearization::default();
        for impulse in [0.0, 1.0] {
            let mut point = work.points[0].clone();
            point[row] = impulse;
            let (a, scratch) = (integrator.coefficients, &mut work.scratch);
            integrator
                .laws
                .evaluate(a, &mut point, 1, scratch, &mut local)?;
            active.push(local.columns.clone());
            columns.push(match integrator.all {
                Some((tape, _)) => {
                    let mut all = Vec::new();
                    values(tape, &point, 1, &mut all, &mut work.tape);
                    all
                }
                None => local.columns.clone(),
            });
        }
        let grown = |of: &[Vec<f64>]| of[1].iter().zip(&of[0]).map(|(b, a)| b - a).collect();
        Ok(GrownColumns {
            columns: grown(&columns),
            active: grown(&active),
        })
    }

    /// Adds an impulse of this size to the states and to U.
    pub(super) fn add_impulse(
        &mut self,
        effect: &ImpulseEffect,
        size: f64,
        work: &mut Workspace,
        out: &mut IntervalBlock,
    ) -> Result<(), Diverged> {
        let laws = self.integrator.laws;
        let (n, m, p) = (laws.states, laws.laws, self.integrator.width());
        let all = self.integrator.all.map(|(_, ranges)| ranges);
        let ranges = all.unwrap_or(&laws.ranges);
        let slot = self.group.slots[0];
        for i in 0..n {
            let u = &mut out.columns[(slot * n + i) * p..(slot * n + i + 1) * p];
            let gains = &effect.gains[i * m..(i + 1) * m];
            for ((gain, columns), active) in gains.iter().zip(ranges).zip(&laws.ranges) {
                for j in columns.clone() {
                    u[j] += size * gain * effect.grown.columns[j];
                }
                for j in active.clone() {
                    let own = effect.grown.active[j] * self.integrator.coefficients[j];
                    work.points[0][i] += size * gain * own;
                }
            }
        }
        self.begin_piece(work)
    }
}
