//! How far each term and its coefficient are to be trusted: intervals, stability, what stands in for a term, and a mark.
//!
//! In: the least-squares problem behind an answer, stretch by stretch of the records. Out: a [`crate::discover::Trust`] for every term found. Never
//! changes a term or a coefficient, never prints.

mod halves;
mod identical;
mod interval;
mod mark;
mod nearest;
mod rows;
mod without;

#[cfg(test)]
mod tests;

use crate::discover::{Discovery, Equation, FoundTerm, Stretches};
use crate::solve::quadratic::Quadratic;
use crate::term::{Language, Signal, Term};

pub use mark::mark;
pub use rows::stretches;

/// Sums over stretches, and forms of some columns.
struct Choice<'a> {
    stretches: &'a Stretches,
}

impl Choice<'_> {
    fn width(&self) -> usize {
        self.stretches.columns.len() + 1
    }

    /// Products of some stretches together.
    fn sum(&self, of: &[usize]) -> Vec<f64> {
        let mut sum = vec![0.0; self.width() * self.width()];
        for part in of.iter().filter_map(|i| self.stretches.products.get(*i)) {
            sum.iter_mut().zip(part).for_each(|(s, x)| *s += x);
        }
        sum
    }

    /// The form of the columns `kept`, of the products of some stretches.
    fn form(&self, products: &[f64], kept: &[usize]) -> Quadratic {
        let (w, last) = (self.width(), self.width() - 1);
        let places = || kept.iter().copied().chain([last]);
        let part: Vec<f64> = places()
            .flat_map(|i| places().map(move |j| (i, j)))
            .map(|(i, j)| products.get(i * w + j).copied().unwrap_or(0.0))
            .collect();
        Quadratic::new(&part, kept.len())
    }
}

/// Gives every term that was found on these stretches its stability and what stands in for it.
pub fn judge(stretches: &Stretches, discovery: &mut Discovery) {
    let choice = Choice { stretches };
    let found = halves::halves(&choice);
    let mut targets: Vec<Signal> = stretches.columns.iter().map(|(t, _)| *t).collect();
    targets.sort_unstable();
    targets.dedup();
    for target in targets {
        let nearest = nearest::nearest(&choice, target, &Language(&*discovery));
        let evidence = equation(discovery, target).and_then(|e| e.evidence.as_mut());
        if let Some(evidence) = evidence {
            evidence.nearest = nearest;
            evidence.halves = found.as_ref().map(|(halves, _)| halves.clone());
        }
    }
    for (k, place) in stretches.support.iter().enumerate() {
        let Some((target, term)) = stretches.columns.get(*place) else {
            continue;
        };
        let without = without::without(&choice, *place, &Language(&*discovery));
        let Some(equation) = equation(discovery, *target) else {
            continue;
        };
        if let Some(own) = found_term(equation, term) {
            let trust = own.trust.get_or_insert_with(Box::default);
            trust.stability = found.as_ref().and_then(|(_, s)| s.get(k).copied());
            trust.without = without;
        }
    }
}

/// Gives every coefficient with a standard error its interval. `readings` are independent.
pub fn intervals(equation: &mut Equation, readings: f64) {
    let fitted = equation.terms.iter().filter(|t| !t.fixed).count();
    let width = interval::student(readings - fitted as f64);
    for t in equation.terms.iter_mut().filter(|t| !t.fixed) {
        if let Some(error) = t.standard_error {
            let trust = t.trust.get_or_insert_with(Box::default);
            let by = width * error;
            trust.interval = Some((t.coefficient - by, t.coefficient + by));
        }
    }
}

fn equation(discovery: &mut Discovery, target: Signal) -> Option<&mut Equation> {
    let mut all = discovery.equations.iter_mut();
    all.find(|e| e.target == target)
}

fn found_term<'a>(equation: &'a mut Equation, term: &Term) -> Option<&'a mut FoundTerm> {
    let mut all = equation.terms.iter_mut();
    all.find(|t| !t.fixed && t.term == *term)
}
