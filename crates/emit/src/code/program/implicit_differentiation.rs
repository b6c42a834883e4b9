//! Partial derivatives of the rates by implicit differentiation.
//!
//! In: a form and signals s. Out: the linear systems M · ∂q/∂s = ∂right/∂s, block by block, and ∂(rates)/∂s in terms of their solutions
//! (implicit function theorem). Exact: no finite differences are taken.

use crate::code::program::definitions::{Definition, Definitions, System, is_explicit, mass};
use crate::code::program::strong_components::blocks;
use sidc_lang::term::{Expr, Signal, VarId};
use sidc_system::discovery::{Form, Rate};

/// Derivatives of the rates (rows) by signals (columns), and the definitions they need: the unknowns, then their
/// derivatives.
pub(crate) fn rate_derivatives(form: &Form, signals: &[Signal]) -> (Definitions, Vec<Vec<Expr>>) {
    let mut found = Differentiation {
        form,
        signals,
        of_unknown: vec![vec![Expr::zero(); signals.len()]; form.rows.len()],
        definitions: Definitions::new(form),
    };
    blocks(form).iter().for_each(|block| found.add(block));
    let row = |rate: &Rate| match rate {
        Rate::State(i) => signals
            .iter()
            .map(|s| same(form.state.get(*i), s))
            .collect(),
        Rate::Unknown(i) => found.of_unknown.get(*i).cloned().unwrap_or_default(),
    };
    let rows = form.rates.iter().map(row).collect();
    (found.definitions, rows)
}

fn same(a: Option<&Signal>, b: &Signal) -> Expr {
    Expr::number(if a == Some(b) { 1.0 } else { 0.0 })
}

struct Differentiation<'a> {
    form: &'a Form,
    signals: &'a [Signal],
    /// ∂q/∂s: unknowns × signals.
    of_unknown: Vec<Vec<Expr>>,
    definitions: Definitions,
}

impl Differentiation<'_> {
    fn add(&mut self, block: &[usize]) {
        let right: Vec<Vec<Expr>> = block.iter().map(|i| self.right(*i, block)).collect();
        if let ([i], [row]) = (block, right.as_slice())
            && is_explicit(self.form, *i)
        {
            self.set(*i, row.clone());
            return;
        }
        // A signal that no equation of the block mentions has derivative zero.
        let alive: Vec<usize> = (0..self.signals.len())
            .filter(|k| {
                right
                    .iter()
                    .any(|row| row.get(*k).is_some_and(|e| *e != Expr::zero()))
            })
            .collect();
        if alive.is_empty() {
            return;
        }
        let names: Vec<Vec<Signal>> = block
            .iter()
            .map(|i| alive.iter().filter_map(|k| self.fresh(*i, *k)).collect())
            .collect();
        for (i, names) in block.iter().zip(&names) {
            let mut row = vec![Expr::zero(); self.signals.len()];
            for (k, name) in alive.iter().zip(names) {
                row.iter_mut()
                    .skip(*k)
                    .take(1)
                    .for_each(|e| *e = Expr::signal(*name));
            }
            self.set(*i, row);
        }
        let kept = |row: &Vec<Expr>| alive.iter().filter_map(|k| row.get(*k)).cloned().collect();
        self.definitions.in_order.push(Definition::Linear(System {
            mass: mass(self.form, block),
            right: right.iter().map(kept).collect(),
            signals: names,
        }));
    }

    /// ∂right/∂s of row `i`, with unknowns outside the block included by the chain rule.
    fn right(&self, i: usize, block: &[usize]) -> Vec<Expr> {
        let Some(row) = self.form.rows.get(i) else {
            return Vec::new();
        };
        let derivative = |(k, s): (usize, &Signal)| {
            let others = row.mass.iter().zip(&self.of_unknown).enumerate();
            let through =
                others
                    .filter(|(j, _)| !block.contains(j))
                    .filter_map(|(_, (m, derivatives))| {
                        let derivative = derivatives.get(k).filter(|e| **e != Expr::zero())?;
                        Some((m.clone() * derivative.clone()).scale(-1.0))
                    });
            std::iter::once(row.right.derivative(*s))
                .chain(through)
                .sum()
        };
        self.signals.iter().enumerate().map(derivative).collect()
    }

    fn set(&mut self, i: usize, row: Vec<Expr>) {
        self.of_unknown
            .iter_mut()
            .skip(i)
            .take(1)
            .for_each(|r| r.clone_from(&row));
    }

    /// A new signal for ∂q_i/∂s_k: a variable that no model has, with a counter as its shift.
    fn fresh(&mut self, i: usize, k: usize) -> Option<Signal> {
        let (of, by) = (self.form.unknowns.get(i)?, self.signals.get(k)?);
        let count = self.definitions.derivatives.len() as i32;
        let signal = Signal::shifted(VarId(u16::MAX), count + 1);
        self.definitions.derivatives.push((signal, *of, *by));
        Some(signal)
    }
}
