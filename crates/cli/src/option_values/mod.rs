//! How the values of options are written on the command line.

pub mod assignments;
pub mod limits;
pub mod names;
pub mod operating_point;
pub mod quantities;
pub mod time_ranges;
