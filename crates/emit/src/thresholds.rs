//! Numbers that decide what is printed and how much of a figure is drawn. Sizes of a page or a line are beside their layout.
//!
//! In: nothing. Out: families of numbers, and their tables for the documentation. Never computes with them.

use sidc_thresholds::{Table, family};

family! {
    /// What the text of an answer mentions.
    pub(crate) PRINTED: PrintedEvidence {
        /// Gain of the criterion from which a term left out is mentioned.
        nearest: f64 = 1.0, unit "units of the criterion", source "less is chance: under the null hypothesis the gain of one term has mean 1";
        /// Loss of the criterion from which it is printed only as over 1000.
        large_loss: f64 = 1000.0, unit "units of the criterion", source "set by hand";
        /// Excess of the residual over the tolerance at which a solution path still counts as complete.
        path_tolerance: f64 = 1e-6, unit "of the tolerance", source "set by hand";
        /// The same for a tolerance of zero.
        path_rounding: f64 = 1e-9, unit "of the target", source "set by hand";
        /// States of a linear system up to which A and B are printed with the equations.
        printed_states: usize = 12, unit "states", source "set by hand";
        /// Share of held-out readings in the 90 % band of the data used, below which that is said.
        band_share: f64 = 0.8, unit "", source "the band is then missed twice as often as it promises";
        /// Signals whose predictions are printed, those with the largest errors.
        predicted_signals: usize = 3, unit "signals", source "what fits into two lines; the result document has all";
        /// Error of a prediction below which it is not printed.
        exact_prediction: f64 = 1e-6, unit "of the signal's spread", source "as the noise below which readings count as clean";
        /// Equations as sparse as the one printed that the evidence names.
        as_sparse: usize = 5, unit "equations", source "what fits on a screen; the result document has more";
        /// Lines on the sparsest form of an equation that the answer has.
        sparsest_lines: usize = 2, unit "lines", source "the bound and what became of it; --evidence has the equations as sparse";
        /// Multipliers of laws that the evidence names.
        multipliers: usize = 8, unit "terms", source "what fits into a line; the result document has all";
        /// Reasons that are told with what to do.
        reasons: usize = 3, unit "reasons", source "what fits on a screen below the equations; --evidence has all";
        /// Doubts that the line of the law names.
        doubt_codes: usize = 4, unit "codes", source "what fits into one line; each is explained at its equation";
    }
}

family! {
    /// Figures of the report.
    pub(crate) FIGURES: ReportFigures {
        /// Error of a free run below which it is rounding, so that its autocorrelation means nothing.
        exact_run: f64 = 1e-6, unit "of the signal's spread", source "set by hand";
        /// Lags of an autocorrelation.
        lags: usize = 40, unit "rows", source "set by hand";
        /// Rows whose spectrum is drawn, those in the middle of a record.
        spectrum_rows: usize = 2048, unit "rows", source "each frequency goes through all rows: 2 million products, some milliseconds";
        /// Points of a spectrum.
        spectrum_points: usize = 256, unit "points", source "set by hand: a column of a small figure for each";
        /// Fewest frequencies of a spectrum.
        least_frequencies: usize = 16, unit "frequencies", source "set by hand";
        /// Deviation of a step of time from the mean up to which samples count as even.
        uneven_step: f64 = 0.02, unit "steps", source "set by hand";
        /// Groups of readings whose mean errors are drawn along a state.
        error_groups: usize = 10, unit "groups", source "set by hand: tenths of the readings";
        /// Rows that these means are of; of longer records every so many.
        means_rows: usize = 100_000, unit "rows", source "a tenth of them gives a mean to 1 % of the spread of the errors";
        /// Fewest readings of such a group.
        group_readings: usize = 8, unit "readings", source "set by hand: fewer have no standard error to speak of";
        /// Readings up to which each is drawn as a dot.
        dots: usize = 120, unit "readings", source "set by hand";
        /// How far the vertical axis follows a simulation beyond the measured range.
        overshoot: f64 = 0.35, unit "of the measured range", source "set by hand";
        /// Largest deviation from a coefficient that is drawn.
        deviation: f64 = 1.5, unit "of the coefficient", source "set by hand";
        /// Width of an interval below which it is rounding.
        interval_rounding: f64 = 1e-12, unit "of the coefficient", source "set by hand";
        /// Least span of an axis of errors, so that a difference of one decibel looks small.
        error_span: f64 = 20.0, unit "dB", source "set by hand";
    }
}

/// Families of the numbers that decide, for the documentation.
pub fn tables() -> Vec<Table> {
    vec![PrintedEvidence::table(), ReportFigures::table()]
}
