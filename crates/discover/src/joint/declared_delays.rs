//! Delays that the model declares: stated ones are applied, ranges are settled before the terms are searched for the last time.
//!
//! In: a model, its libraries, a dataset, the problem without delays. Out: every declared delay with its interval, and the problem and the
//! dataset with them; doubts about them. Screening gives a first delay, a search the terms at it, the profile of their likelihood the
//! delay.

use std::borrow::Cow;

use crate::doubts::trajectory_rules::with_delay;
use crate::joint::constrained_search::{SearchOutcome, search_under_constraints};
use crate::joint::weak_start::weak_start;
use crate::options::Options;
use crate::trajectory::{
    AppliedDelay, DECLARED_DELAYS, DelayEstimate, Problem, profile_delays, screen_ranges,
};
use sidc_data::{Dataset, InputValue, KnownDelay, with_acting_inputs, with_true_readings};
use sidc_lang::library::Library;
use sidc_lang::model::{Delay, Model, Var, VarKind};
use sidc_lang::number::significant;
use sidc_lang::term::{SignalNames, VarId};
use sidc_progress::EquationObserver;
use sidc_system::discovery::{Change, Discovery, Equation, Reason, ReasonCode, SignalDelay};

/// The declared delays of a model, in order of declaration.
pub(crate) struct DeclaredDelays {
    estimates: Vec<DelayEstimate>,
    /// Whether the ranges were estimated, not only screened.
    profiled: bool,
}

/// Settles the delays of a model.
pub(crate) fn estimate_delays(
    (model, libraries): (&Model, &[Option<Library>]),
    dataset: &Dataset,
    problem: &Problem,
    options: &Options,
    watcher: &mut EquationObserver,
) -> DeclaredDelays {
    let mut declared = DeclaredDelays::of(model);
    if !model.has_unknown_delays() {
        return declared;
    }
    let screened = screen_ranges(problem, declared.applied(), watcher);
    for (estimate, delay) in declared.estimates.iter_mut().zip(screened) {
        estimate.delay = delay;
    }
    for _ in 0..DECLARED_DELAYS.rounds {
        if watcher.stop().is_some() {
            break;
        }
        let mut delays = declared.applied();
        let at = problem.with_delays(&delays);
        let acted = acted(model, dataset, &delays);
        let start = weak_start((model, libraries), &acted, &at, options, watcher);
        let outcome = search_under_constraints((model, &at), start, options, watcher);
        let SearchOutcome::Answer(answer) = outcome else {
            break;
        };
        let (fit, count) = (&answer.fit, delays.len());
        delays.extend(fit.late.iter().flat_map(|late| late.applied()));
        let problem = problem.of_trajectories(&fit.problem.runs());
        let at = (fit.problem.as_ref(), &fit.found.best);
        let inefficiency = fit.found.inefficiency;
        let Some(estimates) = profile_delays(&problem, &delays, at, inefficiency, watcher) else {
            break;
        };
        declared.estimates = estimates.into_iter().take(count).collect();
        declared.profiled = true;
    }
    declared
}

impl DeclaredDelays {
    fn of(model: &Model) -> DeclaredDelays {
        let estimate = |(var, delay)| {
            let delay = match delay {
                Delay::Known(seconds) => AppliedDelay::known(var, seconds),
                Delay::Within { from, to } => AppliedDelay {
                    var,
                    seconds: 0.0_f64.clamp(from, to),
                    range: (from, to),
                },
            };
            DelayEstimate {
                delay,
                interval: delay.range,
                at_end: false,
            }
        };
        DeclaredDelays {
            estimates: model.delays().map(estimate).collect(),
            profiled: false,
        }
    }

    fn applied(&self) -> Vec<AppliedDelay> {
        self.estimates.iter().map(|e| e.delay).collect()
    }

    /// The delays as fixed values. Comparing a range of delays would leave out readings at the ends; these leave out none for that.
    pub fn known(&self) -> Vec<AppliedDelay> {
        let known = |e: &DelayEstimate| AppliedDelay::known(e.delay.var, e.delay.seconds);
        self.estimates.iter().map(known).collect()
    }

