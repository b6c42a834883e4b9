//! The assessment of one equation: figures, relations, equivalent supports and findings together.
//!
//! In: the [`ScaledDesign`] of an equation, its library, the rows. Out: an [`Identifiability`]; the doubt `tie` for an equation.

use super::collinearity::equivalent_supports::{equivalent_supports, supports_tied_in_refits};
use super::collinearity::gram_matrix::{GramMatrix, rank};
use super::collinearity::relation::ExplainedRelation;
use super::collinearity::restricted_isometry::restricted_isometry;
use super::collinearity::term_relations::explained_relations;
use super::diagnosis::findings::{UNEXPLAINED, findings, misspecification_finding, relation_doubt};
use super::diagnosis::messages;
use super::diagnosis::misspecification::{Specification, find_misspecification};
use super::diagnosis::series_of_law::series_doubt;
use super::excitation;
use super::thresholds::LISTED;
use crate::scaled_design::ScaledDesign;
use crate::tie;
use sidc_data::Samples;
use sidc_lang::library::Library;
use sidc_lang::model::Model;
use sidc_lang::term::{Language, Term};
use sidc_solve::threads;
use sidc_system::discovery::{
    CosineTable, Discovery, Equation, Failed, Finding, Identifiability, Pair, Reason, ReasonCode,
    Relation, Status,
};

/// The rows that equations were found from.
#[derive(Clone, Copy)]
pub struct Rows<'a> {
    pub samples: &'a Samples,
    /// The same with the measured or estimated targets, if the rows are those of a fitted trajectory.
    pub read: Option<&'a Samples>,
    /// Headers of columns of the data that the model does not read.
    pub unread: &'a [String],
}

/// Whether measured targets are needed: something is unexplained, and only they show what is missing.
pub fn needs_measured_targets(discovery: &Discovery) -> bool {
    let failed = discovery.failed.iter().flat_map(|f| &f.reasons);
    let doubts = discovery.equations.iter().flat_map(|e| &e.reasons);
    let others = [ReasonCode::Tie, ReasonCode::NotSettled];
    let open = |r: &Reason| UNEXPLAINED.contains(&r.code) || others.contains(&r.code);
    doubts.chain(failed).any(open)
}

/// What is wrong with the library or the order of an equation that was not found.
pub fn misspecification(
    model: &Model,
    library: &Library,
    rows: Rows,
    failed: &Failed,
) -> Option<Finding> {
    let unexplained = |r: &Reason| UNEXPLAINED.contains(&r.code);
    let equation = Equation {
        target: failed.target,
        terms: Vec::new(),
        status: Status::Doubt,
        reasons: Vec::new(),
        evidence: None,
        path: Vec::new(),
    };
    let specification = Specification {
        model,
        library,
        equation: &equation,
        unexplained: failed.reasons.iter().any(unexplained),
    };
    let read = rows.read?;
    let found = find_misspecification(&specification, read);
    let found = found.filter(|_| specification.unexplained)?;
    let columns = (read, rows.unread);
    Some(misspecification_finding(
        model,
        failed.target,
        &found,
        columns,
    ))
}

/// What the rows can distinguish for one equation, and the doubts that follow from it.
#[derive(Debug)]
pub struct Assessment {
    identifiability: Identifiability,
    /// Doubts that follow.
    reasons: Vec<Reason>,
}

/// What the rows can distinguish for one equation; the rank of its library only if `ranks` is set.
pub fn assess(design: &ScaledDesign, library: &Library, rows: Rows, ranks: bool) -> Assessment {
    let model = design.model;
    let gram = GramMatrix::of(design);
    let language = Language(model);
    let name = |p: usize| language.term(design.term(p));
    let pairs = gram.largest_cosines(LISTED.pairs);
    // The rank of a thousand columns takes as long as everything else.
    let everything_else = || {
        let mut equivalent = equivalent_supports(design, &gram);
        equivalent.extend(supports_tied_in_refits(design, &gram));
        let relations = explained_relations(design, &gram, library, &equivalent);
        let read = rows.read.unwrap_or(rows.samples);
        let findings = findings(design, library, (read, rows.unread), &relations);
        (relations, findings, equivalent)
    };
    let ((relations, findings, equivalent), (rank, tolerance)) = match ranks {
        true => threads::join(everything_else, || rank(design, &gram)),
        false => (everything_else(), (0, 0.0)),
    };
    let mut supports: Vec<Vec<String>> = Vec::new();
    for e in &equivalent {
        let names: Vec<String> = e.support.iter().map(|p| name(*p)).collect();
        if !supports.contains(&names) {
            supports.push(names);
        }
    }
    let equivalent_more = supports.len().saturating_sub(LISTED.equivalent_supports);
    supports.truncate(LISTED.equivalent_supports);
    let identifiability = Identifiability {
        rows: design.rows(),
        columns: design.columns.len(),
        candidates: design.candidates,
        rank,
        tolerance,
        coherence: pairs.first().map_or(0.0, |p| p.2.abs()),
        condition: gram.condition(&design.support),
        neighbour: worst_neighbour(design, &gram).map(|(p, c)| (name(p), c)),
        alike: cosine_table(design, &gram),
        pairs: pairs
            .iter()
            .map(|(i, j, cosine)| Pair {
                first: name(*i),
                second: name(*j),
                cosine: *cosine,
            })
            .collect(),
        isometry: restricted_isometry(&gram, design.support.len()),
        idle: design
            .zero_columns
            .iter()
            .take(LISTED.zero_columns)
            .map(|t| language.term(t))
            .collect(),
        idle_more: design
            .zero_columns
            .len()
            .saturating_sub(LISTED.zero_columns),
        relations: relations
            .iter()
            .take(LISTED.relations)
            .map(|t| written_relation(design, t))
            .collect(),
        equivalent: supports,
        equivalent_more,
        excitation: excitation::excitation(design, library),
        leverage: excitation::leverage(design),
        findings,
    };
    let series = series_doubt(design, library);
    Assessment {
        identifiability,
        reasons: series
            .into_iter()
            .chain(relation_doubt(design, &relations))
            .collect(),
    }
}

