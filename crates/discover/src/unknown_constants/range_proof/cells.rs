//! How far from a value of a constant |φ(k)ᵀλ| ≤ B w(k) is proved for a family of terms.
//!
//! In: terms ψ_j h(k) with one varying factor h, λ, the value at which some of them touch the bound, a range. Out: the part of the range
//! around that value over which no term breaks its bound. Rounding of sums of rows is not enclosed, that of functions is.
//!
//! On a cell |k − c| ≤ ρ the rows of h are h(c) + h′(c) t + ½ h″ t², h″ within its enclosure over the cell. So are g = φᵀλ and n = ‖φ‖², and
//! D(t) = B² n − g², which is to be at least zero. Its lower bound D(c) + D′(c) t + ½ min D″ t² is exact to third order, which is what a
//! bound that is touched needs: there D and D′ are zero and D″ is positive, on a cell about the value itself. From there cells follow one
//! another outwards, twice as wide after each that was proved and half as wide after each that was not.

use super::interval::{Interval, enclose};
use crate::dictionary::evaluate;
use crate::unknown_constants::thresholds::RANGE_PROOF;
use crate::unknown_constants::variable_projection::expression_values;
use sidc_data::Samples;
use sidc_lang::term::{Expr, Signal, Term};
use sidc_progress::Observer;
use sidc_solve::simd::dot;

/// Terms that share their varying factor.
pub(super) struct TermFamily {
    /// h
    pub varying: Term,
    pub members: Vec<Member>,
}

/// A term's other factors on the rows.
pub(super) struct Member {
    /// λ ψ, with the factors of the rows.
    weighted: Vec<f64>,
    /// Its magnitudes.
    sizes: Vec<f64>,
    /// ψ², with the squares of the factors of the rows.
    squares: Vec<f64>,
    /// The square of the grade.
    grade: f64,
}

impl Member {
    /// ψ on the rows, factors of the rows and λ.
    pub fn new(psi: &[f64], row: &[f64], dual: &[f64], grade: f64) -> Member {
        let psi: Vec<f64> = psi.iter().zip(row).map(|(p, w)| p * w).collect();
        let weighted: Vec<f64> = psi.iter().zip(dual).map(|(p, l)| p * l).collect();
        Member {
            sizes: weighted.iter().map(|x| x.abs()).collect(),
            weighted,
            squares: psi.iter().map(|p| p * p).collect(),
            grade: grade * grade,
        }
    }
}

/// The rows and the constant that runs over a range.
pub(super) struct Rows<'a> {
    /// Every signal; that of the constant is overwritten.
    pub samples: Samples,
    pub constant: Signal,
    /// B²
    pub bound: f64,
    pub family: &'a TermFamily,
    slopes: [Expr; 2],
}

/// h on a cell: row by row its value and slope at the centre, and what is known of the rest.
struct Cell {
    radius: f64,
    value: Vec<f64>,
    slope: Vec<f64>,
    /// h″: middle and half width.
    bend: [Vec<f64>; 2],
    /// (h²)″/2 = h′² + h h″: middle and half width.
    turn: [Vec<f64>; 2],
}

