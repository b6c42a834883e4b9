//! Which terms: best-subset selection by an information criterion, and the screening of libraries too large for it.
//!
//! In: columns and a target. Out: supports, best first. Never knows what the columns mean.

pub(crate) mod best_subset;
pub(crate) mod information_criterion;
pub(crate) mod qr_reduction;
pub(crate) mod screening;
pub(crate) mod subset_search;
pub(crate) mod term_selection;
pub(crate) mod thresholds;
