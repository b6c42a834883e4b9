//! The search of terms that hold unknown constants: terms at given values of the constants, then the likeliest values for these terms and
//! for others, in turn.
//!
//! In: a model, its libraries, a dataset, the problem, where the constants may start. Out: what the search ended with, at which values. Without
//! unknown constants it is one search.

use std::borrow::Cow;

use crate::joint::constrained_search::{
    ConstrainedAnswer, SearchOutcome, search_under_constraints,
};
use crate::joint::delay_outlier_search::search_terms;
use crate::joint::disturbances::with_disturbances;
use crate::joint::joint_fit::{JointFit, unexplained};
use crate::joint::unknown_constants::Constants;
use crate::joint::weak_start::weak_start;
use crate::options::Options;
use crate::selection::thresholds::TERM_SELECTION;
use crate::trajectory::{
    CONSTANTS, FittedConstants, Found, HIDDEN, Problem, Rival, StartingSupport,
};
use sidc_data::Dataset;
use sidc_lang::library::Library;
use sidc_lang::model::Model;
use sidc_progress::EquationObserver;

/// Terms with their constants.
pub(crate) struct Searched<'a> {
    pub outcome: SearchOutcome<'a>,
    pub constants: Constants,
    /// Constants at other ends of the search whose answer has the same terms and is as good.
    pub twins: Vec<Constants>,
}

impl<'a> Searched<'a> {
    pub fn new(outcome: SearchOutcome<'a>, constants: Constants) -> Searched<'a> {
        Searched {
            outcome,
            constants,
            twins: Vec::new(),
        }
    }
}

/// Searches from each start and returns the best result.
pub(crate) fn search_with_constants<'a>(
    of: (&'a Model, &'a [Option<Library>]),
    data: (&'a Dataset, &'a Problem),
    starts: Vec<Constants>,
    options: &'a Options,
    watcher: &mut EquationObserver,
) -> Option<Searched<'a>> {
    let mut all: Vec<Searched> = Vec::new();
    let search = ConstantSearch { of, data, options };
    for start in starts {
        all.push(search.search_from(start, watcher));
        if watcher.stop().is_some() {
            break;
        }
    }
    all.sort_by(|a, b| a.value().total_cmp(&b.value()));
    let mut all = all.into_iter();
    let mut best = all.next()?;
    let others: Vec<Searched> = all.collect();
    best.add_rivals_of(&others);
    best.twins = others
        .into_iter()
        .filter(|other| other.is_twin_of(&best))
        .map(|other| other.constants)
        .collect();
    Some(best)
}

/// A short search from each start, and the best of them: it shows how well a model can describe the readings. Terms are searched at the
/// start values of constants and hidden states, then once more, as deeply as `depth` says, at the likeliest constants for these terms.
pub(crate) fn sketch_with_constants<'a>(
    of: (&'a Model, &'a [Option<Library>]),
    data: (&'a Dataset, &'a Problem),
    (starts, scope): (Vec<Constants>, SearchScope),
    options: &'a Options,
    watcher: &mut EquationObserver,
) -> Option<Searched<'a>> {
    let search = ConstantSearch { of, data, options };
    let mut sketches = Vec::new();
    for start in starts {
        sketches.push(search.sketch(start, scope, watcher));
        if watcher.stop().is_some() {
            break;
        }
    }
    let sketches = sketches.into_iter();
    sketches.min_by(|a, b| a.value().total_cmp(&b.value()))
}

impl Searched<'_> {
    /// Whether the readings are followed as well by the same terms with other constants.
    fn is_twin_of(&self, best: &Searched) -> bool {
        let (SearchOutcome::Answer(own), SearchOutcome::Answer(other)) =
            (&self.outcome, &best.outcome)
        else {
            return false;
        };
        let (own, other) = (&own.fit.found, &other.fit.found);
        let tie = TERM_SELECTION.tie * other.inefficiency;
        own.best.converged
            && own.best.support() == other.best.support()
            && own.best.value < other.best.value + tie
            && !self.constants.is_at(&best.constants)
    }

    /// Adds what searches from other starts found to the rivals.
    fn add_rivals_of(&mut self, others: &[Searched]) {
        let SearchOutcome::Answer(own) = &mut self.outcome else {
            return;
        };
        let found = &mut own.fit.found;
        for other in others {
            if let SearchOutcome::Answer(answer) = &other.outcome {
                let best = &answer.fit.found.best;
                let rival = Rival {
                    moves_constants: !other.constants.is_at(&self.constants),
                    ..Rival::new(best.support().to_vec(), best.value)
                };
                add_rival(found, rival);
            }
        }
        sort_rivals(found);
    }

    fn value(&self) -> f64 {
        match &self.outcome {
            SearchOutcome::Answer(a) => a.fit.found.best.value,
            _ => f64::INFINITY,
        }
    }
}

