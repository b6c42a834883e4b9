//! A discovery as text, LaTeX, code and a report. [`TARGETS`] lists what it can be exported to; a new target is a file in `targets/`.
//!
//! Emitters see only the [`Discovery`](sidc_system::discovery::Discovery). Parentheses are placed by the printer of terms in `sidc_lang`,
//! in code by `code::infix`.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

mod caveats;
mod code;
mod derived_forms;
pub mod report;
mod target;
mod targets;
mod text;
mod thresholds;
mod typeset;
mod unknown_constants;

pub use caveats::doubted;
pub use target::{Target, Written};
pub use targets::{TARGETS, target};
pub use text::answer::answer;
pub use text::coefficient_inference::without;
pub use text::equations::equations;
pub use text::evidence::evidence;
pub use text::free_runs::validation;
pub use text::layout::{TEXT_WIDTH, wrapped};
pub use text::linearization::{kink_warnings, linearization};
pub use text::matrices::derived_forms;
pub use text::verdict::{Rival, rival, rival_advice, verdict};
pub use thresholds::tables as thresholds;
pub use typeset::mathml::{MathMl, escape};
pub use unknown_constants::constants_in;
