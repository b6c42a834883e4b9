//! The numbers that decide in joint estimation, one family a subject.
//!
//! In: nothing. Out: records of values with unit and source. Never computes with them.

use super::likelihood::thresholds::Criterion;
use sidc_thresholds::{Table, family};

family! {
    /// When readings are enough, coarse, or too many to be searched at once.
    pub(crate) RECORDS: Records {
        /// Fewest samples of an uninterrupted piece of a trajectory that is used.
        min_samples: usize = 4, unit "samples", source "set by hand";
        /// Fewest readings of every measured state for which a trajectory has noise levels of its own.
        min_readings_of_own_noise: usize = 50, unit "readings", source "a standard deviation from m readings has a relative error of 1/sqrt(2 m): a tenth at 50";
        /// Distance of a reading from a quantization grid that rounding in print may make.
        grid_tolerance: f64 = 0.05, unit "quantization steps", source "set by hand";
        /// Fewest readings a distinct value for which a grid is accepted.
        readings_per_value: usize = 2, unit "readings", source "set by hand";
        /// Noise from which quantization errors count as white.
        dither: f64 = 0.5, unit "quantization steps", source "Widrow and Kollar 2008, Quantization Noise (dither); the value is set by hand";
        /// Samples up to which all records are searched whole.
        max_searched_samples: usize = 10_000, unit "samples", source "set by hand";
        /// Longest segment of a record that is searched in parts.
        segment_samples: usize = 1_000, unit "samples", source "set by hand";
        /// Shortest segment that is used.
        min_segment_samples: usize = 50, unit "samples", source "set by hand";
    }
}

family! {
    /// How laws are integrated between samples, and how far a trajectory may depart from them.
    pub(crate) SHOOTING: Shooting {
        /// Standard deviation by which a state may slip from the laws between samples: it allows for rounding and chaos.
        slack: f64 = 3e-3, unit "noise of the sensor", source "1e-5 of the variance of a reading";
        /// The same summed over a record (it grows with the root of the number of samples).
        slack_of_record: f64 = 0.1, unit "noise of the sensor", source "set by hand";
        /// Standard deviation of the weak prior that keeps a state near its present value at a sample without a reading.
        unread_hold: f64 = 30.0, unit "spread of the state", source "a thousandth of the information that a spread has";
        /// Standard deviation of the prior on the one sample of a hidden state that fixes its scale while terms are sought.
        pinned_hold: f64 = 1e-4, unit "spread of the state", source "far below what any reading tells of a state, far above the rounding of its square";
        /// Slack of the laws of hidden states.
        hidden_slack: f64 = 1e-6, unit "slack of the best sensor", source "a coefficient of a hundred thousand then still makes less than the noise of a slip";
        /// Integration error allowed over an interval.
        accuracy: f64 = 1e-4, unit "noise of the sensor", source "the errors of 10⁴ readings then change the criterion by 0.02, `criterion_step`: 2·1e-4·√10⁴";
        /// Finest integration error that is requested.
        min_accuracy: f64 = 1e-11, unit "spread of the state", source "set by hand";
        /// Most Runge-Kutta steps of an interval.
        max_steps: usize = 64, unit "steps", source "set by hand";
        /// Error of a Runge-Kutta step over the fifth power of its length in time constants.
        step_error: f64 = 1.0 / 120.0, unit "", source "the first term of exp that order four leaves out: 1/5!";
        /// A guard of a switch that counts as zero at the start of an interval.
        on_guard: f64 = 1e-10, unit "spread of its states", source "set by hand: far above rounding, far below what a reading shows";
        /// Part of an interval within which a body that comes to rest counts as at rest at its start.
        at_rest: f64 = 0.01, unit "of the interval", source "set by hand: slips leave speeds that are a thousandth of the sensor's noise";
        /// Newton steps for laws that contain rates.
        newton_steps: usize = 8, unit "steps", source "set by hand";
        /// Relative change of a rate at which Newton's method ends.
        newton_converged: f64 = 1e-12, unit "", source "set by hand";
        /// Relative change that is accepted after the last step.
        newton_accepted: f64 = 1e-6, unit "", source "set by hand";
        /// Pivot, relative to the largest entry, below which laws cannot be solved for their rates.
        singular_pivot: f64 = 1e-10, unit "", source "set by hand";
    }
}

