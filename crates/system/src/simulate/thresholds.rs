//! Numbers that decide how a run is integrated, started, ended and scored.

use sidc_thresholds::Table;

sidc_thresholds::family! {
    /// Steps of the explicit Runge–Kutta method.
    pub EXPLICIT: Explicit {
        /// Local error of a step.
        tolerance: f64 = 1e-13, unit "of the state and its typical size", source "set by hand";
        /// Part of the step that the error suggests.
        safety: f64 = 0.9, unit "of the step", source "Hairer, Nørsett, Wanner, Solving ODEs I, II.4";
        /// Least part of a rejected step that the next one keeps.
        shrinks: f64 = 0.1, unit "of the step", source "set by hand";
        /// Most that a step grows by.
        grows: f64 = 8.0, unit "times the step", source "set by hand";
        /// Product of step and eigenvalue from which the right side counts as stiff.
        stability: f64 = 3.0, unit "h·|λ|", source "Hairer, Wanner, Solving ODEs II, IV.2: the limit on the negative real axis is 3.31; the margin is set by hand";
        /// Steps at that limit before the implicit method takes over.
        stiff_steps: usize = 15, unit "steps", source "Hairer, Wanner, Solving ODEs II, IV.2 (code DOPRI5)";
        /// Steps away from the limit after which the count starts again at zero.
        calm_steps: usize = 6, unit "steps", source "Hairer, Wanner, Solving ODEs II, IV.2 (code DOPRI5)";
        /// Steps between two stops that are too many for an explicit method, whatever the reason.
        steps_between_stops: usize = 20_000, unit "steps", source "set by hand";
        /// Smallest step.
        smallest_step: f64 = 1e-15, unit "of the time", source "a few times the unit roundoff of 1.1e-16";
    }
}

sidc_thresholds::family! {
    /// Steps of the implicit Radau method. HW is Hairer, Wanner, Solving ODEs II.
    pub IMPLICIT: Implicit {
        /// Local error of a step.
        tolerance: f64 = 1e-10, unit "of the state and its typical size", source "set by hand";
        /// Failures of the right side in successive steps after which integration ends.
        failures: usize = 20, unit "steps", source "set by hand";
        /// Part of a step in which the right side failed that is tried next.
        after_failure: f64 = 1.0 / 8.0, unit "of the step", source "set by hand";
        /// Smallest step.
        smallest_step: f64 = 1e-15, unit "of the time", source "a few times the unit roundoff of 1.1e-16";
        /// First step.
        first_step: f64 = 0.1, unit "of the time in which the state changes by its size", source "its sixth power times the error constant, 1e-5, is a tenth of the tolerance";
        /// Part of the step that the error suggests.
        safety: f64 = 0.9, unit "of the step", source "HW, IV.8 (code RADAU5)";
        /// Least ratio of a step to the next one.
        least_ratio: f64 = 1.0 / 8.0, unit "", source "HW, IV.8 (code RADAU5)";
        /// Largest ratio of a step to the next one.
        largest_ratio: f64 = 5.0, unit "", source "HW, IV.8 (code RADAU5)";
        /// Growth of a step up to which its length and factors are kept.
        kept_growth: f64 = 1.2, unit "times the step", source "HW, IV.8 (code RADAU5)";
        /// Part of a rejected first step that is tried next.
        after_first: f64 = 0.1, unit "of the step", source "HW, IV.8 (code RADAU5)";
        /// Least error whose change from step to step is a trend.
        trend_floor: f64 = 1e-2, unit "of the allowed error", source "HW, IV.8 (code RADAU5)";
        /// Error below which it is rounding and allows no longer steps.
        error_rounding: f64 = 1e-9, unit "of the allowed error", source "set by hand";
        /// Part of the way ahead from which a step is stretched to its end.
        stretch: f64 = 0.999, unit "", source "as RADAU5 from 0.9999 on: the rest would be a step too small to take";
        /// Newton iterations of a step.
        iterations: usize = 12, unit "iterations", source "Hairer, Wanner 1999, J. Comp. Appl. Math. 111, for five stages, rounded";
        /// Error that Newton's method may leave.
        newton_error: f64 = 1e-3, unit "of the allowed error", source "set by hand";
        /// Rate of convergence up to which a Jacobian is used for another step.
        jacobian_speed: f64 = 1e-3, unit "", source "HW, IV.8 (code RADAU5)";
        /// Relative difference of steps that share their factors: the rows of a table are equally far apart but for rounding.
        same_step: f64 = 1e-3, unit "", source "set by hand";
        /// Rate of convergence from which Newton's method diverges.
        stalled: f64 = 0.99, unit "", source "HW, IV.8 (code RADAU5)";
        /// Part of a step in which Newton's method diverged that is tried next.
        after_divergence: f64 = 0.5, unit "of the step", source "HW, IV.8 (code RADAU5)";
    }
}