/// What a search of terms looks for besides them.
#[derive(Clone, Copy, PartialEq)]
pub enum SearchScope {
    /// Nothing else.
    Terms,
    /// Faults of sensors too: outliers, delays, offsets.
    Sensors,
    /// And what drives the laws besides their terms.
    Disturbances,
}

struct ConstantSearch<'a> {
    of: (&'a Model, &'a [Option<Library>]),
    data: (&'a Dataset, &'a Problem),
    options: &'a Options,
}

impl<'a> ConstantSearch<'a> {
    /// Searches terms at the present values of the constants. If another law near the answer, with its own likeliest constants, is better,
    /// the search is repeated at those, and so on. Sensor faults are looked for last, since a wrong constant looks like one.
    fn search_from(
        &self,
        mut constants: Constants,
        watcher: &mut EquationObserver,
    ) -> Searched<'a> {
        let (_, problem) = self.data;
        let system = &problem.system;
        let plain = system.constraints.is_empty() && system.hidden.is_empty();
        let mut careful = !plain || constants.sought().is_empty();
        let mut start = None;
        let mut known: Option<KnownLaws> = None;
        let mut round = 0;
        loop {
            let scope = if careful {
                SearchScope::Disturbances
            } else {
                SearchScope::Terms
            };
            let mut outcome = self.search_at(&constants, start.take(), scope, watcher);
            let SearchOutcome::Answer(answer) = &mut outcome else {
                return Searched::new(outcome, constants);
            };
            let laws = match known.take().filter(|k| k.is_of(&answer.fit)) {
                Some(known) => known.laws,
                None => {
                    let explained = !unexplained(&answer.fit.problem, &answer.fit.found.best);
                    let of = (answer.fit.problem.as_ref(), &answer.fit.found);
                    constants.laws_about(of, explained, watcher)
                }
            };
            round += 1;
            let last = round >= CONSTANTS.rounds || watcher.stop().is_some();
            let better = laws.first().filter(|l| improves(l, answer, &constants));
            if let Some(better) = better.filter(|_| !last) {
                start = Some(better.terms.clone());
                constants = constants.moved_to(better.constants.clone());
            } else if !careful && watcher.stop().is_none() {
                (careful, round) = (true, CONSTANTS.rounds - 2);
                start = Some(answer.fit.found.best.point.active());
                known = Some(KnownLaws::new(&answer.fit, laws));
            } else {
                add_rivals(answer, &laws);
                return Searched::new(outcome, constants);
            }
        }
    }

    /// Terms from a few guessed courses of the hidden states, then again at the likeliest constants for these terms.
    fn sketch(
        &self,
        constants: Constants,
        scope: SearchScope,
        watcher: &mut EquationObserver,
    ) -> Searched<'a> {
        let (dataset, problem) = self.data;
        let at = constants.started(problem, HIDDEN.courses_per_value, watcher);
        let acting = constants.dataset(dataset);
        let outcome = self.search_terms((&acting, &at), None, SearchScope::Terms, watcher);
        let SearchOutcome::Answer(answer) = outcome else {
            let outcome = SearchOutcome::Nothing;
            return Searched::new(outcome, constants);
        };
        let of = (answer.fit.problem.as_ref(), &answer.fit.found);
        let constants = constants.likeliest_in(of, watcher).unwrap_or(constants);
        let at = constants.problem(of.0);
        let acting = constants.dataset(dataset);
        let start = answer.fit.found.best.point.active();
        let outcome = self.search_terms((&acting, &at), Some(start), scope, watcher);
        let outcome = outcome.into_owned();
        Searched::new(outcome, constants)
    }

    /// One search of terms.
    fn search_at(
        &self,
        constants: &Constants,
        start: Option<StartingSupport>,
        scope: SearchScope,
        watcher: &mut EquationObserver,
    ) -> SearchOutcome<'a> {
        let (dataset, problem) = self.data;
        match constants.started(problem, HIDDEN.courses, watcher) {
            Cow::Borrowed(at) => self.search_terms((dataset, at), start, scope, watcher),
            Cow::Owned(at) => {
                let acting = constants.dataset(dataset);
                let outcome = self.search_terms((&acting, &at), start, scope, watcher);
                outcome.into_owned()
            }
        }
    }

    fn search_terms<'b>(
        &self,
        (dataset, problem): (&Dataset, &'b Problem),
        start: Option<StartingSupport>,
        scope: SearchScope,
        watcher: &mut EquationObserver,
    ) -> SearchOutcome<'b> {
        let (model, _) = self.of;
        let start = start.or_else(|| weak_start(self.of, dataset, problem, self.options, watcher));
        let of = (model, problem);
        if scope != SearchScope::Terms {
            let outcome = search_under_constraints(of, start, self.options, watcher);
            return match scope {
                SearchScope::Disturbances => with_disturbances(of, outcome, watcher),
                _ => outcome,
            };
        }
        match search_terms(problem, start, watcher) {
            None => SearchOutcome::Nothing,
            Some(fit) => SearchOutcome::Answer(Box::new(ConstrainedAnswer {
                fit,
                free: None,
                not_followed: Vec::new(),
            })),
        }
    }
}

