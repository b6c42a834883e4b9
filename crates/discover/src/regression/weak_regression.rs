//! One equation by its weak form: iterated generalised least squares.
//!
//! In: a task. Out: an equation, as from regression. How noise enters the terms depends on the equation itself, so the rows are
//! whitened by a first guess, terms are selected again, and so on, from several first guesses. The guess of largest likelihood
//! stands. Never differentiates a noisy signal.

use std::collections::BTreeSet;

use crate::dictionary::BadValue;
use crate::interruption;
use crate::options::Method;
use crate::refusal::Unevaluable;
use crate::regression::design::{Design, RowKind};
use crate::regression::task::Task;
use crate::regression::thresholds::WEAK_FORM;
use crate::regression::uncoupled::{at_once, map_equations};
use crate::row_weights::Weights;
use crate::selection::information_criterion::InformationCriterion;
use crate::selection::term_selection;
use crate::selection::thresholds::TERM_SELECTION;
use crate::statistics::rms;
use crate::weak_form::{Weak, WeakFormInputs, Whitened};
use sidc_data::Samples;
use sidc_lang::term::Term;
use sidc_progress::{EquationObserver, Stage};
use sidc_solve as solve;
use sidc_solve::Problem;
use sidc_solve::dictionary::Dictionary;
use sidc_system::discovery::{Discovery, Equation, Failed};

/// Slots of a library with their coefficients.
pub(crate) type SlotTerms = Vec<(usize, f64)>;

/// What the weak form says before it iterates.
#[derive(Clone, Default)]
pub(crate) struct WeakGuess {
    /// Squared residuals plus the cost of the terms.
    pub value: f64,
    /// Terms of each equation that has a weak form, with its place.
    pub terms: Vec<(usize, SlotTerms)>,
}

/// Terms selected in one iteration.
#[derive(Clone)]
struct WeakFit {
    support: Vec<usize>,
    pairs: SlotTerms,
    /// Squared residual.
    left: f64,
    /// Squared residual plus the cost of the terms.
    value: f64,
}

/// One iteration: a guess, rows whitened by it, and the terms selected on these rows.
struct Iteration {
    /// The weak form along the trajectory that follows from the guess.
    own: Weak,
    whitened: Whitened,
    found: WeakFit,
    /// Mean squared whitened residual; 1 for noise alone.
    left: f64,
}

/// The equations found by their weak form, in the order of the model, each with its place there.
pub(crate) struct WeakSystem<'a> {
    members: Vec<WeakEquation<'a>>,
}

struct WeakEquation<'a> {
    place: usize,
    task: Task<'a>,
    weak: Weak,
    best: Option<Iteration>,
}

impl WeakEquation<'_> {
    /// Bytes of its matrix, with all copies.
    fn size(&self) -> u128 {
        let entries = self.weak.rows() as u128 * self.task.library.len() as u128;
        entries * u128::from(WEAK_FORM.bytes_per_entry)
    }
}

