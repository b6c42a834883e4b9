//! What the data can distinguish, equation by equation: rank, collinearity, equivalent supports, excitation, and what to record next.
//!
//! In: the [`crate::scaled_design::ScaledDesign`] of an equation, its library, the rows. Out: an [`sidc_system::discovery::Identifiability`] for its
//! evidence, and the doubt `tie` if another support of equal size fits as well. Never changes an equation, never reads or prints.

mod assessment;
mod collinearity;
mod diagnosis;
mod excitation;
mod periodogram;
pub(crate) mod thresholds;

pub use assessment::{Assessment, Rows, assess, attach, misspecification, needs_measured_targets};
pub use diagnosis::leaves_motion;
pub use diagnosis::remedies::{advise, remedy};
