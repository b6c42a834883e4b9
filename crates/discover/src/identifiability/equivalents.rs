//! Other supports of the same size that fit as well as the one found.
//!
//! In: a frame and its cosines. Out: supports whose criterion is within [`TIE`] of the best, found by exchanging one term after
//! another, again from every one that is found. Candidates are priced on cosines, and fitted on the columns before they count.

use std::collections::{BTreeSet, VecDeque};

use super::gram::Gram;
use crate::frame::Frame;
use sidc_lang::term::Language;
use sidc_solve::simd::dot;

/// Difference of the criterion under which two supports of equal size are a tie (as the choice of the support has it).
const TIE: f64 = 6.0;
/// Supports after which it is enough.
const ENOUGH: usize = 60;
/// Fits tried for each term taken out.
const FITS: usize = 12;
/// Digits of squared lengths that products of columns keep.
const DIGITS: f64 = 1e-12;

/// A support, and the exchange that led to it from the one found: what went, what came.
#[derive(Clone, Debug)]
pub(super) struct Equivalent {
    pub places: Vec<usize>,
    pub out: usize,
    pub into: usize,
}

/// Best fits first among those one exchange away; then those further away.
pub(super) fn equivalents(frame: &Frame, gram: &Gram) -> Vec<Equivalent> {
    let own = sorted(frame.support.clone());
    let constraints = frame.model.constraints.iter();
    let mut tied = constraints.flat_map(|c| &c.coefficients).map(|c| c.target);
    // What fits as well may not be allowed.
    let constrained = tied.any(|target| target == frame.equation.target);
    if own.is_empty() || own.len() >= frame.rows() || constrained {
        return Vec::new();
    }
    let rows = frame.rows();
    let bound = frame.noise.value(frame.left(&own), rows) + TIE;
    let products = Products::new(frame, gram);
    let mut seen = BTreeSet::from([own.clone()]);
    let mut found: Vec<Equivalent> = Vec::new();
    let mut open = VecDeque::from([own]);
    while let Some(support) = open.pop_front() {
        for out in &support {
            let kept: Vec<usize> = support.iter().copied().filter(|p| p != out).collect();
            let mut near: Vec<(f64, Vec<usize>, usize)> = Vec::new();
            for into in products.near(frame, &kept, *out, bound) {
                let next = sorted([kept.as_slice(), &[into]].concat());
                if !seen.insert(next.clone()) {
                    continue;
                }
                let value = frame.noise.value(frame.left(&next), rows);
                if value < bound {
                    near.push((value, next, into));
                }
            }
            near.sort_by(|a, b| a.0.total_cmp(&b.0).then_with(|| a.1.cmp(&b.1)));
            for (_, places, into) in near {
                open.push_back(places.clone());
                found.push(Equivalent {
                    places,
                    out: *out,
                    into,
                });
                if found.len() >= ENOUGH {
                    return found;
                }
            }
        }
    }
    found
}

/// Supports that refits with the trajectory found to be ties, of the same size: each exchange of one term, the most alike first.
pub(super) fn refitted(frame: &Frame, gram: &Gram) -> Vec<Equivalent> {
    let language = Language(frame.model);
    let names: Vec<String> = frame
        .columns
        .iter()
        .map(|c| language.term(&c.term))
        .collect();
    let place = |name: &String| names.iter().position(|n| n == name);
    let own = sorted(frame.support.clone());
    let mut found: Vec<Equivalent> = Vec::new();
    for tie in &frame.evidence.ties {
        let Some(places) = tie.iter().map(place).collect::<Option<Vec<usize>>>() else {
            continue;
        };
        if places.len() != own.len() {
            continue;
        }
        let mut gone: Vec<usize> = own
            .iter()
            .copied()
            .filter(|p| !places.contains(p))
            .collect();
        for into in places.iter().filter(|p| !own.contains(p)) {
            let alike = |p: &usize| gram.at(*p, *into).abs();
            let nearest =
                (0..gone.len()).max_by(|a, b| alike(&gone[*a]).total_cmp(&alike(&gone[*b])));
            let Some(at) = nearest else { continue };
            found.push(Equivalent {
                places: sorted(places.clone()),
                out: gone.swap_remove(at),
                into: *into,
            });
        }
    }
    found
}

fn sorted(mut places: Vec<usize>) -> Vec<usize> {
    places.sort_unstable();
    places
}

/// Cosines, and the products of all columns with the target.
struct Products<'a> {
    gram: &'a Gram,
    target: Vec<f64>,
    square: f64,
}

impl<'a> Products<'a> {
    fn new(frame: &Frame, gram: &'a Gram) -> Self {
        let target = &frame.target;
        let with = |c: &crate::frame::Column| dot(&c.unit, target);
        Products {
            gram,
            target: frame.columns.iter().map(with).collect(),
            square: dot(target, target),
        }
    }

    /// Columns that may stand for `out` beside `kept`, most promising first.
    fn near(&self, frame: &Frame, kept: &[usize], out: usize, bound: f64) -> Vec<usize> {
        let mut lower: Vec<Vec<f64>> = Vec::new();
        let mut along: Vec<f64> = Vec::new();
        let forward = |lower: &[Vec<f64>], j: usize| -> Vec<f64> {
            let mut row: Vec<f64> = Vec::with_capacity(lower.len());
            for (l, p) in lower.iter().zip(kept) {
                let known: f64 = dot(l, &row);
                row.push((self.gram.at(*p, j) - known) / l.last().copied().unwrap_or(1.0));
            }
            row
        };
        for p in kept {
            let row = forward(&lower, *p);
            let pivot = (1.0 - dot(&row, &row)).max(f64::EPSILON).sqrt();
            along.push((self.target[*p] - dot(&row, &along)) / pivot);
            lower.push([row, vec![pivot]].concat());
        }
        let left = self.square - dot(&along, &along);
        let mut near: Vec<(f64, usize)> = Vec::new();
        for j in (0..self.gram.len()).filter(|j| *j != out && !kept.contains(j)) {
            let row = forward(&lower, j);
            let room = 1.0 - dot(&row, &row);
            if room < DIGITS {
                continue;
            }
            let gain = (self.target[j] - dot(&row, &along)).powi(2) / room;
            let rss = (left - gain - DIGITS * self.square / room).max(0.0);
            if frame.noise.value(rss, frame.rows()) < bound {
                near.push((left - gain, j));
            }
        }
        near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        near.into_iter().take(FITS).map(|(_, j)| j).collect()
    }
}
