//! The search of all equations together, and what is searched again once a first answer shows what the sensors did.
//!
//! In: a problem, options. Out: the problem as it was in the end, and what was found in it. Knows no words.

use std::borrow::Cow;

use super::Options;
use super::joint_doubts;
use super::watch::{Stage, Watcher};
use crate::lang::model::{Model, VarKind};
use crate::term::VarId;
use crate::trajectory::{self, Found, Late, Offset, Problem};

/// Searches until the readings left out no longer change, at most.
const ROUNDS: usize = 3;
/// Searches for a delay: the first answer, found without it, may not tell it exactly.
const DELAYS: usize = 2;
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

/// `None` if no support could be fitted at all.
pub(super) fn settle<'a>(
    model: &Model,
    problem: &'a Problem,
    options: &Options,
    watcher: &mut Watcher,
) -> Option<Settled<'a>> {
    let mut search = Search { watcher, at: 0 };
    let found = search.run(problem)?;
    let mut settled = Settled {
        problem: Cow::Borrowed(problem),
        found,
        late: None,
        offset: None,
    };
    if options.robust {
        search.without_strays(&mut settled);
    }
    search.with_delay(model, &mut settled);
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

impl Search<'_, '_> {
    fn run(&mut self, problem: &Problem) -> Option<Found> {
        let laws = &problem.system.laws;
        trajectory::search(problem, &mut || {
            // The work is for all of them: each in turn is named.
            self.watcher.turn_to(laws[self.at % laws.len()].equation);
            self.at += 1;
            self.watcher.at(Stage::Refitting(self.at)).is_none()
        })
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
        let channels = trajectory::channels(&settled.problem, best);
        if best.support().len() > MOST || channels.iter().any(joint_doubts::unexplained) {
            return None;
        }
        let mut go_on = || self.watcher.at(Stage::Refitting(self.at)).is_none();
        trajectory::offset(&settled.problem, best, &mut go_on)
    }

    /// Moves inputs in time where that explains what is left, and searches again.
    fn with_delay(&mut self, model: &Model, settled: &mut Settled) {
        let inputs = inputs(model, &settled.problem);
        let channels = trajectory::channels(&settled.problem, &settled.found.best);
        if inputs.is_empty() || !channels.iter().any(joint_doubts::unexplained) {
            return;
        }
        let whole = settled.problem.clone();
        for _ in 0..DELAYS {
            let mut go_on = || self.watcher.at(Stage::Refitting(self.at)).is_none();
            let (problem, best) = (&settled.problem, &settled.found.best);
            let Some(more) = trajectory::delay(problem, best, &inputs, &mut go_on) else {
                return;
            };
            let late = match &settled.late {
                None => more,
                Some(before) if before.inputs == more.inputs => Late {
                    samples: before.samples + more.samples,
                    seconds: before.seconds + more.seconds,
                    gain: before.gain + more.gain,
                    ..more
                },
                Some(_) => return,
            };
            let next = trajectory::delayed(&whole, &late);
            let Some(found) = self.run(&next) else {
                return;
            };
            *settled = Settled {
                problem: Cow::Owned(next),
                found,
                late: Some(late),
                offset: None,
            };
        }
    }
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