family! {
    /// Inputs between their samples.
    pub(crate) INTERPOLATION: Interpolation {
        /// Second difference up to which a signal is straight by itself.
        straight: f64 = 1e-9, unit "of its largest value", source "above rounding of ten digits in print; what it moves is below any noise";
    }
}

family! {
    /// When a Gauss-Newton fit of one support ends.
    pub(crate) GAUSS_NEWTON: GaussNewton {
        /// Most steps.
        max_steps: usize = 8, unit "steps", source "set by hand";
        /// Further steps for laws that jump.
        event_steps: usize = 16, unit "steps", source "an event moves by one interval a step; of the 40 bodies of crates/studies/friction at 1 % of noise 4 stay unsettled without them, 2 with them";
        /// Largest step of a state at which the fit has converged.
        state_step: f64 = 0.02, unit "noise of the sensor", source "set by hand";
        /// Largest step of the logarithm of a noise at which the fit has converged.
        log_noise_step: f64 = 1e-3, unit "", source "set by hand";
        /// Change of the criterion at which the fit has converged.
        criterion_step: f64 = 0.02, unit "criterion", source "set by hand";
        /// Rise of the criterion from which steps are mistrusted and halved: taking each noise from the residuals moves it by less.
        uphill: f64 = 1.0, unit "criterion", source "set by hand";
        /// Halvings of a step before the fit ends without it.
        max_halvings: usize = 7, unit "halvings", source "a step of one standard deviation of a sensor is then below `state_step`: 2^-7";
        /// Further steps of a fit whose steps are halved.
        halving_steps: usize = 12, unit "steps", source "six are too few for the laws with delays of the study, and twice as many change nothing";
        /// A fit is given up if its criterion, less the gains expected of its remaining steps, exceeds the best one by more than
        /// this.
        hopeless_lag: f64 = 100.0, unit "criterion", source "set by hand";
        /// Gain expected of each remaining step in that comparison, over the gain of the last step.
        hopeless_gain: f64 = 2.0, unit "", source "set by hand";
        /// Distance from the readings at which a trajectory has left the data.
        lost_spread: f64 = 2.0, unit "spread of the state", source "set by hand";
        /// Factor on the relative noise that is added to this distance.
        lost_noise: f64 = 10.0, unit "noise of the sensor", source "set by hand";
        /// The same for states without a reading, measured from the smoothed trajectory.
        lost_unread: f64 = 6.0, unit "spread of the state", source "set by hand";
        /// Distance from its first guess at which a hidden state is lost.
        lost_hidden: f64 = 1e3, unit "spread of the guess", source "guesses are in the scale of what they explain; only laws that leave the data run farther";
        /// Diagonal entry of R, relative to the norm of its column, below which the column depends on those before it.
        dependent_pivot: f64 = 1e-10, unit "", source "set by hand";
    }
}

family! {
    /// Minimisation of the likelihood over a few noises.
    pub(crate) QUASI_NEWTON: QuasiNewton {
        /// Most steps.
        max_steps: usize = 30, unit "steps", source "four times what the cart-pole's five noises need";
        /// Longest step of a logarithm.
        longest_step: f64 = 2.0, unit "", source "a factor of seven: differences say little of what is farther";
        /// Halvings of a step that goes uphill.
        max_halvings: usize = 12, unit "halvings", source "a step is then below `difference`";
        /// Difference of a logarithm by which slopes are taken.
        difference: f64 = 1e-3, unit "", source "its error moves a noise by 0.05 %, far less than its own error";
    }
}