/// The laws found near an answer, kept for a later search that ends in the same answer.
struct KnownLaws {
    laws: Vec<FittedConstants>,
    support: Vec<usize>,
    value: f64,
}

impl KnownLaws {
    fn new(fit: &JointFit, laws: Vec<FittedConstants>) -> KnownLaws {
        KnownLaws {
            laws,
            support: fit.found.best.support().to_vec(),
            value: fit.found.best.value,
        }
    }

    fn is_of(&self, fit: &JointFit) -> bool {
        let best = &fit.found.best;
        let near = (best.value - self.value).abs() <= CONSTANTS.settled;
        fit.late.is_none() && best.process().is_none() && best.support() == self.support && near
    }
}

/// Whether a law has other terms and a smaller criterion, or the same terms at clearly different constants: by more than ten times the
/// accuracy of their fit.
fn improves(law: &FittedConstants, answer: &ConstrainedAnswer, constants: &Constants) -> bool {
    let best = &answer.fit.found.best;
    if law.support() != best.support() {
        return law.value < best.value;
    }
    let values = constants.sought().iter().zip(&law.constants);
    let mut moved = values.zip(&law.standard_errors);
    moved.any(|((a, b), e)| (a.value - b.value).abs() > 10.0 * CONSTANTS.settled * e)
}

/// Adds laws with their own likeliest constants to the rivals, which were fitted at the constants of the answer.
fn add_rivals(answer: &mut ConstrainedAnswer, laws: &[FittedConstants]) {
    let found = &mut answer.fit.found;
    let own = laws.iter().find(|l| l.support() == found.best.support());
    for law in laws {
        let rival = Rival {
            support: law.support(),
            value: law.value,
            moves_constants: own.is_some_and(|own| own.excludes(&law.constants)),
        };
        add_rival(found, rival);
    }
    sort_rivals(found);
}

/// Adds a law to the rivals, in place of the same terms with a larger criterion.
fn add_rival(found: &mut Found, rival: Rival) {
    if rival.support == found.best.support() {
        return;
    }
    let mut known = found.rivals.iter_mut();
    match known.find(|r| r.support == rival.support) {
        Some(known) if known.value <= rival.value => {}
        Some(known) => *known = rival,
        None => found.rivals.push(rival),
    }
}

/// The answer first, then the best first.
fn sort_rivals(found: &mut Found) {
    let own = found.best.support().to_vec();
    let rank = |r: &Rival| (r.support != own, r.value);
    found.rivals.sort_by(|a, b| {
        let (a, b) = (rank(a), rank(b));
        a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
    });
}
