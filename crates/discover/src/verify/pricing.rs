//! All columns of a library priced with a dual point, in 106 bits.
//!
//! In: a library, rows, λ, a grading. Out: the largest |φ_jᵀλ|/w_j, w_j = κ^degree ‖φ_j‖, over all columns and over those off a support, with bounds. Columns are evaluated
//! from the factors of their terms, a tile at a time; only the values of the atoms are kept, where they are few. Sums are compensated
//! (Ogita, Rump & Oishi 2005), as if made in twice the digits; bounds on the errors of the entries are summed beside them.

use sidc_progress::{Activity, Observer, Stage};
use std::collections::BTreeMap;

use super::ball::Ball;
use super::double_double::{DoubleDouble, ROUNDING, two_prod, two_sum};
use super::term_evaluation;
use super::thresholds::{ARITHMETIC, TILES};
use super::weighted_sums::WeightedRows;
use sidc_lang::library::{Block, Grading, Library};
use sidc_lang::term::{Atom, Term};
use sidc_solve::simd::wide;

/// Numbers that a tile holds for each entry: two each for value and square, and the error.
const NUMBERS_PER_ENTRY: usize = 5;
/// 2⁻¹⁰⁴ = 4 u² for the rounding u = 2⁻⁵³ of f64. The rounding of a compensated sum of n products is about n² u² of Σ |products|, to second
/// order (Ogita, Rump & Oishi 2005).
const SUM_ROUNDING: f64 = 1.0 / (1_u128 << 104) as f64;

/// Prices of all columns.
#[derive(Clone, Debug, Default)]
pub struct Pricing {
    /// Columns that are candidates.
    pub columns: usize,
    /// max |φ_jᵀλ|/w_j, and its slot.
    pub largest: Ball,
    pub largest_slot: usize,
    /// The same off the support.
    pub other: Ball,
    pub other_slot: usize,
    /// A column whose values are not finite or not known.
    pub unknown: Option<usize>,
}

/// Products that pricing takes: rows × slots of the library.
pub fn work(library: &Library, rows: usize) -> u128 {
    library.slots() as u128 * rows as u128
}

/// Prices all columns. The observer hears how many slots are done; `None` if it ended the work. `support` is in rising order.
pub fn price(
    library: &Library,
    rows: &WeightedRows,
    (dual, grading): (&[f64], &Grading),
    support: &[usize],
    observer: &mut dyn Observer,
) -> Option<Pricing> {
    let atoms = Atoms::new(library, rows);
    let length = dual.iter().map(|l| l * l).sum::<f64>().sqrt() * (1.0 + 1e-9);
    let mut pricer = Pricer {
        library,
        rows,
        dual,
        length,
        grading,
        support,
        atoms,
        pricing: Pricing::default(),
    };
    let mut first_slot = 0;
    for block in library.blocks() {
        pricer.block(block, first_slot, observer)?;
        first_slot += block.slots();
    }
    Some(pricer.pricing)
}

struct Pricer<'a> {
    library: &'a Library,
    rows: &'a WeightedRows<'a>,
    dual: &'a [f64],
    /// ‖λ‖, rounded up.
    length: f64,
    grading: &'a Grading,
    support: &'a [usize],
    atoms: Atoms<'a>,
    pricing: Pricing,
}

impl Pricer<'_> {
    /// Fills tiles with the factors of the longer list, and multiplies them with those of the other one by one.
    fn block(
        &mut self,
        block: &Block,
        first_slot: usize,
        observer: &mut dyn Observer,
    ) -> Option<()> {
        let across = block.right.len();
        let swapped = block.left.len() > across;
        let (singles, many) = match swapped {
            true => (&block.right, &block.left),
            false => (&block.left, &block.right),
        };
        let rows = self.rows.len();
        let width = (TILES.numbers / (NUMBERS_PER_ENTRY * rows.max(1))).clamp(1, TILES.columns);
        let mut tile = Tile::default();
        let mut column = vec![Ball::default(); rows];
        let mut done = first_slot;
        for (t, terms) in many.chunks(width).enumerate() {
            tile.fill(terms, rows, |term, row| {
                self.atoms.term(term, self.rows, row)
            });
            let grades: Vec<f64> = terms.iter().map(|t| self.grading.of(t)).collect();
            for (s, single) in singles.iter().enumerate() {
                let grade = self.grading.of(single);
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
                    self.add_column(first_slot + slot, &sum, grade * grades[k]);
                }
                done += terms.len();
                let verifying = Stage::Verifying(done, self.library.slots());
                observer.hear(Activity::Stage(verifying)).continue_value()?;
            }
        }
        Some(())
    }

    /// Takes in the sums of one column.
    fn add_column(&mut self, slot: usize, sum: &Sum, grade: f64) {
        if self.library.is_empty_slot(slot) {
            return;
        }
        let rows = self.rows.len() as f64;
        self.pricing.columns += 1;
        let square = sum.square.to_f64();
        let norm = square.sqrt();
        let known = sum.product.is_finite() && sum.square.is_finite();
        if !known || !sum.error.is_finite() || !sum.error_square.is_finite() {
            self.pricing.unknown.get_or_insert(slot);
            return;
        }
        if norm < ARITHMETIC.shortest_column {
            return;
        }
        let summing = 2.0 * (rows + 4.0).powi(2) * SUM_ROUNDING;
        let product_error = sum.error + summing * norm * self.length;
        let norm_part = summing + sum.error_square.sqrt() / norm;
        if norm_part >= 0.5 {
            self.pricing.unknown.get_or_insert(slot);
            return;
        }
        // In 106 bits, since columns of the support are at 1 up to rounding.
        let value = sum.product.abs() / sum.square.sqrt();
        let rounding = 4.0 * ROUNDING * value.hi;
        let error = (product_error / norm + value.hi * norm_part) / (1.0 - norm_part) + rounding;
        let found = Ball {
            value,
            error: error * (1.0 + 1e-9),
        };
        let found = found.over(Ball::exact(grade));
        if exceeds(found, self.pricing.largest) {
            self.pricing.largest = found;
            self.pricing.largest_slot = slot;
        }
        if exceeds(found, self.pricing.other) && self.support.binary_search(&slot).is_err() {
            self.pricing.other = found;
            self.pricing.other_slot = slot;
        }
    }
}

