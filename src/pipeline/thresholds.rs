//! Numbers that bound the work of the pipeline itself.
//!
//! In: nothing. Out: a family of numbers, and its table for the documentation. Never computes with them.

use sidc_thresholds::{Table, family};

family! {
    /// Work between the stages.
    pub(crate) BUDGET: PipelineBudget {
        /// Equations from which on libraries are expanded one after another, without a thread for each.
        parallel_libraries: usize = 8, unit "equations", source "set by hand";
        /// Samples from which on readings are not differentiated just to say what a library lacks.
        differentiated_samples: usize = 20_000, unit "samples", source "set by hand";
        /// Rounds in which unknown constants are refined for the terms that were found, and terms are found again.
        constant_rounds: usize = 3, unit "rounds", source "the second finds the terms of the first, unless they changed with its constants; a third settles those";
        /// Part of every record that is held out where predictions are to be good and nothing else was held out.
        held_out: f64 = 0.25, unit "of the rows", source "as where several models are compared";
    }
}

family! {
    /// Delays that records are long enough for.
    pub(crate) DELAYS: PipelineDelays {
        /// Longest delay.
        longest: f64 = 0.5, unit "of the longest record without a gap", source "a delay takes so much of the record away; what is left is to be the larger part";
    }
}

family! {
    /// Equations estimated jointly although the readings are clean.
    pub(crate) SECOND_METHOD: PipelineSecondMethod {
        /// Residual by estimated derivatives below which the trajectory has nothing more to say.
        exact_rates: f64 = 1e-6, unit "of the target", source "the noise below which readings are clean";
        /// How far from the values found unknown constants are sought along the trajectory.
        near: f64 = 2.0, unit "times", source "the errors of derivatives, thousandths, move the constant of a right law by far less";
        /// Samples times candidate terms up to which that is tried.
        work: usize = 100_000, unit "values", source "it takes ten seconds there: the drive EMPS, 17,389 rows of 6 terms";
        /// The same for models with unknown constants whose terms do not jump.
        work_with_constants: usize = 25_000, unit "values", source "800 rows of 9 terms take 3 s, of 30 terms 15, of 125 terms 200: terms and constants are searched in turn";
    }
}

family! {
    /// States that nothing measures, tried where the answer is doubted.
    pub(crate) MISSING: PipelineMissingStates {
        /// Inputs that are tried behind a lag.
        inputs: usize = 4, unit "inputs", source "each costs a search of its own";
        /// Sensors that are tried with a lag.
        sensors: usize = 2, unit "sensors", source "each costs a search of its own, from many time constants";
        /// Samples times columns up to which lags of inputs are tried.
        work: usize = 50_000, unit "values", source "each costs some seconds there, two to five times the search for the answer";
        /// Samples times columns up to which a state with a law that is sought is tried.
        work_along_course: usize = 10_000, unit "values", source "each costs up to ten seconds there: its law is searched too";
        /// Terms of an equation up to which something is tried.
        terms: usize = 10, unit "terms", source "more take a minute: the first draft of models/data/pendulum.csv has 13, the rigs of docs/rigs.md at most 7";
        /// How near to the end of its range a time constant is none.
        end: f64 = 0.02, unit "of the end", source "a fit that settles at the end stays there; one that a record tells is a fifth of its length or less";
        /// Shortest lag that is tried.
        shortest_lag: f64 = 0.1, unit "of the step between samples", source "what is faster follows its input from sample to sample";
        /// Digits of coefficients in a sentence.
        figures: usize = 3, unit "digits", source "what a sentence can carry";
    }
}

/// Every number that decides in the pipeline, family by family.
pub fn thresholds() -> Vec<Table> {
    vec![
        PipelineBudget::table(),
        PipelineDelays::table(),
        PipelineSecondMethod::table(),
        PipelineMissingStates::table(),
    ]
}
