//! Doubts of an equation that was estimated with its trajectory: each rule is one function, and its text gives the figure.
//!
//! In: the residuals of each channel and the terms. Out: reasons. The measure is the noise of the sensor, declared or estimated by
//! smoothing: right equations leave white residuals of that size. Never changes the equation.

use crate::doubts::regression_rules;
use crate::doubts::thresholds::{DOUBTS, TRAJECTORY_DOUBTS};
use crate::trajectory::{
    BetterLaws, Channel, DelayedInputs, InputLag, LawChange, Problem, SensorOffset,
};
use sidc_lang::model::{Equation, Model, Var, VarKind};
use sidc_lang::number::significant;
use sidc_lang::term::{Language, Signal, SignalNames, Term};
use sidc_system::discovery::{
    Change, Discovery, DisturbanceFit, Evidence, FoundTerm, Reason, ReasonCode,
};

/// What the rules judge.
pub(crate) struct TrajectoryCase<'a> {
    pub names: &'a Discovery,
    pub channels: &'a [Channel],
    /// Names of the trajectories.
    pub files: &'a [String],
    pub terms: &'a [FoundTerm],
    pub written: &'a [String],
    pub evidence: &'a Evidence,
    pub readings: usize,
    /// Terms of all equations.
    pub all_terms: usize,
    pub converged: bool,
    /// Candidates of this equation that a generator made.
    pub made: usize,
}

pub(crate) fn doubts(case: &TrajectoryCase) -> Vec<Reason> {
    let mut reasons = Vec::new();
    for c in case.channels {
        reasons.extend(poor_fit(case, c));
        reasons.extend(misfit(case, c));
        reasons.extend(coloured_residuals(case, c));
        reasons.extend(outliers(case, c));
    }
    reasons.extend(few_rows(case));
    reasons.extend(regression_rules::exhausted(
        case.terms.len(),
        case.evidence.candidates,
        case.made,
    ));
    reasons.extend(not_settled(case));
    reasons.extend(regression_rules::tie(&case.evidence.ties));
    reasons.extend(regression_rules::uncertain(case.terms, case.written));
    reasons
}

/// Whether the residuals of a channel are larger than the noise of its sensor.
pub(crate) fn misfits(c: &Channel) -> bool {
    c.noise_ratio > TRAJECTORY_DOUBTS.misfit
}

/// Whether the residuals of a channel are larger than the noise of its sensor, or autocorrelated beyond chance.
pub(crate) fn unexplained(c: &Channel) -> bool {
    misfits(c)
        || c.autocorrelation.abs() > c.white_noise_bound.max(DOUBTS.autocorrelation) && told(c)
}

/// Size and autocorrelation of a channel's residuals over what noise alone may give, the larger of the two: above 1 where the channel
/// is unexplained.
pub(crate) fn left_over_noise(c: &Channel) -> f64 {
    let remembered = match told(c) {
        true => c.autocorrelation.abs() / c.white_noise_bound.max(DOUBTS.autocorrelation),
        false => 0.0,
    };
    remembered.max(c.noise_ratio / TRAJECTORY_DOUBTS.misfit)
}

/// The doubt `input-delay`: inputs that were shifted in time, or that a lag would explain as well.
pub(crate) fn late(model: &Model, late: &DelayedInputs, lag: Option<&InputLag>) -> Reason {
    let inputs: Vec<&str> = late.inputs.iter().map(|v| model.variable(*v)).collect();
    let (act, record) = match inputs.len() {
        1 => ("acts", "its record"),
        _ => ("act", "their records"),
    };
    let unit = model.time_unit();
    let (inputs, delay) = (inputs.join(", "), significant(late.seconds, 4));
    let within = late.interval.map_or(String::new(), |(from, to)| {
        format!(
            ", 95 %: {} to {} {unit}",
            significant(from, 4),
            significant(to, 4)
        )
    });
    let text = match lag {
        None => format!(
            "{inputs} {act} {delay} {unit} ({} samples{within}) later than {record}, which the criterion prefers by {:.0}",
            significant(late.samples, 3),
            late.gain
        ),
        Some(lag) => format!(
            "{inputs} {act} slowly or late: a lag of about {} {unit} explains as much as a delay of about {delay} {unit}, and neither explains all",
            short(lag.seconds)
        ),
    };
    let reason = Reason::new(ReasonCode::InputDelay, text);
    let found = "the equations are those with the delay";
    if lag.is_some() {
        return reason.remedy(format!(
            "measure what is between {inputs} and the states: a drive, a valve, a tank; {found}"
        ));
    }
    let step = late.seconds / late.samples;
    let range = format!(
        "delay in {}..{}",
        significant((late.seconds - step).max(0.0), 3),
        significant(late.seconds + step, 3)
    );
    let mut all = model.vars_of(VarKind::Input);
    match (all.next(), all.next()) {
        (Some((_, only)), None) => {
            let line = with_delay(only, &range);
            let text = format!("if that can be, declare it: `{line}`; {found}");
            reason.change(text, Change::Model(vec![line]))
        }
        _ => reason.remedy(format!(
            "if that can be, declare it, with `{range}` for {inputs}; {found}"
        )),
    }
}

