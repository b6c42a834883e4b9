//! Numbers that decide how a discovery is marked and solved.

use sidc_thresholds::Table;

sidc_thresholds::family! {
    /// The rule behind the marks of terms.
    pub MARKS: Marks {
        /// Share of half records that a firm term is found in.
        stable: f64 = 0.9, unit "of the half records", source "Meinshausen and Bühlmann 2010, Stability selection, section 3.1: thresholds of 0.6 to 0.9";
        /// Share under which a term is doubtful: it is missing more often than not.
        unstable: f64 = 0.5, unit "of the half records", source "a majority, by definition";
        /// What is lost without a firm term.
        cost: f64 = 20.0, unit "of the criterion", source "a difference of 20 in -2 ln L is odds of e^10 to 1";
        /// Loss under which a term is doubtful.
        tied: f64 = 6.0, unit "of the criterion", source "a difference of 6 in -2 ln L is odds of e^3 to 1; also what a tie is told by";
    }
}

sidc_thresholds::family! {
    /// Newton's method for equations that are not linear in their highest derivatives. Emitted code uses the same numbers.
    pub NEWTON: Newton {
        /// Steps for one instant.
        iterations: usize = 50, unit "steps", source "set by hand";
        /// Size of the last step.
        step: f64 = 1e-12, unit "of the largest unknown", source "set by hand";
    }
}

/// Every family of this module.
pub fn tables() -> Vec<Table> {
    vec![Marks::table(), Newton::table()]
}
