//! Every column of a library priced once more with a dual point, in 106 bits, a tile at a time.
//!
//! In: a library, rows, λ. Out: the largest |φ_jᵀλ|/‖φ_j‖ over all columns and over those off a support, with bounds. A column is evaluated from
//! its term's factors, used, and forgotten: memory is a tile, and the values of the atoms where those are few. Sums are
//! compensated (Ogita, Rump & Oishi 2005), as if made in twice the digits; errors of the entries are summed beside them.

use std::collections::BTreeMap;

use super::double::{Double, ROUNDING, two_prod, two_sum};
use super::rows::Rows;
use super::value::{self, Bounded};
use sidc_lang::library::{Block, Library};
use sidc_lang::term::{Atom, Term};
use sidc_solve::simd::wide;

/// Numbers that a tile holds for each entry: value, square, error.
const NUMBERS: usize = 5;
/// Most numbers of a tile: 1 MB, which a core's cache holds.
const TILE: usize = 130_000;
/// Most columns of a tile.
const WIDEST: usize = 256;
/// Most bytes of atoms that are kept.
const KEPT: usize = 64_000_000;
/// Columns shorter than this are zero: squares of their entries fall out of the range of f64.
const SHORT: f64 = 1e-140;
/// 2⁻¹⁰⁴
const SUM_ROUNDING: f64 = 1.0 / (1_u128 << 104) as f64;

/// What a look at all columns showed.
#[derive(Clone, Debug, Default)]
pub struct Priced {
    /// Columns that are candidates.
    pub columns: usize,
    /// max |φ_jᵀλ|/‖φ_j‖, and its slot.
    pub largest: Bounded,
    pub largest_slot: usize,
    /// The same off the support.
    pub off: Bounded,
    pub off_slot: usize,
    /// A column whose values are not finite or not known.
    pub unknown: Option<usize>,
}

/// Entries multiplied, in numbers: rows × slots of the library.
pub fn work(library: &Library, rows: usize) -> u128 {
    library.slots() as u128 * rows as u128
}

/// Prices all columns; `None` if `go_on`, which hears how many slots are done, ended it. `support` rises.
pub fn price(
    library: &Library,
    rows: &Rows,
    dual: &[f64],
    support: &[usize],
    go_on: &mut dyn FnMut(usize) -> bool,
) -> Option<Priced> {
    let atoms = Atoms::new(library, rows);
    let length = dual.iter().map(|l| l * l).sum::<f64>().sqrt() * (1.0 + 1e-9);
    let mut look = Look {
        library,
        rows,
        dual,
        length,
        support,
        atoms,
        priced: Priced::default(),
    };
    let mut first_slot = 0;
    for block in library.blocks() {
        look.block(block, first_slot, go_on)?;
        first_slot += block.slots();
    }
    Some(look.priced)
}

struct Look<'a> {
    library: &'a Library,
    rows: &'a Rows<'a>,
    dual: &'a [f64],
    /// ‖λ‖, rounded up.
    length: f64,
    support: &'a [usize],
    atoms: Atoms<'a>,
    priced: Priced,
}