/// The declaration of an input with a delay.
pub(crate) fn with_delay(input: &Var, delay: &str) -> String {
    let mut attributes = Vec::new();
    if input.order > 0 {
        attributes.push(format!("order {}", input.order));
    }
    if let Some(sigma) = input.noise.get(&0) {
        attributes.push(format!("noise {sigma}"));
    }
    if let Some(unit) = &input.unit {
        attributes.push(format!("unit \"{unit}\""));
    }
    attributes.extend(input.between.map(|b| b.word().to_string()));
    attributes.push(delay.into());
    format!("input {} : {}", input.name, attributes.join(", "))
}

/// The doubt `disturbed`: a disturbance with a memory may stand for a term, an input or a state that the model lacks, which vary
/// slowly too. White disturbances may not, so they give no doubt.
pub(crate) fn disturbed(
    names: &Discovery,
    target: Signal,
    disturbance: &DisturbanceFit,
) -> Option<Reason> {
    let memory = disturbance.memory?;
    Some(Reason::new(
        ReasonCode::Disturbed,
        format!(
            "something of {} (standard deviation) drives {} besides its terms, for {} at a time: a term, an input or a state that the model \
             lacks would look the same",
            significant(disturbance.size, 2),
            names.name(target),
            names.duration(memory),
        ),
    ))
}

/// The doubt `sensor-offset`: with a constant offset of the sensor, fewer terms would do. `terms` are those of this equation that the
/// offset makes superfluous; empty if they are in other equations.
pub(crate) fn offset(model: &Model, offset: &SensorOffset, terms: &[String]) -> Reason {
    let needed = match terms {
        [] => "terms of another equation are".into(),
        [one] => format!("{one} is"),
        many => format!("{} are", many.join(", ")),
    };
    let all = offset.terms.len();
    let as_well = match offset.gain > 1.0 {
        true => format!("which the criterion prefers by {:.0}", offset.gain),
        false => "and the fit is as good".into(),
    };
    let name = model.name(offset.signal);
    let reason = Reason::new(
        ReasonCode::SensorOffset,
        format!(
            "if the sensor of {name} reads {:.4} too much, {needed} not needed ({all} fewer in all, {as_well})",
            offset.value,
        ),
    );
    let told = format!(
        "check its zero; if it is off, subtract {:.4} in the data block",
        offset.value
    );
    match model.data.column(offset.signal, &name) {
        Some(column) => {
            let sign = if offset.value < 0.0 { '+' } else { '-' };
            let line = format!(
                "data {{ {name} = \"{column}\" {sign} {:.4} }}",
                offset.value.abs()
            );
            reason.change(told, Change::Model(vec![line]))
        }
        None => reason.remedy(told),
    }
}

/// The doubt `beyond-library` for every law that would be better with terms that its library lacks.
pub(crate) fn doubt_libraries(
    discovery: &mut Discovery,
    (model, problem): (&Model, &Problem),
    better: Option<&BetterLaws>,
) {
    let Some(better) = better else { return };
    for (law, change) in problem.system.laws.iter().zip(&better.changes) {
        let Some(stated) = model.equations.get(law.equation) else {
            continue;
        };
        let reason = beyond_library(discovery, stated, change, better);
        let mut all = discovery.equations.iter_mut();
        let Some(equation) = all.find(|e| e.target == law.target) else {
            continue;
        };
        if !change.enter.is_empty() || !change.leave.is_empty() {
            equation.doubt(reason);
        }
    }
}

fn beyond_library(
    names: &Discovery,
    stated: &Equation,
    change: &LawChange,
    laws: &BetterLaws,
) -> Reason {
    let all =
        |terms: &[Term]| -> Vec<String> { terms.iter().map(|t| Language(names).term(t)).collect() };
    let list = |terms: &[Term]| all(terms).join(", ");
    let (enter, leave) = (list(&change.enter), list(&change.leave));
    let better = format!(
        "the readings are described better, the criterion says by {:.0}",
        laws.gain
    );
    // Terms with which the residuals still exceed the noise stand for something else that the model lacks.
    let explained = !laws.channels.iter().any(unexplained);
    let (many, lacking) = (change.enter.len(), all(&change.lacking));
    let alone = names.equations.len() < 2;
    let text = match (many, change.leave.len()) {
        (many, _) if many > TRAJECTORY_DOUBTS.named_terms => {
            let first: Vec<String> = all(&change.enter)
                .into_iter()
                .take(TRAJECTORY_DOUBTS.named_terms)
                .collect();
            let others = many - first.len();
            format!(
                "with {} and {others} more {better}; so many terms imitate what the model lacks",
                first.join(", ")
            )
        }
        (0, _) if alone => format!("without {leave} {better}"),
        (0, _) => {
            format!("without {leave} {better}: as the other equations change, it is not needed")
        }
        (_, 0) => format!("with {enter} {better}"),
        _ => format!("with {enter} instead of {leave} {better}"),
    };
    let reason = Reason::new(ReasonCode::BeyondLibrary, text);
    match (many, lacking.is_empty()) {
        (many, _) if many > TRAJECTORY_DOUBTS.named_terms => reason.remedy(
            "look for a state or an input that the model lacks, or for other kinds of terms",
        ),
        (0, _) if alone => reason.remedy(format!("leave {leave} out of the library")),
        (0, _) => reason.remedy("mend the other equations first"),
        (_, true) => reason.remedy("offer fewer terms: the search may have missed it"),
        (_, false) if !explained => reason.remedy(
            "look for a state or an input that the model lacks: even with these terms more than noise is left",
        ),
        (_, false) => reason.change(
            format!("add {} to the library", lacking.join(", ")),
            Change::Model(vec![stated.with(&lacking)]),
        ),
    }
}

