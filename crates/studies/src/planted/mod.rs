//! Records that cannot say what is asked of them: the cases, and what the program says of each.

pub mod cases;
pub mod run;
