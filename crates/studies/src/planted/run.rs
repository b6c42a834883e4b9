//! Runs a planted case through the whole program: which cause is named, and whether a wrong answer passes.
//!
//! In: a case. Out: an [`Outcome`]. Makes the same calls as `sidc identify`.

use sidc::pipeline;
use sidc::{Options, Unwatched};
use sidc_data::{Limits, read};
use sidc_lang::render;
use sidc_lang::source::Sources;
use sidc_lang::term::{Language, SignalNames};
use sidc_system::discovery::{Cause, Discovery, FoundTerm, Mark, Status};

use super::cases::Case;

pub struct Outcome {
    /// Cause of the leading finding, as printed; empty if there is none.
    pub named: String,
    pub right_cause: bool,
    /// Whether the equation has exactly the true terms.
    pub right_answer: bool,
    pub passes: bool,
    /// Terms marked firm that are not in the true law.
    pub firm: Vec<String>,
    /// The evidence as the terminal shows it.
    pub shown: String,
}

impl Outcome {
    pub fn firm_and_wrong(&self) -> bool {
        (self.passes && !self.right_answer) || !self.firm.is_empty()
    }
}

/// # Errors
/// What the program reported instead of an answer.
pub fn run(case: &Case) -> Result<Outcome, String> {
    let discovery = identify(case)?;
    let found = discovery
        .equations
        .iter()
        .find(|e| discovery.name(e.target) == case.target);
    let Some(equation) = found else {
        let shown = sidc_emit::evidence(&discovery);
        // For an equation that could not be found, the reason says what its library lacks.
        let lacks = shown.contains("which it lacks") && case.causes.contains(&Cause::MissingTerm);
        return Ok(Outcome {
            named: if lacks {
                Cause::MissingTerm.name().into()
            } else {
                String::new()
            },
            right_cause: lacks,
            right_answer: false,
            passes: false,
            firm: Vec::new(),
            shown,
        });
    };
    let language = Language(&discovery);
    let mut terms: Vec<String> = equation
        .terms
        .iter()
        .map(|t| planned_word(language.term(&t.term)))
        .collect();
    terms.sort();
    let right_answer = case.truth.is_some_and(|truth| {
        let mut truth: Vec<String> = truth.iter().map(|t| t.to_string()).collect();
        truth.sort();
        truth == terms
    });
    let firm = |t: &&FoundTerm| t.evidence.as_ref().is_some_and(|t| t.mark == Mark::Firm);
    let marked = equation.terms.iter().filter(firm);
    let wrong = |name: &String| {
        !case
            .truth
            .is_some_and(|truth| truth.contains(&name.as_str()))
    };
    let firm = marked
        .map(|t| planned_word(language.term(&t.term)))
        .filter(wrong)
        .collect();
    let evidence = equation.evidence.as_ref();
    let judged = evidence.and_then(|e| e.identifiability.as_ref());
    let leading = judged.and_then(|i| i.findings.first());
    Ok(Outcome {
        named: leading.map_or_else(String::new, |f| f.cause.name().into()),
        right_cause: leading.is_some_and(|f| case.causes.contains(&f.cause)),
        right_answer,
        passes: equation.status != Status::Doubt,
        firm,
        shown: sidc_emit::evidence(&discovery),
    })
}

/// The spelling used in the plan for a function that its library has in two forms.
fn planned_word(term: String) -> String {
    match term.as_str() {
        "sqrt(x^2)" => "abs(x)".into(),
        "sin(x)*cos(x)" => "sin(2*x)".into(),
        "cosh(x)*tanh(x)" => "sinh(x)".into(),
        _ => term,
    }
}

/// # Errors
/// Diagnostics, as text.
pub fn identify(case: &Case) -> Result<Discovery, String> {
    let mut sources = Sources::default();
    let file = sources.add("planted.sid", case.model.as_str());
    let (program, said) = pipeline::compile(file, &sources, pipeline::MEMORY);
    let program = program.ok_or_else(|| render(&said, &sources, false))?;
    let mut tables = Vec::new();
    for (i, text) in case.tables.iter().enumerate() {
        let name = format!("{i}.csv");
        let table = read(&name, text.as_bytes(), &Limits::default(), &mut sources);
        tables.push(table.map_err(|d| render(&d, &sources, false))?);
    }
    let (data, options) = (
        pipeline::from_tables(tables, Vec::new()),
        Options::default(),
    );
    let staged = pipeline::measure(&program, &data, &options, &mut sources, &mut Unwatched);
    let measured = staged.0.ok_or_else(|| render(&staged.1, &sources, false))?;
    let found = pipeline::identify(&program, &measured, &options, &mut Unwatched);
    found.map_err(|d| render(&d, &sources, false))
}
