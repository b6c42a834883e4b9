//! The stages from a model's text and tables to a verdict, one file per stage: `program` → `measure` → `identify` → `verification` → `judgement`.
//!
//! Each stage takes the result of the one before and adds its diagnostics; an observer follows the work. Nothing here reads files or prints.

mod constant_estimation;
mod delays;
mod document;
mod evidence;
mod files;
mod identify;
mod joint;
mod judgement;
mod measure;
mod missing_states;
mod noise;
mod program;
mod rates;
mod reduction;
mod regression;
mod second_method;
mod thresholds;
mod unevaluable;
mod verification;

pub use document::{ModelSource, settings, signal_entries, warnings};
pub use evidence::without_ranks;
pub use files::{Hashed, file_entry};
pub use identify::identify;
pub use judgement::{Judgement, check_limits, judge};
pub use measure::{Measured, from_tables, measure};
pub use noise::{NoiseFault, set_noise};
pub use program::{Program, Staged, compile, needed, vocabulary};
pub use reduction::{reduce, refit_all_rows};
pub use regression::Regression;
pub use sidc_lang::library::MEMORY;
pub(crate) use thresholds::BUDGET;
pub use thresholds::thresholds;
pub use verification::{verification_work, verify};
