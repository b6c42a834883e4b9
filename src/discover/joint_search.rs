//! The search of all equations together, and what is searched again once a first answer shows what the sensors did.
//!
//! In: a problem, options. Out: the problem as it was in the end, and what was found in it. Knows no words.

use std::borrow::Cow;

use super::Options;
use super::joint_doubts;
use super::watch::{Stage, Watcher};
use crate::lang::model::{Model, VarKind};
use crate::term::VarId;
use crate::trajectory::{self, Fit, Found, Guide, Late, Law, Offset, Problem};

/// Searches until the readings left out no longer change, at most.
const ROUNDS: usize = 3;
/// Looks for a delay: the first answer, found without it, may not tell it exactly.
const DELAYS: usize = 2;
/// Gain a reading of a delay that terms are searched with before it is known what those without it explain.
const PLAIN: f64 = 0.05;
/// Terms up to which offsets are looked for: each costs fits.
const MOST: usize = 24;

/// The problem in the end, and the answer to it.
pub(super) struct Settled<'a> {
    pub problem: Cow<'a, Problem>,
    pub found: Found,
    /// Inputs that act at other times than recorded; the problem has them moved.
    pub late: Option<Late>,
    /// A sensor's offset that would explain terms.
    pub offset: Option<Offset>,
}

impl<'a> Settled<'a> {
    fn new(problem: Cow<'a, Problem>, found: Found, late: Option<Late>) -> Settled<'a> {
        Settled {
            problem,
            found,
            late,
            offset: None,
        }
    }
}

/// `None` if no support could be fitted at all.
pub(super) fn settle<'a>(
    model: &Model,
    problem: &'a Problem,
    options: &Options,
    watcher: &mut Watcher,
) -> Option<Settled<'a>> {
    let mut search = Search { watcher, at: 0 };
    let inputs = inputs(model, problem);
    let mut settled = search.first(problem, &inputs)?;
    if options.robust {
        search.without_strays(&mut settled);
    }
    search.with_delay(&inputs, &mut settled);
    if options.robust && settled.late.is_some() {
        search.without_strays(&mut settled);
    }
    settled.offset = search.offset(&settled);
    Some(settled)
}

struct Search<'a, 'w> {
    watcher: &'a mut Watcher<'w>,
    at: usize,
}

/// Looks at a search's first fit, and ends the search if a delay of inputs explains what that leaves.
struct Look<'s, 'a, 'w> {
    search: &'s mut Search<'a, 'w>,
    inputs: &'s [VarId],
    laws: &'s [Law],
    late: Option<Late>,
}

impl Guide for Look<'_, '_, '_> {
    fn go_on(&mut self) -> bool {
        self.search.go_on(self.laws)
    }

    fn in_time(&mut self) -> bool {
        self.search.in_time()
    }

    fn first(&mut self, problem: &Problem, fit: &Fit) -> bool {
        if unexplained(problem, fit) {
            let late = self.search.delay(problem, fit, self.inputs);
            let enough = PLAIN * problem.measurements() as f64;
            self.late = late.filter(|l| l.gain > enough);
        }
        self.late.is_none()
    }
}

/// A search to its end.
struct Plain<'s, 'a, 'w> {
    search: &'s mut Search<'a, 'w>,
    laws: &'s [Law],
}

impl Guide for Plain<'_, '_, '_> {
    fn go_on(&mut self) -> bool {
        self.search.go_on(self.laws)
    }

    fn in_time(&mut self) -> bool {
        self.search.in_time()
    }
}

impl Search<'_, '_> {
    fn go_on(&mut self, laws: &[Law]) -> bool {
        // The work is for all of them: each in turn is named.
        self.watcher.turn_to(laws[self.at % laws.len()].equation);
        self.at += 1;
        self.watcher.at(Stage::Refitting(self.at)).is_none()
    }

    fn in_time(&mut self) -> bool {
        self.watcher.at(Stage::Refitting(self.at)).is_none()
    }

    fn run(&mut self, problem: &Problem) -> Option<Found> {
        let mut plain = Plain {
            search: self,
            laws: &problem.system.laws,
        };
        trajectory::search(problem, &mut plain)
    }