family! {
    /// Disturbances of the laws.
    pub(crate) DISTURBANCES: Disturbances {
        /// Most steps of a fit under process noise.
        max_steps: usize = 20, unit "steps", source "as many as fits whose steps are halved may take";
        /// Predicted gain of a step below which the noises have converged.
        converged: f64 = 0.01, unit "criterion", source "half of `criterion_step`";
        /// Deviation of states before anything is read.
        first_state: f64 = 10.0, unit "spread of the state", source "hardly anything is known: ten times what the data show";
        /// First size of a disturbance.
        first_size: f64 = 0.3, unit "spread of the target", source "any size is a start: the likelihood over noises has one maximum in all cases looked at";
        /// First memory of a disturbance.
        first_memory: f64 = 10.0, unit "samples", source "the same";
        /// Residuals of the first fits, over what noise may give, above which no support under disturbances is sought.
        hopeless: f64 = 3.0, unit "of what noise may leave", source "204 searches of trust cases: of 94 whose first fits left more than noise 5 ended with noise alone; these left at most 1.7 first";
        /// Least and largest noise that is tried, relative to the spread of the states.
        range: [f64; 2] = [1e-6, 1e3], unit "spread of the state", source "beyond, a noise is none, or the readings say nothing";
    }
}

family! {
    /// Inputs that are read with noise.
    pub(crate) INPUT_NOISE: InputNoise {
        /// Correlation of an input from one sample to the next, at least and at most.
        correlation: [f64; 2] = [1e-3, 0.999], unit "", source "below, it is none; above, the record holds no change to tell it by";
        /// Least share of the variance of its readings that is the input's own.
        least_share: f64 = 0.01, unit "of the variance", source "with less the readings say nothing of the input";
    }
}

