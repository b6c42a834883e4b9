//! Numbers that decide whether constants can be identified at all.
//!
//! In: nothing. Out: families of numbers, and their tables for the documentation. Never computes with them.

use sidc_thresholds::{Table, family};

family! {
    /// When constants are said to be beyond all readings, before any search.
    pub(crate) STRUCTURAL: Structural {
        /// Where the random numbers start.
        seed: u64 = 1, unit "", source "any: a rank is the same almost everywhere";
        /// Runs that have to agree.
        runs: usize = 3, unit "runs", source "one is enough but for chance; a scaling is the same direction in all";
        /// Runs that are tried until so many say something.
        draws: usize = 12, unit "runs", source "a random point may lie outside of a root or a logarithm";
        /// Candidate terms above which nothing is said.
        columns: usize = 60, unit "terms", source "a tenth of a second of work";
        /// Steps of a run.
        steps: usize = 120, unit "steps", source "some readings for each of sixty parameters";
        /// Steps for which inputs are held.
        held: usize = 12, unit "steps", source "ten random levels in a run";
        /// Length of a step.
        step: f64 = 0.05, unit "of the fastest time constant", source "the run sees six of them; its sensitivities are exact whatever the step";
        /// How fast laws are at least.
        rates: f64 = 10.0, unit "in the length of the record", source "a record is meant to show its motion";
        /// A singular value that is zero.
        rounding: f64 = 1e-12, unit "of the largest", source "rounding of some hundred steps; constants that are merely hard to tell stay above";
        /// A singular value that is clearly not zero; between the two nothing is said.
        clear: f64 = 1e-9, unit "of the largest", source "powers of a state that hardly moves have singular values of any size: tests/it/unknown_constants.rs";
        /// A change that belongs to a direction.
        part: f64 = 1e-3, unit "of the largest", source "rounding over the gap of singular values";
        /// A value from which nothing is seen.
        underflow: f64 = 1e-100, unit "", source "products of it with others vanish";
    }
}

family! {
    /// When parameters can change together while the readings of a record stay as they are.
    pub(crate) PRACTICAL: Practical {
        /// Change of the readings below which a relative change of 1, all of the parameter, is not seen.
        unseen: f64 = 1.0, unit "standard deviations", source "the parameter is then known to no better than itself";
        /// Singular value that is zero.
        rounding: f64 = 1e-8, unit "of the largest", source "set by hand";
        /// Change above which a parameter belongs to a direction.
        part: f64 = 0.1, unit "of the largest", source "set by hand";
        /// How loosely samples of hidden states are held.
        hold: f64 = 1e4, unit "of their hold in a fit", source "holding them then determines nothing";
    }
}

/// Every family of this module.
pub fn tables() -> Vec<Table> {
    vec![Structural::table(), Practical::table()]
}
