//! The values of unknown constants by name and by signal.
//!
//! In: a discovery. Out: numbers. Estimates nothing.

use sidc_data::ConstantValue;
use sidc_lang::term::{Signal, SignalNames, VarId};

use super::equations::Discovery;
use super::unknown_values::UnknownValue;

impl Discovery {
    /// The value of an unknown constant of that name; the mean of the runs where it differs from run to run.
    pub fn constant(&self, name: &str) -> Option<f64> {
        let own = || self.unknowns.iter().filter(|u| u.name == name);
        match own().count() {
            0 => None,
            1 => own().map(|u| u.value).next(),
            n => Some(own().map(|u| u.value).sum::<f64>() / n as f64),
        }
    }

    /// The value of a signal that is an unknown constant, as [`Discovery::constant`].
    pub fn unknown_value(&self, signal: Signal) -> Option<f64> {
        match self.unknowns.is_empty() {
            true => None,
            false => self.constant(self.variable(signal.var)),
        }
    }

    /// The values of all unknown constants of the equations, with their runs.
    pub fn constant_values(&self) -> Vec<ConstantValue> {
        let value = |u: &UnknownValue| {
            let place = self.variables.iter().position(|v| v.name == u.name)?;
            Some(ConstantValue {
                signal: Signal::new(VarId(u16::try_from(place).ok()?)),
                run: u.run.clone(),
                value: u.value,
            })
        };
        self.unknowns.iter().filter_map(value).collect()
    }
}
