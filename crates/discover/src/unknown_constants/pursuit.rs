//! Basis pursuit over a continuum: every term that holds constants stands for a column at each of their values.
//!
//! In: a library, rows, points to begin with, a target, ε. Out: the columns of the answer with their values, the norm, the
//! dual point. Judges nothing.
//!
//! Column generation (Bredies & Pikkarainen 2013, for measures): basis pursuit on the columns at hand gives a dual point λ; the values at
//! which |φ(k)ᵀλ|/w(k) is largest give the next columns, until none breaks its bound. Each column has values of its own here, also where
//! an equation has one value for all: the norm that comes out is then a lower bound.

use super::family::Family;
use super::maxima::{Ascent, Grid};
use super::searched_constant::{SearchedConstant, set_values};
use super::thresholds::PRICING;
use crate::dictionary::{Continuum, ContinuumColumns, evaluate};
use crate::statistics::agree;
use crate::statistics::product;
use sidc_progress::Observer;
use sidc_solve::dictionary::{Dense, Dictionary, Graded, Grades, Joined};
use sidc_solve::{Homotopy, Problem, Solution, Solver, Status, support};

/// A column of an answer.
#[derive(Clone, Debug)]
pub(super) struct Member {
    pub slot: usize,
    /// The constants of its term; `None` without one.
    pub values: Option<Vec<f64>>,
    /// |a| w: what it adds to the norm.
    pub share: f64,
}

/// An answer over the continuum.
pub(super) struct Answer {
    pub members: Vec<Member>,
    /// λ, on the weighted rows.
    pub dual: Vec<f64>,
    /// Σ |a| w
    pub norm: f64,
}

/// A column at values that are no points.
struct Added {
    slot: usize,
    values: Vec<f64>,
    column: Vec<f64>,
    grade: f64,
}

/// The columns at hand.
pub(super) struct Pursuit<'a> {
    family: Family<'a>,
    grid: Grid,
    columns: ContinuumColumns,
    grades: Grades,
    added: Vec<Added>,
}

/// How far a pursuit goes.
#[derive(Clone, Copy)]
pub(super) struct Effort {
    /// Rounds of pricing between the points.
    pub rounds: usize,
    /// Steps of a path.
    pub steps: usize,
    /// Excess over a bound up to which the bound counts as kept.
    pub violation: f64,
}

