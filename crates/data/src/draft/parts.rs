//! What a first model is made of.
//!
//! In: columns, their roles, states. Out: all of them together. Guesses nothing.

use super::column_roles::Roles;
use super::states::State;
use super::table_column::Column;

/// Everything that was guessed, of which the text is made.
pub(super) struct Parts<'a> {
    pub table: &'a str,
    pub all: &'a [Column],
    pub roles: &'a Roles,
    pub states: &'a [State<'a>],
    pub left_out: &'a [String],
}

impl Parts<'_> {
    /// Laws from sample to sample, for want of a time.
    pub fn is_discrete(&self) -> bool {
        self.roles.time.is_none()
    }
}