impl Look<'_> {
    /// The longer list of factors goes into tiles, those of the other are taken one by one.
    fn block(
        &mut self,
        block: &Block,
        first_slot: usize,
        go_on: &mut dyn FnMut(usize) -> bool,
    ) -> Option<()> {
        let across = block.right.len();
        let swapped = block.left.len() > across;
        let (singles, many) = match swapped {
            true => (&block.right, &block.left),
            false => (&block.left, &block.right),
        };
        let rows = self.rows.len();
        let width = (TILE / (NUMBERS * rows.max(1))).clamp(1, WIDEST);
        let mut tile = Tile::default();
        let mut column = vec![Bounded::default(); rows];
        let mut done = first_slot;
        for (t, terms) in many.chunks(width).enumerate() {
            tile.fill(terms, rows, |term, row| {
                self.atoms.term(term, self.rows, row)
            });
            for (s, single) in singles.iter().enumerate() {
                for (row, out) in column.iter_mut().enumerate() {
                    let weight = self.rows.weight(row);
                    *out = self.atoms.term(single, self.rows, row).scale(weight);
                }
                let sums = tile.multiply(&column, self.dual);
                for (k, sum) in sums.into_iter().enumerate() {
                    let place = t * width + k;
                    let slot = match swapped {
                        true => place * across + s,
                        false => s * across + place,
                    };
                    self.see(first_slot + slot, &sum);
                }
                done += terms.len();
                if !go_on(done) {
                    return None;
                }
            }
        }
        Some(())
    }

    /// A column's sums.
    fn see(&mut self, slot: usize, sum: &Sum) {
        if self.library.is_empty_slot(slot) {
            return;
        }
        let rows = self.rows.len() as f64;
        self.priced.columns += 1;
        let square = sum.square.value();
        let norm = square.sqrt();
        let known = sum.product.is_finite() && sum.square.is_finite();
        if !known || !sum.error.is_finite() || !sum.error_square.is_finite() {
            self.priced.unknown.get_or_insert(slot);
            return;
        }
        if norm < SHORT {
            return;
        }
        let summing = 2.0 * (rows + 4.0).powi(2) * SUM_ROUNDING;
        let product_error = sum.error + summing * norm * self.length;
        let norm_part = summing + sum.error_square.sqrt() / norm;
        if norm_part >= 0.5 {
            self.priced.unknown.get_or_insert(slot);
            return;
        }
        // In 106 bits, since columns on the support are at 1 to the last digit.
        let value = sum.product.abs() / sum.square.sqrt();
        let own = 4.0 * ROUNDING * value.hi;
        let error = (product_error / norm + value.hi * norm_part) / (1.0 - norm_part) + own;
        let found = Bounded {
            value,
            error: error * (1.0 + 1e-9),
        };
        if exceeds(found, self.priced.largest) {
            self.priced.largest = found;
            self.priced.largest_slot = slot;
        }
        if exceeds(found, self.priced.off) && self.support.binary_search(&slot).is_err() {
            self.priced.off = found;
            self.priced.off_slot = slot;
        }
    }
}

/// Whether the upper bound of one is above that of the other.
fn exceeds(a: Bounded, b: Bounded) -> bool {
    (a.value - b.value).value() + a.error > b.error
}

/// φᵀλ and ‖φ‖² of one column, and bounds of what errors of its entries change: Σ |λ| e and Σ e².
#[derive(Clone, Copy, Default)]
struct Sum {
    product: Double,
    square: Double,
    error: f64,
    error_square: f64,
}

/// Factors side by side, row after row.
#[derive(Default)]
struct Tile {
    width: usize,
    hi: Vec<f64>,
    lo: Vec<f64>,
    square_hi: Vec<f64>,
    square_lo: Vec<f64>,
    error: Vec<f64>,
}

impl Tile {
    fn fill(&mut self, terms: &[Term], rows: usize, value: impl Fn(&Term, usize) -> Bounded) {
        self.width = terms.len();
        let all = rows * self.width;
        for numbers in [
            &mut self.hi,
            &mut self.lo,
            &mut self.square_hi,
            &mut self.square_lo,
            &mut self.error,
        ] {
            numbers.clear();
            numbers.resize(all, 0.0);
        }
        for (k, term) in terms.iter().enumerate() {
            for row in 0..rows {
                let v = value(term, row);
                let square = v.value * v.value;
                let at = row * self.width + k;
                self.hi[at] = v.value.hi;
                self.lo[at] = v.value.lo;
                self.square_hi[at] = square.hi;
                self.square_lo[at] = square.lo;
                self.error[at] = v.error;
            }
        }
    }

    /// The sums of every product of a column of the tile with `single`, rows weighted already.
    fn multiply(&self, single: &[Bounded], dual: &[f64]) -> Vec<Sum> {
        let width = self.width;
        let mut sums = Accumulators::new(width);
        wide(
            #[inline(always)]
            || {
                for (row, (v, lambda)) in single.iter().zip(dual).enumerate() {
                    let factor = Row {
                        price: v.value * *lambda,
                        square: v.value * v.value,
                        size: (v.size() + v.error) * (1.0 + 1e-12),
                        error: v.error,
                        lambda: lambda.abs(),
                    };
                    let of = |numbers| part(numbers, row, width);
                    let squares = [of(&self.square_hi), of(&self.square_lo)];
                    sums.add(
                        &factor,
                        [of(&self.hi), of(&self.lo)],
                        squares,
                        of(&self.error),
                    );
                }
            },
        );
        sums.finish()
    }
}

