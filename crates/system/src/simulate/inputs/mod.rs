//! What drives a run: input signals between their samples, and where each comes from.

pub(crate) mod interpolation;
pub(crate) mod sources;
