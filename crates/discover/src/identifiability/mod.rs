//! What the data can tell apart, equation by equation: rank, relations, equivalent models, excitation, and what to record next.
//!
//! In: the [`ScaledDesign`] of an equation, its library, the rows. Out: an [`Identifiability`] for its evidence, and the
//! doubt `tie` where another support of equal size does as well. Never changes an equation, never reads or prints.

mod advice;
mod cause;
mod equivalents;
mod excitation;
mod findings;
mod gram;
mod isometry;
mod relations;
mod shortfall;
mod signals;
mod spectrum;
mod tell;

use std::collections::BTreeMap;

use cause::{Reduced, cause, is_bare};
use equivalents::{Equivalent, equivalents, refitted};
use findings::Told;
use gram::Gram;
use relations::{Null, OF_TERMS, Search};

use crate::scaled_design::ScaledDesign;
use crate::tie;
use sidc_data::Samples;
use sidc_lang::library::Library;
use sidc_lang::model::Model;
use sidc_lang::term::{Language, Term};
use sidc_solve::threads;
use sidc_system::discovery::{
    Alike, Discovery, Equation, Failed, Finding, Identifiability, Pair, Reason, ReasonCode,
    Relation, Status,
};

/// Pairs, relations and supports that are listed.
const PAIRS: usize = 5;
const RELATIONS: usize = 12;
const EQUIVALENT: usize = 8;
const IDLE: usize = 12;
/// Terms whose cosines are listed: in all, and beside the support.
const ALIKE_MOST: usize = 16;
const ALIKE_RIVALS: usize = 8;
/// Columns around which relations are searched, beside the support.
const SEEDS: usize = 12;
/// Rest up to which an exchange is told as a relation of the two terms alone.
const ALIKE: f64 = 0.3;

/// The rows equations were found from.
#[derive(Clone, Copy)]
pub struct Rows<'a> {
    pub samples: &'a Samples,
    /// The same with targets as they were read (estimated), where the rows are those of a fitted trajectory.
    pub read: Option<&'a Samples>,
}

/// Whether targets as read are of use: something is not explained, and what is missing shows in them.
pub fn wants_readings(discovery: &Discovery) -> bool {
    let failed = discovery.failed.iter().flat_map(|f| &f.reasons);
    let doubts = discovery.equations.iter().flat_map(|e| &e.reasons);
    let others = [ReasonCode::Tie, ReasonCode::NotSettled];
    let open = |r: &Reason| findings::UNEXPLAINED.contains(&r.code) || others.contains(&r.code);
    doubts.chain(failed).any(open)
}

/// What the library of an equation lacks that was not found though its target was read.
pub fn lacking(model: &Model, library: &Library, rows: Rows, failed: &Failed) -> Option<Finding> {
    let unexplained = |r: &Reason| findings::UNEXPLAINED.contains(&r.code);
    let equation = Equation {
        target: failed.target,
        terms: Vec::new(),
        status: Status::Doubt,
        reasons: Vec::new(),
        evidence: None,
        path: Vec::new(),
    };
    let asked = shortfall::Asked {
        library,
        equation: &equation,
        unexplained: failed.reasons.iter().any(unexplained),
    };
    let found = shortfall::shortfall(&asked, rows.read?).filter(|_| asked.unexplained)?;
    Some(findings::told(model, failed.target, &found))
}

