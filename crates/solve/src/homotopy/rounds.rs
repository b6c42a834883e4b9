//! Rounds of the working set: walk on the columns at hand, price all columns, take in those whose bounds are broken.
//!
//! In: a problem, its target of length one. Out: the end of the path with what it proves. Φ is only ever priced, never stored.

use sidc_progress::{Observer, SolverProgress};

use super::super::pool::Pool;
use super::super::{CONSISTENT, Status};
use super::centre::centre;
use super::path::{End, Goal, Path, Place, VIOLATION};
use crate::dictionary::{Dictionary, Strongest};

/// Columns of the first working set, and most that a round adds.
const FIRST: usize = 256;
const MORE: usize = 256;
/// Once a bound is broken, columns this near to theirs join too: the path is about to meet them.
const NEAR: f64 = 0.9;
/// Steps between two looks at all columns: as many as cost about what the look costs, within these bounds.
const STRIDE: (usize, usize) = (8, 64);
/// Largest correlation with what is left, of columns that cannot explain any of it.
const UNRELATED: f64 = 1e-9;

pub(super) struct Rounds<'a> {
    dictionary: &'a dyn Dictionary,
    pool: Pool<'a>,
    path: Path<'a>,
    round: usize,
    /// Worst of all columns when last priced.
    violation: f64,
    /// True from a restart until a column joins: a second one would change nothing.
    restarted: bool,
    /// The last place that no column speaks against: optimal for the residual it has.
    proved: Option<Place>,
}

impl<'a> Rounds<'a> {
    /// `target` is y/‖y‖, and the goal in its units. `None` if no column correlates with the target.
    pub fn new(
        dictionary: &'a dyn Dictionary,
        target: &'a [f64],
        goal: Goal,
    ) -> Option<Rounds<'a>> {
        let mut pool = Pool::new(dictionary);
        pool.add(columns(dictionary.strongest(target, FIRST, 0.0)));
        (pool.len() > 0).then(|| Rounds {
            dictionary,
            path: Path::new(target, goal, &pool),
            pool,
            round: 0,
            violation: 0.0,
            restarted: false,
            proved: None,
        })
    }

    pub fn steps(&self) -> usize {
        self.path.steps
    }

    /// τ
    pub fn level(&self) -> f64 {
        self.path.level()
    }

    /// How far the worst of all columns exceeded its bound when last priced.
    pub fn violation(&self) -> f64 {
        self.violation
    }

    /// Rounds until the last.
    pub fn run(&mut self, observer: &mut dyn Observer) -> (Place, Status) {
        loop {
            let (place, verdict) = self.play(observer);
            if let Some(status) = verdict {
                return (place, status);
            }
        }
    }

    /// Coefficients in raw units from those of unit columns.
    pub fn raw(&self, coefficients: &[(usize, f64)], size: f64) -> Vec<(usize, f64)> {
        self.pool.raw(coefficients, size)
    }

    /// Number of the column at a place of the pool.
    pub fn column(&self, place: usize) -> Option<usize> {
        self.pool.number(place)
    }

    /// One round; a status if it was the last.
    fn play(&mut self, observer: &mut dyn Observer) -> (Place, Option<Status>) {
        let apart = self.dictionary.cols() / (2 * self.pool.len());
        let place = self.walk(apart.clamp(STRIDE.0, STRIDE.1), observer);
        let look = match place.end {
            End::Interrupted | End::Lost => Look::Stays,
            _ => self.look(&place),
        };
        let verdict = match look {
            Look::Changed => None,
            Look::Stays => verdict(&place),
            Look::Fails => Some(inaccurate(&place)),
        };
        match (&verdict, &self.proved) {
            // What was found last holds for the columns at hand; what was proved before, for all.
            (Some(Status::Interrupted | Status::Inaccurate { .. }), Some(proved)) => {
                (proved.clone(), verdict)
            }
            (None, _) if self.violation <= VIOLATION && place.end == End::Due => {
                self.proved = Some(place.clone());
                (place, verdict)
            }
            _ => (place, verdict),
        }
    }

    /// λ off the bounds that an answer with ε = 0 does not need, or as it is where columns outside the pool do not allow it.
    pub fn centred(&self, place: &Place) -> Vec<f64> {
        let exact =
            place.end == End::Reached && place.residual <= CONSISTENT && self.path.is_exact();
        let centred = exact.then(|| centre(&self.pool, place)).flatten();
        let holds =
            |lambda: &Vec<f64>| self.dictionary.strongest(lambda, 1, 1.0 + VIOLATION).count == 0;
        centred
            .filter(holds)
            .unwrap_or_else(|| place.lambda.clone())
    }

    /// At most `stride` steps.
    pub fn walk(&mut self, stride: usize, observer: &mut dyn Observer) -> Place {
        self.round += 1;
        let (round, violation) = (self.round, self.violation);
        let mut iteration = self.path.steps;
        self.path.walk(&self.pool, stride, &mut |gap, residual| {
            iteration += 1;
            let progress = SolverProgress {
                round,
                iteration,
                gap,
                residual,
                violation,
            };
            progress.tell(observer).is_continue()
        })
    }

    /// Prices all columns; where bounds are broken, the path is taken back.
    pub fn look(&mut self, place: &Place) -> Look {
        let new = self.pool.len();
        let priced = self.price(place);
        let broken = priced.count > 0;
        if self.pool.add(columns(priced)) > 0 {
            self.restarted = false;
            self.path.rewind(&self.pool, new);
            return Look::Changed;
        }
        // Bounds of columns at hand are broken only where a path was taken up too late.
        let astray = broken && place.end != End::Due;
        match (astray, self.restarted) {
            (false, _) => Look::Stays,
            (true, true) => Look::Fails,
            (true, false) => {
                self.restarted = true;
                self.path.restart(&self.pool);
                Look::Changed
            }
        }
    }

    /// Columns that would change the path: those that explain what is left, where the path is stuck, and those whose bounds
    /// λ breaks.
    fn price(&mut self, place: &Place) -> Strongest {
        if place.end == End::Stuck {
            let related = self.dictionary.strongest(&place.rest, MORE, UNRELATED);
            if related.columns.iter().any(|(j, _)| !self.pool.has(*j)) {
                return related;
            }
        }
        let priced = self.dictionary.strongest(&place.lambda, MORE, NEAR);
        self.violation = (priced.largest() - 1.0).max(0.0);
        if self.violation > VIOLATION {
            priced
        } else {
            Strongest::default()
        }
    }
}

/// What a look at all columns showed.
pub(super) enum Look {
    /// The path is another now.
    Changed,
    Stays,
    /// Rounding keeps bounds broken.
    Fails,
}

fn verdict(place: &Place) -> Option<Status> {
    match place.end {
        End::Due => None,
        End::Reached => Some(Status::Solved),
        End::Stuck if place.residual <= CONSISTENT => Some(Status::Solved),
        End::Stuck => Some(Status::Inconsistent {
            residual: place.residual,
        }),
        End::Lost => Some(inaccurate(place)),
        End::Interrupted => Some(Status::Interrupted),
    }
}

fn inaccurate(place: &Place) -> Status {
    Status::Inaccurate {
        gap: f64::INFINITY,
        residual: place.residual,
    }
}

fn columns(found: Strongest) -> impl Iterator<Item = usize> {
    found.columns.into_iter().map(|(j, _)| j)
}
