//! Local maxima of |φ(k)ᵀλ|/‖φ(k)‖ over the constants of a term.
//!
//! In: a term, λ, a point of a grid. Out: the values and the size of a maximum between the neighbours of the point. Solves no problem.
//!
//! One constant at a time, each to the root of the exact slope: with one constant that is the maximum itself. With several it may be any
//! stationary point of its cell, so that larger ones can be missed.

use super::family::Family;
use super::searched_constant::{SearchedConstant, set_values};
use super::thresholds::PRICING;
use super::variable_projection::expression_values;
use crate::dictionary::evaluate;
use crate::statistics::product;
use sidc_data::Samples;
use sidc_lang::term::{Expr, Term};
use sidc_solve::simd::dot;

/// Points in rows and columns.
pub(super) struct Grid {
    points: Vec<Vec<f64>>,
    /// Of each constant the values that occur, rising.
    lists: Vec<Vec<f64>>,
}

impl Grid {
    pub fn new(points: &[Vec<f64>]) -> Grid {
        let constants = points.first().map_or(0, Vec::len);
        let list = |k: usize| {
            let mut values: Vec<f64> = points.iter().map(|p| p[k]).collect();
            values.sort_by(f64::total_cmp);
            values.dedup();
            values
        };
        Grid {
            lists: (0..constants).map(list).collect(),
            points: points.to_vec(),
        }
    }

    pub fn point(&self, p: usize) -> Vec<f64> {
        self.points[p].clone()
    }

    fn rank(&self, constant: usize, value: f64) -> usize {
        self.lists[constant].partition_point(|v| *v < value)
    }

    /// Whether two points are one or neighbours in every constant.
    pub fn adjacent(&self, p: usize, q: usize) -> bool {
        let near = |k: usize| {
            let of = |point: usize| self.rank(k, self.points[point][k]);
            of(p).abs_diff(of(q)) <= 1
        };
        (0..self.lists.len()).all(near)
    }

    /// The values of a constant before and after that of a point.
    fn about(&self, constant: usize, value: f64) -> (f64, f64) {
        let list = &self.lists[constant];
        let rank = self.rank(constant, value);
        let at = |k: usize| list[k.min(list.len() - 1)];
        (at(rank.saturating_sub(1)), at(rank + 1))
    }
}

/// |φ(k)ᵀλ|/‖φ(k)‖ of one term.
pub(super) struct Ascent<'a> {
    family: Family<'a>,
    term: &'a Term,
    /// λ times the factors of the rows.
    dual: Vec<f64>,
    /// By constant; `None` for those that the term does not hold.
    slopes: Vec<Option<Expr>>,
}

impl<'a> Ascent<'a> {
    pub fn new(term: &'a Term, family: Family<'a>, dual: &[f64]) -> Ascent<'a> {
        let slope = |s: &SearchedConstant| {
            let held = term.mentions(s.signal());
            held.then(|| term.derivative(s.signal()))
        };
        Ascent {
            family,
            term,
            dual: product(dual, family.row),
            slopes: family.sought.iter().map(slope).collect(),
        }
    }

    /// Upwards from a point, between its neighbours. `None` where the term has no value.
    pub fn climb(&self, grid: &Grid, point: usize) -> Option<(Vec<f64>, f64)> {
        let mut samples = self.family.samples.clone();
        let start = grid.point(point);
        let mut values = start.clone();
        let mut best = self.at(&mut samples, &values, None)?.0;
        let held = self.slopes.iter().filter(|s| s.is_some()).count();
        let sweeps = if held > 1 { PRICING.sweeps } else { 1 };
        for _ in 0..sweeps {
            let before = best;
            for k in (0..values.len()).filter(|k| self.slopes[*k].is_some()) {
                let within = grid.about(k, start[k]);
                if let Some((value, size)) = self.line(&mut samples, &values, k, within)
                    && size > best
                {
                    (values[k], best) = (value, size);
                }
            }
            if best - before <= 1e-9 * best {
                break;
            }
        }
        Some((values, best))
    }

    /// The root of the slope by one constant on the side to which it rises (regula falsi, the Illinois variant; bisection until the signs
    /// differ).
    fn line(
        &self,
        samples: &mut Samples,
        values: &[f64],
        k: usize,
        (from, to): (f64, f64),
    ) -> Option<(f64, f64)> {
        let mut at = |value: f64| {
            let mut values = values.to_vec();
            values[k] = value;
            let (size, slope) = self.at(samples, &values, Some(k))?;
            Some((value, size, slope))
        };
        let mut a = at(values[k])?;
        let end = if a.2 > 0.0 { to } else { from };
        let mut b = at(end)?;
        let mut best = if a.1 >= b.1 { a } else { b };
        for _ in 0..PRICING.line_steps {
            let crossing = a.2 * b.2 < 0.0;
            let share = if crossing { a.2 / (a.2 - b.2) } else { 0.5 };
            let next = at(a.0 + share * (b.0 - a.0))?;
            if next.1 > best.1 {
                best = next;
            }
            if crossing && (a.2 > 0.0) == (next.2 > 0.0) {
                b.2 *= 0.5;
            }
            // The maximum stays between the end that rises towards it and the other.
            let rising = (next.2 > 0.0) == (a.2 > 0.0);
            if rising {
                a = next;
            } else {
                b = next;
            }
            if (a.0 - b.0).abs() <= PRICING.same * a.0.abs() || next.2 == 0.0 {
                break;
            }
        }
        Some((best.0, best.1))
    }

    /// The size at some values, and its slope by one constant. `None` where the term has no value or no length.
    fn at(&self, samples: &mut Samples, values: &[f64], by: Option<usize>) -> Option<(f64, f64)> {
        set_values(samples, self.family.sought, values);
        let column = evaluate(self.term, samples);
        let weighted = product(&column, self.family.row);
        let (g, n) = (dot(&column, &self.dual), dot(&weighted, &weighted));
        let size = g.abs() / n.sqrt();
        if !size.is_finite() {
            return None;
        }
        let slope = by.and_then(|k| self.slopes[k].as_ref()).map_or(0.0, |e| {
            let moved = expression_values(e, samples);
            let turned = dot(&product(&moved, self.family.row), &weighted);
            g.signum() * (dot(&moved, &self.dual) - g * turned / n) / n.sqrt()
        });
        Some((size, slope))
    }
}
