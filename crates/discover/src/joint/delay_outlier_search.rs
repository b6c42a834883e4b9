//! The joint search, repeated for faults of the sensors that a first answer shows: outliers, delayed inputs, offsets.
//!
//! In: a problem, options. Out: the corrected problem and the best fit to it. Never writes messages.

use crate::doubts::trajectory_rules;
use crate::joint::joint_fit::{JointFit, unexplained};
use crate::joint::thresholds::SENSOR_SEARCH;
use crate::joint::undeclared_delays::{refined_delay, undeclared};
use std::borrow::Cow;
use std::ops::ControlFlow;

use crate::options::Options;
use crate::trajectory;
use crate::trajectory::{
    DelayedInputs, Fit, Found, GrownNoise, Law, Problem, SearchObserver, SensorOffset,
    StartingSupport,
};
use sidc_lang::model::Model;
use sidc_lang::term::VarId;
use sidc_progress::{Activity, EquationObserver, Observer, Stage, Stop};

/// Searches all equations, for faults of sensors too. `None` if no support could be fitted.
pub(crate) fn search_system<'a>(
    (model, problem): (&Model, &'a Problem),
    start: Option<StartingSupport>,
    options: &Options,
    watcher: &mut EquationObserver,
) -> Option<JointFit<'a>> {
    watcher.during(Stage::Refitting(0));
    let mut search = DelayOutlierSearch {
        watcher,
        start: start.unwrap_or_default(),
        refits: 0,
    };
    let inputs = undeclared(model, problem);
    let mut fit = search.first(problem, &inputs)?;
    if options.robust {
        search.without_outliers(&mut fit);
    }
    search.with_delay(&inputs, &mut fit);
    search.within_a_sample(problem, &mut fit);
    search.lag_or_delay(problem, &mut fit);
    if options.robust && fit.late.is_some() {
        search.without_outliers(&mut fit);
    }
    if search.with_growing_noise(&mut fit) && options.robust {
        search.without_outliers(&mut fit);
    }
    search.with_lasting_noise(&mut fit);
    fit.offset = search.offset(&fit);
    Some(fit)
}

/// Searches all equations without looking for sensor faults.
pub(crate) fn search_terms<'a>(
    problem: &'a Problem,
    start: Option<StartingSupport>,
    watcher: &mut EquationObserver,
) -> Option<JointFit<'a>> {
    watcher.during(Stage::Refitting(0));
    let mut search = DelayOutlierSearch {
        watcher,
        start: start.unwrap_or_default(),
        refits: 0,
    };
    let found = search.run(problem)?;
    Some(JointFit::new(Cow::Borrowed(problem), found, None))
}

/// Searches under the constraints of the problem of `free`, starting from that fit.
pub(crate) fn search_from<'a>(
    free: &JointFit<'a>,
    watcher: &mut EquationObserver,
) -> Option<JointFit<'a>> {
    let laws = &free.problem.system.laws;
    let found = watched(laws, watcher, |guide| {
        trajectory::search_from_fit(&free.problem, &free.found, guide)
    })?;
    let late = free.late.clone();
    Some(JointFit::new(free.problem.clone(), found, late))
}

/// Searches laws with disturbances, from the fit without them if there is one. `gained`: what other explanations improve the criterion by,
/// which disturbances have to improve it by too. `None` if they do not.
pub(crate) fn search_with_disturbances<'a>(
    problem: &Problem,
    (free, gained): (Option<&JointFit>, f64),
    watcher: &mut EquationObserver,
) -> Option<JointFit<'a>> {
    let best = (free.map(|fit| &fit.found.best), gained);
    let (problem, found) = watched(&problem.system.laws, watcher, |guide| {
        trajectory::search_disturbed(problem, best, guide)
    })?;
    Some(JointFit::new(
        Cow::Owned(problem),
        found,
        free.and_then(|fit| fit.late.clone()),
    ))
}

/// Runs a search without looking for sensor faults.
fn watched<T>(
    laws: &[Law],
    watcher: &mut EquationObserver,
    search: impl FnOnce(&mut dyn SearchObserver) -> T,
) -> T {
    let mut searches = DelayOutlierSearch {
        watcher,
        start: StartingSupport::new(),
        refits: 0,
    };
    search(&mut SearchGuide {
        search: &mut searches,
        inputs: None,
        laws,
        late: None,
    })
}

