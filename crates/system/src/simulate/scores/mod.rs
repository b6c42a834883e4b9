//! How well a run follows its record.

pub(crate) mod document;
pub(crate) mod goodness_of_fit;
