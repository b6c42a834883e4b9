//! How each unknown is computed: by a formula, by a small linear system, or by Newton's method.
//!
//! In: a form. Out: definitions of signals, each using only those before it.

use crate::code::program::strong_components::blocks;
use sidc_lang::term::{Expr, Signal};
use sidc_system::discovery::Form;

/// Definitions of unknowns, each using only those before it.
#[derive(Default)]
pub(crate) struct Definitions {
    pub in_order: Vec<Definition>,
    /// Signals that stand for a derivative: (∂q/∂s, q, s).
    pub derivatives: Vec<(Signal, Signal, Signal)>,
}

/// What defines one signal or several.
pub(crate) enum Definition {
    Formula(Signal, Expr),
    /// mass · signals = right, column by column.
    Linear(System),
    /// The same with one column, where mass and right depend on the signals: solved by fixed-point iteration from
    /// zero, which is Newton's method.
    Newton(System),
}

/// n equations; `right` and `signals` are n × columns.
pub(crate) struct System {
    pub mass: Vec<Vec<Expr>>,
    pub right: Vec<Vec<Expr>>,
    pub signals: Vec<Vec<Signal>>,
}

impl Definition {
    pub fn signals(&self) -> Vec<Signal> {
        match self {
            Definition::Formula(s, _) => vec![*s],
            Definition::Linear(system) | Definition::Newton(system) => system.signals.concat(),
        }
    }

    pub fn exprs(&self) -> Vec<&Expr> {
        match self {
            Definition::Formula(_, e) => vec![e],
            Definition::Linear(s) | Definition::Newton(s) => {
                s.mass.iter().chain(&s.right).flatten().collect()
            }
        }
    }
}

impl Definitions {
    /// Definitions of all unknowns. Linear systems are split, so that only coupled equations are solved together.
    /// Nonlinear ones are not: Newton's method on a part may find another root.
    pub fn new(form: &Form) -> Definitions {
        if !form.linear {
            let column = |e: Expr| vec![e];
            let whole = Definition::Newton(System {
                mass: form.rows.iter().map(|r| r.mass.clone()).collect(),
                right: form.rows.iter().map(|r| column(r.force.clone())).collect(),
                signals: form.unknowns.iter().map(|s| vec![*s]).collect(),
            });
            return Definitions {
                in_order: vec![whole],
                derivatives: Vec::new(),
            };
        }
        let mut known = vec![false; form.rows.len()];
        let mut all = Vec::new();
        for block in blocks(form) {
            all.push(definition(form, &block, &known));
            for i in block {
                known.iter_mut().skip(i).take(1).for_each(|k| *k = true);
            }
        }
        Definitions {
            in_order: all,
            derivatives: Vec::new(),
        }
    }
}

fn definition(form: &Form, block: &[usize], known: &[bool]) -> Definition {
    if let Some((signal, right)) = formula(form, block) {
        return Definition::Formula(signal, right);
    }
    let rows = || block.iter().filter_map(|i| form.rows.get(*i));
    let right = rows().map(|row| {
        let before = row
            .mass
            .iter()
            .zip(&form.unknowns)
            .zip(known)
            .filter(|(_, known)| **known);
        let moved = before.map(|((m, q), _)| (m.clone() * Expr::signal(*q)).scale(-1.0));
        vec![std::iter::once(row.force.clone()).chain(moved).sum()]
    });
    Definition::Linear(System {
        right: right.collect(),
        mass: mass(form, block),
        signals: block
            .iter()
            .filter_map(|i| form.unknowns.get(*i))
            .map(|s| vec![*s])
            .collect(),
    })
}

/// The equation itself, if it is explicit in its unknown.
fn formula(form: &Form, block: &[usize]) -> Option<(Signal, Expr)> {
    let [i] = block else { return None };
    let (row, unknown) = (form.rows.get(*i)?, form.unknowns.get(*i)?);
    is_explicit(form, *i).then(|| (*unknown, row.right.clone()))
}

pub(crate) fn is_explicit(form: &Form, i: usize) -> bool {
    let own = form.rows.get(i).and_then(|r| r.mass.get(i));
    own.and_then(Expr::as_number) == Some(1.0)
}

/// The diagonal block of the mass matrix for these rows.
pub(crate) fn mass(form: &Form, block: &[usize]) -> Vec<Vec<Expr>> {
    let rows = block.iter().filter_map(|i| form.rows.get(*i));
    rows.map(|row| {
        block
            .iter()
            .filter_map(|j| row.mass.get(*j))
            .cloned()
            .collect()
    })
    .collect()
}
