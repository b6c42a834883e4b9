//! A first model of a table: states with orders and angles, inputs, parameters, and a library to start from.
//!
//! In: a [`Table`]. Out: the text of a `.sid` file, whose comments say what was guessed and what to change. All guesses come
//! from headers and the shapes of columns; nothing is identified. Reads no file.
//!
//! Flow: `table_column` → `column_roles` (with `rate_detection` and `exogeneity`) → `states` (with `law_order`) → `candidate_terms` → `model_text`.

mod candidate_terms;
mod column_roles;
mod exogeneity;
mod law_order;
mod model_text;
mod parts;
mod rate_detection;
mod states;
mod table_column;
pub(crate) mod thresholds;

use crate::csv::{Table, TooLarge};
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
    /// A log with more columns than fit into a table, and none was given a role.
    TooLarge(TooLarge),
}

/// The text of a first model, not yet formatted. Of a log, columns that were given roles leave out all others.
///
/// # Errors
/// No column can be a state, one that was given a role does not exist, or there are too many.
pub fn draft(table: &Table, chosen: &ChosenRoles) -> Result<String, NoDraft> {
    let asked = chosen.columns();
    let wanted = |header: &str| asked.is_empty() || asked.contains(&header);
    let table = &*table.of_columns(&wanted).map_err(NoDraft::TooLarge)?;
    let (all, mut left_out) = columns(table);
    if let Some(name) = chosen.unknown(&all) {
        let unread = table.known_headers().skip(table.headers().len());
        let headers = all.iter().map(|c| &c.header).chain(unread);
        return Err(NoDraft::NoColumn(
            name.to_owned(),
            headers.cloned().collect(),
        ));
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
