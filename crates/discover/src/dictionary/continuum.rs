//! Φ of a library at many values of its unknown constants: terms without a constant once, the others at every point.
//!
//! In: a library, samples, points. Out: one dictionary of products, and for each column its slot and its point. Solves nothing.
//!
//! A block of products L × R splits into factors without a constant, L₀ and R₀, and with one, L₁ and R₁. Its columns are then
//! L₀ × R₀, L₀ × (R₁ at all points), (L₁ at all points) × R₀, and L₁ × R₁ point by point, so that no product is stored.

use std::ops::Range;

use sidc_data::Samples;
use sidc_lang::library::{Grading, Library};
use sidc_lang::term::Term;
use sidc_solve::dictionary::{Block, Factored, Grades};

use super::compile::evaluate;

/// Where a column comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Origin {
    pub slot: usize,
    /// The point at which it was evaluated; `None` for a term without a constant.
    pub point: Option<usize>,
}

/// A factor of a library's block, at a point where it holds a constant.
#[derive(Clone, Copy, Debug)]
struct Factor {
    /// Its place in the list of its block.
    place: usize,
    point: Option<usize>,
}

/// The columns of a library over a range of constants.
pub(crate) struct ContinuumColumns {
    pub phi: Factored,
    columns: Layout,
}

/// How columns stand for slots and points.
struct Layout {
    blocks: Vec<Block>,
    /// First slot and number of right factors of the library's block that each block comes from.
    sources: Vec<(usize, usize)>,
    lefts: Vec<Factor>,
    rights: Vec<Factor>,
    /// Grades of the left and the right factors.
    grades: [Vec<f64>; 2],
}

/// Factors of one side, as far as they are laid out.
struct Side {
    values: Vec<f64>,
    factors: Vec<Factor>,
    grades: Vec<f64>,
}

impl Side {
    fn new() -> Side {
        Side {
            values: Vec::new(),
            factors: Vec::new(),
            grades: Vec::new(),
        }
    }

    /// Appends evaluated factors.
    fn add(&mut self, evaluated: Vec<Evaluated>, point: Option<usize>, grading: &Grading) {
        for (place, term, column) in evaluated {
            self.values.extend(column);
            self.grades.push(grading.of(term));
            self.factors.push(Factor { place, point });
        }
    }
}

/// A factor: its place in the list of its block, its term, its values by row.
type Evaluated<'a> = (usize, &'a Term, Vec<f64>);

/// Factors on samples, rows multiplied by `weights`; `None` where one is not finite.
fn evaluated<'a>(
    terms: &[(usize, &'a Term)],
    samples: &Samples,
    weights: Option<&[f64]>,
) -> Option<Vec<Evaluated<'a>>> {
    let one = |(place, term): &(usize, &'a Term)| {
        let mut column = evaluate(term, samples);
        for (x, w) in column.iter_mut().zip(weights.into_iter().flatten()) {
            *x *= w;
        }
        let finite = column.iter().all(|x| x.is_finite());
        finite.then_some((*place, *term, column))
    };
    terms.iter().map(one).collect()
}

/// The factors of a list without a varying constant, and those with one.
fn split<'a>(terms: &'a [Term], varies: &dyn Fn(&Term) -> bool) -> [Vec<(usize, &'a Term)>; 2] {
    let all = terms.iter().enumerate();
    let (with, without) = all.partition(|(_, t)| varies(t));
    [without, with]
}

/// The library, the rows and the points at which columns are made.
pub(crate) struct Continuum<'a> {
    pub library: &'a Library,
    /// How many points there are.
    pub points: usize,
    /// Factors of the rows.
    pub weights: &'a [f64],
    pub grading: &'a Grading,
    /// Whether a term differs between points.
    pub varies: &'a dyn Fn(&Term) -> bool,
}

impl ContinuumColumns {
    /// `at` gives the samples at each point. Points at which a varying factor is not finite are left out. `None` if a factor
    /// without a constant, or a product, is not finite.
    pub fn new(of: &Continuum, at: &mut dyn FnMut(usize) -> Samples) -> Option<ContinuumColumns> {
        let (mut left, mut right) = (Side::new(), Side::new());
        let mut blocks: Vec<Block> = Vec::new();
        let mut sources: Vec<(usize, usize)> = Vec::new();
        let mut slots = 0;
        for block in of.library.blocks().iter().filter(|b| b.slots() > 0) {
            let mut put = |left: Range<usize>, right: Range<usize>| {
                if left.is_empty() || right.is_empty() {
                    return;
                }
                blocks.push(Block {
                    first_slot: blocks.last().map_or(0, |b| b.ends().0),
                    left,
                    right,
                });
                sources.push((slots, block.right.len()));
            };
            let [l0, l1] = split(&block.left, of.varies);
            let [r0, r1] = split(&block.right, of.varies);
            let here = |left: &Side, right: &Side| (left.factors.len(), right.factors.len());
            let first = here(&left, &right);
            let fixed = at(0);
            left.add(evaluated(&l0, &fixed, Some(of.weights))?, None, of.grading);
            right.add(evaluated(&r0, &fixed, None)?, None, of.grading);
            let varying = here(&left, &right);
            let mut both = Vec::new();
            let points = if l1.is_empty() && r1.is_empty() {
                0
            } else {
                of.points
            };
            for point in 0..points {
                let samples = at(point);
                let l = evaluated(&l1, &samples, Some(of.weights));
                let Some((l, r)) = l.zip(evaluated(&r1, &samples, None)) else {
                    continue;
                };
                let before = here(&left, &right);
                left.add(l, Some(point), of.grading);
                right.add(r, Some(point), of.grading);
                let after = here(&left, &right);
                both.push((before.0..after.0, before.1..after.1));
            }
            let end = here(&left, &right);
            put(first.0..varying.0, first.1..varying.1);
            put(first.0..varying.0, varying.1..end.1);
            put(varying.0..end.0, first.1..varying.1);
            both.into_iter().for_each(|(l, r)| put(l, r));
            slots += block.slots();
        }
        let columns = Layout {
            blocks,
            sources,
            lefts: left.factors,
            rights: right.factors,
            grades: [left.grades, right.grades],
        };
        let empty = columns.empty(of.library);
        let values = [left.values, right.values];
        let phi = Factored::new(of.weights.len(), values, columns.blocks.clone(), &empty);
        Some(ContinuumColumns {
            phi: phi.ok()?,
            columns,
        })
    }

