//! Column generation for the Lasso path: follow the path on the working set, price all columns, add those that violate their bounds.
//!
//! In: a dictionary, a target of length one. Out: the end of the path with its status. Φ is only priced, never stored.

use sidc_progress::{Observer, SolverProgress};

use super::interior_dual::interior_dual;
use super::path::{Goal, Path, PathPoint, Stop};
use super::working_set::WorkingSet;
use crate::dictionary::{Dictionary, Priced};
use crate::problem::Status;
use crate::thresholds::{CERTIFICATES, HOMOTOPY};

/// A path, its working set, and what pricing showed last.
pub(super) struct ColumnGeneration<'a> {
    dictionary: &'a dyn Dictionary,
    set: WorkingSet<'a>,
    path: Path<'a>,
    round: usize,
    /// Largest excess over a bound when all columns were last priced.
    violation: f64,
    /// True from a restart until a column enters: a second restart would change nothing.
    restarted: bool,
    /// The last point that no column violates: optimal for its residual.
    optimal: Option<PathPoint>,
}

impl<'a> ColumnGeneration<'a> {
    /// `target` is y/‖y‖, and the goal in its units. `None` if no column correlates with the target.
    pub fn new(
        dictionary: &'a dyn Dictionary,
        target: &'a [f64],
        goal: Goal,
    ) -> Option<ColumnGeneration<'a>> {
        let mut set = WorkingSet::new(dictionary);
        set.add(indices(first_columns(dictionary, target)));
        (set.len() > 0).then(|| ColumnGeneration {
            dictionary,
            path: Path::new(target, goal, &set),
            set,
            round: 0,
            violation: 0.0,
            restarted: false,
            optimal: None,
        })
    }

    pub fn steps(&self) -> usize {
        self.path.steps
    }

    /// τ
    pub fn penalty(&self) -> f64 {
        self.path.penalty()
    }

    /// Largest excess over a bound when all columns were last priced.
    pub fn violation(&self) -> f64 {
        self.violation
    }

    /// Rounds until the path ends.
    pub fn run(&mut self, observer: &mut dyn Observer) -> (PathPoint, Status) {
        loop {
            let (point, status) = self.round(observer);
            if let Some(status) = status {
                return (point, status);
            }
        }
    }

    /// Coefficients in raw units from those of unit columns.
    pub fn raw(&self, coefficients: &[(usize, f64)], target_norm: f64) -> Vec<(usize, f64)> {
        self.set.raw(coefficients, target_norm)
    }

    /// Index in the dictionary of a column of the working set.
    pub fn column(&self, place: usize) -> Option<usize> {
        self.set.index(place)
    }

    /// One round; a status if it was the last.
    pub fn round(&mut self, observer: &mut dyn Observer) -> (PathPoint, Option<Status>) {
        // As many steps as cost about what pricing costs.
        let stride = self.dictionary.cols() / (2 * self.set.len());
        let point = self.advance(
            stride.clamp(HOMOTOPY.min_stride, HOMOTOPY.max_stride),
            observer,
        );
        let pricing = match point.stop {
            Stop::Interrupted | Stop::Breakdown => Pricing::PathStays,
            _ => self.price_all(&point),
        };
        let status = match pricing {
            Pricing::PathChanged => None,
            Pricing::PathStays => final_status(&point),
            Pricing::Breakdown => Some(inaccurate(&point)),
        };
        match (&status, &self.optimal) {
            // The last point is optimal over the working set only; the one before, over all columns.
            (Some(Status::Interrupted | Status::Inaccurate { .. }), Some(optimal)) => {
                (optimal.clone(), status)
            }
            (None, _) if self.violation <= HOMOTOPY.violation && point.stop == Stop::PricingDue => {
                self.optimal = Some(point.clone());
                (point, status)
            }
            _ => (point, status),
        }
    }

    /// λ in the interior of the optimal face, for an answer with ε = 0; λ as it is where no column off the support
    /// allows that.
    pub fn interior_dual(&self, point: &PathPoint) -> Vec<f64> {
        let exact = point.stop == Stop::Goal
            && point.residual <= CERTIFICATES.consistent
            && self.path.is_exact();
        let feasible = |lambda: &[f64]| {
            self.dictionary
                .price(lambda, 1, 1.0 + HOMOTOPY.violation)
                .is_empty()
        };
        let interior = exact.then(|| interior_dual(&self.set, point, &feasible));
        interior.flatten().unwrap_or_else(|| point.lambda.clone())
    }

    /// At most `stride` steps.
    pub fn advance(&mut self, stride: usize, observer: &mut dyn Observer) -> PathPoint {
        self.round += 1;
        let (round, violation) = (self.round, self.violation);
        let mut iteration = self.path.steps;
        self.path.advance(&self.set, stride, &mut |gap, residual| {
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

    /// Prices all columns. Where bounds are violated, the path is taken back.
    pub fn price_all(&mut self, point: &PathPoint) -> Pricing {
        let new = self.set.len();
        let priced = self.violating(point);
        let violated = !priced.is_empty();
        if self.set.add(indices(priced)) > 0 {
            self.restarted = false;
            self.path.rewind(&self.set, new);
            return Pricing::PathChanged;
        }
        // Columns of the working set violate their bounds only where the path continued from too late a knot.
        let too_late = violated && point.stop != Stop::PricingDue;
        match (too_late, self.restarted) {
            (false, _) => Pricing::PathStays,
            (true, true) => Pricing::Breakdown,
            (true, false) => {
                self.restarted = true;
                self.path.restart(&self.set);
                Pricing::PathChanged
            }
        }
    }

    /// Columns that would change the path: those that correlate with the unexplained part, where no active column does, and those
    /// whose bounds λ violates.
    fn violating(&mut self, point: &PathPoint) -> Priced {
        if point.stop == Stop::ResidualOrthogonal {
            let related = self.dictionary.price(
                &point.unexplained,
                HOMOTOPY.added_columns,
                HOMOTOPY.unrelated,
            );
            if related.columns.iter().any(|(j, _)| !self.set.contains(*j)) {
                return related;
            }
        }
        let priced =
            self.dictionary
                .price(&point.lambda, HOMOTOPY.added_columns, HOMOTOPY.near_bound);
        self.violation = (priced.largest() - 1.0).max(0.0);
        if self.violation > HOMOTOPY.violation {
            priced
        } else {
            Priced::default()
        }
    }
}

/// The columns that correlate most with the target. Bounds spare those that their grade dismisses; the largest correlation is that of
/// the first column whatever the bound.
fn first_columns(dictionary: &dyn Dictionary, target: &[f64]) -> Priced {
    let price = |bound| dictionary.price(target, HOMOTOPY.initial_columns, bound);
    let bounds = [HOMOTOPY.initial_bound, 0.0].into_iter().map(price);
    let found = bounds.into_iter().find(|found| !found.is_empty());
    found.unwrap_or_default()
}

/// What pricing all columns showed.
pub(super) enum Pricing {
    /// Columns entered, and the path was taken back.
    PathChanged,
    PathStays,
    /// Bounds stay violated by rounding.
    Breakdown,
}

fn final_status(point: &PathPoint) -> Option<Status> {
    match point.stop {
        Stop::PricingDue => None,
        Stop::Goal => Some(Status::Solved),
        Stop::ResidualOrthogonal if point.residual <= CERTIFICATES.consistent => {
            Some(Status::Solved)
        }
        Stop::ResidualOrthogonal => Some(Status::Inconsistent {
            residual: point.residual,
        }),
        Stop::Breakdown => Some(inaccurate(point)),
        Stop::Interrupted => Some(Status::Interrupted),
    }
}

fn inaccurate(point: &PathPoint) -> Status {
    Status::Inaccurate {
        gap: f64::INFINITY,
        residual: point.residual,
    }
}

fn indices(found: Priced) -> impl Iterator<Item = usize> {
    found.columns.into_iter().map(|(j, _)| j)
}
