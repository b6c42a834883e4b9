//! Columns by the sides of their switches.
//!
//! In: a system. Out: its switches, always in the same order, and its columns with their sides as signals. Never decides a side.

use super::system::System;
use sidc_lang::term::{Expr, Signal, Tape, Term};
use sidc_system::switching::Switches;

impl System {
    /// The switches of all columns and known parts.
    pub(crate) fn switches(&self) -> Switches {
        let (mut switches, rates) = (Switches::default(), self.rates());
        let mut see = |t: &Term| {
            if Switches::are_in(t) {
                switches.rewritten(&t.clone().into(), &rates);
            }
        };
        self.columns.iter().for_each(&mut see);
        let known = self.laws.iter().flat_map(|l| l.known.terms());
        known.for_each(|(_, t)| see(t));
        switches
    }

    /// The rates, on which no switch may depend: laws are solved for them.
    pub(crate) fn rates(&self) -> Vec<Signal> {
        self.laws.iter().map(|l| l.target).collect()
    }

    /// The signals of evaluations by sides: states, rates, exogenous, sides.
    pub(crate) fn signals_with_sides(&self, switches: &Switches) -> Vec<Signal> {
        let mut signals = self.evaluation_signals();
        signals.extend(switches.signals());
        signals
    }

    /// All columns by sides, compiled; `None` where nothing switches.
    pub(crate) fn columns_by_sides(&self) -> Option<Tape> {
        let mut switches = self.switches();
        if switches.is_empty() {
            return None;
        }
        let rates = self.rates();
        let smooth = self.columns.iter().map(|t| match Switches::are_in(t) {
            true => switches.rewritten(&t.clone().into(), &rates),
            false => t.clone().into(),
        });
        let smooth: Vec<Expr> = smooth.collect();
        Tape::new(&smooth, &self.signals_with_sides(&switches)).ok()
    }
}
