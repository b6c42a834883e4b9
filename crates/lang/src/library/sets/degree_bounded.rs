//! Graded products: products of lists with the total degree in a range, as a union of plain products.
//!
//! In: coprime lists whose entries have degrees, and a range for the total. Out: products of plain lists, no term twice. Partial
//! products beyond the range are never made. Their number comes from the degree histograms (coefficients of the Hilbert series).

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use crate::library::sets::term_list::{LimitExceeded, TermList};
use crate::term::Term;
use crate::thresholds::LIBRARY;

/// Terms with their degrees, in ascending order of degree.
#[derive(Clone, Debug)]
pub(crate) struct GradedList(Vec<(u64, Term)>);

/// A range of total degrees in millionths, ends included.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Degrees {
    pub from: u64,
    pub to: u64,
}

/// Number of products for each total degree.
type Histogram = BTreeMap<u64, u128>;

/// Degrees are integers in millionths, so that sums of fractions such as 0.1 and 0.2 are exact.
const MILLIONTHS: f64 = 1e6;
/// Rounding error that a sum of many fractions such as 1/3 may reach, in millionths.
const ROUNDING_SLACK: u64 = 100;

/// The degree of a term in millionths. It adds up over products of coprime terms.
pub(crate) fn grade(term: &Term) -> u64 {
    in_millionths(term.degree())
}

fn in_millionths(degree: f64) -> u64 {
    (degree * MILLIONTHS).round() as u64
}

impl Degrees {
    pub fn up_to(bound: f64) -> Degrees {
        Degrees {
            from: 0,
            to: in_millionths(bound).saturating_add(ROUNDING_SLACK),
        }
    }

    pub fn has(self, degree: u64) -> bool {
        (self.from..=self.to).contains(&degree)
    }
}

impl GradedList {
    pub fn new(mut entries: Vec<(u64, Term)>) -> GradedList {
        entries.sort_by_key(|e| e.0);
        GradedList(entries)
    }

    /// A list by the degrees of its terms.
    pub fn of(list: &TermList) -> GradedList {
        let terms = list.terms().iter();
        GradedList::new(terms.map(|t| (grade(t), t.clone())).collect())
    }

    fn ends(&self) -> (u64, u64) {
        let end = |entry: Option<&(u64, Term)>| entry.map_or(0, |e| e.0);
        (end(self.0.first()), end(self.0.last()))
    }

    fn list(&self) -> Arc<TermList> {
        TermList::new(self.0.iter().map(|(_, t)| t.clone()).collect())
    }
}

/// Every product of one entry of each list with its total degree in `range`, as disjoint products. The lists must be coprime.
///
/// # Errors
/// Too many products.
pub(crate) fn bounded_products(
    lists: &[GradedList],
    range: Degrees,
) -> Result<Vec<Vec<Arc<TermList>>>, LimitExceeded> {
    let all = within(&degree_histogram(lists, range.to)?, range);
    let most = LIBRARY.small_set.max(4 * (all as f64).sqrt() as u128);
    Splitter { most }.of(lists, range, all)
}

struct Splitter {
    /// Longest list that is not split further: a few times the side of a balanced product of all terms.
    most: u128,
}

impl Splitter {
    /// `size` is the number of products in the range.
    fn of(
        &self,
        lists: &[GradedList],
        range: Degrees,
        size: u128,
    ) -> Result<Vec<Vec<Arc<TermList>>>, LimitExceeded> {
        if size == 0 {
            return Ok(Vec::new());
        }
        let (least, largest) = ends(lists);
        if range.has(least) && range.has(largest) && size > self.most {
            return Ok(vec![lists.iter().map(GradedList::list).collect()]);
        }
        if size <= self.most || lists.len() < 2 {
            return Ok(vec![vec![TermList::new(products(lists, range))]]);
        }
        let (first, second) = lists.split_at(lists.len() / 2);
        let (lefts, rights) = (
            degree_histogram(first, range.to)?,
            degree_histogram(second, range.to)?,
        );
        let (left, right): (Vec<u64>, Vec<u64>) = (
            lefts.keys().copied().collect(),
            rights.keys().copied().collect(),
        );
        let mut out = Vec::new();
        for (i, j) in rectangles(&left, &right, range) {
            let (i, j) = (span(&left, i), span(&right, j));
            let a = self.of(first, i, within(&lefts, i))?;
            let b = self.of(second, j, within(&rights, j))?;
            for a in &a {
                out.extend(b.iter().map(|b| [a.as_slice(), b.as_slice()].concat()));
            }
            if out.len() > LIBRARY.products {
                return Err(LimitExceeded::Products);
            }
        }
        Ok(out)
    }
}

