//! The relations between the columns of a library and between its signals, each with its cause.
//!
//! In: a design, its Gram matrix, its library, equivalent supports. Out: relations, the most relevant first. Judges no equation.

use std::collections::BTreeMap;

use super::causes::{cause, is_bare};
use super::equivalent_supports::EquivalentSupport;
use super::gram_matrix::GramMatrix;
use super::null_vectors::{NullVector, NullVectorSearch};
use super::relation::{ExplainedRelation, ReducedRelation};
use super::signal_relations::signal_relations;
use crate::identifiability::thresholds::{COLLINEARITY, NULL_VECTORS};
use crate::scaled_design::ScaledDesign;
use sidc_lang::library::Library;
use sidc_lang::term::{Language, Term};

/// All relations with their causes, every set of terms once, those that allow an exchange first.
pub fn explained_relations(
    design: &ScaledDesign,
    gram: &GramMatrix,
    library: &Library,
    equivalent: &[EquivalentSupport],
) -> Vec<ExplainedRelation> {
    let search = NullVectorSearch {
        gram,
        columns: design.columns.iter().map(|c| &c.unit[..]).collect(),
        max_residuals: NULL_VECTORS.term_residuals,
    };
    let mut all = signal_relations(design, library);
    for e in equivalent {
        if let Some(null) = exchange_relation(design, &search, e) {
            let mut relation = explain(design, &null);
            let terms = (design.term(e.leaving), design.term(e.entering));
            relation.exchange = Some((terms.0.clone(), terms.1.clone()));
            all.push(relation);
        }
    }
    let found = search.around(&seeds(design));
    all.extend(found.iter().map(|null| explain(design, null)));
    let mut kept: Vec<ExplainedRelation> = Vec::new();
    let mut met: BTreeMap<String, usize> = BTreeMap::new();
    for t in all {
        let mut names: Vec<String> = (t.reduced.terms.iter())
            .map(|(_, t)| Language(design.model).term(t))
            .collect();
        names.sort();
        let key = names.join(", ");
        let same = met.get(&key).and_then(|at| kept.get_mut(*at));
        match same {
            Some(first) => {
                first.exchange = first.exchange.take().or(t.exchange);
                for term in t.support_terms {
                    if !first.support_terms.contains(&term) {
                        first.support_terms.push(term);
                    }
                }
            }
            None => {
                met.insert(key, kept.len());
                kept.push(t);
            }
        }
    }
    kept.sort_by_key(|t| {
        let unrelated = t.support_terms.is_empty() && !t.involves_support;
        (t.exchange.is_none(), unrelated)
    });
    kept
}

/// The relation behind an exchange: between the two terms if they are collinear, else between the support and the entering term.
/// `None` if noise alone makes both supports fit equally badly.
fn exchange_relation(
    design: &ScaledDesign,
    search: &NullVectorSearch,
    e: &EquivalentSupport,
) -> Option<NullVector> {
    if !design.support.contains(&e.leaving) || design.support.contains(&e.entering) {
        return None;
    }
    let pair = search.null_vector(&[e.leaving, e.entering])?;
    if pair.residual < COLLINEARITY.exchange {
        return Some(pair);
    }
    let together = [design.support.as_slice(), &[e.entering]].concat();
    search.null_vector(&together).filter(|n| {
        let has = |p: &usize| n.indices.contains(p);
        n.residual < COLLINEARITY.exchange && has(&e.leaving) && has(&e.entering)
    })
}

/// Columns around which relations are searched: the support, then single signals and the constant.
fn seeds(design: &ScaledDesign) -> Vec<usize> {
    let mut seeds = design.support.clone();
    let bare = |t: &Term| t.is_one() || is_bare(t);
    let columns = 0..design.columns.len();
    let more = columns.filter(|p| bare(design.term(*p)) && !design.support.contains(p));
    seeds.extend(more.take(COLLINEARITY.seeds));
    seeds
}

fn explain(design: &ScaledDesign, null: &NullVector) -> ExplainedRelation {
    let reduced = ReducedRelation::new(design, null);
    let found = null.indices.iter().filter(|p| design.support.contains(p));
    let support_terms: Vec<Term> = found.map(|p| design.term(*p).clone()).collect();
    ExplainedRelation {
        why: cause(design, &reduced),
        exchange: None,
        involves_support: !support_terms.is_empty(),
        support_terms,
        reduced,
    }
}
