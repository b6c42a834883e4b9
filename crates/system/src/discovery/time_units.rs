//! What times and frequencies of a discovery are counted in.
//!
//! In: a discovery. Out: units, and times with them. Converts nothing.

use super::equations::Discovery;
use sidc_lang::number::significant;
use sidc_lang::term::Signal;
use sidc_lang::units;

impl Discovery {
    /// What time is counted in.
    pub fn time_unit(&self) -> String {
        units::of_time(self.discrete, self.unit(Signal::TIME).as_ref())
    }

    /// What frequencies are counted in.
    pub fn frequency_unit(&self) -> String {
        match self.time_unit().as_str() {
            _ if self.discrete => "1/sample".into(),
            "s" => "Hz".into(),
            unit => format!("1/{unit}"),
        }
    }

    /// A time with its unit, to two digits.
    pub fn duration(&self, time: f64) -> String {
        format!("{} {}", significant(time, 2), self.time_unit())
    }
}