/// Least and largest total degree.
fn ends(lists: &[GradedList]) -> (u64, u64) {
    let ends = lists.iter().map(GradedList::ends);
    ends.fold((0, 0), |sum, e| (sum.0 + e.0, sum.1 + e.1))
}

/// Number of products for each total degree up to a bound: the convolution of the lists' own histograms.
///
/// # Errors
/// Too many pairs of degrees.
fn degree_histogram(lists: &[GradedList], bound: u64) -> Result<Histogram, LimitExceeded> {
    let mut counts = Histogram::from([(0, 1)]);
    for list in lists {
        let mut own = Histogram::new();
        for (degree, _) in &list.0 {
            *own.entry(*degree).or_default() += 1;
        }
        if counts.len() * own.len() > LIBRARY.degree_pairs {
            return Err(LimitExceeded::Products);
        }
        let mut sum = Histogram::new();
        for (a, n) in &counts {
            for (b, m) in own.range(..=bound - a) {
                let count: &mut u128 = sum.entry(a + b).or_default();
                *count = count.saturating_add(n.saturating_mul(*m));
            }
        }
        counts = sum;
    }
    Ok(counts)
}

fn within(counts: &Histogram, range: Degrees) -> u128 {
    if range.from > range.to {
        return 0;
    }
    let inside = counts.range(range.from..=range.to);
    inside.fold(0, |sum: u128, (_, n)| sum.saturating_add(*n))
}

fn span(degrees: &[u64], range: Range<usize>) -> Degrees {
    let at = |i: usize| degrees.get(i).copied().unwrap_or_default();
    Degrees {
        from: at(range.start),
        to: at(range.end.saturating_sub(1)),
    }
}

/// The pairs of degrees with their sum in a range, as disjoint rectangles. Rectangles are halved recursively, so that a staircase of
/// n steps takes lists of n log n entries in all, not n².
fn rectangles(left: &[u64], right: &[u64], range: Degrees) -> Vec<(Range<usize>, Range<usize>)> {
    let mut found = Vec::new();
    let mut open = vec![(0..left.len(), 0..right.len())];
    while let Some((i, j)) = open.pop() {
        if i.is_empty() || j.is_empty() {
            continue;
        }
        let (a, b) = (span(left, i.clone()), span(right, j.clone()));
        let (least, largest) = (a.from + b.from, a.to + b.to);
        if range.has(least) && range.has(largest) {
            found.push((i, j));
        } else if i.len() * j.len() > 1 && least <= range.to && largest >= range.from {
            let halves = |r: &Range<usize>| {
                let middle = r.start + r.len().div_ceil(2);
                (r.start..middle, middle..r.end)
            };
            if i.len() >= j.len() {
                let (low, high) = halves(&i);
                open.extend([(high, j.clone()), (low, j)]);
            } else {
                let (low, high) = halves(&j);
                open.extend([(i.clone(), high), (i, low)]);
            }
        }
    }
    found
}

/// The products themselves.
fn products(lists: &[GradedList], range: Degrees) -> Vec<Term> {
    let mut so_far = vec![(0, Term::one())];
    for (i, list) in lists.iter().enumerate() {
        let (least, largest) = ends(lists.get(i + 1..).unwrap_or_default());
        let mut next = Vec::new();
        for (degree, term) in &so_far {
            for (d, factor) in &list.0 {
                let sum = degree + d;
                if sum + least > range.to {
                    break;
                }
                if sum + largest >= range.from {
                    next.push((sum, term.mul(factor)));
                }
            }
        }
        so_far = next;
    }
    so_far.into_iter().map(|(_, t)| t).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each admissible pair of degrees is in exactly one rectangle.
    #[test]
    fn rectangles_cover_a_band_once() {
        for (from, to) in [(0, 6), (3, 5), (4, 4), (0, 100), (20, 30)] {
            let (left, right) = ([0, 1, 2, 3, 5], [0, 2, 3, 4, 6, 7]);
            let mut seen = [[0; 6]; 5];
            for (i, j) in rectangles(&left, &right, Degrees { from, to }) {
                for a in i {
                    j.clone().for_each(|b| seen[a][b] += 1);
                }
            }
            for (a, x) in left.iter().enumerate() {
                for (b, y) in right.iter().enumerate() {
                    let inside = (from..=to).contains(&(x + y));
                    assert_eq!(seen[a][b], i32::from(inside), "{x} + {y} in {from}..{to}");
                }
            }
        }
    }
}
