//! How far each term and its coefficient are to be trusted: intervals, stability, what stands in for a term, and a mark.
//!
//! In: the least-squares problem behind an answer, stretch by stretch of the records. Out: a [`sidc_system::discovery::Trust`] for every term found. Never
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

use sidc_lang::term::{Language, Signal, Term};
use sidc_solve::QuadraticForm;
use sidc_system::discovery::{Discovery, Equation, FoundTerm, Stretches};

pub use mark::mark;
pub use rows::stretches;

/// Products of some stretches together.
fn sum<'a>(products: impl Iterator<Item = &'a Vec<f64>>, width: usize) -> Vec<f64> {
    let mut sum = vec![0.0; width * width];
    for part in products {
        sum.iter_mut().zip(part).for_each(|(s, x)| *s += x);
    }
    sum
}

/// Some columns on whole records.
struct Part<'a> {
    stretches: &'a Stretches,
    /// Places of the columns, rising.
    kept: Vec<usize>,
    form: QuadraticForm,
    /// What was found, by place among the columns kept.
    support: Vec<usize>,
}

impl Part<'_> {
    /// The columns of an equation but one that is barred, and what was found of the other equations.
    fn of(stretches: &Stretches, target: Signal, barred: Option<usize>) -> Part<'_> {
        let own = |(p, (t, _)): &(usize, &(Signal, Term))| {
            Some(*p) != barred && (*t == target || stretches.support.contains(p))
        };
        let columns = stretches.columns.iter().enumerate().filter(own);
        let kept: Vec<usize> = columns.map(|(p, _)| p).collect();
        let (w, last) = (stretches.columns.len() + 1, stretches.columns.len());
        let places = || kept.iter().copied().chain([last]);
        let products: Vec<f64> = places()
            .flat_map(|i| places().map(move |j| i * w + j))
            .map(|at| stretches.whole.get(at).copied().unwrap_or(0.0))
            .collect();
        let place = |p: &usize| kept.binary_search(p).ok();
        Part {
            form: QuadraticForm::new(&products, kept.len()),
            support: stretches.support.iter().filter_map(place).collect(),
            kept,
            stretches,
        }
    }

    /// The column at a place among those kept: the target of its equation, and its term.
    fn column(&self, k: usize) -> Option<&(Signal, Term)> {
        self.stretches.columns.get(*self.kept.get(k)?)
    }
}

/// Twice the log likelihood that a difference of χ² is worth, the noise profiled out, which counts independent readings.
fn worth(square: f64, readings: f64) -> f64 {
    readings * (square / readings).ln_1p()
}

/// Gives every term that was found on these stretches its stability and what stands in for it.
pub fn judge(stretches: &Stretches, discovery: &mut Discovery) {
    let (halves, shares) = halves::halves(stretches).unzip();
    let mut targets: Vec<Signal> = stretches.columns.iter().map(|(t, _)| *t).collect();
    targets.sort_unstable();
    targets.dedup();
    for target in targets {
        let whole = Part::of(stretches, target, None);
        let nearest = nearest::nearest(&whole, target, &Language(&*discovery));
        for (k, place) in stretches.support.iter().enumerate() {
            let own = stretches.columns.get(*place);
            let Some((_, term)) = own.filter(|(t, _)| *t == target) else {
                continue;
            };
            let without = without::without(&whole, *place, &Language(&*discovery));
            let found = equation(discovery, target).and_then(|e| found_term(e, term));
            if let Some(found) = found {
                let trust = found.trust.get_or_insert_with(Box::default);
                trust.stability = shares.as_ref().and_then(|s: &Vec<f64>| s.get(k).copied());
                trust.without = without;
            }
        }
        let evidence = equation(discovery, target).and_then(|e| e.evidence.as_mut());
        if let Some(evidence) = evidence {
            evidence.nearest = nearest;
            evidence.halves.clone_from(&halves);
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
