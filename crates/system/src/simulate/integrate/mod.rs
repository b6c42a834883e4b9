//! Numerical integration from row to row of a record.

pub(crate) mod continuous_time;
pub(crate) mod discrete_time;
pub(crate) mod event_crossing;
mod runge_kutta;
pub(crate) mod trajectory;