/// Whether the upper bound of one is above that of the other.
fn exceeds(a: Ball, b: Ball) -> bool {
    (a.value - b.value).to_f64() + a.error > b.error
}

/// φᵀλ and ‖φ‖² of one column, and bounds of what errors of its entries change: Σ |λ| e and Σ e².
#[derive(Clone, Copy, Default)]
struct Sum {
    product: DoubleDouble,
    square: DoubleDouble,
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
    fn fill(&mut self, terms: &[Term], rows: usize, value: impl Fn(&Term, usize) -> Ball) {
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
    fn multiply(&self, single: &[Ball], dual: &[f64]) -> Vec<Sum> {
        let width = self.width;
        let mut sums = Accumulators::new(width);
        wide(
            #[inline(always)]
            || {
                for (row, (v, lambda)) in single.iter().zip(dual).enumerate() {
                    let factor = Row {
                        dual: v.value * *lambda,
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
    dual: DoubleDouble,
    square: DoubleDouble,
    size: f64,
    error: f64,
    lambda: f64,
}

/// Running sums of a tile's columns: leading parts, and the sums of what was rounded off.
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
        add_products(row.dual, hi, lo, sum, rest);
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
        let double = |hi: &f64, lo: &f64| DoubleDouble::sum(*hi, *lo);
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
fn add_products(by: DoubleDouble, hi: &[f64], lo: &[f64], sum: &mut [f64], rest: &mut [f64]) {
    for (((sum, rest), hi), lo) in sum.iter_mut().zip(rest).zip(hi).zip(lo) {
        let (product, left) = two_prod(by.hi, *hi);
        let left = by.hi.mul_add(*lo, left);
        let left = by.lo.mul_add(*hi, left);
        let (next, lost) = two_sum(*sum, product);
        *sum = next;
        *rest += lost + left;
    }
}

/// The atoms of a library at every row, if these fit in memory.
struct Atoms<'a> {
    places: BTreeMap<&'a Atom, usize>,
    /// Atom after atom, length rows each; empty if they are not kept.
    values: Vec<Ball>,
}

impl<'a> Atoms<'a> {
    fn new(library: &'a Library, rows: &WeightedRows) -> Atoms<'a> {
        let mut places = BTreeMap::new();
        for (atom, _) in library.factors().flat_map(Term::factors) {
            let next = places.len();
            places.entry(atom).or_insert(next);
        }
        let bytes = places.len() * rows.len() * size_of::<Ball>();
        let mut values = Vec::new();
        if bytes <= TILES.atom_bytes {
            values = vec![Ball::default(); places.len() * rows.len()];
            for (atom, place) in &places {
                let own = values.iter_mut().skip(place * rows.len());
                for (row, out) in own.take(rows.len()).enumerate() {
                    *out = term_evaluation::atom(atom, &rows.at(row));
                }
            }
        }
        Atoms { places, values }
    }

    fn term(&self, term: &Term, rows: &WeightedRows, row: usize) -> Ball {
        let value = |atom: &Atom| {
            let place = self.places.get(atom).map(|p| p * rows.len() + row);
            let kept = place.and_then(|at| self.values.get(at));
            kept.copied()
                .unwrap_or_else(|| term_evaluation::atom(atom, &rows.at(row)))
        };
        term_evaluation::product(term.factors().map(|(atom, p)| (value(atom), p)))
    }
}
