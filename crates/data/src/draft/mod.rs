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

pub use column_roles::ChosenRoles;

/// Why there is no first model.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NoDraft {
    /// No column can be a state.
    NoState,
    /// No column has a name that was given a role; with the headers that there are.
    NoColumn(String, Vec<String>),
}

/// The text of a first model, not yet formatted.
///
/// # Errors
/// No column can be a state, or one that was given a role does not exist.
pub fn draft(table: &Table, chosen: &ChosenRoles) -> Result<String, NoDraft> {
    let (all, mut left_out) = columns(table);
    if let Some(name) = chosen.unknown(&all) {
        let headers = all.iter().map(|c| c.header.clone()).collect();
        return Err(NoDraft::NoColumn(name.to_owned(), headers));
    }
    let roles = roles(&all, chosen);
    let words = all
        .iter()
        .enumerate()
        .filter(|(i, c)| c.words && roles.run != Some(*i));
    left_out.extend(words.map(|(_, c)| format!("column \"{}\" holds words", c.header)));
    let states = states(&all, &roles);
    if states.is_empty() {
        return Err(NoDraft::NoState);
    }
    Ok(model_text(&Parts {
        table: &table.name,
        all: &all,
        roles: &roles,
        states: &states,
        left_out: &left_out,
    }))
}
