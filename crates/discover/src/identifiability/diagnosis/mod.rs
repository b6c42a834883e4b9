//! What follows from the figures: findings about the data, the library or the model, in words and with advice.
//!
//! In: a design and its relations. Out: findings. Changes nothing.

mod advice;
pub mod findings;
mod lacking_terms;
pub mod messages;
pub mod misspecification;
pub mod remedies;
pub mod series_of_law;
mod unexplained_motion;
mod unread_signals;

pub use unexplained_motion::leaves_motion;
