//! A second method where regression errs: joint estimation of all equations and their trajectory. It errs where measured rates are bad, which the joint estimate
//! does without, where laws jump or bend, since estimated derivatives are blurred there, and where the errors of estimated derivatives hide which terms a law has,
//! as the trajectory shows.
//!
//! In: a program, its measured signals, the equations of the first method. Out: the equations of the method that passes, with a record of both. A method that
//! the user chose is the only one tried. Equations of clean records whose terms are certain and do not jump are not estimated again: regression is faster.

use std::borrow::Cow;

use sidc_data::Dataset;
use sidc_discover as discover;
use sidc_discover::Method;
use sidc_discover::identifiability::leaves_motion;
use sidc_discover::trajectory::Problem;
use sidc_lang::library::Library;
use sidc_lang::model::VarKind;
use sidc_lang::term::{Signal, Term};
use sidc_progress::Observer;
use sidc_system::discovery::{
    Cost, Discovery, Equation, Mark, MethodComparison, Reason, ReasonCode, SecondMethodReason,
};
use sidc_system::switching::Switches;

use super::joint::jointly;
use super::measure::Measured;
use super::program::Program;
use super::thresholds::SECOND_METHOD;
use crate::options::Options;

/// The first equations, or those of the joint estimate if only these pass.
pub(super) fn passing_method(
    program: &Program,
    measured: &Measured,
    options: &Options,
    mut first: Discovery,
    observer: &mut dyn Observer,
) -> Discovery {
    if !options.search.chooses_way() || !doubts_concern_data(&first) {
        return first;
    }
    let missed = missed_trajectory((program, measured), &first, options, observer);
    let second = Second::of(program, measured, (&first, !missed.is_empty()));
    let why = second.as_ref().map(|second| second.why);
    let second = second.and_then(|second| second.estimate(options, observer));
    let Some((mut second, why)) = second.zip(why) else {
        return doubted(first, missed);
    };
    // Where both pass with the same terms, regression is the more accurate: its rows hold the inputs as they were read, not what they were in between.
    let confirms = why == SecondMethodReason::EstimatedRates && first.passes();
    let holds = second.passes() && !(confirms && have_the_same_terms(&first, &second));
    let name = |method: Method| method.chosen().to_owned();
    let (regression, joint) = (name(Method::Regression), name(Method::Joint));
    let ways = MethodComparison {
        first: regression.clone(),
        first_doubts: first.doubt_codes(),
        second: joint.clone(),
        second_doubts: second.doubt_codes(),
        given: if holds { joint } else { regression },
        why,
    };
    let given = if holds { &mut second } else { &mut first };
    given.record_ways(&ways);
    if holds {
        second
    } else {
        doubted(first, missed)
    }
}

/// Whether two answers have the same terms, in any order.
fn have_the_same_terms(a: &Discovery, b: &Discovery) -> bool {
    let terms = |found: &Discovery| {
        let each = |e: &Equation| {
            let mut terms: Vec<Term> = e.terms.iter().map(|t| t.term.clone()).collect();
            terms.sort();
            (e.target, terms)
        };
        found.equations.iter().map(each).collect::<Vec<_>>()
    };
    terms(a) == terms(b)
}

/// What is estimated jointly.
struct Second<'a> {
    program: Cow<'a, Program>,
    dataset: Cow<'a, Dataset>,
    why: SecondMethodReason,
}

