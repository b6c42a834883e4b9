//! How well a model describes the readings, so that it can be compared with another model of the same readings.
//!
//! In: the fit of a model's laws. Out: its criterion, with what that rests on. Compares; decides nothing.

use crate::joint::joint_fit::{JointFit, unexplained};
use crate::selection::thresholds::TERM_SELECTION;
use crate::trajectory;
use sidc_progress::Observer;

/// What the criterion says of a model's laws.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Description {
    /// −2 log likelihood with the price of all that was estimated, if every reading counts.
    criterion: f64,
    /// Whether the likelihood is that of innovations, as it is where disturbances drive the laws.
    disturbed: bool,
    /// The criterion by innovations of laws that nothing else drives, where it may be asked for.
    by_innovations: Option<f64>,
    /// Number of readings.
    readings: f64,
    /// Readings for each that counts (statistical inefficiency of the residuals).
    inefficiency: f64,
    /// Whether the laws leave more than the noise of the sensors.
    pub unexplained: bool,
}

impl Description {
    /// Of a fit that estimated `constants` inside terms as well.
    pub(crate) fn of(fit: &JointFit, constants: usize, observer: &mut dyn Observer) -> Description {
        let (problem, found) = (&fit.problem, &fit.found);
        let readings = problem.measurements() as f64;
        let runs = problem.runs().len();
        let delays = fit.late.as_ref().map_or(0, |late| late.inputs.len());
        let hidden = problem.system.hidden.len() * runs;
        let beside = (constants + delays + hidden) as f64 * trajectory::term_price(readings);
        let disturbed = found.best.process().is_some();
        let unexplained = unexplained(problem, &found.best);
        let asked = !disturbed && (unexplained || !problem.system.hidden.is_empty());
        let by_innovations =
            asked.then(|| trajectory::value_by_innovations(problem, found, observer));
        Description {
            criterion: found.value_of_all_readings(problem) + beside,
            disturbed,
            by_innovations: by_innovations.flatten().map(|value| value + beside),
            readings,
            inefficiency: found.inefficiency,
            unexplained,
        }
    }

    /// Whether something else drives the laws.
    pub fn is_disturbed(&self) -> bool {
        self.disturbed
    }

    /// Whether the laws leave more than the noise of the sensors, or something else drives them.
    pub fn leaves_more_than_noise(&self) -> bool {
        self.unexplained || self.disturbed
    }

    /// Whether the criterion prefers this to another by more than a tie.
    pub fn is_better_than(&self, other: &Description) -> bool {
        self.gain_over(other) > TERM_SELECTION.tie
    }

    /// By how much the criterion prefers this to another. Both criteria are scaled to the smaller number of readings and divided by the
    /// inefficiency of this fit. −∞ where they cannot be compared.
    pub fn gain_over(&self, other: &Description) -> f64 {
        let shared = self.readings.min(other.readings);
        let innovations = self.disturbed || other.disturbed;
        let each = |d: &Description| {
            let value = match innovations && !d.disturbed {
                true => d.by_innovations?,
                false => d.criterion,
            };
            Some(value * shared / d.readings.max(1.0))
        };
        let (Some(own), Some(others)) = (each(self), each(other)) else {
            return f64::NEG_INFINITY;
        };
        (others - own) / self.inefficiency.max(1.0)
    }
}
