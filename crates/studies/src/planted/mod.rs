//! Records that cannot answer the question asked of them: the cases, and what the program says of each.

pub mod cases;
pub mod run;
