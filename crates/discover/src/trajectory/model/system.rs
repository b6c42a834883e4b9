//! The dynamic system that is estimated: its states and the laws that move them.
//!
//! In: a checked model and the libraries of its searched equations. Out: a [`System`], or why there is none. Never sees data.

use std::collections::BTreeSet;
use std::ops::Range;

use super::coefficient_constraints::CoefficientConstraints;
use crate::standard_terms::has_unit;
use sidc_lang::library::{Library, known_terms};
use sidc_lang::model::{LibExpr, LibKind, Model, Reset, RightSide, VarKind};
use sidc_lang::term::{Expr, Signal, Term, VarId};

/// A system z' = f(z, w, u; a) in first-order form, its laws linear in the coefficients a. z: states, w: highest derivatives (rates), which
/// implicit laws contain, u: exogenous signals.
#[derive(Clone, Debug)]
pub struct System {
    /// The n states: for every variable with a law, its derivatives below the highest.
    pub states: Vec<Signal>,
    /// Variables whose states nothing measures.
    pub hidden: Vec<VarId>,
    /// One law a variable.
    pub laws: Vec<Law>,
    /// All candidate terms, law after law.
    pub columns: Vec<Term>,
    /// Exogenous signals, sorted: inputs, parameters, time, states without a law.
    pub exogenous: Vec<Signal>,
    /// Which of them belong to states without a law, whose values are noisy measurements.
    pub noisy_exogenous: Vec<bool>,
    /// States and exogenous signals in a unit that is no pure number.
    pub with_units: BTreeSet<Signal>,
    /// What the coefficients obey; none at first.
    pub constraints: CoefficientConstraints,
    /// Exogenous signals that are impulses at events, where unknown constants that act there are estimated.
    pub(crate) impulses: Vec<Impulse>,
    /// Where states jump.
    pub resets: Vec<Reset>,
}

/// A signal that is zero along all records and acts at events.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Impulse {
    pub signal: Signal,
    pub source: ImpulseSource,
}

/// What an impulse is.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum ImpulseSource {
    /// δ(g) of a guard, as switches list it.
    Guard(Expr),
    /// A unit changes the states as a unit of this constant does where they jump.
    Jump(Signal),
}

/// A law: target = known + Σ coefficient · column.
#[derive(Clone, Debug)]
pub struct Law {
    /// Place of the equation in the model.
    pub equation: usize,
    /// The highest derivative of a variable.
    pub target: Signal,
    /// The state whose rate it is.
    pub state: usize,
    pub known: Expr,
    /// Its candidate columns; empty for a known law.
    pub columns: Range<usize>,
    /// Number of terms of its library.
    pub candidates: usize,
    /// The slots of its library that the columns are.
    pub slots: Vec<usize>,
    /// Whether each column is written out in the model and not made by a generator.
    pub written: Vec<bool>,
}

