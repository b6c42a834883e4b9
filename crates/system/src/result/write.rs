//! Discovery → document → text.

use crate::discovery::{Discovery, Equation, FoundTerm, Notice, PathKnot};
use crate::result::{
    Document, DocumentContext, EquationEntry, FailedEntry, JumpEntry, KnotEntry, ResetEntry,
    TermEntry, TimeKind, VERSION, VariableEntry,
};
use sidc_lang::model::{Reset, VarKind};
use sidc_lang::term::{Expr, Language, Signal, SignalNames};

/// The document of a discovery as JSON text, ending in a newline.
///
/// # Errors
/// As [`text`].
pub fn write(d: &Discovery, beside: DocumentContext) -> Result<String, serde_json::Error> {
    text(&document(d, beside))
}

/// A document as JSON text, ending in a newline.
///
/// # Errors
/// Only if a figure cannot be represented, which would be a fault of this program.
pub fn text(document: &Document) -> Result<String, serde_json::Error> {
    serde_json::to_string_pretty(document).map(|text| text + "\n")
}

/// The document of a discovery.
pub fn document(d: &Discovery, beside: DocumentContext) -> Document {
    Document {
        sidc_result: VERSION,
        system: d.system.clone(),
        time: if d.discrete {
            TimeKind::Discrete
        } else {
            TimeKind::Continuous
        },
        time_unit: d.unit(Signal::TIME).map(|u| u.to_string()),
        variables: d.variables.iter().skip(1).map(variable).collect(),
        equations: d.equations.iter().map(|e| equation(d, e)).collect(),
        resets: d.resets.iter().map(|r| reset(d, r)).collect(),
        failed: d
            .failed
            .iter()
            .map(|f| FailedEntry {
                target: d.name(f.target),
                reasons: f.reasons.clone(),
            })
            .collect(),
        runs_left: d.runs_left.clone(),
        rests: d.rests.clone(),
        relations: d.relations.clone(),
        delays: d.delays.clone(),
        unknowns: d.unknowns.clone(),
        correlations: d.correlations.clone(),
        hidden: d.hidden.clone(),
        settings: beside.settings,
        signals: beside.signals,
        warnings: warnings(d, beside.warnings),
        validation: beside.validation,
        verdict: beside.verdict,
        candidates: beside.candidates,
    }
}

/// Warnings of model and data, and what is to be said of how the equations were found.
fn warnings(d: &Discovery, mut given: Vec<Notice>) -> Vec<Notice> {
    let other = d.other_way().filter(|notice| !given.contains(notice));
    given.extend(other);
    given
}

fn variable(v: &crate::discovery::Variable) -> VariableEntry {
    let kind = match v.kind {
        VarKind::Time => "time",
        VarKind::State => "state",
        VarKind::Input => "input",
        VarKind::Output => "output",
        VarKind::Param => "param",
        VarKind::Unknown => "unknown",
    };
    VariableEntry {
        name: v.name.clone(),
        kind: kind.into(),
        order: v.order,
        unit: v.unit.as_ref().map(ToString::to_string),
    }
}

fn reset(d: &Discovery, reset: &Reset) -> ResetEntry {
    let jump = |(signal, value): &(Signal, Expr)| JumpEntry {
        signal: d.name(*signal),
        value: Language(d).expr(value),
    };
    ResetEntry {
        when: reset.condition.text(d),
        jumps: reset.jumps.iter().map(jump).collect(),
    }
}

fn equation(d: &Discovery, e: &Equation) -> EquationEntry {
    EquationEntry {
        target: d.name(e.target),
        terms: terms(d, e.target, &e.terms),
        status: e.status,
        reasons: e.reasons.clone(),
        evidence: e.evidence.clone(),
        path: e.path.iter().map(|k| knot(d, e.target, k)).collect(),
    }
}

fn terms(d: &Discovery, target: Signal, terms: &[FoundTerm]) -> Vec<TermEntry> {
    let finite = |(low, high): &(f64, f64)| low.is_finite() && high.is_finite();
    let entry = |t: &FoundTerm| TermEntry {
        term: Language(d).term(&t.term),
        coefficient: t.coefficient,
        unit: d.coefficient_unit(target, &t.term).map(|u| u.to_string()),
        fixed: t.fixed,
        standard_error: t.standard_error.filter(|s| s.is_finite()),
        runs: t.runs.clone(),
        interval: (t.evidence.as_ref()).and_then(|t| t.interval.filter(finite)),
        stability: t.evidence.as_ref().and_then(|t| t.stability),
        without: t.evidence.as_ref().and_then(|t| t.without.clone()),
        mark: t.evidence.as_ref().map(|t| t.mark),
    };
    terms.iter().map(entry).collect()
}

fn knot(d: &Discovery, target: Signal, k: &PathKnot) -> KnotEntry {
    KnotEntry {
        number: k.number,
        penalty: k.penalty,
        residual: k.residual,
        terms: terms(d, target, &k.terms),
        gap: k.gap,
    }
}
