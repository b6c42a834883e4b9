//! An equation and its proof checked a second time, by other code and in 106 bits.
//!
//! In: an equation with its [`Witness`](sidc_system::discovery::Witness), its library, the samples. Out: a
//! [`Verification`](sidc_system::discovery::Verification): figures with bounds on all rounding, claims that do not hold, and claims
//! that were not checked. Every term is evaluated afresh from the signals, which count as exact, and every sum is made anew. Shares no
//! code with solvers, certificates and dictionaries. Never changes an equation.

mod ball;
mod certificate_check;
mod double_double;
mod elementary_functions;
mod equation_check;
mod messages;
mod normal_equations;
mod pricing;
mod term_evaluation;
pub(crate) mod thresholds;
mod tolerance;
mod trajectory_check;
mod verification;
mod weighted_sums;

pub use equation_check::Case;
pub use verification::{verify, work};
