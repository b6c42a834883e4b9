//! The values of unknown constants by name and by signal.
//!
//! In: a discovery. Out: numbers. Estimates nothing.

use sidc_lang::term::{Signal, SignalNames};

use super::equations::Discovery;
use super::unknown_values::UnknownValue;

impl Discovery {
    /// The value of an unknown constant of that name: where it differs from run to run the mean of the runs, each weighing as much as it is
    /// known, or all the same where some are not.
    pub fn constant(&self, name: &str) -> Option<f64> {
        let own = || self.unknowns.iter().filter(|u| u.name == name);
        let known = |u: &UnknownValue| u.standard_error.filter(|e| *e > 0.0);
        let weight = |u: &UnknownValue| match own().all(|u| known(u).is_some()) {
            true => known(u).map_or(0.0, |e| e.powi(-2)),
            false => 1.0,
        };
        let weights: f64 = own().map(weight).sum();
        let sum: f64 = own().map(|u| weight(u) * u.value).sum();
        let mean = sum / weights;
        match own().count() {
            1 => own().map(|u| u.value).next(),
            _ => Some(mean).filter(|m| m.is_finite()),
        }
    }

    /// The value of a signal that is an unknown constant, as [`Discovery::constant`].
    pub fn unknown_value(&self, signal: Signal) -> Option<f64> {
        match self.unknowns.is_empty() {
            true => None,
            false => self.constant(self.variable(signal.var)),
        }
    }
}