/// Terms that are written out in a library.
fn written(right: &RightSide) -> BTreeSet<Term> {
    fn walk(library: &LibExpr, found: &mut BTreeSet<Term>) {
        match &library.kind {
            LibKind::Term(e) => {
                found.insert(e.clone().into_term().1);
            }
            LibKind::List(items) => items.iter().for_each(|i| walk(i, found)),
            LibKind::Union(a, b) => [a, b].into_iter().for_each(|l| walk(l, found)),
            LibKind::Difference(a, _) => walk(a, found),
            LibKind::Named { body, .. } | LibKind::Required(body) => walk(body, found),
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
    /// The system of all equations of a model; `pools` restricts the columns of an equation to slots of its library (`None`: all).
    ///
    /// # Errors
    /// In words that follow "because": discrete time; an equation for something else than a highest derivative; no equation.
    pub fn new(
        model: &Model,
        libraries: &[Option<Library>],
        pools: &[Option<Vec<usize>>],
    ) -> Result<System, String> {
        if model.discrete {
            return Err("time is discrete".into());
        }
        let mut system = System {
            states: Vec::new(),
            hidden: model.hidden_states().map(|(id, _)| id).collect(),
            laws: Vec::new(),
            columns: Vec::new(),
            exogenous: Vec::new(),
            noisy_exogenous: Vec::new(),
            with_units: BTreeSet::new(),
            constraints: CoefficientConstraints::default(),
            impulses: Vec::new(),
            resets: model.resets.clone(),
        };
        for (i, equation) in model.equations.iter().enumerate() {
            let target = equation.target;
            let order = model.var(target.var).map_or(0, |v| v.order);
            if target.der == 0 || target.der != order {
                return Err(format!(
                    "{} is not the highest derivative of a state",
                    sidc_lang::term::SignalNames::name(model, target)
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
        if system.laws.is_empty() {
            return Err("no state has a law".into());
        }
        system.find_exogenous();
        let noisy_exogenous =
            |s: &Signal| model.var(s.var).is_some_and(|v| v.kind == VarKind::State);
        system.noisy_exogenous = system.exogenous.iter().map(noisy_exogenous).collect();
        let signals = system.states.iter().chain(&system.exogenous).copied();
        system.with_units = signals.filter(|s| has_unit(model, *s)).collect();
        Ok(system)
    }

    pub(super) fn find_exogenous(&mut self) {
        let mut all = Vec::new();
        let mut see = |s: Signal| all.push(s);
        self.columns
            .iter()
            .for_each(|t| t.for_each_signal(&mut see));
        self.laws
            .iter()
            .for_each(|l| l.known.for_each_signal(&mut see));
        let resets = self.resets.iter().flat_map(Reset::expressions);
        resets.for_each(|e| e.for_each_signal(&mut see));
        all.sort_unstable();
        all.dedup();
        all.retain(|s| !self.states.contains(s) && self.laws.iter().all(|l| l.target != *s));
        self.exogenous = all;
    }

    /// The law of a column.
    pub fn law_of(&self, column: usize) -> usize {
        let holds = |l: &Law| l.columns.contains(&column);
        self.laws.iter().position(holds).unwrap_or(0)
    }

    /// The state that is the derivative of this one; `None` if that is a rate.
    pub fn derivative_state(&self, state: usize) -> Option<usize> {
        let next = self.states.get(state + 1)?;
        (next.der > 0).then_some(state + 1)
    }

    /// The rate of a state, given all states and the rates of the laws.
    pub fn rate_of(&self, state: usize, states: &[f64], rates: &[f64]) -> f64 {
        let law = || self.laws.iter().position(|l| l.state == state);
        match self.derivative_state(state) {
            Some(next) => states[next],
            None => law().map_or(0.0, |l| rates[l]),
        }
    }

    /// Whether nothing measures a state.
    pub fn is_hidden(&self, state: usize) -> bool {
        let signal = self.states.get(state);
        signal.is_some_and(|s| self.hidden.contains(&s.var))
    }

    /// Whether a term has a state that nothing measures, or a rate of one.
    pub fn mentions_hidden(&self, term: &Term) -> bool {
        let mut found = false;
        term.for_each_signal(&mut |s| found |= self.hidden.contains(&s.var));
        found
    }

    /// The lowest derivative of a variable that jumps.
    pub fn lowest_jump(&self, var: VarId) -> Option<u8> {
        let all = self.resets.iter().flat_map(|r| &r.jumps);
        let own = all.filter(|(signal, _)| signal.var == var);
        own.map(|(signal, _)| signal.der).min()
    }

    /// The index of a signal among the states.
    pub fn state_index(&self, signal: Signal) -> Option<usize> {
        self.states.iter().position(|s| *s == signal)
    }

    /// All signals in the order in which compiled columns take them: states, rates, exogenous.
    pub fn evaluation_signals(&self) -> Vec<Signal> {
        let targets = self.laws.iter().map(|l| l.target);
        let states = self.states.iter().copied();
        states
            .chain(targets)
            .chain(self.exogenous.iter().copied())
            .collect()
    }
}
