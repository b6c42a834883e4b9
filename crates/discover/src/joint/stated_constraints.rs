//! The constraints of a model over the columns of the system that is estimated.
//!
//! In: a model, its libraries, screened pools, the system. Out: pools with every term that a constraint names; rows over columns. Never
//! sees data.

use crate::constrained::constraint_rows::{ConstraintRow, constraint_rows};
use crate::selection::screening::{CandidatePools, offer};
use crate::trajectory::{CoefficientConstraints, System};
use sidc_lang::library::Library;
use sidc_lang::model::Model;
use sidc_solve::LinearConstraint;

/// Adds to screened pools the terms that are required or that constraints name: one left out would silently have the coefficient zero.
pub(crate) fn with_named_terms(
    mut pools: CandidatePools,
    model: &Model,
    libraries: &[Option<Library>],
) -> CandidatePools {
    for tied in constraint_rows(model, libraries) {
        for (place, slot, _) in tied.row.entries {
            offer(&mut pools, place, slot);
        }
    }
    for (place, library) in libraries.iter().enumerate() {
        for slot in library.iter().flat_map(Library::required) {
            offer(&mut pools, place, *slot);
        }
    }
    pools
}

/// The constraints that restrict unknown coefficients, over the columns of the system.
pub(crate) fn coefficient_constraints(
    model: &Model,
    libraries: &[Option<Library>],
    system: &System,
) -> CoefficientConstraints {
    let column = |place: usize, slot: usize| {
        let law = system.laws.iter().find(|l| l.equation == place)?;
        let at = law.slots.iter().position(|s| *s == slot)?;
        Some(law.columns.start + at)
    };
    let tied = constraint_rows(model, libraries);
    let row = |t: &ConstraintRow| {
        let entries = t.row.entries.iter();
        let entries = entries.filter_map(|(place, slot, w)| Some((0, column(*place, *slot)?, *w)));
        LinearConstraint {
            entries: entries.collect(),
            ..t.row.clone()
        }
    };
    let statement = |t: &ConstraintRow| {
        let all = model.constraints.iter();
        let mut same = all
            .enumerate()
            .filter(|(_, c)| std::ptr::eq(*c, t.constraint));
        same.next().map_or(0, |(k, _)| k)
    };
    let (each, column_of) = (libraries.iter().enumerate(), &column);
    let required = each.flat_map(|(place, library)| {
        let slots = library.iter().flat_map(Library::required);
        slots.filter_map(move |slot| column_of(place, *slot))
    });
    CoefficientConstraints {
        rows: tied.iter().map(row).collect(),
        stated: tied.iter().map(statement).collect(),
        required: required.collect(),
    }
}
