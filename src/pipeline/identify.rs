//! Program + measured signals → equations: the third stage.
//!
//! In: a program, its signals on common rows. Out: equations with evidence, or why a term has no value.

use sidc_discover as discover;
use sidc_discover::Refusal;
use sidc_discover::identifiability::Rows;
use sidc_lang::diagnostic::Diagnostic;
use sidc_progress::Observer;
use sidc_system::discovery::{Discovery, SparsestProof};

use super::constant_estimation;
use super::evidence::Weighing;
use super::joint::jointly;
use super::measure::Measured;
use super::missing_states;
use super::program::Program;
use super::rates;
use super::second_method::passing_method;
use super::unevaluable;
use crate::options::Options;

const TOGETHER: &str = "the equations were estimated together with their trajectory, and no tolerance says which others fit";
const CONSTRAINED: &str = "equations that constraints tie are not looked at one by one";
const OTHERWISE: &str = "this equation was found another way, or the search was ended before";

/// Program + measured signals → equations with evidence.
///
/// # Errors
/// Terms without a value on the rows; constraints that the data contradict.
pub fn identify(
    program: &Program,
    measured: &Measured,
    options: &Options,
    observer: &mut dyn Observer,
) -> Result<Discovery, Vec<Diagnostic>> {
    let program = measured.searched(program);
    if let Some(problem) = &measured.joint {
        let dataset = &measured.dataset;
        let (mut found, description) = jointly(program, dataset, problem, options, observer)
            .map_err(|refused| diagnostics(program, measured, vec![*refused]))?;
        missing_states::propose(
            (program, dataset),
            &mut found,
            description,
            options,
            observer,
        );
        return Ok(sparsest_or_why(found, options));
    }
    let search = &options.search;
    let found = discover::discover(
        &program.model,
        &program.libraries,
        (measured.acting(), &measured.samples),
        search,
        observer,
    );
    let mut discovery = found.map_err(|refused| diagnostics(program, measured, refused))?;
    let data = (&measured.dataset, &measured.samples);
    constant_estimation::report_values(program, data, &mut discovery, options);
    constant_estimation::certify(program, &measured.samples, &mut discovery, observer);
    constant_estimation::doubt(program, &measured.samples, &mut discovery, options);
    let rows = (&measured.samples, &measured.other_constants[..]);
    constant_estimation::doubt_rivals(program, rows, &mut discovery, options, observer);
    rates::doubt(&mut discovery, &measured.dataset.rate_faults);
    let weighing = Weighing {
        program,
        rows: Rows {
            samples: &measured.samples,
            read: None,
            unread: &measured.dataset.unread,
        },
        stretches: None,
        options: search,
    };
    weighing.weigh(&mut discovery, observer);
    let mut found = passing_method(program, measured, options, discovery, observer);
    if options.search.chooses_way() {
        let dataset = &measured.dataset;
        missing_states::propose((program, dataset), &mut found, None, options, observer);
    }
    discover::describe_relations(
        &mut found,
        &measured.samples,
        &program.libraries,
        (search.solver, observer),
    );
    Ok(sparsest_or_why(found, options))
}

/// If proofs of sparsest equations were requested, says of every equation without one why it has none.
fn sparsest_or_why(mut found: Discovery, options: &Options) -> Discovery {
    if !options.search.sparsest {
        return found;
    }
    for equation in &mut found.equations {
        let Some(evidence) = &mut equation.evidence else {
            continue;
        };
        let why = match (&evidence.joint, evidence.certificate.constrained) {
            (Some(_), _) => TOGETHER,
            (None, true) => CONSTRAINED,
            (None, false) => OTHERWISE,
        };
        let refused = || Box::new(SparsestProof::refused(why));
        evidence.sparsest.get_or_insert_with(refused);
    }
    found
}

pub(super) fn diagnostics(
    program: &Program,
    measured: &Measured,
    refused: Vec<Refusal>,
) -> Vec<Diagnostic> {
    let explain = |refusal| match refusal {
        Refusal::Unevaluable((i, value)) => unevaluable::explain(program, measured, i, &value),
        Refusal::Contradiction(diagnostic) => diagnostic,
    };
    refused.into_iter().map(explain).collect()
}