impl<'a> WeakSystem<'a> {
    /// The tasks that have a weak form; the others are left to regression.
    ///
    /// # Errors
    /// Terms that the data cannot evaluate, one for each task.
    pub fn new(tasks: impl Iterator<Item = (usize, Task<'a>)>) -> Result<Self, Vec<Unevaluable>> {
        let (mut members, mut bad) = (Vec::new(), Vec::new());
        for (place, task) in tasks {
            match task.weak_form() {
                Ok(Some(weak)) => members.push(WeakEquation {
                    place,
                    task,
                    weak,
                    best: None,
                }),
                Ok(None) => {}
                Err(value) => bad.push((place, value)),
            }
        }
        if bad.is_empty() {
            Ok(WeakSystem { members })
        } else {
            Err(bad)
        }
    }

    /// The equations with their evidence.
    pub fn run(
        mut self,
        names: &Discovery,
        watcher: &mut EquationObserver,
    ) -> Vec<(usize, Result<Equation, Failed>)> {
        self.iterate(watcher);
        let conclude = |m: WeakEquation| (m.place, m.task.concluded(m.best, names, watcher));
        self.members.into_iter().map(conclude).collect()
    }

    /// Slots and coefficients of each equation that is found, without evidence.
    pub fn terms(mut self, watcher: &mut EquationObserver) -> Vec<(usize, SlotTerms)> {
        self.iterate(watcher);
        let terms = |m: WeakEquation| Some((m.place, m.best?.found.pairs));
        self.members.into_iter().filter_map(terms).collect()
    }

    /// First guesses of all equations, not iterated, one for each factor on the cost of a term, with the sum of their criteria. No guess enters
    /// the whitening of the rows, so these sums can be compared between values of constants. Costs a tenth of [`WeakSystem::terms`].
    pub fn guesses(self, factors: &[f64], watcher: &mut EquationObserver) -> Vec<WeakGuess> {
        let [slack, ..] = WEAK_FORM.initial_slacks;
        let mut guesses = vec![WeakGuess::default(); factors.len()];
        for m in &self.members {
            let Some(whitened) = m.weak.whitened(&[], slack) else {
                continue;
            };
            for (guess, factor) in guesses.iter_mut().zip(factors) {
                let found = m.task.choose(&whitened, *factor, watcher);
                guess.value += found.value;
                guess.terms.push((m.place, found.pairs));
            }
        }
        guesses
    }

    /// Finds each equation alone, then again along the trajectories that the other equations gave.
    fn iterate(&mut self, watcher: &mut EquationObserver) {
        let sizes = self.members.iter().map(WeakEquation::size).collect();
        let limit = self.members.first().map_or(0, |m| m.task.options.memory);
        let members: Vec<_> = self.members.iter_mut().map(|m| (m.place, m)).collect();
        let alone = |m: &mut WeakEquation, watcher: &mut EquationObserver| {
            m.best = m.task.search(&m.weak, None, watcher);
        };
        map_equations(at_once(sizes, limit), members, watcher, alone);
        for _ in 1..WEAK_FORM.max_passes {
            let moved = |m: &WeakEquation| m.best.as_ref().is_some_and(|r| r.own.moved());
            if !self.members.iter().any(moved) {
                return;
            }
            let mut changed = false;
            for k in 0..self.members.len() {
                changed |= self.iterate_along_others(k, watcher);
            }
            if !changed {
                return;
            }
        }
    }

    /// Finds one equation along the trajectories of the others; true if its terms changed.
    fn iterate_along_others(&mut self, k: usize, watcher: &mut EquationObserver) -> bool {
        let Some(member) = self.members.get(k) else {
            return false;
        };
        watcher.set_equation(member.place);
        let shared = self.members.iter().filter_map(|m| m.best.as_ref());
        let shared = shared.filter(|r| r.left < WEAK_FORM.shared_misfit && r.own.moved());
        let others: Vec<&Weak> = shared.map(|r| &r.own).collect();
        let mut weak = member.weak.clone();
        if weak.adopt(&others, member.task.library).is_err() {
            weak = member.weak.clone();
        }
        let before = member.best.as_ref().map(|r| &r.found);
        let next = member.task.search(&weak, before, watcher);
        let support = |r: &Option<Iteration>| r.as_ref().map(|r| r.found.support.clone());
        let changed = support(&next) != support(&member.best);
        if let (Some(member), Some(next)) = (self.members.get_mut(k), next) {
            member.best = Some(next);
        }
        changed
    }
}

impl Task<'_> {
    /// The weak form of this equation; `None` where the target itself was measured and there is nothing to integrate.
    ///
    /// # Errors
    /// A term that the data cannot evaluate.
    pub fn weak_form(&self) -> Result<Option<Weak>, Box<BadValue>> {
        let asked = WeakFormInputs {
            model: self.model,
            dataset: self.dataset,
            target: self.target,
            known: &self.known,
            library: self.library,
            entries: WEAK_FORM
                .max_entries
                .min((self.options.memory / WEAK_FORM.bytes_per_entry) as usize),
        };
        Weak::new(&asked).map_err(|(mut bad, (trajectory, time))| {
            bad.row = nearest(self.samples, trajectory, time);
            bad
        })
    }

    /// The best iteration from all first guesses, and from the fit of the pass before.
    fn search(
        &self,
        weak: &Weak,
        before: Option<&WeakFit>,
        watcher: &mut EquationObserver,
    ) -> Option<Iteration> {
        let mut best: Option<Iteration> = None;
        let mut initial_fits = self.initial_fits(weak, watcher);
        initial_fits.extend(before.cloned());
        let mut seen = BTreeSet::new();
        for found in initial_fits {
            self.iterate(weak, found, (&mut best, &mut seen), watcher);
        }
        best
    }

    /// The equation of the best iteration, with its evidence.
    fn concluded(
        &self,
        best: Option<Iteration>,
        names: &Discovery,
        watcher: &mut EquationObserver,
    ) -> Result<Equation, Failed> {
        if let (None, Some(stop)) = (&best, watcher.stop()) {
            return Err(self.failed(interruption::failure(stop)));
        }
        let best = best.and_then(|b| self.weak_design(&b.own, b.whitened));
        let Some(mut design) = best else {
            return Err(self.motionless(names));
        };
        Ok(self.solve(names, &mut design, watcher))
    }

    /// Distinct first guesses: for every slack and every factor on the cost of a term.
    fn initial_fits(&self, weak: &Weak, watcher: &mut EquationObserver) -> Vec<WeakFit> {
        let mut out: Vec<WeakFit> = Vec::new();
        for slack in WEAK_FORM.initial_slacks {
            let Some(whitened) = weak.whitened(&[], slack) else {
                continue;
            };
            let first = out.len();
            for penalty_factor in WEAK_FORM.penalty_factors {
                let found = self.choose(&whitened, penalty_factor, watcher);
                if out.iter().skip(first).all(|f| f.support != found.support) {
                    out.push(found);
                }
            }
        }
        out
    }

