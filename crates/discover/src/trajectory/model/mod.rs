//! What is estimated from what: the system of laws, the records of readings, the sensors, and where estimation starts.
//!
//! In: a checked model, its libraries, a dataset. Out: a [`Problem`], which stays the same while supports are tried.

mod autocorrelated_noise;
mod coefficient_constraints;
mod constant_values;
mod delayed_records;
mod disturbance_states;
mod estimation_problem;
mod extra_columns;
mod growth;
mod held_sample;
mod hidden_states;
mod impulses;
mod jump_rows;
mod noise_growth;
mod noisy_inputs;
mod observed_part;
mod process_noise;
mod quantization;
mod record;
mod rejected_readings;
mod resting;
mod run_columns;
mod sensor_groups;
mod smoothing;
mod split_by_run;
mod subsampling;
mod system;
pub(crate) mod thresholds;

pub use coefficient_constraints::CoefficientConstraints;
pub use delayed_records::AppliedDelay;
pub(crate) use estimation_problem::LinearizationPoint;
pub use estimation_problem::Problem;
pub(crate) use extra_columns::ExtendedProblem;
pub(crate) use hidden_states::HiddenCourse;
pub(crate) use impulses::{impulse_of, impulses_of};
pub(crate) use observed_part::ObservedPart;
pub use process_noise::{Disturbance, ProcessNoise};
pub use record::{Exogenous, Record};
pub use rejected_readings::LeftOut;
pub use resting::Rest;
pub use run_columns::{RunColumn, RunColumns};
pub use sensor_groups::SensorGroups;
pub(crate) use smoothing::{SmoothedTrajectory, gradient};
pub(crate) use split_by_run::indicator;
pub(crate) use subsampling::segments;
pub(crate) use system::ImpulseSource;
pub use system::{Law, System};
