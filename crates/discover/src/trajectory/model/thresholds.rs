//! The numbers of the problem that estimation starts from.

use sidc_thresholds::{Table, family};

family! {
    /// Where readings of a state that jumps are smoothed apart.
    pub(crate) JUMPS: Jumps {
        /// Readings on each side that a parabola is laid through.
        windows: [usize; 5] = [16, 12, 8, 5, 4], unit "readings", source "set by hand: long ones see kinks in noise, short ones flights of few readings";
        /// For each window, the variance that one cubic leaves, of that which two parabolas leave.
        gains: [f64; 5] = [3.5, 4.6, 8.5, 50.6, 1000.0], unit "", source "white noise exceeds it once in 1,000 rows: F with 2w - 4 and 2w - 6 degrees of freedom";
        /// The same where an end of the record cuts the window.
        gains_at_end: [f64; 5] = [6.5, 10.2, 29.8, 999.0, 4.1e5], unit "", source "F with w - 3 and w - 3 degrees of freedom, for one reading on the short side";
        /// How far the laws must lead from the next state before a jump is looked for that they miss: the sum over the states of the squares.
        missed: f64 = 0.01, unit "spread, squared", source "set by hand: a tenth of the spread, more than a step of the laws slips";
        /// What is left of parabolas without noise.
        rounding: f64 = 1e-9, unit "of the range", source "readings written with nine digits";
    }
}

/// Every family of this module.
pub fn tables() -> Vec<Table> {
    vec![Jumps::table()]
}
