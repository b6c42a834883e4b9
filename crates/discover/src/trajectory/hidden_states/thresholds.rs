//! The numbers that decide how hidden states are started.
//!
//! In: nothing. Out: records of values with unit and source. Never computes with them.

use sidc_thresholds::{Table, family};

family! {
    /// First guesses of hidden states, and of the constants in their laws.
    pub(crate) HIDDEN: Hidden {
        /// Values tried of a constant over its range, where it is the only one.
        values: usize = 24, unit "values", source "a first-order lag wrong by a factor of 1.5 still correlates with the right one by more than 0.9";
        /// Values tried first where each is judged by a fit.
        coarse_values: usize = 9, unit "values", source "the criterion of a sensor's lag falls towards its minimum over two decades";
        /// Combinations tried where each is judged by a fit.
        coarse_combinations: usize = 40, unit "combinations", source "some seconds of work for a thousand samples";
        /// Times that the step of an improvement is halved there.
        refinements: usize = 4, unit "halvings", source "from a factor of 1.5 to one of 1.05, from where a fit finds the rest";
        /// Combinations of values tried where there are several constants.
        combinations: usize = 300, unit "combinations", source "a second of work for a thousand samples";
        /// Points that are improved.
        improved: usize = 4, unit "points", source "set by hand";
        /// Times that the step of an improvement is halved: from a factor of 1.5 to one of 1.03.
        halvings: usize = 4, unit "halvings", source "the joint estimate finds the rest";
        /// Points that a search of terms starts from.
        starts: usize = 2, unit "points", source "set by hand";
        /// Ratio of one time constant tried to the one before.
        time_ratio: f64 = 1.25, unit "", source "Lorenz's z, hidden: its law is found from all ten starts at 0.1 and 1 % of noise, at 1.6 too (python3 crates/studies/hidden/table.py)";
        /// Most courses that a fit of all laws is tried from.
        courses: usize = 24, unit "courses", source "set by hand";
        /// Courses that are fitted to judge a value of a constant.
        courses_per_value: usize = 2, unit "courses", source "the same course with columns at another price seldom orders values otherwise";
        /// Pairs of parameters that are tried in each other's place.
        exchanges: usize = 12, unit "pairs", source "each costs a fit of all laws";
        /// Relative difference from which a value of a constant counts as another one.
        distinct: f64 = 0.1, unit "of the value", source "a tenth is more than a settled fit moves";
        /// First step of an improvement.
        first_step: f64 = 0.4, unit "of the value", source "the logarithm of the factor of 1.5 between two values that are tried";
        /// Relative difference up to which two improved values are one.
        same: f64 = 0.05, unit "of the value", source "the last step of an improvement: the first one halved three times";
        /// Most time constants tried.
        times: usize = 100, unit "time constants", source "from the step of a million samples to three times their record";
        /// Longest time constant tried.
        longest: f64 = 3.0, unit "length of the longest record", source "beyond, a lag and an integral look alike";
        /// Most Runge-Kutta steps of a guess between two samples.
        steps: usize = 50, unit "steps", source "set by hand";
        /// How much more laws may slip in the first fits than in the last.
        looseness: [f64; 2] = [1000.0, 30.0], unit "slack of the laws", source "at 1000 a law may miss a sample by three times its noise";
        /// Newton steps to where hidden states rest.
        newton_steps: usize = 20, unit "steps", source "set by hand";
        /// Times that the courses of hidden states are taken anew before the last fit.
        courses_renewed: usize = 2, unit "times", source "in the browser lorenz_hidden begins elsewhere: at 0 its coefficients differ by 5e-4 of their errors, at 2 by less than 1e-4";
        /// Size of a coefficient that an offset of a hidden state takes away.
        cancelled: f64 = 0.05, unit "of the parts that it is the sum of", source "set by hand: what is left out wrongly, the fit and its criterion refuse";
        /// Offsets tried one after another.
        offsets: usize = 3, unit "offsets", source "Rössler's third state has a form of nine terms that three offsets make one of seven";
        /// Laws that a further offset is tried on.
        offset_beam: usize = 20, unit "laws", source "set by hand";
        /// Most products of measured states that a hidden one is shifted by.
        offset_products: usize = 12, unit "products", source "more than the ten of degree 2 of three states";
        /// Their largest degree.
        offset_degree: f64 = 2.0, unit "", source "the rate of a product of higher degree is in few libraries";
        /// Most candidate columns of the measured part.
        columns: usize = 300, unit "columns", source "backward elimination of these takes a second";
    }
}

family! {
    /// Runs of given laws from many starts.
    pub(crate) OUTPUT_ERROR: OutputError {
        /// Values tried of a constant over its range, where it is the only one.
        values: usize = 24, unit "values", source "as for the laws of hidden states";
        /// Combinations tried where there are several constants.
        combinations: usize = 80, unit "combinations", source "the laws of crates/studies/given, constants over two decades; a run of sixty samples takes a millisecond";
        /// Parts of the records that are followed, one after another.
        parts: [f64; 3] = [0.1, 0.35, 1.0], unit "of the record", source "a run from wrong constants stays near the readings for a part of an oscillation";
        /// Fits that are kept after each part.
        kept: [usize; 3] = [10, 4, 2], unit "fits", source "set by hand";
        /// Steps of a fit.
        iterations: usize = 20, unit "steps", source "set by hand: further parts go on";
        /// Fall of the sum of squares at which a part is done.
        converged: f64 = 1e-3, unit "of the sum", source "the fit of the trajectory goes on from there";
        /// Relative difference of all constants up to which two fits are one.
        same: f64 = 0.02, unit "of the value", source "set by hand";
        /// Samples of a part at least.
        samples: usize = 4, unit "for each unknown", source "set by hand";
        /// Samples of a part at most, of all records.
        most_samples: usize = 4000, unit "samples", source "a second of work";
        /// Length of a step.
        step: f64 = 0.5, unit "of the fastest time constant", source "errors of the classical method below 1e-3, less than a start needs";
        /// Most steps between two samples.
        steps: usize = 100, unit "steps", source "stiffer laws are not run";
    }
}

/// The families of this module.
pub(crate) fn tables() -> Vec<Table> {
    vec![Hidden::table(), OutputError::table()]
}