/// What the rows tell apart for one equation.
pub fn judge(frame: &ScaledDesign, library: &Library, rows: Rows) -> Identifiability {
    let model = frame.model;
    let gram = Gram::of(frame);
    let language = Language(model);
    let name = |p: usize| language.term(frame.term(p));
    let pairs = gram.worst(PAIRS);
    // The rank of a thousand columns takes as long as all the rest.
    let look = || {
        let mut equivalent = equivalents(frame, &gram);
        equivalent.extend(refitted(frame, &gram));
        let told = told(frame, &gram, library, &equivalent);
        let read = rows.read.unwrap_or(rows.samples);
        let findings = findings::findings(frame, library, read, &told);
        (told, findings, equivalent)
    };
    let ((told, findings, equivalent), (rank, tolerance)) =
        threads::join(look, || gram::rank(frame, &gram));
    let mut supports: Vec<Vec<String>> = Vec::new();
    for e in &equivalent {
        let names: Vec<String> = e.places.iter().map(|p| name(*p)).collect();
        if !supports.contains(&names) {
            supports.push(names);
        }
    }
    let equivalent_more = supports.len().saturating_sub(EQUIVALENT);
    supports.truncate(EQUIVALENT);
    Identifiability {
        rows: frame.rows(),
        columns: frame.columns.len(),
        candidates: frame.candidates,
        rank,
        tolerance,
        coherence: pairs.first().map_or(0.0, |p| p.2.abs()),
        condition: gram.condition(&frame.support),
        neighbour: neighbour(frame, &gram).map(|(p, c)| (name(p), c)),
        alike: alike(frame, &gram),
        pairs: pairs
            .iter()
            .map(|(i, j, cosine)| Pair {
                first: name(*i),
                second: name(*j),
                cosine: *cosine,
            })
            .collect(),
        isometry: isometry::isometry(&gram, frame.support.len()),
        idle: frame
            .zero_columns
            .iter()
            .take(IDLE)
            .map(|t| language.term(t))
            .collect(),
        idle_more: frame.zero_columns.len().saturating_sub(IDLE),
        relations: told
            .iter()
            .take(RELATIONS)
            .map(|t| written(frame, t))
            .collect(),
        equivalent: supports,
        equivalent_more,
        excitation: excitation::excitation(frame, library),
        leverage: excitation::leverage(frame),
        findings,
    }
}

/// The cosines of the support with each other and with the columns nearest to one of its terms.
fn alike(frame: &ScaledDesign, gram: &Gram) -> Option<Alike> {
    let support: Vec<usize> = frame.support.iter().copied().take(ALIKE_MOST).collect();
    let nearness = |p: usize| {
        let cosines = support.iter().map(|s| gram.at(*s, p).abs());
        cosines.fold(0.0, f64::max)
    };
    let mut others: Vec<(usize, f64)> = (0..gram.len())
        .filter(|p| !frame.support.contains(p))
        .map(|p| (p, nearness(p)))
        .collect();
    others.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    let room = ALIKE_RIVALS.min(ALIKE_MOST - support.len());
    let places = support.iter().copied();
    let places: Vec<usize> = places
        .chain(others.iter().take(room).map(|o| o.0))
        .collect();
    let rounded = |x: f64| (x * 1e4).round() / 1e4;
    let row = |(i, p): (usize, &usize)| {
        let before = places.iter().take(i);
        before.map(|q| rounded(gram.at(*p, *q))).collect()
    };
    let language = Language(frame.model);
    (!support.is_empty()).then(|| Alike {
        terms: (places.iter().map(|p| language.term(frame.term(*p)))).collect(),
        support: support.len(),
        cosines: places.iter().enumerate().map(row).collect(),
    })
}

/// Another support of equal size that rows explain as well is a doubt; where the trajectory was estimated, refits decide.
pub fn attach(equation: &mut Equation, judged: Identifiability) {
    let Some(evidence) = &mut equation.evidence else {
        return;
    };
    let said = equation.reasons.iter().any(|r| r.code == ReasonCode::Tie);
    let refitted = evidence.together.is_some();
    if !said
        && !refitted
        && let Some(reason) = tie(&judged.equivalent)
    {
        equation.reasons.push(reason);
        equation.status = Status::Doubt;
    }
    evidence.identifiability = Some(Box::new(judged));
}

/// The column that, beside the support, makes the largest condition number.
fn neighbour(frame: &ScaledDesign, gram: &Gram) -> Option<(usize, f64)> {
    let none = frame.support.is_empty();
    let others = (0..gram.len()).filter(|p| !none && !frame.support.contains(p));
    let with = |p: usize| gram.condition(&[frame.support.as_slice(), &[p]].concat());
    let mut worst: Option<(usize, f64)> = None;
    for p in others {
        let condition = with(p);
        if worst.is_none_or(|(_, c)| condition > c) {
            worst = Some((p, condition));
        }
    }
    worst
}

