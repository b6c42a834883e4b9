//! Multiples of laws, as rows over the terms that they have.
//!
//! In: laws as sums of terms, the factors of the libraries. Out: the multipliers, and a matrix with one row a multiple and one column
//! a term. Never looks at data.

use std::collections::{BTreeMap, BTreeSet};

use crate::relations::thresholds::FEWER_TERMS;
use sidc_lang::term::Term;

/// Σ coefficient · term = 0.
pub(super) type Law = Vec<(f64, Term)>;

/// Rows over terms.
pub(super) struct Multiples {
    pub terms: Vec<Term>,
    pub rows: Vec<Vec<f64>>,
    /// By which laws were multiplied, each once, 1 first.
    pub multipliers: Vec<Term>,
    /// Whether a limit left multiples out.
    pub limited: bool,
}

/// The multiples of laws by 1, by what makes a term of one law a term of another, and by single factors of the libraries: those of lower
/// degree first, as many as the limits allow.
pub(super) fn multiples(laws: &[Law], factors: &BTreeSet<Term>) -> Multiples {
    let mut wanted: Vec<(Term, usize)> = Vec::new();
    for (k, law) in laws.iter().enumerate() {
        let meeting = meeting(law, laws);
        let all = factors.union(&meeting).filter(|m| !m.is_one());
        wanted.extend(all.map(|m| (m.clone(), k)));
    }
    let degree = |a: &(Term, usize), b: &(Term, usize)| {
        a.0.degree().total_cmp(&b.0.degree()).then_with(|| a.cmp(b))
    };
    wanted.sort_by(degree);
    let itself = (0..laws.len()).map(|k| (Term::one(), k));
    let wanted: Vec<(Term, usize)> = itself.chain(wanted).collect();
    let mut made = Multiples {
        terms: Vec::new(),
        rows: Vec::new(),
        multipliers: Vec::new(),
        limited: false,
    };
    let mut places: BTreeMap<Term, usize> = BTreeMap::new();
    let mut sums: Vec<Vec<(usize, f64)>> = Vec::new();
    for (m, k) in &wanted {
        let Some(law) = laws.get(*k) else { continue };
        let new = law
            .iter()
            .filter(|(_, t)| !places.contains_key(&t.mul(m)))
            .count();
        if sums.len() >= FEWER_TERMS.multiples || places.len() + new > FEWER_TERMS.terms {
            made.limited = true;
            break;
        }
        let row = law.iter().map(|(a, t)| {
            let next = places.len();
            (*places.entry(t.mul(m)).or_insert(next), *a)
        });
        sums.push(row.collect());
        if !made.multipliers.contains(m) {
            made.multipliers.push(m.clone());
        }
    }
    made.rows = sums.iter().map(|sum| dense(sum, places.len())).collect();
    let mut terms: Vec<(Term, usize)> = places.into_iter().collect();
    terms.sort_by_key(|(_, place)| *place);
    made.terms = terms.into_iter().map(|(t, _)| t).collect();
    made
}

fn dense(sum: &[(usize, f64)], columns: usize) -> Vec<f64> {
    let mut row = vec![0.0; columns];
    for (place, a) in sum {
        if let Some(x) = row.get_mut(*place) {
            *x += a;
        }
    }
    row
}

/// What makes a term of `law` a term of one of `laws`: products of whole powers up to the degree of the limits.
fn meeting(law: &Law, laws: &[Law]) -> BTreeSet<Term> {
    let theirs = laws.iter().flatten();
    let quotients =
        theirs.flat_map(|(_, wanted)| law.iter().map(|(_, own)| wanted.mul(&own.pow(-1.0))));
    let whole = |m: &Term| m.factors().all(|(_, p)| p > 0.0) && m.degree() <= FEWER_TERMS.degree;
    quotients.filter(whole).collect()
}
