//! Intervals, stability and alternatives on problems whose answer is known.

use super::{
    assess_terms as assess, confidence_intervals, doubt_unneeded_terms, mark_terms,
    stability_selection,
};
use crate::SplitMix;
use sidc_lang::model::Model;
use sidc_lang::term::{Signal, Term, VarId};
use sidc_system::discovery::{
    BlockNormalEquations, Discovery, DropOneRefit, Equation, Evidence, FoundTerm, MARKS, Mark,
    ReasonCode, Status, TermEvidence,
};

const TARGET: Signal = Signal {
    var: VarId(1),
    der: 1,
    shift: 0,
};

fn assess_terms(blocks: &BlockNormalEquations, d: &mut Discovery) {
    assess(blocks, &stability_selection(blocks), d);
}

fn column(j: u16) -> Term {
    Term::signal(Signal::new(VarId(j + 2)))
}

/// Rows of random columns; with `twin`, column 5 is column 0 plus a small part. The target is 2 × column 0 − column 1 plus noise.
fn blocks(noise: f64, twin: Option<f64>) -> BlockNormalEquations {
    let mut random = SplitMix::new(4);
    let (rows, p) = (400, 6);
    let mut products = vec![vec![0.0; (p + 1) * (p + 1)]; 20];
    for row in 0..rows {
        let mut x: Vec<f64> = (0..p).map(|_| random.normal()).collect();
        if let Some(part) = twin {
            x[5] = x[0] + part * x[5];
        }
        x.push(2.0 * x[0] - x[1] + noise * random.normal());
        for i in 0..=p {
            for j in 0..=p {
                products[row / 20][i * (p + 1) + j] += x[i] * x[j] / (noise * noise);
            }
        }
    }
    let mut whole = vec![0.0; (p + 1) * (p + 1)];
    for part in &products {
        whole.iter_mut().zip(part).for_each(|(s, x)| *s += x);
    }
    BlockNormalEquations {
        whole,
        columns: (0..p as u16).map(|j| (TARGET, column(j))).collect(),
        products,
        support: vec![0, 1],
        readings: rows as f64,
        price: (12.0, 11.0),
    }
}

fn discovery() -> Discovery {
    let term = |j: u16, coefficient: f64| FoundTerm {
        term: column(j),
        coefficient,
        fixed: false,
        standard_error: Some(0.01),
        evidence: None,
        runs: Vec::new(),
    };
    Discovery {
        equations: vec![Equation {
            target: TARGET,
            terms: vec![term(0, 2.0), term(1, -1.0)],
            status: Status::Pass,
            reasons: Vec::new(),
            evidence: Some(Evidence::default()),
            path: Vec::new(),
        }],
        ..Discovery::default()
    }
}

fn assessed(blocks: &BlockNormalEquations) -> Vec<TermEvidence> {
    let mut d = discovery();
    confidence_intervals(&mut d.equations[0], blocks.readings);
    assess_terms(blocks, &mut d);
    mark_terms(&mut d);
    let terms = d.equations[0].terms.iter();
    terms.map(|t| *t.evidence.clone().unwrap()).collect()
}

#[test]
fn terms_that_stand_out_are_firm() {
    for t in assessed(&blocks(0.1, None)) {
        assert_eq!((t.mark, t.stability), (Mark::Firm, Some(1.0)));
        assert!(t.without.unwrap().cost > 100.0);
    }
}

#[test]
fn errors_of_twins_are_opposite() {
    let mut d = discovery();
    let mut twins = blocks(0.1, Some(1e-4));
    twins.support = vec![0, 1, 5];
    assess_terms(&twins, &mut d);
    let [all] = &d.correlations[..] else {
        panic!("{:?}", d.correlations)
    };
    assert!(all.is_sound() && all.of.len() == 3);
    let least = all.below.iter().copied().fold(1.0, f64::min);
    assert!(least < -0.99, "{all:?}");
}