    /// Iterates until the terms no longer change, or until terms were selected that another iteration passed through: the terms determine
    /// what follows, up to small differences of coefficients.
    fn iterate(
        &self,
        weak: &Weak,
        mut found: WeakFit,
        (best, seen): (&mut Option<Iteration>, &mut BTreeSet<Vec<usize>>),
        watcher: &mut EquationObserver,
    ) {
        if !seen.insert(found.support.clone()) {
            return;
        }
        let mut own = weak.clone();
        for round in 0..WEAK_FORM.max_iterations {
            if watcher.at(Stage::Evaluating).is_some() {
                return;
            }
            let pairs = found.pairs.iter();
            let belief: Vec<(f64, Term)> = pairs.map(|(j, a)| (*a, self.term(*j))).collect();
            if own.refine(&belief, WEAK_FORM.slack, self.library).is_err() {
                return;
            }
            let Some(whitened) = own.whitened(&belief, WEAK_FORM.slack) else {
                return;
            };
            let next = self.choose(&whitened, 1.0, watcher);
            let same = next.support == found.support;
            let settled = match same {
                true => round > 0,
                false => !seen.insert(next.support.clone()),
            };
            if best.as_ref().is_none_or(|b| next.value < b.found.value) {
                *best = Some(Iteration {
                    left: next.left / own.rows().max(1) as f64,
                    own: own.clone(),
                    whitened,
                    found: next.clone(),
                });
            }
            found = next;
            if settled {
                return;
            }
        }
    }

    /// Selects terms where each costs `penalty_factor` times what the criterion says.
    fn choose(
        &self,
        whitened: &Whitened,
        penalty_factor: f64,
        watcher: &mut EquationObserver,
    ) -> WeakFit {
        let phi = &whitened.columns;
        let mut criterion = InformationCriterion::new(
            phi.rows(),
            1.0,
            self.library.len(),
            WEAK_FORM.error_floor * WEAK_FORM.error_floor,
        );
        criterion.per_term *= penalty_factor;
        let proposals = if phi.cols() > TERM_SELECTION.exhaustive_columns {
            let problem = Problem {
                dictionary: phi,
                target: &whitened.target,
                tolerance: (phi.rows() as f64).sqrt(),
            };
            self.options.solver.solve(&problem, watcher).coefficients
        } else {
            Vec::new()
        };
        let selection = term_selection::select_terms(
            phi,
            &whitened.target,
            &proposals,
            (criterion, self.library.required()),
            watcher.during(Stage::Choosing),
        );
        let polished = solve::refit(phi, &whitened.target, &selection.support);
        let terms = selection.support.len() as f64;
        let columns = selection.support.iter().copied();
        let left = polished.residual.powi(2);
        WeakFit {
            left,
            value: left + criterion.per_term * terms,
            pairs: columns.zip(polished.coefficients).collect(),
            support: selection.support,
        }
    }

    /// The design matrix with rows whitened by an equation that was found; `None` if there are no rows.
    pub fn design_about(
        &self,
        names: &Discovery,
        equation: &Equation,
        watcher: &mut EquationObserver,
    ) -> Option<Design> {
        let weak = match self.options.method {
            Method::Weak => self.weak_form().ok()?,
            _ => None,
        };
        let Some(mut weak) = weak else {
            return self.design(names, watcher).ok()?.ok();
        };
        let found = equation.terms.iter().filter(|t| !t.fixed);
        let belief: Vec<(f64, Term)> = found.map(|t| (t.coefficient, t.term.clone())).collect();
        weak.refine(&belief, WEAK_FORM.slack, self.library).ok()?;
        let whitened = weak.whitened(&belief, WEAK_FORM.slack)?;
        self.weak_design(&weak, whitened)
    }

    /// The problem of whitened rows; `None` if the target is zero.
    pub fn weak_design(&self, weak: &Weak, whitened: Whitened) -> Option<Design> {
        let rows = weak.rows();
        let size = rms(&whitened.target);
        if size == 0.0 || !size.is_finite() {
            return None;
        }
        let weights = Weights::known(rows, WEAK_FORM.error_floor);
        let basis = RowKind::Integrals {
            rows,
            reach: weak.reach(),
        };
        Some(Design::new(
            basis,
            weights,
            Box::new(whitened.columns),
            whitened.target,
        ))
    }
}

/// The row of a trajectory that is nearest to a time.
fn nearest(samples: &Samples, trajectory: u32, time: f64) -> usize {
    let rows = samples.trajectory.iter().zip(&samples.time).enumerate();
    let own = rows.filter(|(_, (t, _))| **t == trajectory);
    let apart = own.map(|(row, (_, at))| (row, (at - time).abs()));
    let nearest = apart.min_by(|a, b| a.1.total_cmp(&b.1));
    nearest.map_or(0, |(row, _)| row)
}