impl<'a> Rows<'a> {
    pub fn new(samples: Samples, constant: Signal, bound: f64, family: &'a TermFamily) -> Rows<'a> {
        let slope = family.varying.derivative(constant);
        let bend = slope.derivative(constant);
        Rows {
            samples,
            constant,
            bound: bound * bound,
            family,
            slopes: [slope, bend],
        }
    }

    /// The part of `range` about `value` over which all bounds hold; `None` where they do not hold about the value itself.
    pub fn proved(
        &mut self,
        value: f64,
        range: (f64, f64),
        observer: &mut dyn Observer,
    ) -> Option<(f64, f64)> {
        let whole = range.1 - range.0;
        let mut radius = RANGE_PROOF.first_cell * value.abs().min(whole);
        let least = RANGE_PROOF.least_cell;
        while !self.holds(value, radius) {
            radius *= 0.5;
            if radius < least * value.abs() || !observer.go_on() {
                return None;
            }
        }
        let from = self.outwards(value - radius, range.0, radius, observer);
        let to = self.outwards(value + radius, range.1, radius, observer);
        Some((from.max(range.0), to.min(range.1)))
    }

    /// How far towards `end` cell after cell is proved.
    fn outwards(
        &mut self,
        mut here: f64,
        end: f64,
        mut width: f64,
        observer: &mut dyn Observer,
    ) -> f64 {
        let towards = (end - here).signum();
        for _ in 0..RANGE_PROOF.cells {
            if (end - here) * towards <= 0.0 || !observer.go_on() {
                break;
            }
            let next = here + towards * width.min((end - here).abs());
            // A little wider than the cell, so that no rounding is left between two.
            let radius = 0.5 * (next - here).abs() + 1e-12 * here.abs();
            match self.holds(0.5 * (here + next), radius) {
                true => {
                    here = next;
                    width *= 2.0;
                }
                false if width < RANGE_PROOF.least_cell * here.abs() => break,
                false => width *= 0.5,
            }
        }
        here
    }

    /// Whether every bound holds on the cell.
    fn holds(&mut self, centre: f64, radius: f64) -> bool {
        let Some(cell) = self.cell(centre, radius) else {
            return false;
        };
        let mut members = self.family.members.iter();
        members.all(|m| self.margin(m, &cell) >= 0.0)
    }

    /// `None` where h″ has no bound.
    fn cell(&mut self, centre: f64, radius: f64) -> Option<Cell> {
        let constant = self.constant;
        let own = |c: &&mut sidc_data::Column| c.signal == constant;
        let mut columns = self.samples.columns.iter_mut();
        let column = columns.find(own)?;
        column.values.fill(centre);
        let value = evaluate(&self.family.varying, &self.samples);
        let slope = expression_values(&self.slopes[0], &self.samples);
        let range = Interval::about(centre, radius);
        let places: Vec<(Signal, &[f64])> = (self.samples.columns.iter())
            .map(|c| (c.signal, &c.values[..]))
            .collect();
        let (mut bend, mut turn) = ([Vec::new(), Vec::new()], [Vec::new(), Vec::new()]);
        let within = Interval::about(0.0, radius);
        for row in 0..self.samples.len() {
            let at = |s: Signal| match s == constant {
                true => range,
                false => {
                    let own = places.iter().find(|(signal, _)| *signal == s);
                    own.map_or(Interval::WHOLE, |(_, v)| Interval::point(v[row]))
                }
            };
            let second = enclose(&self.slopes[1], &at);
            let first = Interval::point(slope[row]).plus(second.times(within));
            let zeroth = Interval::point(value[row]).plus(first.times(within));
            let half = first.square().plus(zeroth.times(second));
            if !second.is_finite() || !half.is_finite() {
                return None;
            }
            bend[0].push(second.middle());
            bend[1].push(second.radius());
            turn[0].push(half.middle());
            turn[1].push(half.radius());
        }
        let finite = value.iter().chain(&slope).all(|x| x.is_finite());
        finite.then_some(Cell {
            radius,
            value,
            slope,
            bend,
            turn,
        })
    }

    /// A lower bound of D/(B² n) on the cell, and a rounding above zero where it is touched.
    fn margin(&self, member: &Member, cell: &Cell) -> f64 {
        let squared = |a: &[f64], b: &[f64]| -> f64 {
            let all = member.squares.iter().zip(a.iter().zip(b));
            all.map(|(s, (a, b))| s * a * b).sum()
        };
        let scale = self.bound * member.grade;
        let (g0, g1) = (
            dot(&member.weighted, &cell.value),
            dot(&member.weighted, &cell.slope),
        );
        let q = Interval::about(
            dot(&member.weighted, &cell.bend[0]),
            dot(&member.sizes, &cell.bend[1]),
        );
        let n0 = squared(&cell.value, &cell.value);
        let n1 = 2.0 * squared(&cell.value, &cell.slope);
        let p = Interval::about(
            2.0 * dot(&member.squares, &cell.turn[0]),
            2.0 * dot(&member.squares, &cell.turn[1]),
        );
        let within = Interval::about(0.0, cell.radius);
        let slope = Interval::point(g1).plus(q.times(within));
        let value = Interval::point(g0).plus(slope.times(within));
        let bent = slope.square().plus(value.times(q));
        let second = Interval::point(scale)
            .times(p)
            .minus(bent.times(Interval::point(2.0)));
        let (d0, d1) = (scale * n0 - g0 * g0, scale * n1 - 2.0 * g0 * g1);
        if n0 == 0.0 && g0 == 0.0 && second.lo >= 0.0 {
            return 0.0;
        }
        least(d0, d1, second.lo, cell.radius) / (scale * n0)
    }
}

/// The minimum of d₀ + d₁ t + ½ d₂ t² over |t| ≤ ρ.
fn least(d0: f64, d1: f64, d2: f64, radius: f64) -> f64 {
    let at = |t: f64| d0 + d1 * t + 0.5 * d2 * t * t;
    let ends = at(radius).min(at(-radius));
    let turning = -d1 / d2;
    match d2 > 0.0 && turning.abs() < radius {
        true => at(turning),
        false => ends,
    }
}
