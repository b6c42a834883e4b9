//! The initial state of a run: what was measured there, and its least-squares estimate where sensors are noisy.

pub(crate) mod candidates;
pub(crate) mod least_squares;
