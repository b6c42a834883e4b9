//! Numbers that decide how predictions are made and compared.

use sidc_thresholds::Table;

sidc_thresholds::family! {
    /// Starts, horizons and work of predictions.
    pub PREDICTION: PredictionRule {
        /// Starts that are compared.
        starts: usize = 60, unit "starts", source "the share of starts within a limit then has a standard error of √(0.9 · 0.1/60), 4 %";
        /// Least number of starts, whatever they cost; as many are run beyond the horizon asked for.
        fewest_starts: usize = 20, unit "starts", source "the least number whose 90 % quantile leaves out two starts, so that a single one does not decide";
        /// Rows that all runs may cover.
        rows: usize = 20_000, unit "rows", source "some 20 ms at 1 µs a row of a small system";
        /// More of them for each row of the data.
        rows_a_row: usize = 8, unit "rows", source "work linear in the data, as that of one estimate of derivatives";
        /// Error of the last value kept from which on it says no more than the mean of all readings.
        no_change: f64 = 1.0, unit "of the signal's spread", source "predicting the mean has an error of one spread, by definition";
        /// Part of a record that the horizon may take.
        record_part: usize = 5, unit "th part of the record", source "the starts then cover the other four fifths";
        /// Horizons of the curve, from the shortest.
        doublings: usize = 8, unit "horizons", source "each twice the one before, from an eighth of the horizon to sixteen times it";
        /// Error up to which a prediction follows.
        follows: f64 = 0.5, unit "of the signal's spread", source "then 1 − 0.5², three quarters of the variance, are explained";
    }
}

sidc_thresholds::family! {
    /// Bands about predictions.
    pub BAND: BandRule {
        /// Starts on the data used and as many on data held out, where the rows of all runs allow it.
        starts: usize = 400, unit "starts", source "the share of readings within a band then has a standard error of √(0.9 · 0.1/400), 1.5 %";
        /// Rows that the runs of bands may cover, over those of all other runs.
        work: usize = 4, unit "times `prediction.rows` and `prediction.rows_a_row`", source "then all measured sets of docs/rigs.md have some 300 starts or more, in at most a second";
        /// Growth of a band that follows its errors, for each prediction that was missed; for one that was not, a ninth as much less.
        rate: f64 = 0.1, unit "of the logarithm of the half width", source "after a change of the errors by two a band has followed in 8 misses; on seven measured sets of docs/rigs.md with 400 to 600 starts, rates of 0.02, 0.05 and 0.1 hold 84 to 96, 86 to 94 and 88 to 92 %";
    }
}

sidc_thresholds::family! {
    /// States at the starts, fitted with the equations to the readings before them.
    pub STATE_FIT: StateFit {
        /// Starts on the data used by which the number of rows is chosen.
        starts: usize = 12, unit "starts", source "the median of twelve has an error of 0.36 of their scatter, and neighbouring numbers of rows differ by a factor of two";
        /// Readings for each component of the state in the shortest fit.
        readings: usize = 2, unit "readings", source "as many degrees of freedom are left as are fitted";
        /// How often that number of rows is doubled.
        doublings: usize = 6, unit "doublings", source "noise averaged over 64 times the rows falls to an eighth; what remains is no longer the largest error";
        /// Part of an uninterrupted record that the rows of a fit may take.
        record_part: usize = 5, unit "th part of the record", source "as that of the horizon";
        /// Score, over the best, from which on longer fits are not tried.
        worse: f64 = 4.0, unit "times the least square of the error", source "twice the error: the equations do not hold for so long";
        /// Error one row ahead up to which readings are without noise, and are the state.
        clean: f64 = 1e-4, unit "of the signal's spread", source "repeat: on exact data of the gallery the largest is 3e-7, with noise of 0.1 % it is 1e-3";
        /// Gauss–Newton steps.
        steps: usize = 6, unit "steps", source "from a local polynomial the error falls at least to a tenth with each step: six reach rounding of readings";
        /// Fall of the sum of squares at which the fit has settled.
        settled: f64 = 1e-3, unit "of the sum of squares", source "a thousandth of χ² moves the state by 0.03 standard errors";
        /// Step at which the fit has settled.
        still: f64 = 1e-9, unit "of the size of a component", source "the tolerance of integration";
        /// Step of a difference quotient.
        difference: f64 = 1e-4, unit "of the size of a component", source "about the square root of the tolerance of 1e-9, the usual balance of truncation and rounding";
        /// Least noise of a channel.
        noise_floor: f64 = 1e-6, unit "of the signal's spread", source "below, readings count as clean: `initial_state.clean`";
    }
}

sidc_thresholds::family! {
    /// The linear model beside the equations.
    pub LINEAR_MODEL: LinearModel {
        /// Pairs of rows that it is fitted to.
        pairs: usize = 2_000, unit "pairs", source "its coefficients then have errors of 1/√2,000, 2 % of the noise";
        /// Steps that a horizon is cut into.
        steps: usize = 8, unit "steps", source "as many as the shortest horizon of the curve fits into the one asked for";
        /// Rows to each side that a rate without readings is taken from.
        slope_rows: usize = 3, unit "rows", source "seven rows: four more than the parabola that is fitted has coefficients";
        /// Ridge that keeps equal columns apart.
        ridge: f64 = 1e-10, unit "of a unit column's square", source "about √ε, far below any noise";
    }
}

/// Every family of this module.
pub fn tables() -> Vec<Table> {
    vec![
        PredictionRule::table(),
        BandRule::table(),
        StateFit::table(),
        LinearModel::table(),
    ]
}
