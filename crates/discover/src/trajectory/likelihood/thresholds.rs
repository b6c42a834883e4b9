//! What a term costs in the criterion that supports are compared by.
//!
//! In: nothing. Out: a record of values with unit and source. Never computes with them.

use sidc_thresholds::family;

family! {
    /// The price of a term, and the least noise.
    pub(crate) CRITERION: Criterion {
        /// Price of a term over the logarithm of the number of readings; 1 would be the Bayesian criterion (Schwarz 1978).
        term_price: f64 = 1.5, unit "ln(readings)", source "1 ln(readings) is the Bayesian criterion (Schwarz 1978) for one support; half as much again for the choice among as many supports as there are readings (extended criterion, Chen & Chen 2008, γ = 1/4 at N = M)";
        /// Fewest readings in that logarithm.
        min_readings: f64 = 4.0, unit "readings", source "set by hand";
        /// What each degree of a term costs: its prior odds fall by κ = 1.5 a degree, as the graded norms have it.
        degree_price: f64 = 0.81, unit "criterion", source "2 ln 1.5; ODEBench and dysts with 5 % noise, three draws: of 141 answers 95.7 % exact with it, 94.3 % without, with 1 % noise 97.9 % both; attack cases: 147 of 160 exact, 145 without";
        /// What a term that the model's author wrote out costs less than one that a generator made.
        written_discount: f64 = 0.5, unit "criterion", source "odds of e^(1/4) to 1; set by hand, not measured";
        /// Least floor under the noise.
        min_floor: f64 = 0.5, unit "noise that smoothing sees", source "smoothing knows the noise to a factor of two: the likelihood is not believed below half of it";
    }
}
