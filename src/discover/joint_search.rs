//! The search of all equations together, and what is searched again once a first answer shows what the sensors did.
//!
//! In: a problem, options. Out: the problem as it was in the end, and what was found in it. Knows no words.

use std::borrow::Cow;

use super::Options;
use super::watch::{Stage, Watcher};
use crate::trajectory::{self, Found, Problem};

/// Searches until the readings left out no longer change, at most.
const ROUNDS: usize = 3;

/// The problem in the end, and the answer to it.
pub(super) struct Settled<'a> {
    pub problem: Cow<'a, Problem>,
    pub found: Found,
}

/// `None` if no support could be fitted at all.
pub(super) fn settle<'a>(
    problem: &'a Problem,
    options: &Options,
    watcher: &mut Watcher,
) -> Option<Settled<'a>> {
    let mut search = Search { watcher, at: 0 };
    let found = search.run(problem)?;
    let mut settled = Settled {
        problem: Cow::Borrowed(problem),
        found,
    };
    if options.robust {
        search.without_strays(&mut settled);
    }
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
            *settled = Settled {
                problem: Cow::Owned(next),
                found,
            };
        }
    }
}