impl<'a> Pursuit<'a> {
    /// `None` where the columns are not finite.
    pub fn new(family: Family<'a>, points: &[Vec<f64>]) -> Option<Pursuit<'a>> {
        let signals: Vec<_> = family.sought.iter().map(SearchedConstant::signal).collect();
        let continuum = Continuum {
            library: family.library,
            points: points.len(),
            weights: family.row,
            grading: family.grading,
            varies: &|t| signals.iter().any(|s| t.mentions(*s)),
        };
        let mut at = |p: usize| {
            let mut samples = family.samples.clone();
            set_values(&mut samples, family.sought, &points[p]);
            samples
        };
        let columns = ContinuumColumns::new(&continuum, &mut at)?;
        Some(Pursuit {
            grades: columns.grades(),
            columns,
            grid: Grid::new(points),
            family,
            added: Vec::new(),
        })
    }

    /// Adds the column of a term at some values.
    pub fn add(&mut self, slot: usize, values: &[f64]) {
        let Some(term) = self.family.library.term(slot) else {
            return;
        };
        let mut samples = self.family.samples.clone();
        set_values(&mut samples, self.family.sought, values);
        let column = product(&evaluate(&term, &samples), self.family.row);
        if column.iter().all(|x| x.is_finite()) {
            self.added.push(Added {
                slot,
                values: values.to_vec(),
                column,
                grade: self.family.grading.of(&term),
            });
        }
    }

    /// The least Σ |a| w with ‖Φa − y‖ ≤ ε over the continuum, to `effort`. `None` where the path is too long or the observer ends the work.
    pub fn solve(
        &mut self,
        (target, tolerance): (&[f64], f64),
        effort: Effort,
        observer: &mut dyn Observer,
    ) -> Option<Answer> {
        for round in 1.. {
            let (solution, answer) = self.restricted(target, tolerance, effort, observer)?;
            let found = self.price(&solution.dual);
            let violation = found.iter().map(|a| a.size - 1.0).fold(0.0, f64::max);
            if violation <= effort.violation || round >= effort.rounds {
                return Some(answer);
            }
            let before = self.added.len();
            for peak in found {
                let new = |a: &Added| {
                    a.slot != peak.slot || !agree(&a.values, &peak.values, PRICING.same)
                };
                if peak.size > 1.0 + effort.violation && self.added.iter().all(new) {
                    self.add(peak.slot, &peak.values);
                }
            }
            if self.added.len() == before {
                return Some(answer);
            }
        }
        None
    }

    /// Basis pursuit on the columns at hand.
    fn restricted(
        &self,
        target: &[f64],
        tolerance: f64,
        effort: Effort,
        observer: &mut dyn Observer,
    ) -> Option<(Solution, Answer)> {
        let base = Graded {
            columns: &self.columns.phi,
            grades: &self.grades,
        };
        let rows = self.family.row.len();
        let added = self.added.iter().flat_map(|a| a.column.iter().copied());
        let added = Dense::new(rows, added.collect());
        let dear = Grades::of_columns(self.added.iter().map(|a| a.grade).collect());
        let added = Graded {
            columns: &added,
            grades: &dear,
        };
        let plain = self.family.grading.is_plain();
        let base: &dyn Dictionary = if plain { &self.columns.phi } else { &base };
        let joined = Joined::new([base, &added]);
        let problem = Problem {
            dictionary: &joined,
            target,
            tolerance,
        };
        let solution = Homotopy
            .solve_all(&[problem], effort.steps, observer)
            .pop()?;
        if !matches!(solution.status, Status::Solved) {
            return None;
        }
        let problem = Problem {
            dictionary: &joined,
            target,
            tolerance,
        };
        let shares: Vec<f64> = problem.contributions(&solution.coefficients).collect();
        let kept = support(&problem, &solution.coefficients);
        let pairs = solution.coefficients.iter().zip(&shares);
        let members = pairs.filter(|((j, _), _)| kept.binary_search(j).is_ok());
        let members = members.map(|((j, _), share)| self.member(*j, *share));
        let answer = Answer {
            members: members.collect(),
            dual: solution.dual.clone(),
            norm: shares.iter().sum(),
        };
        Some((solution, answer))
    }

    fn member(&self, column: usize, share: f64) -> Member {
        let (slot, values) = self.origin(column);
        Member {
            slot,
            values,
            share,
        }
    }

    /// The slot of a column, and the values of the constants at which it was evaluated.
    fn origin(&self, column: usize) -> (usize, Option<Vec<f64>>) {
        match column.checked_sub(self.columns.phi.cols()) {
            Some(k) => (self.added[k].slot, Some(self.added[k].values.clone())),
            None => {
                let origin = self.columns.origin(column);
                (origin.slot, origin.point.map(|p| self.grid.point(p)))
            }
        }
    }

    /// The largest local maxima of |φ(k)ᵀλ|/w(k), by ascent from the points at which it is near its bound.
    fn price(&self, dual: &[f64]) -> Vec<Peak> {
        let priced = self.columns.phi.price_graded(
            &self.grades,
            dual,
            PRICING.priced_columns,
            PRICING.near_bound,
        );
        let mut starts: Vec<(usize, usize)> = Vec::new();
        for (column, _) in priced.columns {
            let origin = self.columns.origin(column);
            let Some(point) = origin.point else { continue };
            let near =
                |(slot, p): &(usize, usize)| *slot == origin.slot && self.grid.adjacent(*p, point);
            if starts.len() < PRICING.ascents && !starts.iter().any(near) {
                starts.push((origin.slot, point));
            }
        }
        let mut peaks: Vec<Peak> = Vec::new();
        for (slot, point) in starts {
            let Some(term) = self.family.library.term(slot) else {
                continue;
            };
            let grade = self.family.grading.of(&term);
            let ascent = Ascent::new(&term, self.family, dual);
            if let Some((values, size)) = ascent.climb(&self.grid, point) {
                let size = size / grade;
                peaks.push(Peak { slot, values, size });
            }
        }
        peaks
    }
}

/// A local maximum of |φ(k)ᵀλ|/w(k).
struct Peak {
    slot: usize,
    values: Vec<f64>,
    size: f64,
}