fn poor_fit(case: &TrajectoryCase, c: &Channel) -> Option<Reason> {
    let part = c.residual / c.spread;
    let allowed = match unexplained(c) {
        true => TRAJECTORY_DOUBTS.poor_fit,
        false => TRAJECTORY_DOUBTS.mostly_noise,
    };
    (part > allowed).then(|| {
        Reason::new(
            ReasonCode::PoorFit,
            format!(
                "the trajectory leaves {:.0} % of the variation of {} unexplained (R² {:.3})",
                100.0 * part.min(1.0),
                case.names.name(c.signal),
                1.0 - part * part
            ),
        )
    })
}

fn misfit(case: &TrajectoryCase, c: &Channel) -> Option<Reason> {
    (c.noise_ratio > TRAJECTORY_DOUBTS.misfit
        && c.residual > TRAJECTORY_DOUBTS.negligible_residual * c.spread)
        .then(|| {
            Reason::new(
                ReasonCode::Misfit,
                format!(
                    "the residuals of {} are {} times its sensor's noise",
                    case.names.name(c.signal),
                    match c.noise_ratio < 1e4 {
                        true => format!("{:.1}", c.noise_ratio),
                        false => significant(c.noise_ratio, 2),
                    }
                ),
            )
        })
}

/// Whether the residuals of a channel exceed both rounding and the accuracy of the fit.
fn told(c: &Channel) -> bool {
    c.residual
        > c.accuracy
            .max(TRAJECTORY_DOUBTS.negligible_residual * c.spread)
}

fn coloured_residuals(case: &TrajectoryCase, c: &Channel) -> Option<Reason> {
    (c.autocorrelation.abs() > c.white_noise_bound.max(DOUBTS.autocorrelation) && told(c)).then(|| {
        Reason::new(
            ReasonCode::ColouredResiduals,
            format!(
                "the residuals of {} follow each other (autocorrelation {:.2}, chance allows {:.2}), which neither white noise of \
                 a sensor nor one that fades explains",
                case.names.name(c.signal),
                c.autocorrelation,
                c.white_noise_bound
            ),
        )
    })
}

fn outliers(case: &TrajectoryCase, c: &Channel) -> Option<Reason> {
    let s = c.outliers?;
    let file = case.files.get(s.trajectory).map_or("?", String::as_str);
    let lie = match s.count {
        1 => "1 reading lies".to_string(),
        n => format!("{n} of {} readings lie", c.readings),
    };
    Some(Reason::new(
        ReasonCode::Outliers,
        format!(
            "{}: {lie} alone, more than 5 standard deviations from the trajectory; the worst by {:.0}, in {file} at {} {}",
            case.names.name(c.signal),
            s.worst,
            short(s.time),
            case.names.time_unit()
        ),
    )
    .change(
        ReasonCode::Outliers.usual_remedy(),
        Change::Options("--robust".into()),
    ))
}

/// At most six decimals.
fn short(seconds: f64) -> f64 {
    (seconds * 1e6).round() / 1e6
}

fn few_rows(case: &TrajectoryCase) -> Option<Reason> {
    (case.readings < DOUBTS.rows_per_term * case.all_terms).then(|| {
        Reason::new(
            ReasonCode::FewRows,
            format!(
                "{} noisy readings for {} terms: another law may fit as well by chance",
                case.readings, case.all_terms
            ),
        )
        .remedy(format!(
            "record {} readings or more",
            DOUBTS.rows_per_term * case.all_terms
        ))
    })
}

fn not_settled(case: &TrajectoryCase) -> Option<Reason> {
    (!case.converged).then(|| {
        Reason::new(
            ReasonCode::NotSettled,
            "trajectory and coefficients still moved when their fit was ended: they are near the best, not at it",
        )
    })
}