family! {
    /// Budgets of the search for supports.
    pub(crate) SEARCH: Search {
        /// Floors under the noise, level after level.
        floors: [f64; 5] = [0.1, 0.01, 1e-3, 1e-4, 1e-5], unit "spread of the state", source "by factors of ten, from where any law of the right shape fits to clean readings";
        /// A floor is skipped unless it is this many times the largest noise that smoothing shows.
        floor_over_noise: f64 = 1.5, unit "", source "set by hand";
        /// Slack of the laws in the two first linearisations.
        initial_slacks: [f64; 2] = [0.3, 0.03], unit "noise of the sensor", source "set by hand";
        /// Residual up to which a support from another method explains the readings.
        start_noise: f64 = 1.1, unit "noise that smoothing shows", source "set by hand: right laws leave 0.95 to 1.00 of it on the cart-pendulum; beyond, the search only takes longer";
        /// Most terms of a support, where one from another method explains the readings: more cannot explain them better.
        terms_of_start: usize = 2, unit "terms of that support", source "set by hand; with it 376 benchmark runs at 1 to 20 % noise are as exact as a search from nothing, and one more is";
        /// Prices of a term for which the first linearisations propose supports.
        initial_prices: [f64; 3] = [1.0, 4.0, 16.0], unit "price of a term", source "by factors of four, from rich supports to sparse ones";
        /// Prices for which backward elimination proposes supports about a fit.
        prices: [f64; 5] = [1.0, 2.0, 4.0, 8.0, 16.0], unit "price of a term", source "set by hand";
        /// Price above which a proposal is fitted whatever the linearised likelihood says of it.
        sparse_price: f64 = 2.0, unit "price of a term", source "set by hand";
        /// Most terms of a law that the beam search reaches.
        max_beam_terms: usize = 7, unit "terms", source "set by hand";
        /// Supports that the beam keeps of each size above two.
        beam_width: usize = 200, unit "supports", source "set by hand";
        /// Supports that the beam keeps of one and two terms.
        beam_width_pairs: usize = 500, unit "supports", source "set by hand";
        /// Supports that the beam reports of each size.
        beam_reported: usize = 8, unit "supports", source "set by hand";
        /// Best subsets of each law that are proposed.
        subsets_proposed: usize = 4, unit "supports", source "set by hand";
        /// Single additions, removals and exchanges that are proposed.
        moves_proposed: usize = 6, unit "supports", source "set by hand";
        /// Most fits of a level, beside the first ones and those carried over.
        max_fits: usize = 40, unit "fits", source "set by hand";
        /// Predicted loss up to which a proposal is fitted.
        max_predicted_loss: f64 = 3.0, unit "criterion", source "set by hand";
        /// Predicted loss up to which a rival is fitted at the end.
        rival_loss: f64 = 12.0, unit "criterion", source "twice a tie: of four attack cases the fitted loss was 15 to 25 % less than the predicted one, and 6.3 predicted was 4.8";
        /// Most rivals fitted at the end.
        max_rivals: usize = 12, unit "fits", source "set by hand";
        /// Fits carried over to the next level.
        carried: usize = 3, unit "fits", source "set by hand";
        /// Improvement below which a fit is no better.
        min_gain: f64 = 1e-3, unit "criterion", source "set by hand";
        /// Largest support of which a fit without each term is tried at the end.
        max_pruned_terms: usize = 30, unit "terms", source "set by hand";
        /// Predicted loss of χ² up to which a support is fitted without one of its terms at the end.
        max_pruned_loss: f64 = 100.0, unit "criterion", source "906 such fits (47 systems at 0.1, 5 and 20 % noise, five measured rigs): 7 of 32 predicted to lose up to 100 were better, the worst predicted to lose 10; none of the 874 others was";
        /// Statistical inefficiency of the residuals above which supports are selected again.
        max_inefficiency: f64 = 1.5, unit "readings", source "set by hand";
        /// Most fits with terms that the libraries lack.
        fits_beyond: usize = 8, unit "fits", source "evidence is to cost less than the search, whose median is some 40 fits";
        /// Blocks of intervals that the last fit of a stopped search may take: a second or two.
        grace_blocks: usize = 5_000, unit "blocks", source "set by hand";
    }
}

family! {
    /// Supports under constraints, on linearised likelihoods.
    pub(crate) CONSTRAINED_SUPPORTS: ConstrainedSupports {
        /// Columns of each law that are tried in every place of a support.
        additions: usize = 5, unit "columns", source "that of `ConstrainedSearchLimits`";
        /// Single changes of one descent.
        max_changes: usize = 60, unit "changes", source "that of `ConstrainedSearchLimits`";
    }
}

family! {
    /// What residuals say of noise, memory and outliers.
    pub(crate) RESIDUALS: Residuals {
        /// Autocorrelation below which residuals count as white, however sure it is.
        white: f64 = 0.05, unit "", source "set by hand";
        /// Residual that comes from arithmetic.
        arithmetic: f64 = 1e-6, unit "spread of the state", source "set by hand";
        /// Lags summed, over the integrated autocorrelation time so far.
        lag_window: f64 = 5.0, unit "", source "Sokal 1997, Monte Carlo methods in statistical mechanics, section 3 (automatic windowing)";
        /// Least noise by which standard errors are computed, over the noise of the fit.
        min_noise: f64 = 0.1, unit "noise of the fit", source "set by hand";
        /// Ratio of residuals from which files count as having different sensors.
        files_differ: f64 = 1.5, unit "", source "set by hand";
        /// Robust distance beyond which a reading is an outlier.
        outlier: f64 = 5.0, unit "robust standard deviations", source "normal noise goes so far once in 1.7 million readings";
        /// Neighbouring readings, in time and in value, whose deviations give the usual size there.
        around: usize = 50, unit "readings", source "a standard deviation from the median of 50 readings has a relative error of 1.17/sqrt(50): a sixth";
        /// Distance of its neighbours, relative to its own, up to which a reading is an outlier and not a misfit of the laws.
        neighbours: f64 = 0.6, unit "", source "set by hand";
        /// Largest share of outliers; a channel with more has another distribution.
        max_outliers: f64 = 0.2, unit "readings", source "set by hand";
        /// Probability under a normal distribution below which outliers of a state are a doubt.
        outliers_by_chance: f64 = 1e-3, unit "", source "one false doubt in a thousand sensors";
        /// Blocks of the records that stability is judged on.
        max_blocks: usize = 10, unit "blocks", source "they divide into halves in 252 ways";
        /// Fewest blocks of which halves are drawn.
        min_blocks: usize = 4, unit "blocks", source "two blocks in each half";
        /// Samples of a block a state: its free first state then takes an eighth of its information.
        block_samples: usize = 8, unit "samples", source "n of 8 n readings determine the first state: an eighth";
        /// Columns beside those found whose products are kept.
        block_rivals: usize = 100, unit "columns", source "set by hand";
    }
}