/// Two columns that differ by a ten-thousandth replace each other at no cost.
#[test]
fn a_twin_makes_a_term_doubtful_and_is_named() {
    let all = assessed(&blocks(0.1, Some(1e-4)));
    let without = all[0].without.as_ref().unwrap();
    assert_eq!(without.enter.len(), 1);
    assert!(without.leave.is_empty() && without.cost.abs() < 6.0);
    assert_eq!((all[0].mark, all[1].mark), (Mark::Doubtful, Mark::Firm));
    assert!(all[0].stability.unwrap() < 0.9);
}

/// The smaller term is below the noise, so only some halves select it.
#[test]
fn weak_terms_are_found_on_some_halves() {
    let all = assessed(&blocks(6.0, None));
    let shares: Vec<f64> = all.iter().filter_map(|t| t.stability).collect();
    assert!(shares[0] > shares[1] && shares[1] < 0.9, "{shares:?}");
    assert_ne!(all[1].mark, Mark::Firm);
}

#[test]
fn intervals_are_those_of_student() {
    let mut d = discovery();
    confidence_intervals(&mut d.equations[0], 12.0);
    let (low, high) = d.equations[0].terms[0]
        .evidence
        .as_ref()
        .unwrap()
        .interval
        .unwrap();
    // Ten degrees of freedom: 2.228 standard errors.
    assert!((high - 2.0 - 0.02228).abs() < 1e-5 && (low + high - 4.0).abs() < 1e-12);
}

#[test]
fn terms_of_a_doubted_equation_are_never_firm() {
    let mut d = discovery();
    d.equations[0].status = Status::Doubt;
    confidence_intervals(&mut d.equations[0], 100.0);
    assess_terms(&blocks(0.1, None), &mut d);
    mark_terms(&mut d);
    let marks = d.equations[0]
        .terms
        .iter()
        .map(|t| t.evidence.as_ref().unwrap());
    assert!(marks.clone().all(|t| t.mark == Mark::Likely));
    assert!(marks.clone().all(|t| MARKS.of(t) == Mark::Firm));
}

#[test]
fn without_evidence_no_term_is_firm() {
    let mut d = discovery();
    confidence_intervals(&mut d.equations[0], 100.0);
    mark_terms(&mut d);
    let marks = d.equations[0]
        .terms
        .iter()
        .filter_map(|t| t.evidence.as_ref());
    assert!(marks.map(|t| t.mark).all(|m| m == Mark::Likely));
}

#[test]
fn an_equation_that_is_better_without_a_term_is_doubted() {
    let with = |cost: f64| {
        let mut d = discovery();
        let without = DropOneRefit {
            cost,
            ..DropOneRefit::default()
        };
        d.equations[0].terms[0].evidence = Some(Box::new(TermEvidence {
            without: Some(without),
            ..TermEvidence::default()
        }));
        doubt_unneeded_terms(&mut d, &Model::default(), &|_, _| false);
        d.equations[0].reasons.iter().map(|r| r.code.clone()).next()
    };
    assert_eq!(with(-7.0), Some(ReasonCode::BetterWithout));
    assert_eq!(with(-5.0), None);
}

/// There are too few blocks to draw halves.
#[test]
fn no_stability_is_claimed_of_two_blocks() {
    let mut few = blocks(0.1, None);
    few.products.truncate(2);
    assert!(assessed(&few).iter().all(|t| t.stability.is_none()));
}

/// A library of one term has no replacement for it.
#[test]
fn a_single_term_is_replaced_by_nothing() {
    let mut all = blocks(0.1, None);
    all.columns.truncate(1);
    all.support = vec![0];
    for part in all.products.iter_mut().chain([&mut all.whole]) {
        *part = vec![part[0], part[6], part[6], part[48]];
    }
    let mut d = discovery();
    d.equations[0].terms.truncate(1);
    assess_terms(&all, &mut d);
    let trust = d.equations[0].terms[0].evidence.as_ref().unwrap();
    let without = trust.without.as_ref().unwrap();
    assert!(without.enter.is_empty() && without.cost > 20.0);
}
