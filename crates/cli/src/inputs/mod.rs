//! Input files: models, data, results.

pub mod files;
pub mod result_and_records;
pub mod tables;
pub mod texts;