family! {
    /// Laws run some time ahead.
    pub(crate) AHEAD: Ahead {
        /// How far ahead predictions are compared.
        own_times: f64 = 2.0, unit "times in which a state moves by its spread", source "a third of the period of an oscillation: 2/(2 pi)";
        /// Blocks of neighbouring starts in each record.
        blocks: usize = 6, unit "blocks", source "some 400 starts in each record, a few milliseconds";
        /// Integration error of an interval.
        accuracy: f64 = 1e-6, unit "spread of the state", source "far below any error ahead";
        /// Ratio of errors up to which laws predict as well.
        as_good: f64 = 1.1, unit "", source "400 starts that overlap tell errors to some 10 %";
    }
}

family! {
    /// Noise that grows with the signal.
    pub(crate) GROWTH: NoiseGrowth {
        /// Least noise of a reading.
        least: f64 = 0.01, unit "root mean square noise of its sensor", source "where a signal crosses 0, the fitted value is itself uncertain by about 1/sqrt(readings) of the noise";
        /// Growths that are tried: shares of the noise at the root mean square value, in units of the constant part.
        tried: (f64, f64) = (0.1, 100.0), unit "", source "below, the growth changes no weight by 1 %; above, the constant part is below `least`";
        /// Growths tried a decade before the best one is refined.
        per_decade: usize = 8, unit "growths", source "the likelihood of 50 readings changes over half a decade or more";
        /// Fewest readings of a sensor from which growth is estimated.
        min_readings: usize = 50, unit "readings", source "as for a noise level of their own: `records.min_readings_of_own_noise`";
        /// Root mean square change of the logarithms of the weights at which they are not computed again.
        settled: f64 = 0.05, unit "", source "weights off by 5 % cost estimates less than 1 % of their precision";
    }
}

family! {
    /// What several records of one plant say of each other.
    pub(crate) POOLING: Pooling {
        /// Residual up to which laws follow a record from which they were not found.
        followed: f64 = 3.0, unit "noise of the sensor", source "set by hand: coefficients of other records are off by their errors";
        /// Normal deviate of the χ² over the runs from which a coefficient is suspected to differ.
        differ: f64 = 3.0, unit "standard deviations", source "a chance of 1e-3: refits decide among the suspects";
        /// Gain of the criterion, beyond the price of the values, from which a coefficient differs.
        min_gain: f64 = 6.0, unit "of the criterion, each independent reading", source "Kass and Raftery 1995, section 3.2: 6 is strong evidence";
        /// Most runs that are looked at one by one where not all can be followed together.
        max_runs: usize = 12, unit "runs", source "each costs a search";
    }
}