    /// Where a column comes from.
    pub fn origin(&self, column: usize) -> Origin {
        self.columns.origin(column)
    }

    /// The grades of the columns.
    pub fn grades(&self) -> Grades {
        Grades::of_products(self.columns.blocks.clone(), self.columns.grades.clone())
    }
}

impl Layout {
    /// The columns whose slot is empty, rising.
    fn empty(&self, library: &Library) -> Vec<usize> {
        let count = match library.empty_slots() {
            [] => 0,
            _ => self.blocks.last().map_or(0, |b| b.ends().0),
        };
        let empty = |j: &usize| library.is_empty_slot(self.origin(*j).slot);
        (0..count).filter(empty).collect()
    }

    fn origin(&self, column: usize) -> Origin {
        let after = self.blocks.partition_point(|b| b.first_slot <= column);
        let place = after.saturating_sub(1);
        let Some((block, source)) = self.blocks.get(place).zip(self.sources.get(place)) else {
            return Origin {
                slot: column,
                point: None,
            };
        };
        let [l, r] = block.factors(column);
        let (left, right) = (self.lefts[l], self.rights[r]);
        Origin {
            slot: source.0 + left.place * source.1 + right.place,
            point: left.point.or(right.point),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dictionary::compile;
    use sidc_data::{Column, Origin as From};
    use sidc_lang::library::Block as Lists;
    use sidc_lang::term::{Expr, Func, Signal, VarId};
    use sidc_solve::dictionary::Dictionary;

    /// Signals x and k; k is the constant.
    fn signals() -> [Signal; 2] {
        [0, 1].map(|v| Signal::new(VarId(v)))
    }

    fn samples(k: f64) -> Samples {
        let x: Vec<f64> = (0..7).map(|m| 0.3 + 0.2 * f64::from(m)).collect();
        let column = |signal, values| Column {
            signal,
            values,
            origin: From::Measured { noise: None },
        };
        let [a, b] = signals();
        Samples {
            trajectory: vec![0; 7],
            time: x.clone(),
            columns: vec![column(a, x), column(b, vec![k; 7])],
        }
    }

    /// <1, x, sin(k x)> · <1, exp(k x), x^2>, one slot empty.
    fn library() -> Library {
        let [x, k] = signals().map(Expr::signal);
        let call = |name: &str, arg: Expr| {
            let found = Func::named(name).map(|f| Expr::call(f, vec![arg]));
            let expr = found.unwrap_or_default();
            expr.terms().next().map(|(_, t)| t.clone()).unwrap()
        };
        let one = |e: Expr| e.terms().next().map(|(_, t)| t.clone()).unwrap();
        let left = vec![
            Term::one(),
            one(x.clone()),
            call("sin", k.clone() * x.clone()),
        ];
        let right = vec![Term::one(), call("exp", k * x.clone()), one(x.pow(2.0))];
        Library::products(vec![Lists { left, right }], vec![5])
    }

    #[test]
    fn every_column_is_that_of_its_slot_at_its_point() {
        let library = library();
        let values = [0.5, 1.5, 1e5, 2.5];
        let k = signals()[1];
        let weights: Vec<f64> = (0..7).map(|m| 1.0 / f64::from(m + 1)).collect();
        let of = Continuum {
            library: &library,
            points: values.len(),
            weights: &weights,
            grading: &Grading::PLAIN,
            varies: &|t| t.mentions(k),
        };
        let found = ContinuumColumns::new(&of, &mut |p| samples(values[p])).unwrap();
        // 1, x, x², x³ without k; five slots hold it, and exp(1e5 x) overflows.
        assert_eq!(found.phi.cols(), 4 + 3 * 5);
        let mut seen = std::collections::BTreeSet::new();
        for j in 0..found.phi.cols() {
            let Origin { slot, point } = found.origin(j);
            assert!(seen.insert((slot, point)) && point != Some(2));
            let there = compile(
                &library,
                &samples(values[point.unwrap_or(0)]),
                Some(&weights),
            );
            let there = there.ok().unwrap();
            let (mut a, mut b) = (vec![0.0; 7], vec![0.0; 7]);
            found.phi.column(j, &mut a);
            there.column(slot, &mut b);
            let same = a
                .iter()
                .zip(&b)
                .all(|(a, b)| (a - b).abs() <= 1e-12 * b.abs());
            assert!(same, "column {j}, slot {slot}, point {point:?}");
            assert_eq!(found.phi.norm(j) == 0.0, library.is_empty_slot(slot));
        }
    }
}
