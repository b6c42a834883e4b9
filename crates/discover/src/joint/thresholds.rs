//! Numbers that decide when equations are estimated with their trajectory, and what is reported.
//!
//! In: nothing. Out: families of numbers, and their tables for the documentation. Never computes with them.

use sidc_thresholds::{Table, family};

family! {
    /// When all equations are estimated together, and what is reported.
    pub(crate) JOINT: JointEstimate {
        /// Noise below which differentiating loses nothing, and each equation can be proved alone.
        clean_data: f64 = 1e-6, unit "noise over spread", source "set by hand";
        /// Differences below which readings are clean without being smoothed to see it.
        vanishing_differences: f64 = 1e-9, unit "of the range", source "a thousandth of `clean_data`: what smoothing leaves beyond that is motion";
        /// How far outside the domain of a term the start may lie and be moved inside.
        outside_domain: f64 = 4.0, unit "noise of the sensor", source "noise takes a reading of the edge farther out once in 30,000";
        /// Loss without a term, at most, that is reported.
        weakest_reported: f64 = 10.0, unit "prices of a term", source "set by hand";
        /// Difference below which a support with more terms is a tie: simplicity decides.
        larger_tie: f64 = 2.0, unit "of the criterion", source "Kass & Raftery 1995: a difference below 2 is not worth more than a bare mention";
        /// Fall of χ² from which a support with one term more that takes an unknown constant out of its interval is a tie.
        omitted_gain: f64 = 3.2, unit "χ²", source "two standard errors of the term: 4, of which the floor under the noise (half of it) leaves 0.8";
        /// Autocorrelation up to which innovations that are not white are better than residuals without disturbances.
        far_whiter: f64 = 0.25, unit "of the autocorrelation before", source "the saturating circuit of `crates/studies/rigs` (0.11) then has its constants to 0.6 %, not to 17 %; the other sets stay as they are";
        /// How far a delay is looked for anew when inputs run along cubics.
        retimed: f64 = 0.1, unit "sampling intervals", source "straight inputs moved the delays of `crates/studies/lags/table.py --place delay --level 0` by 0.005";
        /// Spread of the readings below which a state does not move.
        no_motion: f64 = 1.2, unit "of the noise", source "set by hand";
        /// Motion of a state by white noise over all records, below which the noise is not reported.
        noticed_disturbance: f64 = 0.01, unit "spread of the state", source "what moves a state by less in all that time is no part of its motion";
    }
}

family! {
    /// Searches repeated for outliers, delays and offsets of sensors.
    pub(crate) SENSOR_SEARCH: SensorSearch {
        /// Searches until the readings left out no longer change.
        outlier_rounds: usize = 3, unit "searches", source "set by hand";
        /// Searches for a delay: the first answer, found without it, may not show it exactly.
        delay_rounds: usize = 2, unit "searches", source "set by hand";
        /// Gain from which a delay is taken before terms are added.
        early_delay_gain: f64 = 0.05, unit "of the criterion, each reading", source "set by hand";
        /// Searches until weights of readings whose noise grows with the signal no longer change.
        growth_rounds: usize = 3, unit "searches", source "weights that follow from the fit settle in two or three rounds (Carroll & Ruppert 1988, section 2.3)";
        /// Searches until the time constants of noise that lasts no longer change.
        memory_rounds: usize = 4, unit "searches", source "set by hand: a first answer with false terms shows too short a memory, which the next ones correct";
        /// Terms up to which offsets are looked for: each costs fits.
        offset_terms: usize = 24, unit "terms", source "set by hand";
    }
}

family! {
    /// The probe of the libraries with standard terms.
    pub(crate) LIBRARY_PROBE: LibraryProbe {
        /// Signals of a law whose standard terms are tried: 4 give some 150 terms.
        max_signals: usize = 4, unit "signals", source "the time of the probe grows with the square of its terms; 150 cost as much as the search";
    }
}

/// The families as tables.
pub(crate) fn tables() -> Vec<Table> {
    vec![
        JointEstimate::table(),
        SensorSearch::table(),
        LibraryProbe::table(),
    ]
}
