//! The sentences of a verification.
//!
//! In: figures and names. Out: text for the user.

use sidc_lang::term::{Language, Term};
use sidc_system::discovery::{Discovery, Evidence, Proof, RowOrigin, VerifiedProof};

pub fn name(names: &Discovery, term: &Term) -> String {
    Language(names).term(term)
}

/// Two digits.
fn short(x: f64) -> String {
    format!("{x:.1e}")
}

pub fn no_rows(e: &Evidence) -> String {
    match e.origin {
        RowOrigin::Integrals { .. } => {
            "anything, since its rows are integrals of the weak form, which are not computed a second time".into()
        }
        RowOrigin::Samples | RowOrigin::AllSamples { .. } => {
            "anything, since the rows it was found from were not kept".into()
        }
    }
}

pub fn likelihood() -> String {
    "that no other trajectory and terms are more likely, of which there is no proof".into()
}

pub fn along(target: &str, off: f64) -> String {
    format!(
        "along the trajectory the equation misses {target} by {} of its largest part",
        short(off)
    )
}

pub fn channel(signal: &str, left: f64, stated: f64) -> String {
    format!("the trajectory leaves {left:.6e} of the readings of {signal}, {stated:.6e} is stated")
}

pub fn no_channel(signal: &str) -> String {
    format!("the readings of {signal}: the trajectory does not have it")
}

pub fn rows_missing() -> String {
    "the rows it was found from are not among the samples, or lack their weights".into()
}

pub fn candidates(has: usize, stated: usize) -> String {
    format!("the library has {has} candidate terms, {stated} are stated")
}

pub fn columns(seen: usize, all: usize) -> String {
    format!("{seen} columns were evaluated, the library has {all} terms")
}

pub fn rows(has: usize, stated: usize) -> String {
    format!("there are {has} rows, {stated} are stated")
}

pub fn no_candidate(names: &Discovery, term: &Term) -> String {
    format!("{} is not among the candidate terms", name(names, term))
}

pub fn no_value(names: &Discovery, found: &[(&Term, f64)]) -> String {
    let terms: Vec<String> = found.iter().map(|(t, _)| name(names, t)).collect();
    format!(
        "one of {} has no finite value, or none that can be bounded, on these rows",
        terms.join(", ")
    )
}

pub fn unknown(term: &str) -> String {
    format!("{term} has no finite value, or none that can be bounded, on these rows")
}

pub fn residual(found: f64, stated: f64) -> String {
    format!(
        "the equation leaves {} of the target, {} is stated",
        short(found),
        short(stated)
    )
}

pub fn dependent(rank: usize, of: usize) -> String {
    format!(
        "the columns of its terms depend on each other (rank {rank} of {of}): their coefficients are not determined"
    )
}

pub fn coefficient(term: &str, is: f64, should: f64) -> String {
    format!("the coefficient of {term} is {is}, least squares on these rows give {should}")
}

pub fn constrained() -> String {
    "its proof, which is that of all tied equations under their constraints together".into()
}

pub fn nothing_proved() -> String {
    "a proof, since there is none".into()
}

pub fn chosen(searched: usize) -> String {
    format!(
        "that no other choice among the {searched} terms searched is better by the criterion, of which there is no proof"
    )
}

pub fn no_dual() -> String {
    "a proof is stated, but there is no dual point".into()
}

pub fn correlation(found: &VerifiedProof, claimed: &Proof, term: &str) -> String {
    format!(
        "max |φᵀλ| is {:.6} (at {term}), {:.6} is stated",
        found.max_correlation, claimed.max_correlation
    )
}

pub fn outside(found: f64, allowed: f64) -> String {
    format!(
        "what is proved leaves {} of the target, more than its tolerance of {}",
        short(found),
        short(allowed)
    )
}

pub fn gap(found: f64, allowed: f64) -> String {
    format!(
        "the dual point bounds the 1-norm only to within {} of it, {} is request: that none is smaller is not shown",
        short(found),
        short(allowed)
    )
}

pub fn not_unique(found: &VerifiedProof, term: &str) -> String {
    format!(
        "that no other has the same 1-norm is not shown: |φᵀλ| reaches {:.9} at {term}, off the support, with a gap of {}",
        1.0 - found.margin,
        short(found.gap)
    )
}