    /// The first answer. Under an input that acts at another time a search piles up terms that make up for it: if already the
    /// first few leave more than noise, a delay is looked for, and terms are searched with it.
    fn first<'a>(&mut self, problem: &'a Problem, inputs: &[VarId]) -> Option<Settled<'a>> {
        let mut late: Option<Late> = None;
        let mut moved = Cow::Borrowed(problem);
        for _ in 0..DELAYS {
            let mut look = Look {
                search: self,
                inputs,
                laws: &problem.system.laws,
                late: None,
            };
            let found = trajectory::search(&moved, &mut look);
            let Some(more) = look.late else {
                return self.if_better(problem, Settled::new(moved, found?, late));
            };
            let Some(sum) = together(late.as_ref(), more) else {
                break;
            };
            moved = Cow::Owned(trajectory::delayed(problem, &sum));
            late = Some(sum);
        }
        let found = self.run(&moved)?;
        self.if_better(problem, Settled::new(moved, found, late))
    }

    /// An answer with a delay that leaves more than noise is compared with one without.
    fn if_better<'a>(&mut self, problem: &'a Problem, settled: Settled<'a>) -> Option<Settled<'a>> {
        let Some(late) = &settled.late else {
            return Some(settled);
        };
        if !unexplained(&settled.problem, &settled.found.best) || self.watcher.stop().is_some() {
            return Some(settled);
        }
        let Some(found) = self.run(problem) else {
            return Some(settled);
        };
        let without = trajectory::undelayed(problem, &found.best, late, &mut || self.in_time());
        if without - settled.found.best.value >= settled.found.penalty {
            return Some(settled);
        }
        Some(Settled::new(Cow::Borrowed(problem), found, None))
    }

    /// The delay under which the likelihood of few terms gains most.
    fn delay(&mut self, problem: &Problem, fit: &Fit, inputs: &[VarId]) -> Option<Late> {
        if inputs.is_empty() {
            return None;
        }
        let mut go_on = || self.in_time();
        let proposals = trajectory::proposals(problem, fit.support(), inputs, &mut go_on);
        trajectory::delay(problem, fit, &proposals, &mut go_on)
    }

    /// Leaves out what the laws found do not explain, and searches again.
    fn without_strays(&mut self, settled: &mut Settled) {
        for _ in 0..ROUNDS {
            if self.watcher.stop().is_some() {
                return;
            }
            let Some(next) = trajectory::leave_out(&settled.problem, &settled.found.best) else {
                return;
            };
            let Some(found) = self.run(&next) else {
                return;
            };
            settled.problem = Cow::Owned(next);
            settled.found = found;
        }
    }

    /// An offset is a rival of laws that explain everything; of others nothing is known.
    fn offset(&mut self, settled: &Settled) -> Option<Offset> {
        let best = &settled.found.best;
        if best.support().len() > MOST || unexplained(&settled.problem, best) {
            return None;
        }
        trajectory::offset(&settled.problem, best, &mut || self.in_time())
    }

    /// Moves inputs in time where that explains what is left, and searches again.
    fn with_delay(&mut self, inputs: &[VarId], settled: &mut Settled) {
        if inputs.is_empty() || !unexplained(&settled.problem, &settled.found.best) {
            return;
        }
        let (whole, known) = (settled.problem.clone(), settled.late.clone());
        let mut moved: Option<Late> = None;
        for _ in 0..DELAYS {
            let (problem, best) = (&settled.problem, &settled.found.best);
            let Some(more) = self.delay(problem, best, inputs) else {
                return;
            };
            let before = trajectory::undelayed(problem, best, &more, &mut || self.in_time());
            let more = Late { gain: 0.0, ..more };
            let Some(mut late) = together(moved.as_ref(), more) else {
                return;
            };
            let next = trajectory::delayed(&whole, &late);
            let Some(found) = self.run(&next) else {
                return;
            };
            let gain = before - found.best.value;
            late.gain += gain;
            let sum = match &known {
                None => Some(late.clone()),
                Some(known) => together(Some(known), late.clone()),
            };
            if gain < found.penalty || sum.is_none() {
                return;
            }
            *settled = Settled::new(Cow::Owned(next), found, sum);
            moved = Some(late);
        }
    }
}

/// Two delays one after the other; nothing if they are of different inputs or cancel.
fn together(before: Option<&Late>, more: Late) -> Option<Late> {
    let Some(before) = before else {
        return Some(more);
    };
    let samples = before.samples + more.samples;
    (before.inputs == more.inputs && samples != 0.0).then_some(Late {
        samples,
        seconds: before.seconds + more.seconds,
        gain: before.gain + more.gain,
        ..more
    })
}

/// Whether a fit leaves more than the noise of some sensor.
fn unexplained(problem: &Problem, fit: &Fit) -> bool {
    let channels = trajectory::channels(problem, fit);
    channels.iter().any(joint_doubts::unexplained)
}

/// Declared inputs that the problem's laws may contain and that move.
fn inputs(model: &Model, problem: &Problem) -> Vec<VarId> {
    let moves = |place: usize| {
        let columns = problem.records.iter().filter_map(|r| r.outside.get(place));
        let moving = |v: &[f64]| v.windows(2).any(|w| w[0] != w[1]);
        columns.into_iter().any(|o| moving(&o.values))
    };
    let signals = problem.system.outside.iter().enumerate();
    let mut found: Vec<VarId> = signals
        .filter(|(place, s)| {
            model.var(s.var).is_some_and(|v| v.kind == VarKind::Input) && moves(*place)
        })
        .map(|(_, s)| s.var)
        .collect();
    found.sort_unstable();
    found.dedup();
    found
}
