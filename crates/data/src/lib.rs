//! Measured data: CSV text → trajectories of named signals → samples.
//!
//! In: a reader and the model's data block. Out: a [`Dataset`], and from it [`Samples`] with every signal that the model's
//! equations need, measured or estimated. Opens no files.
//!
//! Flow: [`read`] (`csv`) → [`bind`] (`binding`, with `checks`) → [`Dataset`] → [`hold_out`], [`keep_window`] (`dataset`) →
//! [`samples`] (`sample_assembly`, with `derivatives`). Beside it: [`smooth`] (`smoothing`) takes the noise off one signal, [`is_smooth`] says that there is none, and
//! [`draft`] writes a first model of a table. `time_axis`, `intersample` and `segmentation` say where a record is even, held and
//! interrupted, `even_clock` whether scattered stamps are those of an even one.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

mod binding;
mod checks;
mod csv;
mod cubic;
mod dataset;
mod delays;
mod derivatives;
pub mod draft;
mod even_clock;
mod intersample;
mod order_statistics;
mod rate_columns;
mod sample_assembly;
mod segmentation;
mod series;
mod smoothing;
mod time_axis;

pub use binding::bind;
pub use csv::{
    ArrayColumn, ArrayFault, Limits, Table, TooLarge, Topic, Words, bad_cells, column_names,
    io_error_text, read, size, too_large,
};
pub use cubic::Cubic;
pub use dataset::{
    Column, ConstantValue, Dataset, HoldOut, HoldOutRange, Input, Origin, RateFault, RateMend,
    Samples, Trajectory, Window, hold_out, keep_window,
};
pub use delays::{InputValue, KnownDelay, with_acting_inputs, with_true_readings};
pub use derivatives::{difference_noise, is_smooth};
pub use intersample::fill_between;
pub use order_statistics::{MEDIAN_OF_ABS_NORMAL, median, median_step};
pub use sample_assembly::{Provenance, samples};
pub use segmentation::{Break, breaks};
pub use smoothing::{Smoothed, smooth};
pub use time_axis::{contiguous_ranges, gaps, snap_to_even_grid};

/// Every number that decides in this crate, by family.
pub fn thresholds() -> Vec<sidc_thresholds::Table> {
    vec![
        time_axis::thresholds::TimeAxisThresholds::table(),
        even_clock::ClockThresholds::table(),
        intersample::IntersampleThresholds::table(),
        checks::thresholds::RecordChecks::table(),
        checks::thresholds::TimeChecks::table(),
        rate_columns::thresholds::RateColumnThresholds::table(),
        rate_columns::thresholds::RateFilterThresholds::table(),
        delays::DelayThresholds::table(),
        derivatives::thresholds::BandwidthSelection::table(),
        derivatives::thresholds::NoiseEstimation::table(),
        derivatives::thresholds::QuantizationThresholds::table(),
        sample_assembly::thresholds::SamplingThresholds::table(),
        smoothing::thresholds::SmoothingThresholds::table(),
        smoothing::thresholds::SmoothingSearch::table(),
        smoothing::thresholds::OutlierThresholds::table(),
        draft::thresholds::DraftThresholds::table(),
        draft::thresholds::RateThresholds::table(),
        draft::thresholds::LawOrderThresholds::table(),
        draft::thresholds::ExogeneityThresholds::table(),
    ]
}
