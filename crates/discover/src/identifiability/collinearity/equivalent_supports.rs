//! Other supports of the same size that fit as well as the one found.
//!
//! In: a design and its Gram matrix. Out: supports whose criterion ties with that of the support found. A breadth-first search exchanges
//! one term at a time, from every support it finds. Candidates are ranked by inner products, then fitted on the columns.

use std::collections::{BTreeSet, VecDeque};

use super::gram_matrix::GramMatrix;
use crate::identifiability::thresholds::EQUIVALENT_SUPPORTS;
use crate::scaled_design::ScaledDesign;
use crate::selection::thresholds::TERM_SELECTION;
use crate::uncertainty::term_identity::same_laws;
use sidc_lang::term::{Language, Term};
use sidc_solve::simd::dot;

/// A support, and the exchange of columns that led to it.
#[derive(Clone, Debug)]
pub struct EquivalentSupport {
    pub support: Vec<usize>,
    pub leaving: usize,
    pub entering: usize,
}

/// Supports one exchange away first, the best of each exchange first.
pub fn equivalent_supports(design: &ScaledDesign, gram: &GramMatrix) -> Vec<EquivalentSupport> {
    let own = sorted(design.support.clone());
    let constraints = design.model.constraints.iter();
    let mut tied = constraints.flat_map(|c| &c.coefficients).map(|c| c.target);
    // The constraints may forbid another support.
    let constrained = tied.any(|target| target == design.equation.target);
    if own.is_empty() || own.len() >= design.rows() || constrained {
        return Vec::new();
    }
    let terms = |support: &[usize]| -> Vec<Term> {
        support.iter().map(|p| design.term(*p).clone()).collect()
    };
    let found_terms = terms(&own);
    let rows = design.rows();
    let bound = design.noise.criterion(design.residual_square(&own), rows) + TERM_SELECTION.tie;
    let products = InnerProducts::new(design, gram);
    let mut seen = BTreeSet::from([own.clone()]);
    let mut found: Vec<EquivalentSupport> = Vec::new();
    let mut open = VecDeque::from([own]);
    while let Some(support) = open.pop_front() {
        for leaving in &support {
            let kept: Vec<usize> = support.iter().copied().filter(|p| p != leaving).collect();
            let mut tied: Vec<(f64, Vec<usize>, usize)> = Vec::new();
            for entering in products.replacements(design, &kept, *leaving, bound) {
                let next = sorted([kept.as_slice(), &[entering]].concat());
                if !seen.insert(next.clone()) {
                    continue;
                }
                let value = design.noise.criterion(design.residual_square(&next), rows);
                if value < bound && !same_laws(&found_terms, &terms(&next), design.model) {
                    tied.push((value, next, entering));
                }
            }
            tied.sort_by(|a, b| a.0.total_cmp(&b.0).then_with(|| a.1.cmp(&b.1)));
            for (_, support, entering) in tied {
                open.push_back(support.clone());
                found.push(EquivalentSupport {
                    support,
                    leaving: *leaving,
                    entering,
                });
                if found.len() >= EQUIVALENT_SUPPORTS.max_supports {
                    return found;
                }
            }
        }
    }
    found
}

/// Supports of the same size that tie in refits of the trajectory. Each entering column replaces the term it is most collinear with.
pub fn supports_tied_in_refits(design: &ScaledDesign, gram: &GramMatrix) -> Vec<EquivalentSupport> {
    let language = Language(design.model);
    let names: Vec<String> = design
        .columns
        .iter()
        .map(|c| language.term(&c.term))
        .collect();
    let column = |name: &String| names.iter().position(|n| n == name);
    let own = sorted(design.support.clone());
    let mut found: Vec<EquivalentSupport> = Vec::new();
    for tie in &design.evidence.ties {
        let Some(support) = tie.iter().map(column).collect::<Option<Vec<usize>>>() else {
            continue;
        };
        if support.len() != own.len() {
            continue;
        }
        let mut left: Vec<usize> = own
            .iter()
            .copied()
            .filter(|p| !support.contains(p))
            .collect();
        for entering in support.iter().filter(|p| !own.contains(p)) {
            let cosine = |p: &usize| gram.cosine(*p, *entering).abs();
            let most_collinear =
                (0..left.len()).max_by(|a, b| cosine(&left[*a]).total_cmp(&cosine(&left[*b])));
            let Some(at) = most_collinear else { continue };
            found.push(EquivalentSupport {
                support: sorted(support.clone()),
                leaving: left.swap_remove(at),
                entering: *entering,
            });
        }
    }
    found
}

fn sorted(mut support: Vec<usize>) -> Vec<usize> {
    support.sort_unstable();
    support
}

/// The Gram matrix, and the inner products of all columns with the target.
struct InnerProducts<'a> {
    gram: &'a GramMatrix,
    target: Vec<f64>,
    square: f64,
}

impl<'a> InnerProducts<'a> {
    fn new(design: &ScaledDesign, gram: &'a GramMatrix) -> Self {
        let target = &design.target;
        let product = |c: &crate::scaled_design::ScaledColumn| dot(&c.unit, target);
        InnerProducts {
            gram,
            target: design.columns.iter().map(product).collect(),
            square: dot(target, target),
        }
    }

    /// Columns that may replace `leaving` beside `kept`, best predicted fit first. Projects by the Cholesky factor of their cosines.
    fn replacements(
        &self,
        design: &ScaledDesign,
        kept: &[usize],
        leaving: usize,
        bound: f64,
    ) -> Vec<usize> {
        let mut lower: Vec<Vec<f64>> = Vec::new();
        let mut along: Vec<f64> = Vec::new();
        let forward_substitution = |lower: &[Vec<f64>], j: usize| -> Vec<f64> {
            let mut row: Vec<f64> = Vec::with_capacity(lower.len());
            for (l, p) in lower.iter().zip(kept) {
                let known: f64 = dot(l, &row);
                row.push((self.gram.cosine(*p, j) - known) / l.last().copied().unwrap_or(1.0));
            }
            row
        };
        for p in kept {
            let row = forward_substitution(&lower, *p);
            let pivot = (1.0 - dot(&row, &row)).max(f64::EPSILON).sqrt();
            along.push((self.target[*p] - dot(&row, &along)) / pivot);
            lower.push([row, vec![pivot]].concat());
        }
        let left = self.square - dot(&along, &along);
        let mut ranked: Vec<(f64, usize)> = Vec::new();
        for j in (0..self.gram.len()).filter(|j| *j != leaving && !kept.contains(j)) {
            let row = forward_substitution(&lower, j);
            let room = 1.0 - dot(&row, &row);
            if room < EQUIVALENT_SUPPORTS.rounding {
                continue;
            }
            let gain = (self.target[j] - dot(&row, &along)).powi(2) / room;
            let rss = (left - gain - EQUIVALENT_SUPPORTS.rounding * self.square / room).max(0.0);
            if design.noise.criterion(rss, design.rows()) < bound {
                ranked.push((left - gain, j));
            }
        }
        ranked.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let best = ranked.into_iter().take(EQUIVALENT_SUPPORTS.fits);
        best.map(|(_, j)| j).collect()
    }
}