struct DelayOutlierSearch<'a, 'w> {
    watcher: &'a mut EquationObserver<'w>,
    /// Where every search starts.
    start: StartingSupport,
    refits: usize,
}

/// Guides one search of supports. With `inputs`, ends it at the first fit if a delay of these explains the residuals.
struct SearchGuide<'s, 'a, 'w> {
    search: &'s mut DelayOutlierSearch<'a, 'w>,
    inputs: Option<&'s [VarId]>,
    laws: &'s [Law],
    late: Option<DelayedInputs>,
}

impl Observer for SearchGuide<'_, '_, '_> {
    fn hear(&mut self, activity: Activity) -> ControlFlow<Stop> {
        if let Activity::Stage(Stage::Refitting(_)) = activity {
            self.search.count_refit(self.laws);
        }
        self.search.watcher.hear(Activity::Working)
    }
}

impl SearchObserver for SearchGuide<'_, '_, '_> {
    fn first(&mut self, problem: &Problem, fit: &Fit) -> bool {
        if let Some(inputs) = self.inputs.filter(|_| unexplained(problem, fit)) {
            let late = self.search.delay(problem, fit, inputs);
            let enough = SENSOR_SEARCH.early_delay_gain * problem.measurements() as f64;
            self.late = late.filter(|l| l.gain > enough);
        }
        self.late.is_none()
    }

    fn left_by(&mut self, problem: &Problem, fit: &Fit) -> f64 {
        // Noisy inputs are declared, so the search for them is not ended by what it leaves.
        if problem.has_noisy_inputs() {
            return 0.0;
        }
        let channels = trajectory::channels(problem, fit);
        let left = channels.iter().map(trajectory_rules::left_over_noise);
        left.fold(0.0, f64::max)
    }
}

impl DelayOutlierSearch<'_, '_> {
    /// One search serves all laws at once, so progress names the laws in turn.
    fn count_refit(&mut self, laws: &[Law]) {
        self.watcher
            .set_equation(laws[self.refits % laws.len()].equation);
        self.refits += 1;
        self.watcher.during(Stage::Refitting(self.refits));
    }

    fn run(&mut self, problem: &Problem) -> Option<Found> {
        let start = self.start.clone();
        let mut guide = SearchGuide {
            search: self,
            inputs: None,
            laws: &problem.system.laws,
            late: None,
        };
        trajectory::search(problem, &start, &mut guide)
    }

