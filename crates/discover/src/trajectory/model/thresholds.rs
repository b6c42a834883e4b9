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

family! {
    /// Noise of sensors that lasts from sample to sample.
    pub(crate) NOISE_MEMORY: NoiseMemory {
        /// Shortest time constant that is tried.
        least: f64 = 0.2, unit "steps", source "the next reading then shares less than 1 % of an error: white";
        /// Fewest independent errors of a record, on average, at the longest time constant that is tried.
        errors: f64 = 10.0, unit "time constants a record", source "with fewer, noise is an offset or a drift, and laws that are wrong leave the same";
        /// Largest share of an error that lasts from one sample to the next.
        most_lasting: f64 = 0.999_999, unit "", source "1/sqrt(1 - share^2), by which what is new is weighed, then keeps all but three digits";
        /// Fewest readings of a state from which a time constant is estimated.
        min_readings: usize = 50, unit "readings", source "as for a noise level of their own: `records.min_readings_of_own_noise`";
        /// Least robust standard deviation of what is new in each error: what passes for noise, but comes in bursts, wrong laws leave.
        robust: f64 = 0.5, unit "standard deviations", source "of a normal distribution 1, of Laplace's 0.73, of Student's with 3 degrees of freedom 0.65";
        /// Change of the correlation of one sample's error with the next one's at which the fit is not repeated.
        settled: f64 = 0.01, unit "", source "a fifth of what chance leaves in 400 readings";
    }
}

/// Every family of this module.
pub fn tables() -> Vec<Table> {
    vec![Jumps::table(), Resting::table(), NoiseMemory::table()]
}