/// One row of a tile; none past its end.
#[inline(always)]
fn part(numbers: &[f64], row: usize, width: usize) -> &[f64] {
    numbers
        .get(row * width..(row + 1) * width)
        .unwrap_or_default()
}

/// One row's factor of a whole tile.
struct Row {
    /// Factor · weight · λ, and its weighted square.
    price: Double,
    square: Double,
    size: f64,
    error: f64,
    lambda: f64,
}

/// Running sums of a tile's columns: leading parts, and all that was rounded off.
struct Accumulators {
    product: [Vec<f64>; 2],
    square: [Vec<f64>; 2],
    error: Vec<f64>,
    error_square: Vec<f64>,
}

impl Accumulators {
    fn new(width: usize) -> Accumulators {
        let zeros = || vec![0.0; width];
        Accumulators {
            product: [zeros(), zeros()],
            square: [zeros(), zeros()],
            error: zeros(),
            error_square: zeros(),
        }
    }

    #[inline(always)]
    fn add(&mut self, row: &Row, [hi, lo]: [&[f64]; 2], squares: [&[f64]; 2], error: &[f64]) {
        let [sum, rest] = &mut self.product;
        add_products(row.price, hi, lo, sum, rest);
        let [sum, rest] = &mut self.square;
        add_products(row.square, squares[0], squares[1], sum, rest);
        let sums = self.error.iter_mut().zip(&mut self.error_square);
        for ((e, e_square), (own, value)) in sums.zip(error.iter().zip(hi)) {
            let off = row.size * own + row.error * value.abs();
            *e += row.lambda * off;
            *e_square += off * off;
        }
    }

    fn finish(self) -> Vec<Sum> {
        let double = |hi: &f64, lo: &f64| Double::sum(*hi, *lo);
        let [product, product_rest] = &self.product;
        let [square, square_rest] = &self.square;
        let products = product.iter().zip(product_rest);
        let squares = square.iter().zip(square_rest);
        let errors = self.error.iter().zip(&self.error_square);
        products
            .zip(squares)
            .zip(errors)
            .map(|((p, q), (e, e_square))| Sum {
                product: double(p.0, p.1),
                square: double(q.0, q.1),
                error: *e,
                error_square: *e_square,
            })
            .collect()
    }
}

/// sum + rest += by · (hi + lo)
#[inline(always)]
fn add_products(by: Double, hi: &[f64], lo: &[f64], sum: &mut [f64], rest: &mut [f64]) {
    for (((sum, rest), hi), lo) in sum.iter_mut().zip(rest).zip(hi).zip(lo) {
        let (product, left) = two_prod(by.hi, *hi);
        let left = by.hi.mul_add(*lo, left);
        let left = by.lo.mul_add(*hi, left);
        let (next, lost) = two_sum(*sum, product);
        *sum = next;
        *rest += lost + left;
    }
}

/// The atoms of a library at every row, where they are few enough to be kept.
struct Atoms<'a> {
    places: BTreeMap<&'a Atom, usize>,
    /// Atom after atom, length rows each; empty if they are not kept.
    values: Vec<Bounded>,
}

impl<'a> Atoms<'a> {
    fn new(library: &'a Library, rows: &Rows) -> Atoms<'a> {
        let mut places = BTreeMap::new();
        for (atom, _) in library.factors().flat_map(Term::factors) {
            let next = places.len();
            places.entry(atom).or_insert(next);
        }
        let bytes = places.len() * rows.len() * size_of::<Bounded>();
        let mut values = Vec::new();
        if bytes <= KEPT {
            values = vec![Bounded::default(); places.len() * rows.len()];
            for (atom, place) in &places {
                let own = values.iter_mut().skip(place * rows.len());
                for (row, out) in own.take(rows.len()).enumerate() {
                    *out = value::atom(atom, &rows.at(row));
                }
            }
        }
        Atoms { places, values }
    }

    fn term(&self, term: &Term, rows: &Rows, row: usize) -> Bounded {
        let value = |atom: &Atom| {
            let place = self.places.get(atom).map(|p| p * rows.len() + row);
            let kept = place.and_then(|at| self.values.get(at));
            kept.copied()
                .unwrap_or_else(|| value::atom(atom, &rows.at(row)))
        };
        value::product(term.factors().map(|(atom, p)| (value(atom), p)))
    }
}
