//! Products of lists under a bound on the sum of degrees, as a union of products without one.
//!
//! In: lists whose entries have degrees, and a range for the sum. Out: products of plain lists, no term twice. Partial
//! products beyond the range are never made.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use super::MAX_PRODUCTS;
use super::list::{List, Unwieldy};
use super::set::LISTED;
use crate::term::Term;

/// Terms with their degrees, by rising degree.
#[derive(Clone, Debug)]
pub(super) struct Graded(Vec<(u64, Term)>);

/// Sums of degrees from … to, ends included.
#[derive(Clone, Copy, Debug)]
pub(super) struct Degrees {
    pub from: u64,
    pub to: u64,
}

/// How many products have each sum of degrees.
type Histogram = BTreeMap<u64, u128>;

/// Most pairs of degrees to add up: about half a second.
const MAX_DEGREES: usize = 30_000_000;

/// Degrees are counted in millionths: sums of 0.1 and 0.2 are exact.
const UNIT: f64 = 1e6;
/// What the rounding of many fractions may add up to.
const SLACK: u64 = 100;

/// The degree of a term as a whole number that adds up over products.
pub(super) fn grade(term: &Term) -> u64 {
    whole(term.degree())
}

fn whole(degree: f64) -> u64 {
    (degree * UNIT).round() as u64
}

impl Degrees {
    pub fn up_to(bound: f64) -> Degrees {
        Degrees {
            from: 0,
            to: whole(bound).saturating_add(SLACK),
        }
    }

    pub fn has(self, degree: u64) -> bool {
        (self.from..=self.to).contains(&degree)
    }
}

impl Graded {
    pub fn new(mut entries: Vec<(u64, Term)>) -> Graded {
        entries.sort_by_key(|e| e.0);
        Graded(entries)
    }

    /// A list by the degrees of its terms.
    pub fn of(list: &List) -> Graded {
        let terms = list.terms().iter();
        Graded::new(terms.map(|t| (grade(t), t.clone())).collect())
    }

    fn ends(&self) -> (u64, u64) {
        let end = |entry: Option<&(u64, Term)>| entry.map_or(0, |e| e.0);
        (end(self.0.first()), end(self.0.last()))
    }

    fn list(&self) -> Arc<List> {
        List::new(self.0.iter().map(|(_, t)| t.clone()).collect())
    }
}

/// Every product of one entry of each list with its sum of degrees in `range`. The lists must have no atoms in common.
///
/// # Errors
/// Too many pieces.
pub(super) fn pieces(lists: &[Graded], range: Degrees) -> Result<Vec<Vec<Arc<List>>>, Unwieldy> {
    let all = within(&histogram(lists, range.to)?, range);
    let most = LISTED.max(4 * (all as f64).sqrt() as u128);
    Pieces { most }.of(lists, range, all)
}

struct Pieces {
    /// Longest list that is not split further: some times the length that a balanced product would have.
    most: u128,
}

impl Pieces {
    /// `size` is the number of products in the range.
    fn of(
        &self,
        lists: &[Graded],
        range: Degrees,
        size: u128,
    ) -> Result<Vec<Vec<Arc<List>>>, Unwieldy> {
        if size == 0 {
            return Ok(Vec::new());
        }
        let (least, largest) = ends(lists);
        if range.has(least) && range.has(largest) && size > self.most {
            return Ok(vec![lists.iter().map(Graded::list).collect()]);
        }
        if size <= self.most || lists.len() < 2 {
            return Ok(vec![vec![List::new(products(lists, range))]]);
        }
        let (first, second) = lists.split_at(lists.len() / 2);
        let (lefts, rights) = (histogram(first, range.to)?, histogram(second, range.to)?);
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
            if out.len() > MAX_PRODUCTS {
                return Err(Unwieldy::Products);
            }
        }
        Ok(out)
    }
}

/// Least and largest sum of degrees.
fn ends(lists: &[Graded]) -> (u64, u64) {
    let ends = lists.iter().map(Graded::ends);
    ends.fold((0, 0), |sum, e| (sum.0 + e.0, sum.1 + e.1))
}

/// Products by their sums of degrees, up to a bound.
///
/// # Errors
/// So many degrees that no few rectangles cover their pairs.
fn histogram(lists: &[Graded], bound: u64) -> Result<Histogram, Unwieldy> {
    let mut counts = Histogram::from([(0, 1)]);
    for list in lists {
        let mut own = Histogram::new();
        for (degree, _) in &list.0 {
            *own.entry(*degree).or_default() += 1;
        }
        if counts.len() * own.len() > MAX_DEGREES {
            return Err(Unwieldy::Products);
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

/// The pairs of degrees with their sum in a range, as rectangles: halves and halves again, so that a staircase of n steps takes
/// lists of n log n entries and not n².
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
fn products(lists: &[Graded], range: Degrees) -> Vec<Term> {
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

    /// Each admissible pair of steps stands in exactly one rectangle.
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