family! {
    /// Which delays of inputs are tried.
    pub(crate) DELAYS: Delays {
        /// Delays that are screened.
        screened: [usize; 12] = [1, 2, 3, 4, 5, 6, 8, 10, 12, 14, 17, 20], unit "samples", source "set by hand";
        /// Simplest columns of each law that are screened: as many without inputs, and as many with them.
        simple_columns: usize = 8, unit "columns", source "set by hand";
        /// Fewest of them with each input.
        columns_per_input: usize = 2, unit "columns", source "set by hand";
        /// Steps about a proposed delay; held inputs take whole samples only.
        steps: [f64; 4] = [2.0, 1.0, 0.5, 0.25], unit "samples", source "set by hand";
        /// Most terms a law of a support that is fitted with delays as it is.
        max_terms: usize = 8, unit "terms", source "set by hand";
        /// Sets of inputs whose delays are fitted.
        max_sets: usize = 2, unit "sets", source "set by hand";
        /// Time constants of a lag that is tried in place of a delay.
        lags: [f64; 6] = [1.0, 0.7, 1.4, 0.5, 2.0, 0.35], unit "delays", source "a lag shifts slow motion by its time constant and fast motion by less; a grid of half octaves about the delay";
        /// A record is cut by at most one part in so many.
        max_cut: usize = 5, unit "", source "set by hand";
    }
}

family! {
    /// Delays that the model declares.
    pub(crate) DECLARED_DELAYS: DeclaredDelays {
        /// Instants nearer than this are one.
        instant: f64 = 1e-6, unit "sampling intervals", source "time stamps of nine digits round intervals of a thousandth of the record by as much";
        /// Most delays of a range that are screened.
        screened: usize = 40, unit "delays", source "a range of 20 samples in half samples, as `screened` of delays that nobody declared";
        /// Most delays of a range at which a support is refitted before the best is looked for between them.
        profiled: usize = 12, unit "delays", source "the screening has found the region: these guard against a minimum beside it";
        /// Times that each of several delays is moved while the others stand.
        sweeps: usize = 2, unit "sweeps", source "set by hand";
        /// Rise of −2 log likelihood at the ends of a confidence interval.
        rise: f64 = 3.84, unit "", source "0.95 quantile of chi squared with one degree of freedom (Wilks 1938)";
        /// Most golden sections.
        sections: usize = 24, unit "sections", source "0.618^24 = 1e-5 of a grid interval";
        /// Difference of criteria that no longer tells two delays apart.
        flat: f64 = 0.002, unit "of `rise`", source "moves the delay by 2 % of half its interval";
        /// First guess of where an interval ends, as a part of the way to the end of the range.
        first_part: f64 = 0.1, unit "", source "set by hand; secants correct it";
        /// Accuracy of the rise at the ends of an interval.
        bound_accuracy: f64 = 0.05, unit "of `rise`", source "moves an end by 2.5 % of half the interval";
        /// Most fits for an end of an interval.
        bounds: usize = 12, unit "fits", source "halving alone then leaves 1/4096 of the range";
        /// Distance from an end of the range within which a delay counts as at that end.
        end: f64 = 1e-3, unit "of the range", source "a delay so near an end is not bounded by it";
        /// Rounds of a search of terms and a profile of the delays.
        rounds: usize = 2, unit "rounds", source "as `delay_rounds`: the first terms, found at a screened delay, may not be the last";
    }
}