impl<'a> Second<'a> {
    /// What a second estimate is of; `None` where there is no reason for one. `misses`: whether the first laws miss their trajectory.
    fn of(
        program: &'a Program,
        measured: &'a Measured,
        (first, misses): (&Discovery, bool),
    ) -> Option<Second<'a>> {
        let equations = program.model.equations.iter();
        let targets: Vec<Signal> = equations.map(|e| e.target).collect();
        if targets.iter().any(|s| measured.dataset.has(*s)) {
            let is_open = !first.passes() && !library_is_insufficient(program, measured, first);
            return is_open.then(|| Second {
                program: Cow::Borrowed(program),
                dataset: Cow::Owned(measured.dataset.without(&targets)),
                why: SecondMethodReason::MeasuredRates,
            });
        }
        let why = match may_switch(program, first) {
            true => SecondMethodReason::Jumps,
            false if program.model.discrete => return None,
            false if misses || terms_are_open(first) || may_imitate(first) => {
                SecondMethodReason::EstimatedRates
            }
            false => return None,
        };
        let columns = affordable_columns(program, measured, why);
        let program = match why {
            SecondMethodReason::EstimatedRates => narrowed(program, first, columns)?,
            _ => (columns_of(program) <= columns).then_some(Cow::Borrowed(program))?,
        };
        Some(Second {
            program,
            dataset: Cow::Borrowed(&measured.dataset),
            why,
        })
    }

    /// `None` if the program would not estimate such data jointly, if a candidate only restates its target, or if the readings alone contradict
    /// the constraints.
    fn estimate(&self, options: &Options, observer: &mut dyn Observer) -> Option<Discovery> {
        let dataset = self.dataset.as_ref();
        let problem = problem(self, options, observer)?;
        let found = jointly(&self.program, dataset, &problem, options, observer);
        Some(found.ok()?.0)
    }
}

fn columns_of(program: &Program) -> usize {
    program.libraries.iter().flatten().map(Library::len).sum()
}

/// The columns of which a joint search takes some seconds only.
fn affordable_columns(program: &Program, measured: &Measured, why: SecondMethodReason) -> usize {
    let most = match why {
        SecondMethodReason::EstimatedRates if !program.model.unknowns.is_empty() => {
            SECOND_METHOD.work_with_constants
        }
        _ => SECOND_METHOD.work,
    };
    most / measured.samples.len().max(1)
}

/// The program with so many candidates in all: the terms that were found and the simplest others. Laws that follow clean readings to their
/// rounding are right, whatever else was offered. `None` where even those found are too many.
fn narrowed<'a>(
    program: &'a Program,
    found: &Discovery,
    columns: usize,
) -> Option<Cow<'a, Program>> {
    if columns_of(program) <= columns {
        return Some(Cow::Borrowed(program));
    }
    let each = columns / program.libraries.iter().flatten().count().max(1);
    let narrowed = program.with_slots(found, &|library, found| {
        let mut slots = found.to_vec();
        let simplest = library.by_degree().into_iter();
        let others = simplest.filter(|slot| !found.contains(slot));
        slots.extend(others.take(each.saturating_sub(found.len())));
        slots
    });
    (columns_of(&narrowed) <= columns).then_some(Cow::Owned(narrowed))
}

/// Whether equations that are found jump, or those that are doubted might, or bend.
fn may_switch(program: &Program, first: &Discovery) -> bool {
    let is_state = |signal: Signal| {
        let variable = program.model.var(signal.var);
        variable.is_some_and(|v| v.kind == VarKind::State)
    };
    let found = first.equations.iter().flat_map(|e| &e.terms);
    let mut found = found.map(|t| &t.term);
    if first.passes() {
        return found.any(|t| Switches::jumps_in(t, &is_state));
    }
    let offered = program.libraries.iter().flatten();
    let mut offered = offered.flat_map(Library::factors);
    found.any(|t| Switches::switch_in(t, &is_state))
        || offered.any(|t| Switches::jumps_in(t, &is_state))
}

/// Whether all doubts are about which terms a law has, or their coefficients: the terms found follow the readings.
fn terms_are_open(first: &Discovery) -> bool {
    let codes = first.doubt_codes();
    let open = |code: &ReasonCode| matches!(code.cost(), Cost::Terms | Cost::Coefficients);
    !codes.is_empty() && codes.iter().all(open)
}

/// Whether the equations pass with unknown constants, but not all of their terms are firm: other terms at wrong constants can imitate a law
/// within the errors of derivatives.
fn may_imitate(first: &Discovery) -> bool {
    let terms = first.equations.iter().flat_map(|e| &e.terms);
    let mut marks = terms.filter_map(|t| t.evidence.as_ref()).map(|e| e.mark);
    first.passes() && !first.unknowns.is_empty() && marks.any(|mark| mark != Mark::Firm)
}

/// Whether the doubts are about what the data show, not about limits, stops or a solver, chosen by the user, that proves nothing.
fn doubts_concern_data(first: &Discovery) -> bool {
    use ReasonCode::{
        HeuristicSolver, Interrupted, MemoryLimit, NoMotion, SolverRefused, TimeLimit,
    };
    let others = [
        HeuristicSolver,
        Interrupted,
        MemoryLimit,
        NoMotion,
        SolverRefused,
        TimeLimit,
    ];
    first.doubt_codes().iter().all(|c| !others.contains(c))
}