/// The cosines between the terms of the support and the columns most collinear with one of them.
fn cosine_table(design: &ScaledDesign, gram: &GramMatrix) -> Option<CosineTable> {
    let support: Vec<usize> = design
        .support
        .iter()
        .copied()
        .take(LISTED.cosine_terms)
        .collect();
    let largest_cosine = |p: usize| {
        let cosines = support.iter().map(|s| gram.cosine(*s, p).abs());
        cosines.fold(0.0, f64::max)
    };
    let mut others: Vec<(usize, f64)> = (0..gram.len())
        .filter(|p| !design.support.contains(p))
        .map(|p| (p, largest_cosine(p)))
        .collect();
    others.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    let room = LISTED
        .cosine_rivals
        .min(LISTED.cosine_terms - support.len());
    let columns = support.iter().copied();
    let columns: Vec<usize> = columns
        .chain(others.iter().take(room).map(|o| o.0))
        .collect();
    let rounded = |x: f64| (x * 1e4).round() / 1e4;
    let row = |(i, p): (usize, &usize)| {
        let before = columns.iter().take(i);
        before.map(|q| rounded(gram.cosine(*p, *q))).collect()
    };
    let language = Language(design.model);
    (!support.is_empty()).then(|| CosineTable {
        terms: (columns.iter().map(|p| language.term(design.term(*p)))).collect(),
        support: support.len(),
        cosines: columns.iter().enumerate().map(row).collect(),
    })
}

/// Attaches the assessment to an equation and doubts it if another support of equal size fits as well. Where the trajectory was
/// estimated, refits have decided that.
pub fn attach(equation: &mut Equation, assessment: Assessment) {
    let Assessment {
        identifiability: assessment,
        reasons,
    } = assessment;
    for reason in reasons {
        equation.doubt(reason);
    }
    let Some(evidence) = &equation.evidence else {
        return;
    };
    let said = equation.reasons.iter().any(|r| r.code == ReasonCode::Tie);
    let refitted = evidence.joint.is_some();
    if !said
        && !refitted
        && let Some(reason) = tie(&assessment.equivalent)
    {
        equation.doubt(reason);
    }
    if let Some(evidence) = &mut equation.evidence {
        evidence.identifiability = Some(Box::new(assessment));
    }
}

/// The column that gives the largest condition number when added to the support.
fn worst_neighbour(design: &ScaledDesign, gram: &GramMatrix) -> Option<(usize, f64)> {
    let none = design.support.is_empty();
    let others = (0..gram.len()).filter(|p| !none && !design.support.contains(p));
    let with = |p: usize| gram.condition(&[design.support.as_slice(), &[p]].concat());
    let mut worst: Option<(usize, f64)> = None;
    for p in others {
        let condition = with(p);
        if worst.is_none_or(|(_, c)| condition > c) {
            worst = Some((p, condition));
        }
    }
    worst
}

fn written_relation(design: &ScaledDesign, t: &ExplainedRelation) -> Relation {
    let language = Language(design.model);
    let whole = |(w, r): &(f64, Term)| (language.term(&r.mul(&t.reduced.common)), *w);
    Relation {
        terms: t.reduced.terms.iter().map(whole).collect(),
        text: messages::sentence(design, &t.reduced, t.left_term().as_ref()),
        size: t.reduced.residual,
        cause: t.why.cause,
        why: messages::why(design, &t.why),
        touches: t.support_terms.iter().map(|t| language.term(t)).collect(),
        exchanges: t.exchange.is_some(),
    }
}
