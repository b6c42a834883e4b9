//! Numbers that decide what free runs say against equations, and which of several models is best.

use sidc_thresholds::Table;

sidc_thresholds::family! {
    /// Doubts from free runs on data held out.
    pub FREE_RUNS: FreeRuns {
        /// Part of the time that a run on data held out must follow, where those on the data used follow to the end.
        carried: f64 = 0.5, unit "of the time", source "set by hand";
        /// Error below which a run is no reason: where a motion has died down, noise is as large as what is left.
        slight: f64 = 0.1, unit "of the signal's spread", source "set by hand";
        /// Error over that on the data used, below which it is no reason.
        worse: f64 = 3.0, unit "times", source "set by hand";
        /// Error from which a run has left what was measured.
        left: f64 = 5.0, unit "of the signal's spread", source "two independent states of one chaotic motion differ by about √2 spreads; the margin is set by hand";
        /// Error from which the spread can be computed from error and fit.
        visible: f64 = 1e-9, unit "of the signal's spread", source "set by hand";
    }
}

sidc_thresholds::family! {
    /// Candidate models in order.
    pub RANKING: RankingRule {
        /// Errors below are rounding, and equal.
        floor: f64 = -100.0, unit "dB", source "set by hand";
        /// Errors this close count as equal, so that the smaller model is preferred.
        equal: f64 = 1.0, unit "dB", source "set by hand";
        /// Error above which a model does not follow its data; where all are above, shorter runs are compared.
        followed: f64 = -20.0, unit "dB", source "set by hand";
    }
}

/// Every family of this module.
pub fn tables() -> Vec<Table> {
    vec![FreeRuns::table(), RankingRule::table()]
}
