//! What the data say of the equations found: which terms they can distinguish, and how uncertain each coefficient is.
//!
//! In: a program, the rows, the [`Discovery`]. Out: its evidence, marks, and the doubts that follow. Never changes a term or a coefficient.

use std::ops::ControlFlow;

use sidc_data as data;
use sidc_data::{Dataset, Samples};
use sidc_discover as discover;
use sidc_discover::Options;
use sidc_discover::identifiability;
use sidc_discover::identifiability::{Assessment, Rows};
use sidc_discover::scaled_design::ScaledDesign;
use sidc_discover::uncertainty;
use sidc_discover::uncertainty::Stability;
use sidc_lang::term::{Language, Signal, Term};
use sidc_progress::{Activity, Observer, Stage, Stop, Unwatched};
use sidc_solve::threads;
use sidc_system::discovery::{BlockNormalEquations, Discovery, Equation, Reason, ReasonCode};

use super::program::{Program, needed};
use super::thresholds::BUDGET;

/// The options without ranks of libraries, for results that neither print nor store them.
pub fn without_ranks(mut options: crate::Options) -> crate::Options {
    options.search.ranks = false;
    options
}

/// What equations are weighed with.
pub(super) struct Weighing<'a> {
    pub program: &'a Program,
    pub rows: Rows<'a>,
    /// Segments of all equations, if these were estimated jointly.
    pub stretches: Option<&'a BlockNormalEquations>,
    pub options: &'a Options,
}

impl Weighing<'_> {
    /// Weighs every equation on its rows. If an equation failed, its reason says what the library lacks.
    pub fn weigh(&self, discovery: &mut Discovery, observer: &mut dyn Observer) {
        let all: Vec<usize> = (0..discovery.equations.len()).collect();
        let mut judged: Vec<EquationEvidence> = Vec::new();
        // Two at a time, each on its own thread.
        for pair in all.chunks(2) {
            let (mut places, mut stopped) = (Vec::new(), None);
            for place in pair {
                match asked(discovery, *place, observer) {
                    ControlFlow::Continue(()) => places.push(*place),
                    ControlFlow::Break(stop) => {
                        stopped = Some((*place, stop));
                        break;
                    }
                }
            }
            let one = |place: &usize| {
                let equation = discovery.equations.get(*place);
                equation.and_then(|e| self.one(e)).unwrap_or_default()
            };
            match places.as_slice() {
                [a, b] => judged.extend(<[_; 2]>::from(threads::join(|| one(a), || one(b)))),
                alone => judged.extend(alone.iter().map(one)),
            }
            if let Some((place, stop)) = stopped {
                discover::doubt_unassessed(discovery, place, stop);
                break;
            }
        }
        judged.resize_with(discovery.equations.len(), EquationEvidence::default);
        for (equation, judged) in discovery.equations.iter_mut().zip(&mut judged) {
            if let Some(told) = judged.told.take() {
                identifiability::attach(equation, told);
            }
            let rows = equation.evidence.as_ref().map_or(0.0, |e| e.rows as f64);
            uncertainty::confidence_intervals(equation, judged.readings.unwrap_or(rows));
        }
        if let Some(all) = self.stretches {
            uncertainty::assess_terms(all, &uncertainty::stability_selection(all), discovery);
        }
        for judged in &judged {
            if let Some(own) = &judged.stretches {
                uncertainty::assess_terms(own, &judged.halves, discovery);
            }
        }
        let required = |target: Signal, term: &Term| self.program.requires(target, term);
        self.doubt_lacking(discovery);
        uncertainty::doubt_unneeded_terms(discovery, &self.program.model, &required);
        uncertainty::mark_terms(discovery);
        for failed in &mut discovery.failed {
            let sought = self.program.sought(failed.target);
            let model = &self.program.model;
            let lacks = sought
                .and_then(|(_, l)| identifiability::misspecification(model, l, self.rows, failed));
            if let (Some(finding), Some(reason)) = (lacks, failed.reasons.first_mut()) {
                reason.remedy = Some(identifiability::remedy(&finding));
            }
        }
        for equation in &mut discovery.equations {
            identifiability::advise(equation);
        }
    }

    /// Doubts every equation without a term that the model requires, in case a search has lost one.
    fn doubt_lacking(&self, discovery: &mut Discovery) {
        discovery.doubt_each(|names, equation| {
            let (_, library) = self.program.sought(equation.target)?;
            let required = library.required().iter().filter_map(|s| library.term(*s));
            let has = |term: &Term| equation.terms.iter().any(|t| !t.fixed && t.term == *term);
            let lacking: Vec<String> = required
                .filter(|term| !has(term))
                .map(|term| Language(names).term(&term))
                .collect();
            (!lacking.is_empty()).then(|| {
                let lacking = lacking.join(", ");
                let text = format!("required, and lost by the search: {lacking}");
                Reason::new(ReasonCode::BetterWithout, text)
            })
        });
    }

    fn one(&self, equation: &Equation) -> Option<EquationEvidence> {
        if equation.was_stopped() {
            return None;
        }
        let (_, library) = self.program.sought(equation.target)?;
        let (model, samples) = (&self.program.model, self.rows.samples);
        let design = ScaledDesign::new(model, library, samples, equation, self.options)?;
        let stretches = uncertainty::block_normal_equations(&design);
        Some(EquationEvidence {
            told: Some(identifiability::assess(
                &design,
                library,
                self.rows,
                self.options.ranks,
            )),
            halves: (stretches.as_ref()).and_then(uncertainty::stability_selection),
            stretches,
            readings: Some(design.noise.rows),
        })
    }
}

/// Whether to weigh the equation at a place. An observer that has already ended the work is not asked again.
fn asked(discovery: &Discovery, place: usize, observer: &mut dyn Observer) -> ControlFlow<Stop> {
    if discovery.was_stopped() {
        return ControlFlow::Continue(());
    }
    let stage = Stage::Weighing;
    observer.hear(Activity::Equation { place, stage })
}

/// Signals with derivatives estimated from the readings, for equations estimated jointly with their trajectory; `None` if the trajectory explains the
/// readings, or if there are too many readings.
pub(super) fn readings(
    program: &Program,
    dataset: &Dataset,
    discovery: &Discovery,
) -> Option<Samples> {
    let rows: usize = dataset.trajectories.iter().map(|t| t.time.len()).sum();
    let wanted = !discovery.was_stopped() && identifiability::needs_measured_targets(discovery);
    if rows >= BUDGET.differentiated_samples || !wanted {
        return None;
    }
    let mut signals = needed(program);
    let targets = program.model.equations.iter().map(|e| e.target);
    // The library may lack lower derivatives, and the next higher one shows whether the order is too low.
    let around = |t: Signal| (0..=t.der + 1).map(move |der| Signal::derivative(t.var, der));
    signals.extend(targets.flat_map(around));
    signals.sort_unstable();
    signals.dedup();
    let (samples, ..) = data::samples(&program.model, dataset, &signals, &mut Unwatched);
    Some(samples)
}

/// What the rows say of one equation.
#[derive(Default)]
struct EquationEvidence {
    told: Option<Assessment>,
    stretches: Option<BlockNormalEquations>,
    halves: Option<Stability>,
    /// Effective number of readings behind its coefficients.
    readings: Option<f64>,
}
