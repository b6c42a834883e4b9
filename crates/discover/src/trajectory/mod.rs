//! Joint estimation: trajectory, coefficients and noise of a system from noisy readings of some of its states.
//!
//! In: a checked model, its libraries, a dataset. Out: the support (set of terms) and coefficients of the largest penalised likelihood,
//! with the trajectory, the noise of every sensor, standard errors and rival supports. Nothing is differentiated. Whether the answer
//! is to be trusted is decided elsewhere.
//!
//! # The problem
//!
//! States z_k at the samples t_k, laws z' = f(z, w, u; a) that are linear in the coefficients a, readings y_k of some states:
//!
//! ```text
//! z_{k+1} = F_k(z_k; a) + slip      F_k: the laws integrated from t_k to t_{k+1} (`integration`)
//! y_k     = H z_k + noise           slip: a small part of the noise, against rounding and chaos
//! ```
//!
//! This is multiple shooting (Bock 1983) with one interval from every sample to the next, so that held inputs, gaps, uneven times and
//! implicit laws are no special cases. Its unknowns are all z_k, all a, and the standard deviation of each sensor.
//!
//! # A fit of one support (`likelihood`)
//!
//! 1. Linearise: δz_{k+1} = T_k δz_k + U_k δa + defect. T_k, the state-transition matrix, solves the variational equation; U_k is the
//!    sensitivity to the coefficients.
//! 2. Eliminate the states in order of time by a square-root information filter (Bierman 1977; `least_squares`). Householder
//!    reflections keep the digits that normal equations would square away: laws hold to many more digits than sensors have. What is
//!    left are rows in δa alone.
//! 3. Solve these rows (QR), substitute back for the states, take each sensor's noise from its residuals.
//! 4. Repeat (Gauss–Newton) until the states and noises, or the criterion, stand still.
//!
//! The criterion is Σ Mᵢ ln(noiseᵢ²) + χ² of the slips + price · terms, with Mᵢ readings of sensor i.
//!
//! Where laws are disturbed, slips are process noise whose size is estimated, and the states of a record are filtered forward instead: the
//! innovations of an extended Kalman filter take the place of the residuals (`likelihood/disturbed_fit`).
//!
//! # Which terms (`search`)
//!
//! About a fit, the eliminated problem over *all* candidate columns is a quadratic form χ²(a). Backward elimination, single moves and
//! beam search on it cost little and only propose; a refit with the true laws decides. The first form, before there is any fit, comes
//! from integral matching: the laws are integrated along smoothed readings. The noise is held above a floor that falls level by level, so
//! that the terms which explain most come first. Coloured residuals raise the price of a term by their statistical inefficiency.
//!
//! # Order of the folders
//!
//! Each imports only those before it: `thresholds`, `cancellation`, `model`, `integration`, `least_squares`, `likelihood`, `residuals`,
//! `search`, `hidden_states`, `sensor_faults`, `pooling`, `structural`.

mod cancellation;
mod golden_section;
pub(crate) mod hidden_states;
mod integration;
mod least_squares;
mod likelihood;
pub(crate) mod model;
mod pooling;
mod residuals;
mod search;
mod sensor_faults;
pub(crate) mod structural;
mod thresholds;

#[cfg(test)]
pub(crate) mod tests;

pub use hidden_states::ReportedScale;
pub(crate) use hidden_states::{
    HIDDEN, constants_by_runs, exchanged_constants, exchanged_lags, fit_proposed, likely_constants,
    with_sparsest_offset, with_started_states, with_told_scales,
};
pub use least_squares::SketchedProblem;
pub use likelihood::{BlockProducts, Fit, block_products, term_price};
pub use model::{
    AppliedDelay, CoefficientConstraints, Disturbance, Law, LeftOut, Problem, ProcessNoise, Record,
    RunColumn, RunColumns, SensorGroups, System,
};
pub use pooling::{Differing, RunNotFollowed, RunValue, differing_coefficients};
pub(crate) use pooling::{fit_by_run, left_by};
pub use residuals::{
    Channel, File, GrownNoise, LastingNoise, Outliers, autocorrelated_noise, channels, grow_noise,
    leave_out, log_error_ahead, noise_comes_in_bursts, own_time,
};
pub(crate) use search::minimum;
pub use search::{
    Answer, BetterLaws, FittedConstants, Found, LawChange, Parameter, Rival, SearchObserver,
    SoughtConstant, StartingSupport, error_correlations, fit_constants, fit_constants_by_levels,
    fit_constants_from, fit_constants_of_jumps, laws_with_constants, search,
    search_beyond_libraries, search_disturbed, search_from_fit, unidentifiable_directions,
    value_by_innovations, value_from, with_constant_values, with_constants_of_jumps,
    with_flown_states,
};
pub(crate) use sensor_faults::sampling_interval;
pub use sensor_faults::{
    CubicInputs, DelayEstimate, DelayProposal, DelayedInputs, InputLag, SensorOffset,
    criterion_without_delay, find_lag, find_sensor_offset, fit_delay, is_held, profile_delays,
    screen_delays, screen_ranges, with_delay,
};
pub use structural::{UnidentifiableDirection, structurally_unidentifiable_directions};
pub use thresholds::tables;
pub(crate) use thresholds::{AHEAD, CONSTANTS, DECLARED_DELAYS, POOLING};