    /// The problem with the delays.
    pub fn problem<'a>(&self, problem: &'a Problem) -> Cow<'a, Problem> {
        match self.estimates.is_empty() {
            true => Cow::Borrowed(problem),
            false => Cow::Owned(problem.with_delays(&self.known())),
        }
    }

    /// The records with declared delays taken out: inputs as they act, readings at the instants of their states.
    pub fn dataset<'a>(&self, model: &Model, dataset: &'a Dataset) -> Cow<'a, Dataset> {
        acted(model, dataset, &self.known())
    }

    /// States the delays, with a doubt where the data do not tell one, or where its range is too narrow.
    pub fn state(&self, model: &Model, discovery: &mut Discovery) {
        let stated = |e: &DelayEstimate| {
            let sought = e.delay.range.0 < e.delay.range.1;
            SignalDelay {
                signal: model.variable(e.delay.var).to_string(),
                seconds: e.delay.seconds,
                within: sought.then_some(e.delay.range),
                interval: (sought && self.profiled).then_some(e.interval),
            }
        };
        discovery.delays = self.estimates.iter().map(stated).collect();
        for estimate in self.estimates.iter().filter(|_| self.profiled) {
            let Some(reason) = doubt(model, estimate) else {
                continue;
            };
            let var = estimate.delay.var;
            let concerned = |e: &Equation| e.target.var == var || mentions(e, var);
            let any = discovery.equations.iter().any(concerned);
            discovery.doubt_each(|_, e| (concerned(e) || !any).then(|| reason.clone()));
        }
    }
}

fn mentions(equation: &Equation, var: VarId) -> bool {
    let mut found = false;
    let terms = equation.terms.iter();
    terms.for_each(|t| t.term.for_each_signal(&mut |s| found |= s.var == var));
    found
}

/// The records as the inputs acted and as the states were.
fn acted<'a>(model: &Model, dataset: &'a Dataset, delays: &[AppliedDelay]) -> Cow<'a, Dataset> {
    if delays.is_empty() {
        return Cow::Borrowed(dataset);
    }
    let of = |kind: VarKind| -> Vec<KnownDelay> {
        let own = |d: &&AppliedDelay| model.var(d.var).is_some_and(|v| v.kind == kind);
        let known = |d: &AppliedDelay| KnownDelay {
            var: d.var,
            seconds: d.seconds,
        };
        delays.iter().filter(own).map(known).collect()
    };
    let read = with_true_readings(dataset, &of(VarKind::State));
    let inputs = of(VarKind::Input);
    Cow::Owned(with_acting_inputs(&read, &inputs, InputValue::OverStep))
}

/// The doubt `delay-range`: the range of a delay ends where it is likeliest, or the data do not tell the delay.
fn doubt(model: &Model, estimate: &DelayEstimate) -> Option<Reason> {
    let name = model.variable(estimate.delay.var);
    let (from, to) = estimate.delay.range;
    let short = |x: f64| significant(x, 3);
    let unit = model.time_unit();
    let range = format!("{}..{}", short(from), short(to));
    if estimate.at_end {
        let upper = estimate.delay.seconds > 0.5 * (from + to);
        let wider = match upper {
            true => format!("delay in {}..{}", short(from), short(to + (to - from))),
            false => format!("delay in {}..{}", short(from - (to - from)), short(to)),
        };
        let text = format!(
            "the likeliest delay of {name} is the end of its range, {} {unit}, and one beyond it is likelier still",
            short(estimate.delay.seconds),
        );
        let reason = Reason::new(ReasonCode::DelayRange, text);
        let told = match !upper && from >= 0.0 {
            true => format!(
                "if the record of {name} may be late, let the range reach below 0: `{wider}`"
            ),
            false => format!("widen the range: `{wider}`"),
        };
        return Some(match only_input(model, estimate.delay.var) {
            Some(input) => reason.change(told, Change::Model(vec![with_delay(input, &wider)])),
            None => reason.remedy(told),
        });
    }
    estimate.is_open().then(|| {
        let text =
            format!("the data do not tell the delay of {name}: all of {range} {unit} fits as well");
        let remedy = format!(
            "record a motion in which {name} changes faster than in {} {unit}, or state its delay",
            short(to - from)
        );
        Reason::new(ReasonCode::DelayRange, text).remedy(remedy)
    })
}

/// An input that is the only one, so that a statement is its own.
fn only_input(model: &Model, var: VarId) -> Option<&Var> {
    let mut all = model.vars_of(VarKind::Input);
    let (_, input) = all.next().filter(|(id, _)| *id == var)?;
    all.next().is_none().then_some(input)
}
