//! What the data say of an answer once it is there: what they tell apart, and how far each term is to be trusted.
//!
//! In: a program, the rows, the [`Discovery`]. Out: its evidence, the doubts that come of it, and marks. Never changes a
//! term or a coefficient.

use std::ops::ControlFlow;

use super::{Measured, Program, needed};
use sidc_data as data;
use sidc_discover as discover;
use sidc_discover::identifiability;
use sidc_discover::identifiability::Rows;
use sidc_discover::scaled_design::ScaledDesign;
use sidc_discover::uncertainty;
use sidc_discover::{Fitted, Options};
use sidc_lang::term::Signal;
use sidc_progress::{Activity, Observer, Stage, Stop, Unwatched};
use sidc_system::discovery::{Discovery, Equation, Identifiability, Stretches};

/// Samples from which on readings are not differentiated only to say what is missing.
const READ: usize = 20_000;

/// Weighs every equation on its rows. `stretches` are of all equations, where these were estimated together; an equation that
/// failed hears what its library lacks.
pub(super) fn weigh(
    program: &Program,
    rows: Rows,
    stretches: Option<&Stretches>,
    options: &Options,
    (discovery, observer): (&mut Discovery, &mut dyn Observer),
) {
    let mut judged: Vec<Judged> = Vec::new();
    for place in 0..discovery.equations.len() {
        if let ControlFlow::Break(stop) = asked(discovery, place, observer) {
            discover::unweighed(discovery, place, stop);
            break;
        }
        let equation = discovery.equations.get(place);
        let one = equation.and_then(|e| one(program, rows, options, e));
        judged.push(one.unwrap_or_default());
    }
    judged.resize_with(discovery.equations.len(), Judged::default);
    for (equation, judged) in discovery.equations.iter_mut().zip(&mut judged) {
        if let Some(told) = judged.told.take() {
            identifiability::attach(equation, told);
        }
        let rows = equation.evidence.as_ref().map_or(0.0, |e| e.rows as f64);
        uncertainty::intervals(equation, judged.readings.unwrap_or(rows));
    }
    let own = judged.iter().filter_map(|j| j.stretches.as_ref());
    for part in own.chain(stretches) {
        uncertainty::judge(part, discovery);
    }
    uncertainty::mark(discovery);
    for failed in &mut discovery.failed {
        let sought = program.sought(failed.target);
        let lacks =
            sought.and_then(|(_, l)| identifiability::lacking(&program.model, l, rows, failed));
        if let (Some(finding), Some(reason)) = (lacks, failed.reasons.first_mut()) {
            reason.text = format!("{}; {}; {}", reason.text, finding.text, finding.advice);
        }
    }
}

/// Whether to weigh the equation at a place; nobody is asked again who said stop already.
fn asked(discovery: &Discovery, place: usize, observer: &mut dyn Observer) -> ControlFlow<Stop> {
    if discovery.was_stopped() {
        return ControlFlow::Continue(());
    }
    observer.hear(Activity::Equation {
        place,
        stage: Stage::Weighing,
    })
}

/// The same for equations estimated with their trajectory, and what the readings say where that does not explain them.
pub(super) fn weigh_fitted(
    program: &Program,
    measured: &Measured,
    fitted: &Fitted,
    options: &Options,
    (discovery, observer): (&mut Discovery, &mut dyn Observer),
) {
    let dataset = &measured.dataset;
    let rows: usize = dataset.trajectories.iter().map(|t| t.time.len()).sum();
    let wanted = !discovery.was_stopped() && identifiability::wants_readings(discovery);
    let read = (rows < READ && wanted).then(|| {
        let mut signals = needed(program);
        let targets = program.model.equations.iter().map(|e| e.target);
        // Lower derivatives may be missing in the library, the next one shows a higher order.
        let around = |t: Signal| (0..=t.der + 1).map(move |der| Signal::derivative(t.var, der));
        signals.extend(targets.flat_map(around));
        signals.sort_unstable();
        signals.dedup();
        data::samples(&program.model, dataset, &signals, &mut Unwatched).0
    });
    let rows = Rows {
        samples: &fitted.samples,
        read: read.as_ref(),
    };
    let stretches = fitted.stretches.as_ref();
    weigh(program, rows, stretches, options, (discovery, observer));
}

/// What one equation's rows say.
#[derive(Default)]
struct Judged {
    told: Option<Identifiability>,
    stretches: Option<Stretches>,
    /// Independent readings behind its coefficients.
    readings: Option<f64>,
}

fn one(program: &Program, rows: Rows, options: &Options, equation: &Equation) -> Option<Judged> {
    if equation.was_stopped() {
        return None;
    }
    let (_, library) = program.sought(equation.target)?;
    let frame = ScaledDesign::new(&program.model, library, rows.samples, equation, options)?;
    Some(Judged {
        told: Some(identifiability::judge(&frame, library, rows)),
        stretches: uncertainty::stretches(&frame),
        readings: Some(frame.noise.rows),
    })
}
