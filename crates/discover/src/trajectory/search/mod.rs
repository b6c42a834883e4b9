//! Which terms: supports are proposed on linearised likelihoods and accepted where the refitted likelihood improves.
//!
//! In: a problem. Out: [`Found`]: the best fit and its rivals. Constraints of the system hold in every
//! support that is proposed. Never doubts an answer.

mod beam_search;
mod constant_profile;
mod constant_rivals;
mod constrained_supports;
mod disturbed_search;
mod error_correlations;
mod flights;
mod jump_constants;
mod least_squares_of_constants;
mod noise_floor_search;
mod omitted_terms;
mod search_from_fit;
mod search_observer;
mod support_search;
mod unidentifiable_directions;
mod unknown_constants;

#[cfg(test)]
pub(crate) use beam_search::best_subsets;
pub use constant_rivals::{Answer, laws_with_constants};
pub(crate) use constrained_supports::{ConstrainedForm, minimum};
pub use disturbed_search::search_disturbed;
pub use error_correlations::error_correlations;
pub use flights::{fit_constants_of_jumps, with_flown_states};
pub use jump_constants::with_constants_of_jumps;
pub use omitted_terms::{BetterLaws, LawChange, search_beyond_libraries};
pub use search_from_fit::search_from_fit;
pub use search_observer::SearchObserver;
pub use support_search::{Found, Rival, StartingSupport, search, value_by_innovations};
pub(crate) use support_search::{final_criterion, initial_fit, last_criterion};
pub use unidentifiable_directions::{Parameter, unidentifiable_directions};
pub use unknown_constants::{
    FittedConstants, SoughtConstant, fit_constants, fit_constants_by_levels, fit_constants_from,
    value_from, with_constant_values,
};