sidc_thresholds::family! {
    /// Work that a run may take, and where it ends.
    pub BUDGET: Budget {
        /// Evaluations of a run with error control.
        evaluations: u64 = 10_000_000, unit "evaluations", source "set by hand";
        /// More of them for each row.
        evaluations_a_row: u64 = 2_000, unit "evaluations", source "set by hand";
        /// Steps that `--step` may cut a record into.
        fixed_steps: f64 = 1e9, unit "steps", source "set by hand";
        /// Evaluations of one trial of an initial state.
        trial_evaluations: u64 = 200_000, unit "evaluations", source "set by hand";
        /// Size of a state at which a run has diverged from its data.
        blow_up: f64 = 1e6, unit "typical sizes of the state", source "set by hand";
    }
}

sidc_thresholds::family! {
    /// Short runs from many rows of a record, compared with readings.
    pub SEGMENTS: Segments {
        /// Local error of an explicit step.
        tolerance: f64 = 1e-9, unit "of the state and its typical size", source "a thousandth of the noise below which readings count as clean, 1e-6 of the spread";
        /// Evaluations of one run.
        evaluations: u64 = 20_000, unit "evaluations", source "3,000 steps of six stages: a run that takes more between a few rows meets a singularity";
        /// More of them for each row.
        evaluations_a_row: u64 = 200, unit "evaluations", source "30 steps of six stages: readings that are further apart resolve no motion of the equations";
    }
}

sidc_thresholds::family! {
    /// Initial states from noisy readings, by least squares over the first rows.
    pub INITIAL_STATE: InitialState {
        /// Rows at the beginning in which a start is looked for.
        search_rows: usize = 1_000, unit "rows", source "the first errors grow out of a start; more rows cost time and tell no more of it";
        /// Noise below which readings count as clean, as in `identify`.
        clean: f64 = 1e-6, unit "of the signal's spread", source "set by hand";
        /// Residual up to which readings are taken as they are: what smoothing called noise is motion.
        as_read: f64 = 0.2, unit "standard deviations of the noise", source "set by hand";
        /// Rows of the first stretch for each free component.
        rows_a_component: usize = 6, unit "rows", source "set by hand";
        /// Part of a long record that may go into its start.
        record_part: usize = 10, unit "th part of the record", source "set by hand";
        /// Rows up to which half of the record may.
        short_record: usize = 100, unit "rows", source "set by hand";
        /// Rows of the longest stretch.
        longest_stretch: usize = 1_000, unit "rows", source "set by hand";
        /// Root mean square of the residuals up to which the equations follow a stretch.
        follows: f64 = 1.5, unit "standard deviations of the noise", source "set by hand";
        /// Levenberg–Marquardt steps for one stretch.
        iterations: usize = 12, unit "steps", source "set by hand";
        /// Fall of the sum of squares at which a stretch is done.
        converged: f64 = 1e-4, unit "of the sum of squares", source "one ten-thousandth of χ² moves the start by 0.01 standard errors";
        /// Step at which a stretch is done.
        still: f64 = 1e-9, unit "of the size of a component", source "a thousandth of the step of a difference quotient";
        /// Step of a difference quotient: far above the tolerance of integration.
        difference: f64 = 1e-6, unit "of the size of a component", source "about the square root of the tolerance of 1e-13, the usual balance of truncation and rounding";
    }
}

sidc_thresholds::family! {
    /// Unknowns from the mass matrix, at one point of a run.
    pub MASS_MATRIX: MassMatrix {
        /// Size of the last step of Newton's method.
        newton_step: f64 = 1e-13, unit "of the largest unknown", source "set by hand";
        /// Step below which one that grows again is rounding, and ends the iteration.
        newton_rounding: f64 = 1e-8, unit "of the largest unknown", source "set by hand";
        /// Least singular value at which equations that a run cannot follow are called dependent.
        dependent: f64 = 1e-4, unit "of the largest singular value", source "set by hand";
        /// Pivot below which a matrix is singular.
        pivot: f64 = 1e-12, unit "of the largest entry of a row", source "set by hand";
    }
}

sidc_thresholds::family! {
    /// Scores of a run.
    pub SCORES: Scores {
        /// Error up to which a run follows, where `--bound` does not say otherwise.
        bound: f64 = 0.25, unit "standard deviations of the signal", source "valid prediction time, which Pathak et al. 2018 end at 0.4 of the rms";
        /// Noise of the readings beside it, added as variances are.
        noise: f64 = 2.0, unit "standard deviations of the noise", source "with the rule of most rows: of noise of 0.2 spreads 2 % of the rows exceed it, three of five successive ones once in 10^4";
        /// Successive rows of which most have to be off.
        rows: usize = 5, unit "rows", source "an outlier, or two, are no departure";
    }
}

/// Every family of this module.
pub fn tables() -> Vec<Table> {
    vec![
        Explicit::table(),
        Implicit::table(),
        Budget::table(),
        Segments::table(),
        InitialState::table(),
        MassMatrix::table(),
        Scores::table(),
    ]
}