/// Whether rates that agree with their states have motion that the library cannot explain. Then the joint estimate cannot explain it either.
fn library_is_insufficient(program: &Program, measured: &Measured, first: &Discovery) -> bool {
    let poor = |target: Signal| {
        let doubted = first.equations.iter().filter(|e| e.target == target);
        let mut reasons = doubted.flat_map(|e| &e.reasons);
        reasons.any(|r| r.code == ReasonCode::PoorFit)
    };
    let stated = program.model.equations.iter().zip(&program.libraries);
    let mut sought = stated.filter_map(|(e, library)| Some((e.target, library.as_ref()?)));
    measured.dataset.rate_faults.is_empty()
        && sought.any(|(target, library)| {
            poor(target) && leaves_motion(library, target, &measured.samples)
        })
}

/// The joint problem of all equations; `None` if the program would not estimate such data jointly, or if a candidate only restates its target.
fn problem(second: &Second, options: &Options, observer: &mut dyn Observer) -> Option<Problem> {
    let (model, libraries) = (&second.program.model, &second.program.libraries);
    // By themselves, clean records are estimated by regression.
    let method = match second.why {
        SecondMethodReason::MeasuredRates => options.search.method,
        SecondMethodReason::Jumps | SecondMethodReason::EstimatedRates => Method::Joint,
    };
    let search = discover::Options {
        method,
        ..options.search
    };
    let problem = discover::joint(model, libraries, &second.dataset, &search, observer).ok()?;
    problem.target_copies().is_empty().then_some(problem)
}

/// Why laws with unknown constants that pass by estimated derivatives may be wrong all the same, by target: they do not follow the readings from
/// which these were estimated. Other terms at wrong constants imitate a law within the errors of derivatives. The laws found are estimated
/// alone, so this takes a part of a search.
fn missed_trajectory(
    (program, measured): (&Program, &Measured),
    first: &Discovery,
    options: &Options,
    observer: &mut dyn Observer,
) -> Vec<(Signal, Reason)> {
    let model = &program.model;
    let rough = |e: &Equation| {
        let evidence = e.evidence.as_ref();
        evidence.is_some_and(|e| e.residual > SECOND_METHOD.exact_rates)
    };
    let read = model
        .equations
        .iter()
        .any(|e| measured.dataset.has(e.target));
    let certain = !first.passes() || !first.equations.iter().any(rough);
    let may_imitate = !model.unknowns.is_empty() && !may_switch(program, first);
    if model.discrete || read || certain || !may_imitate {
        return Vec::new();
    }
    let why = SecondMethodReason::EstimatedRates;
    let alone = program.with_slots(first, &|_, found| found.to_vec());
    let affordable = affordable_columns(&alone, measured, why);
    if columns_of(&alone) > affordable {
        return Vec::new();
    }
    let searched_whole = columns_of(program) <= affordable;
    let alone = Second {
        program: Cow::Owned(alone.near_constants(first, SECOND_METHOD.near)),
        dataset: Cow::Borrowed(&measured.dataset),
        why,
    };
    let Some(joint) = alone.estimate(options, observer) else {
        return Vec::new();
    };
    let misses = |e: &Equation| {
        let misfit = e.reasons.iter().find(|r| r.code == ReasonCode::Misfit)?;
        let text = format!(
            "along its trajectory {}, though its derivatives fit within their errors",
            misfit.text
        );
        let reason = Reason::new(ReasonCode::Misfit, text);
        let way = match searched_whole {
            true => "look for a term that the library lacks, or declare a smooth input `cubic`",
            false => "search with the trajectory, which takes longer: --method joint",
        };
        Some((e.target, reason.remedy(way)))
    };
    joint.equations.iter().filter_map(misses).collect()
}

/// The answer with these doubts.
fn doubted(mut found: Discovery, reasons: Vec<(Signal, Reason)>) -> Discovery {
    for (target, reason) in reasons {
        let own = found.equations.iter_mut().find(|e| e.target == target);
        if let Some(equation) = own {
            equation.doubt(reason);
        }
    }
    found
}
