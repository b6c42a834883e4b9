//! Model + libraries → the system whose trajectory is sought: which signals are its state, which laws move it.
//!
//! In: a checked model and the libraries of its searched equations. Out: a [`System`], or why the model is none. Never sees data.

use std::collections::BTreeSet;
use std::ops::Range;

use crate::lang::model::{LibExpr, LibKind, Model, RightSide, VarKind};
use crate::library::{Library, known_terms};
use crate::term::{Expr, Signal, Term};

/// A system z' = f(z, w, u; a): states of any order as chains of first-order ones, laws linear in their coefficients.
#[derive(Clone, Debug)]
pub struct System {
    /// The n states: of every moved variable, its derivatives below the highest.
    pub states: Vec<Signal>,
    /// What moves them, one law a variable.
    pub laws: Vec<Law>,
    /// All candidate terms, law after law.
    pub columns: Vec<Term>,
    /// Signals that act from outside, sorted: inputs, parameters, time, states without a law.
    pub outside: Vec<Signal>,
    /// Which of them belong to states without a law: what is known of those is measured, with a sensor's noise.
    pub driven: Vec<bool>,
}

/// target = known + Σ coefficient · column
#[derive(Clone, Debug)]
pub struct Law {
    /// Place of the equation in the model.
    pub equation: usize,
    /// A highest derivative.
    pub target: Signal,
    /// The state it is the rate of.
    pub state: usize,
    pub known: Expr,
    /// Its columns; empty for a law that is known.
    pub columns: Range<usize>,
    /// Terms of its library.
    pub candidates: usize,
    /// Slots of its library that the columns stand for.
    pub slots: Vec<usize>,
    /// Whether each column was written out in the model, not made by a generator.
    pub written: Vec<bool>,
}

/// Why a model is no system of this kind, in words that follow "because".
pub type NoSystem = String;

/// Terms that stand in a library one by one.
fn written(right: &RightSide) -> BTreeSet<Term> {
    fn walk(library: &LibExpr, found: &mut BTreeSet<Term>) {
        match &library.kind {
            LibKind::Term(e) => {
                found.insert(e.clone().into_term().1);
            }
            LibKind::List(items) => items.iter().for_each(|i| walk(i, found)),
            LibKind::Union(a, b) => [a, b].into_iter().for_each(|l| walk(l, found)),
            LibKind::Difference(a, _) => walk(a, found),
            LibKind::Named { body, .. } => walk(body, found),
            _ => {}
        }
    }
    let mut found = BTreeSet::new();
    if let RightSide::Search {
        library: Some(library),
        ..
    } = right
    {
        walk(library, &mut found);
    }
    found
}

impl System {
    /// The system of all equations of the model that move a state; `pools` restricts the columns of an equation to slots of
    /// its library (`None`: all of them).
    ///
    /// # Errors
    /// Discrete time; an equation of something else than a highest derivative; no equation to search.
    pub fn new(
        model: &Model,
        libraries: &[Option<Library>],
        pools: &[Option<Vec<usize>>],
    ) -> Result<System, NoSystem> {
        if model.discrete {
            return Err("time is discrete".into());
        }
        let mut system = System {
            states: Vec::new(),
            laws: Vec::new(),
            columns: Vec::new(),
            outside: Vec::new(),
            driven: Vec::new(),
        };
        for (i, equation) in model.equations.iter().enumerate() {
            let target = equation.target;
            let order = model.var(target.var).map_or(0, |v| v.order);
            if target.der == 0 || target.der != order {
                return Err(format!(
                    "{} is not the highest derivative of a state",
                    crate::term::SignalNames::name(model, target)
                ));
            }
            let known = match &equation.right {
                RightSide::Known(e) => known_terms([e]),
                RightSide::Search { known, .. } => known_terms(known.iter().map(|(e, _)| e)),
            };
            let known = known.into_iter().map(Expr::from);
            let library = libraries.get(i).and_then(Option::as_ref);
            let slots: Vec<usize> = match (library, pools.get(i).and_then(Option::as_ref)) {
                (None, _) => Vec::new(),
                (Some(_), Some(pool)) => pool.clone(),
                (Some(library), None) => (0..library.slots())
                    .filter(|s| !library.is_empty_slot(*s))
                    .collect(),
            };
            let terms: Vec<Term> = slots.iter().filter_map(|s| library?.term(*s)).collect();
            let by_hand = written(&equation.right);
            let from = system.columns.len();
            let state = system.states.len() + usize::from(target.der) - 1;
            let chain = (0..target.der).map(|der| Signal::derivative(target.var, der));
            system.states.extend(chain);
            system.laws.push(Law {
                equation: i,
                target,
                state,
                known: known.fold(Expr::zero(), |sum, e| sum + e),
                columns: from..from + terms.len(),
                candidates: library.map_or(0, Library::len),
                slots,
                written: terms.iter().map(|t| by_hand.contains(t)).collect(),
            });
            system.columns.extend(terms);
        }
        if system.columns.is_empty() {
            return Err("no equation of a state is searched".into());
        }
        system.find_outside();
        let driven = |s: &Signal| model.var(s.var).is_some_and(|v| v.kind == VarKind::State);
        system.driven = system.outside.iter().map(driven).collect();
        Ok(system)
    }

    fn find_outside(&mut self) {
        let mut all = Vec::new();
        let mut see = |s: Signal| all.push(s);
        self.columns
            .iter()
            .for_each(|t| t.for_each_signal(&mut see));
        self.laws
            .iter()
            .for_each(|l| l.known.for_each_signal(&mut see));
        all.sort_unstable();
        all.dedup();
        all.retain(|s| !self.states.contains(s) && self.laws.iter().all(|l| l.target != *s));
        self.outside = all;
    }

    /// The law of a column.
    pub fn law_of(&self, column: usize) -> usize {
        let holds = |l: &Law| l.columns.contains(&column);
        self.laws.iter().position(holds).unwrap_or(0)
    }

    /// The rates of the chains: state i is the derivative of state i − 1 of the same variable.
    pub fn follows(&self, state: usize) -> Option<usize> {
        let next = self.states.get(state + 1)?;
        (next.der > 0).then_some(state + 1)
    }

    /// The place of a variable's derivative among the states.
    pub fn state(&self, signal: Signal) -> Option<usize> {
        self.states.iter().position(|s| *s == signal)
    }

    /// Signals in the order in which evaluation takes them: states, targets, outside.
    pub fn inputs(&self) -> Vec<Signal> {
        let targets = self.laws.iter().map(|l| l.target);
        let states = self.states.iter().copied();
        states
            .chain(targets)
            .chain(self.outside.iter().copied())
            .collect()
    }
}
