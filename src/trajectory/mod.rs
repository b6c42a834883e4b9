//! Trajectory and equations estimated together from noisy measurements of some states.
//!
//! In: a checked model, its libraries, a dataset. Out: the support and coefficients of the largest penalised likelihood, with
//! the trajectory, the noise of every channel, standard errors and rivals. Nothing is differentiated: laws are followed from
//! sample to sample, and compared with what was read, where it was read.
//!
//! The picture: [`System`] (what moves) + [`Record`]s (what was read) → [`Problem`] → `search` proposes supports on linearised
//! likelihoods (`quadratic`, `beam`), `fit` decides on refitted ones; `flow` leads from sample to sample, `sweep` eliminates the
//! states, `errors` says how far the coefficients can be trusted. Never knows whether an answer is trusted, and prints nothing.

mod beam;
mod chain;
mod channel;
mod code;
mod columns;
mod delay;
mod dense;
mod errors;
mod first;
mod fit;
mod flow;
mod guide;
mod lattice;
mod moments;
mod offset;
mod pair;
mod pieces;
mod problem;
mod record;
mod screen;
mod search;
mod sensors;
mod sketch;
mod smooth;
mod strays;
mod stretch;
mod sweep;
mod system;
mod transition;
mod triangle;
mod values;
mod worth;

#[cfg(test)]
mod tests;

pub use channel::{Channel, File, channels};
pub use delay::{Late, delay, delayed, undelayed};
pub use fit::{Fit, price};
pub use guide::Guide;
pub use offset::{Offset, offset};
pub use pieces::{Pieces, pieces};
pub use problem::Problem;
pub use record::Record;
pub use screen::{Proposal, proposals};
pub use search::{Found, search};
pub use sensors::Sensors;
pub use sketch::Sketched;
pub use strays::{LeftOut, Strays, leave_out};
pub use system::{Law, NoSystem, System};
