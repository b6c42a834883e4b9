//! Least squares on long records: states are eliminated by an information filter, the rows that are left go into a [`RowSink`].
//!
//! In: process equations and measurements, sample after sample. Out: a small problem in the coefficients alone, as a QR factor, as
//! normal equations, or as a sketch. Numbers only: it knows neither laws nor sensors.

mod constrained_step;
mod count_sketch;
mod incremental_qr;
mod normal_equations;
mod square_root_information_filter;

pub(crate) use constrained_step::{constrained_covariances, constrained_step};
pub(crate) use count_sketch::CountSketch;
pub use count_sketch::SketchedProblem;
pub(crate) use incremental_qr::IncrementalQr;
pub(crate) use normal_equations::NormalEquations;
pub(crate) use square_root_information_filter::{
    EliminatedStates, FilterState, InformationFilter, Measurement, NoRows, ProcessEquation, RowSink,
};
