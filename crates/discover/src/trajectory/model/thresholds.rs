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
        /// Least variance that parabolas are taken to leave: what is less, of rounded readings above all, they leave by chance.
        least_left: f64 = 0.25, unit "of the variance of the noise", source "white noise leaves two parabolas through four readings each less once in five, through twelve never";
        /// What is left of parabolas without noise.
        rounding: f64 = 1e-9, unit "of the range", source "readings written with nine digits";
    }
}

family! {
    /// When bodies that have struck each other lie on each other.
    pub(crate) RESTING: Resting {
        /// Fewest readings of a rest.
        shortest: usize = 5, unit "readings", source "set by hand: shorter ones are as little as what a flight leaves between two impacts";
        /// Shortest rest, of the readings on its way in and out that are up to three times as far from zero.
        dwell: f64 = 1.5, unit "", source "a body that bounces at any speed has 0.5, one that turns round there under a constant force 1.4";
        /// Fewest readings of a flight before a rest that is used.
        flight: usize = 12, unit "readings", source "set by hand: a parabola through twelve leaves nine degrees of freedom for the law to be told by";
        /// How far from zero the readings of a closed gap are, and their mean square from the variance of the noise.
        reach: f64 = 4.0, unit "standard deviations", source "one normal reading in 16,000 lies farther";
        /// How high the flights before a rest are that are used, besides that they last so many readings.
        height: f64 = 16.0, unit "of the noise", source "`crates/studies/friction/bounces.py --rest`";
    }
}

/// Every family of this module.
pub fn tables() -> Vec<Table> {
    vec![Jumps::table(), Resting::table()]
}