family! {
    /// Unknown constants for given terms.
    pub(crate) CONSTANTS: Constants {
        /// Points whose likelihood is looked at, with terms that the weak form guesses, which costs a thousandth of a search.
        ranked: usize = 40, unit "points", source "every start and every end on rows of differentiated noise, which may put the right one anywhere";
        /// Candidates of all laws from which values of the constants are also scanned by the weak form, and several of them searched.
        scanned_columns: usize = 30, unit "columns", source "crates/studies/families/table.py: at 1 % of noise rows of derivatives miss none of 80 constants among 6 or 9 candidates, with --large (90 or 210) 7 of 32";
        /// Values that such a scan adds to the points.
        scanned: usize = 8, unit "points", source "set by hand: a fifth of `ranked`";
        /// Values from which terms are searched in a large library.
        searched: usize = 3, unit "points", source "crates/studies/families/table.py --large: with 3, at 1 % noise, the search misses 2 of 32 laws that its criterion prefers, with 1 and no scan 7; the time is three times as long";
        /// Gauss–Newton steps.
        steps: usize = 12, unit "steps", source "the search on rows starts them within their basin; each step then gains a digit";
        /// Halvings of a step that makes the likelihood smaller.
        halvings: i32 = 6, unit "halvings", source "to a sixty-fourth of the linearised step";
        /// Step at which constants have settled.
        settled: f64 = 0.01, unit "standard errors", source "the likelihood changes by 1e-4";
        /// Columns of the likelihood on which constants are profiled, terms at many values with their slopes.
        profiled_columns: usize = 250, unit "columns", source "set by hand: 125 values of one term with its slope";
        /// Further terms with each of which an answer is refitted, and exchanges of one term for another.
        added_terms: usize = 3, unit "terms", source "set by hand: those of the largest predicted gain";
        /// Laws of the profile that are fitted.
        profiled_laws: usize = 6, unit "laws", source "set by hand: each takes some ten fits";
        /// Predicted loss from which a law of the profile is not fitted.
        profiled_loss: f64 = 30.0, unit "criterion", source "five times a tie: the linearised likelihood is that wrong away from its fit";
        /// Difference up to which two values of a constant count as the same.
        same: f64 = 0.05, unit "of the constant", source "set by hand: the fit from either goes farther";
        /// Rounds of a search of terms and a fit of the constants.
        rounds: usize = 3, unit "rounds", source "as `delay_rounds`, and one in which nothing changes";
    }
}

family! {
    /// Which offsets of sensors are tried.
    pub(crate) OFFSETS: Offsets {
        /// Offsets tried for each state.
        max_candidates: usize = 2, unit "offsets", source "set by hand";
        /// Relative distance within which two candidates are one.
        same: f64 = 0.2, unit "", source "set by hand";
        /// Most parabolas laid through the criterion.
        max_parabolas: usize = 4, unit "parabolas", source "set by hand";
        /// First step, relative to the offset.
        first_step: f64 = 0.1, unit "", source "set by hand";
        /// Longest move of a parabola, in steps.
        max_move: f64 = 4.0, unit "steps", source "set by hand";
        /// Shortest next step, in steps.
        min_step: f64 = 0.05, unit "steps", source "set by hand";
        /// Change of the criterion at which the offset has converged.
        converged: f64 = 0.5, unit "criterion", source "a move of one standard error changes it by 1: this is less";
        /// Fewest terms that an offset has to explain, constants among them.
        min_terms: usize = 2, unit "terms", source "set by hand";
        /// Loss up to which laws with an offset and as many numbers are as good.
        as_good: f64 = 2.0, unit "criterion", source "Kass and Raftery 1995, section 3.2: less is not worth more than a bare mention";
        /// How much worse the first fit with an offset may be.
        hopeless: f64 = 30.0, unit "price of a term", source "set by hand";
        /// Relative standard error from which a term may be dropped.
        weak: f64 = 0.1, unit "", source "set by hand";
    }
}

/// Every family of joint estimation, for the documentation.
pub fn tables() -> Vec<Table> {
    vec![
        Records::table(),
        Shooting::table(),
        Interpolation::table(),
        GaussNewton::table(),
        QuasiNewton::table(),
        Disturbances::table(),
        InputNoise::table(),
        Criterion::table(),
        Search::table(),
        ConstrainedSupports::table(),
        Residuals::table(),
        Ahead::table(),
        NoiseGrowth::table(),
        Pooling::table(),
        Delays::table(),
        DeclaredDelays::table(),
        Constants::table(),
        Offsets::table(),
    ]
}
