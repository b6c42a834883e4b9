//! Evidence as text: proofs, measured figures, and every doubt.

use sidc_lang::term::SignalNames;
use sidc_system::discovery::{
    ChannelFit, Discovery, Equation, Evidence, JointEvidence, NormGrading, Proof, Rearranged,
    Reason, ReasonCode, RowOrigin,
};

use crate::text::layout::{TEXT_WIDTH, wrapped};
use crate::text::{
    certificate_range, coefficient_inference, coefficient_units, identifiability, relations,
    sparsest, verification,
};
use sidc_lang::number::{percent, significant};

/// Everything behind each equation, a line each: units, fit, proof, reasons, terms, what the data tell apart.
pub fn evidence(d: &Discovery) -> String {
    let mut out = String::new();
    for e in &d.equations {
        out.push_str(&format!("{}:\n", d.name(e.target)));
        out.push_str(&coefficient_units::lines(d, e));
        let mut lines = remarks(d, e);
        lines.extend(e.reasons.iter().flat_map(|r| reason("doubt", r)));
        lines.extend(coefficient_inference::lines(d, e));
        let told = e.evidence.as_ref().and_then(|e| e.identifiability.as_ref());
        lines.extend(told.into_iter().flat_map(|i| identifiability::lines(i)));
        out.push_str(&indented(&lines));
    }
    for f in &d.failed {
        let lines: Vec<String> = f.reasons.iter().flat_map(|r| reason("failed", r)).collect();
        out.push_str(&format!(
            "{}: not found\n{}",
            d.name(f.target),
            indented(&lines)
        ));
    }
    let judged = d.equations.iter().filter_map(|e| e.evidence.as_ref());
    let judged = judged.filter_map(|e| e.identifiability.as_deref());
    let mut lines = identifiability::ranges(judged, &d.frequency_unit());
    lines.extend(coefficient_inference::rule(d));
    lines.extend(relations::searched(d));
    let wrapped = lines
        .iter()
        .flat_map(|l| wrapped(l, TEXT_WIDTH, "", "    "));
    out.extend(wrapped.map(|l| format!("{l}\n")));
    out
}

fn indented(lines: &[String]) -> String {
    let wrapped = lines
        .iter()
        .flat_map(|l| wrapped(l, TEXT_WIDTH, "    ", "        "));
    wrapped.map(|l| format!("{l}\n")).collect()
}

fn reason(kind: &str, r: &Reason) -> [String; 2] {
    [
        format!("{kind}[{}]: {}", r.code, r.text),
        format!("help: {}", r.explained_advice()),
    ]
}

const STATED: &str = "stated by the model";

/// Fit and proof of one equation, a sentence each.
pub fn remarks(d: &Discovery, e: &Equation) -> Vec<String> {
    let Some(evidence) = &e.evidence else {
        return vec![format!("known: {STATED}")];
    };
    let mut lines = match &evidence.joint {
        Some(together) => jointly(d, evidence, together),
        None if evidence.candidates == 0 => {
            vec![format!(
                "{} on {} rows; {STATED}",
                fit(evidence),
                evidence.rows
            )]
        }
        None => vec![
            format!("{}; {}", fit(evidence), scope(evidence)),
            proof(evidence),
        ],
    };
    lines.extend(
        evidence
            .certificate_range
            .iter()
            .map(certificate_range::line),
    );
    lines.extend(sparsest::lines(e));
    lines.extend(verification::lines(evidence.verification.as_deref()));
    // The doubt says the same with more figures.
    if e.reasons.iter().all(|r| r.code != ReasonCode::SameRelation) {
        lines.extend(evidence.relation.as_ref().and_then(independent));
    }
    lines
}

/// The law that the equation replaced because it repeats another one.
fn independent(r: &Rearranged) -> Option<String> {
    let other = r.other.as_ref().filter(|_| r.independent)?;
    let terms: Vec<&str> = other.terms.iter().map(|(t, _)| t.as_str()).collect();
    Some(format!(
        "chosen to be independent of the equation of {}: {{{}}} leaves {} of the target, but says the same as that",
        r.of.join(" and "),
        terms.join(", "),
        significant(other.residual, 2)
    ))
}

/// Residuals of the trajectory, the search for terms, and sets of terms that are nearly as good.
fn jointly(d: &Discovery, evidence: &Evidence, t: &JointEvidence) -> Vec<String> {
    let mut lines: Vec<String> = match &t.disturbance {
        None => t.channels.iter().flat_map(|c| channel(d, c)).collect(),
        Some(_) => t.channels.iter().map(innovations).collect(),
    };
    let terms = match evidence.searched < evidence.candidates {
        true => format!("{} of {} terms", evidence.searched, evidence.candidates),
        false => format!("{} terms", evidence.candidates),
    };
    if evidence.candidates == 0 {
        lines.push(STATED.into());
        return lines;
    }
    let mut search = format!(
        "{terms}; {} sets of terms of all equations fitted with the trajectory",
        t.tried
    );
    if let Some((term, earned)) = &t.weakest {
        search.push_str(&format!(
            "; least missed: {term}, which earns {earned:.0} (a term costs {:.0})",
            t.price
        ));
    }
    lines.push(search);
    let ties = evidence.ties.iter().zip(&t.ties);
    lines.extend(ties.map(|(terms, more)| {
        let terms = terms.join(", ");
        format!("nearly as good: {{{terms}}}, criterion {more:+.1}")
    }));
    lines
}