    /// The first answer. Without a delay that is there, a search adds many terms to compensate for it. So if the first few terms leave more
    /// than noise, a delay is estimated at once and the search is repeated with it.
    fn first<'a>(&mut self, problem: &'a Problem, inputs: &[VarId]) -> Option<JointFit<'a>> {
        let mut late: Option<DelayedInputs> = None;
        let mut moved = Cow::Borrowed(problem);
        for _ in 0..SENSOR_SEARCH.delay_rounds {
            let start = self.start.clone();
            let mut guide = SearchGuide {
                search: self,
                inputs: Some(inputs),
                laws: &problem.system.laws,
                late: None,
            };
            let found = trajectory::search(&moved, &start, &mut guide);
            let Some(more) = guide.late else {
                return self.if_better(problem, JointFit::new(moved, found?, late));
            };
            let Some(sum) = together(late.as_ref(), more) else {
                break;
            };
            moved = Cow::Owned(trajectory::with_delay(problem, &sum));
            late = Some(sum);
        }
        let found = self.run(&moved)?;
        self.if_better(problem, JointFit::new(moved, found, late))
    }

    /// If an answer with a delay leaves more than noise, it has to beat the answer without the delay.
    fn if_better<'a>(&mut self, problem: &'a Problem, fit: JointFit<'a>) -> Option<JointFit<'a>> {
        let Some(late) = &fit.late else {
            return Some(fit);
        };
        if !unexplained(&fit.problem, &fit.found.best) || self.watcher.stop().is_some() {
            return Some(fit);
        }
        let Some(found) = self.run(problem) else {
            return Some(fit);
        };
        let without = trajectory::criterion_without_delay(problem, &found.best, late, self.watcher);
        // If the fit without the delay cannot be compared, the delay is not preferred.
        if without.is_some_and(|w| w - fit.found.best.value >= fit.found.penalty) {
            return Some(fit);
        }
        Some(JointFit::new(Cow::Borrowed(problem), found, None))
    }

    /// The delay with which the likelihood of a few terms improves most.
    fn delay(&mut self, problem: &Problem, fit: &Fit, inputs: &[VarId]) -> Option<DelayedInputs> {
        if inputs.is_empty() {
            return None;
        }
        let proposals = trajectory::screen_delays(problem, fit.support(), inputs, self.watcher);
        trajectory::fit_delay(problem, fit, &proposals, self.watcher)
    }

    /// Looks for a lag where the answer with a delay leaves more than noise, so that the delay stands for dynamics that the model lacks. A
    /// first-order lag is the simplest of these: the effect is called a delay only if a lag explains less.
    fn lag_or_delay(&mut self, problem: &Problem, fit: &mut JointFit) {
        let Some(late) = &fit.late else { return };
        let same_left_out = fit.problem.left_out.len() == problem.left_out.len();
        let noise_alone = !unexplained(&fit.problem, &fit.found.best);
        if noise_alone || !same_left_out || self.watcher.stop().is_some() {
            return;
        }
        fit.lag = trajectory::find_lag(problem, late, (&fit.problem, &fit.found), self.watcher);
    }

    /// Estimates a delay to a fraction of a sample, and searches again if it is another: other terms imitate what a quarter of a sample leaves.
    fn within_a_sample(&mut self, problem: &Problem, fit: &mut JointFit) {
        let Some(late) = refined_delay(problem, fit, self.watcher) else {
            return;
        };
        if fit.late.as_ref().is_some_and(|l| l.seconds == late.seconds) {
            fit.late = Some(late);
            return;
        }
        let moved = problem.with_delays(&late.applied().collect::<Vec<_>>());
        if let Some(found) = self.run(&moved) {
            *fit = JointFit::new(Cow::Owned(moved), found, Some(late));
        }
    }

    /// Leaves out readings that the laws do not explain and searches again, until the set of readings left out no longer changes.
    fn without_outliers(&mut self, fit: &mut JointFit) {
        for _ in 0..SENSOR_SEARCH.outlier_rounds {
            if self.watcher.stop().is_some() {
                return;
            }
            let Some(next) = trajectory::leave_out(&fit.problem, &fit.found.best) else {
                return;
            };
            let Some(found) = self.run(&next) else {
                return;
            };
            fit.problem = Cow::Owned(next);
            fit.found = found;
        }
    }

    /// Weights readings by noise that grows with the signal, where the model declares it or the residuals show it, and searches again until
    /// the weights settle. True if anything changed. Growth that the last answer no longer shows is undone.
    fn with_growing_noise(&mut self, fit: &mut JointFit) -> bool {
        let (before, mut estimated) = ((fit.problem.clone(), fit.found.clone()), 0);
        let mut changed = false;
        for _ in 0..SENSOR_SEARCH.growth_rounds {
            if self.watcher.stop().is_some() {
                break;
            }
            let price = fit.found.penalty;
            let Some(grown) = grown_noise(fit, changed) else {
                break;
            };
            if grown.estimated < estimated {
                (fit.problem, fit.found) = before;
                return false;
            }
            let Some(found) = self.run(&grown.problem) else {
                break;
            };
            let paid = price * grown.estimated as f64;
            let better = found.best.value + paid < fit.found.best.value;
            // Wrong laws, too, leave larger residuals where the signal is large.
            let explains = || !unexplained(&grown.problem, &found.best);
            if grown.estimated > estimated && !(better && explains()) {
                break;
            }
            fit.problem = Cow::Owned(grown.problem);
            fit.found = found;
            estimated = grown.estimated;
            changed = true;
        }
        changed
    }

    /// Takes the noise of sensors as autocorrelated where the residuals show it, and searches again until its time constants settle. The
    /// answer must leave nothing but that noise and be better than the one for white noise: wrong laws leave autocorrelated residuals, too, which
    /// often come in bursts.
    fn with_lasting_noise(&mut self, fit: &mut JointFit) {
        let mut best: Option<JointFit> = None;
        for _ in 0..SENSOR_SEARCH.memory_rounds {
            if self.watcher.stop().is_some() {
                break;
            }
            let from = best.as_ref().unwrap_or(fit);
            let price = trajectory::term_price(from.problem.measurements() as f64);
            let lasting = trajectory::autocorrelated_noise(&from.problem, &from.found.best, price);
            let Some(lasting) = lasting.filter(|l| l.estimated > 0) else {
                break;
            };
            let start = Found {
                inefficiency: 1.0,
                ..from.found.clone()
            };
            let laws = &lasting.problem.system.laws;
            let found = watched(laws, self.watcher, |guide| {
                trajectory::search_from_fit(&lasting.problem, &start, guide)
            });
            let Some(found) = found else { break };
            let late = fit.late.clone();
            let next = JointFit::new(Cow::Owned(lasting.problem), found, late);
            best = Some(JointFit {
                lag: fit.lag.clone(),
                ..next
            });
        }
        let Some(mut best) = best else { return };
        let (problem, found) = (&best.problem, &best.found.best);
        let explains =
            !unexplained(problem, found) && !trajectory::noise_comes_in_bursts(problem, found);
        if explains && best.gain_over(fit) > 0.0 {
            std::mem::swap(fit, &mut best);
            fit.white_noise_answer = Some(Box::new(best));
        }
    }

    /// A sensor offset that would replace terms. Looked for only if the laws explain the readings to their noise.
    fn offset(&mut self, fit: &JointFit) -> Option<SensorOffset> {
        let best = &fit.found.best;
        if best.support().len() > SENSOR_SEARCH.offset_terms || unexplained(&fit.problem, best) {
            return None;
        }
        trajectory::find_sensor_offset(&fit.problem, best, self.watcher)
    }

    /// Shifts inputs in time if that explains the residuals, and searches again.
    fn with_delay(&mut self, inputs: &[VarId], fit: &mut JointFit) {
        if inputs.is_empty() || !unexplained(&fit.problem, &fit.found.best) {
            return;
        }
        let (whole, known) = (fit.problem.clone(), fit.late.clone());
        let mut moved: Option<DelayedInputs> = None;
        for _ in 0..SENSOR_SEARCH.delay_rounds {
            let (problem, best) = (&fit.problem, &fit.found.best);
            let Some(more) = self.delay(problem, best, inputs) else {
                return;
            };
            let without = trajectory::criterion_without_delay(problem, best, &more, self.watcher);
            let Some(before) = without else {
                return;
            };
            let more = DelayedInputs { gain: 0.0, ..more };
            let Some(mut late) = together(moved.as_ref(), more) else {
                return;
            };
            let next = trajectory::with_delay(&whole, &late);
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
            *fit = JointFit::new(Cow::Owned(next), found, sum);
            moved = Some(late);
        }
    }
}

/// Growth of the noise with the signal, estimated along the fit. Where the laws leave more than noise, it is estimated along the smoothed
/// trajectories instead: the residuals of wrong laws are no noise.
fn grown_noise(fit: &JointFit, settled: bool) -> Option<GrownNoise> {
    let (problem, best, price) = (&fit.problem, &fit.found.best, fit.found.penalty);
    let grown = trajectory::grow_noise(problem, Some(best), price)?;
    let explains = || !unexplained(&grown.problem, best);
    if settled || grown.estimated == 0 || explains() {
        return Some(grown);
    }
    trajectory::grow_noise(problem, None, price).filter(|g| g.estimated > 0)
}

/// The sum of two delays; `None` if they belong to different inputs or cancel.
fn together(before: Option<&DelayedInputs>, more: DelayedInputs) -> Option<DelayedInputs> {
    let Some(before) = before else {
        return Some(more);
    };
    let samples = before.samples + more.samples;
    (before.inputs == more.inputs && samples > 0.0).then_some(DelayedInputs {
        samples,
        seconds: before.seconds + more.seconds,
        gain: before.gain + more.gain,
        ..more
    })
}