/// Every relation that is worth telling, those that allow an exchange first.
fn told(
    frame: &ScaledDesign,
    gram: &Gram,
    library: &Library,
    equivalent: &[Equivalent],
) -> Vec<Told> {
    let search = Search {
        gram,
        columns: frame.columns.iter().map(|c| &c.unit[..]).collect(),
        limits: OF_TERMS,
    };
    let mut all = signals::relations(frame, library);
    for e in equivalent {
        if let Some(null) = exchange(frame, &search, e) {
            let mut t = tell(frame, &null);
            t.exchange = Some((frame.term(e.out).clone(), frame.term(e.into).clone()));
            all.push(t);
        }
    }
    let found = search.around(&seeds(frame));
    all.extend(found.iter().map(|null| tell(frame, null)));
    let mut kept: Vec<Told> = Vec::new();
    let mut met: BTreeMap<String, usize> = BTreeMap::new();
    for t in all {
        let mut names: Vec<String> = (t.reduced.terms.iter())
            .map(|(_, t)| Language(frame.model).term(t))
            .collect();
        names.sort();
        let key = names.join(", ");
        let same = met.get(&key).and_then(|at| kept.get_mut(*at));
        match same {
            Some(first) => {
                first.exchange = first.exchange.take().or(t.exchange);
                for touched in t.touches {
                    if !first.touches.contains(&touched) {
                        first.touches.push(touched);
                    }
                }
            }
            None => {
                met.insert(key, kept.len());
                kept.push(t);
            }
        }
    }
    kept.sort_by_key(|t| (t.exchange.is_none(), t.touches.is_empty() && !t.concerns));
    kept
}

/// The relation behind an exchange: of the two terms if they are alike, else of the whole support and what comes. There is none
/// where noise alone makes both fit as badly.
fn exchange(frame: &ScaledDesign, search: &Search, e: &Equivalent) -> Option<Null> {
    if !frame.support.contains(&e.out) || frame.support.contains(&e.into) {
        return None;
    }
    let pair = search.nearest(&[e.out, e.into])?;
    if pair.size < ALIKE {
        return Some(pair);
    }
    let together = [frame.support.as_slice(), &[e.into]].concat();
    search.nearest(&together).filter(|n| {
        let has = |p: &usize| n.places.contains(p);
        n.size < ALIKE && has(&e.out) && has(&e.into)
    })
}

/// The support, then bare signals and the constant.
fn seeds(frame: &ScaledDesign) -> Vec<usize> {
    let mut seeds = frame.support.clone();
    let bare = |t: &Term| t.is_one() || is_bare(t);
    let places = 0..frame.columns.len();
    let more = places.filter(|p| bare(frame.term(*p)) && !frame.support.contains(p));
    seeds.extend(more.take(SEEDS));
    seeds
}

fn tell(frame: &ScaledDesign, null: &Null) -> Told {
    let reduced = Reduced::new(frame, null);
    let touched = null.places.iter().filter(|p| frame.support.contains(p));
    Told {
        reason: cause(frame, &reduced),
        touches: touched.map(|p| frame.term(*p).clone()).collect(),
        exchange: None,
        concerns: null.places.iter().any(|p| frame.support.contains(p)),
        reduced,
    }
}

fn written(frame: &ScaledDesign, t: &Told) -> Relation {
    let language = Language(frame.model);
    let whole = |(w, r): &(f64, Term)| (language.term(&r.mul(&t.reduced.common)), *w);
    Relation {
        terms: t.reduced.terms.iter().map(whole).collect(),
        text: tell::sentence(frame, &t.reduced, t.lead().as_ref()),
        size: t.reduced.size,
        cause: t.reason.cause,
        why: tell::why(frame, &t.reason),
        touches: t.touches.iter().map(|t| language.term(t)).collect(),
        exchanges: t.exchange.is_some(),
    }
}
