//! A first model of a table: states with orders and angles, inputs, parameters, and a library to start from.
//!
//! In: a [`Table`]. Out: the text of a `.sid` file, whose comments say what was guessed and what to change. All guesses come
//! from headers and the shapes of columns; nothing is identified. Reads no file.
//!
//! Flow: `table_column` → `column_roles` (with `rate_detection`) → `states` (with `law_order`) → `candidate_terms` → `model_text`.

mod candidate_terms;
mod column_roles;
mod law_order;
mod model_text;
mod parts;
mod rate_detection;
mod states;
mod table_column;
pub(crate) mod thresholds;

use crate::csv::Table;
use column_roles::roles;
use model_text::model_text;
use parts::Parts;
use states::states;
use table_column::columns;

/// The text of a first model, not yet formatted; `None` if no column can be a state.
pub fn draft(table: &Table) -> Option<String> {
    let (all, left_out) = columns(table);
    let roles = roles(&all);
    let states = states(&all, &roles);
    if states.is_empty() {
        return None;
    }
    Some(model_text(&Parts {
        table: &table.name,
        all: &all,
        roles: &roles,
        states: &states,
        left_out: &left_out,
    }))
}