fn whiteness(c: &ChannelFit) -> String {
    match c.autocorrelation.abs() <= c.white_noise_bound {
        true => "white".into(),
        false => format!("autocorrelation {:.2}", c.autocorrelation),
    }
}

/// The fit of a channel whose laws are disturbed: predictions one sample ahead.
fn innovations(c: &ChannelFit) -> String {
    format!(
        "fit: {} one sample ahead to {} ({} of its spread), errors {}; noise of its sensor {}",
        c.signal,
        significant(c.residual, 2),
        percent(c.relative),
        whiteness(c),
        significant(c.noise, 2)
    )
}

fn channel(d: &Discovery, c: &ChannelFit) -> Vec<String> {
    let white = whiteness(c);
    let noise = match (c.declared, c.lasting) {
        (true, _) => format!("declared noise {}", significant(c.noise, 2)),
        (false, None) => format!("smoothing alone sees noise of {}", significant(c.noise, 2)),
        (false, Some(_)) => "smoothing cannot see noise that lasts".into(),
    };
    let mut lines = vec![format!(
        "fit: {} to {} ({} of its spread), residuals {white}; {noise}",
        c.signal,
        significant(c.residual, 2),
        percent(c.relative)
    )];
    if let Some(noise) = c.growing {
        let floor = match noise.floor > 0.0 {
            true => format!("{} and ", significant(noise.floor, 2)),
            false => String::new(),
        };
        lines.push(format!(
            "noise of {} grows with the signal: {floor}{} of the value",
            c.signal,
            percent(noise.share)
        ));
    }
    if let Some(memory) = c.lasting {
        lines.push(format!(
            "noise of {} lasts: an error fades with a time constant of {}",
            c.signal,
            d.duration(memory)
        ));
    }
    if c.left_out > 0 {
        lines.push(format!(
            "robust: {} readings of {} had no weight",
            c.left_out, c.signal
        ));
    }
    if !c.files.is_empty() {
        let files: Vec<String> = (c.files.iter())
            .map(|(name, left)| format!("{} in {name}", significant(*left, 2)))
            .collect();
        lines.push(format!(
            "noise of {} by file: {}",
            c.signal,
            files.join(", ")
        ));
    }
    lines
}

fn fit(e: &Evidence) -> String {
    let mut out = format!("fit: residual {} of the target", significant(e.residual, 2));
    if e.target_error > 0.0 {
        out.push_str(&format!(
            " (its estimated error: {})",
            significant(e.target_error, 2)
        ));
    }
    if let Some(h) = &e.held_out {
        out.push_str(&format!(
            "; {} on {} rows held out",
            significant(h.residual, 2),
            h.rows
        ));
    }
    out
}

fn scope(e: &Evidence) -> String {
    let rows = match e.origin {
        RowOrigin::Samples => "rows".into(),
        RowOrigin::Integrals { .. } => format!("integrals ({})", e.origin),
        RowOrigin::AllSamples { .. } => format!("rows ({})", e.origin),
    };
    format!("{} terms tried on {} {rows}", e.candidates, e.rows)
}

/// A line on what the certificate proves, and what it does not.
fn proof(e: &Evidence) -> String {
    let p = &e.certificate;
    let mut fits = if p.tolerance == 0.0 {
        "fits these rows".to_string()
    } else {
        format!("fits within {} of the target", significant(p.tolerance, 2))
    };
    if p.constrained {
        fits.push_str(" and obeys the constraints (tied equations taken together)");
    }
    if !p.optimal && p.max_correlation == 0.0 {
        return format!(
            "not proved: `{}` gives no dual bound; this is not a proof of the sparsest answer",
            e.solver
        );
    }
    if !p.optimal {
        return format!(
            "not proved: the dual bound leaves a gap of {} (max |φᵀλ| {:.6})",
            significant(p.gap, 2),
            p.max_correlation
        );
    }
    let (norm, figures) = (norm(p), figures(p));
    match (p.of_answer, p.unique) {
        (true, true) => format!(
            "proved: of all that {fits}, this has the smallest {norm}, and no other equals it ({figures})"
        ),
        (true, false) => {
            format!("proved: of all that {fits}, none has a smaller {norm} ({figures})")
        }
        (false, _) => format!(
            "proved for the solver's proposal: of all that {fits}, it has the smallest {norm} ({figures}); \
             the terms (rank {} of {}) are the best of {} by the extended Bayesian criterion{}",
            p.rank,
            p.support,
            e.searched,
            match e.relation.as_ref().is_some_and(|r| r.independent) {
                true => " that are independent",
                false => "",
            }
        ),
    }
}

/// The name of the norm.
fn norm(p: &Proof) -> String {
    let Some(NormGrading {
        base,
        penalized: dear,
    }) = &p.grading
    else {
        return "1-norm".into();
    };
    let base = significant(*base, 3);
    let dear = match dear.is_empty() {
        true => String::new(),
        false => format!(", and 1e5 times as much for each power of {dear}"),
    };
    format!(
        "1-norm in which a term weighs {base}^d, d its degree by how much its factors vary{dear}"
    )
}

fn figures(p: &Proof) -> String {
    // A negative gap is rounding of the residual.
    let mut out = format!("gap {}", significant(p.gap.abs(), 2));
    if p.of_answer {
        out.push_str(&format!(
            ", |φᵀλ| ≤ {:.4} off the support, rank {} of {}",
            1.0 - p.margin,
            p.rank,
            p.support
        ));
    } else {
        out.push_str(&format!(", max |φᵀλ| {:.6}", p.max_correlation));
    }
    out
}
