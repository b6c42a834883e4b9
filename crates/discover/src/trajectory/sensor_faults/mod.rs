//! What sensors may have done instead of the laws: inputs recorded early or late, and readings with a constant offset.
//!
//! In: a problem and a fit. Out: the fault under which the refitted likelihood gains more than a term costs. Takes no decision on
//! the answer.

mod declared_delays;
mod delay_screening;
mod input_delay;
mod input_interpolation;
mod input_lag;
mod sensor_offset;
mod time_shift;

pub use declared_delays::{DelayEstimate, profile_delays, screen_ranges};
pub use delay_screening::{DelayProposal, screen_delays};
pub use input_delay::{DelayedInputs, criterion_without_delay, fit_delay, is_held, with_delay};
pub use input_interpolation::CubicInputs;
pub use input_lag::{InputLag, find_lag};
pub use sensor_offset::{SensorOffset, find_sensor_offset};
pub(crate) use time_shift::step as sampling_interval;
