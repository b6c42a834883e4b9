//! Sparse laws that were mixed are found again; what cannot be sparser, is noisy or is not coupled says nothing.

use super::*;
use crate::relations::multiples::Law;
use nalgebra::{DMatrix, DVector};
use sidc_data::{Column, Origin};
use sidc_lang::model::VarKind;
use sidc_lang::term::{Expr, Language, Signal, Term};
use sidc_lang::term::{Func, VarId};
use sidc_progress::Unwatched;
use sidc_random::Numbers;
use sidc_solve::Homotopy;
use sidc_system::discovery::Equation;
use sidc_system::discovery::{Evidence, FewerTerms, FoundTerm, Status, Variable};
use std::collections::BTreeSet;

const ROWS: usize = 150;

/// q̈ of coordinate `k`, q̇, q
fn signals(k: u16) -> [Signal; 3] {
    [2, 1, 0].map(|der| Signal::derivative(VarId(k + 1), der))
}

fn force(n: usize) -> Signal {
    Signal::new(VarId(n as u16 + 1))
}

fn of(name: &str, s: Signal) -> Term {
    Expr::call(Func::named(name).unwrap(), vec![Expr::signal(s)])
        .into_term()
        .1
}

/// Σ coefficient · term = 0 with all highest derivatives linear.
type Laws = Vec<Law>;

/// Terms without highest derivatives.
fn plain_terms(n: usize) -> Vec<Term> {
    let mut all = vec![Term::signal(force(n))];
    for k in 0..n as u16 {
        let [_, rate, place] = signals(k);
        all.extend([
            Term::signal(rate),
            Term::signal(place),
            of("sin", place),
            Term::signal(place).pow(3.0),
        ]);
    }
    all
}

/// Sparse laws of `n` coordinates: law k has its own acceleration and two or three other terms, one of them perhaps another acceleration
/// times a cosine.
fn sparse_laws(n: usize, draw: &mut Numbers) -> Laws {
    let plain = plain_terms(n);
    let mut laws: Laws = Vec::new();
    for k in 0..n {
        let own = signals(k as u16)[0];
        let mut law = vec![(1.0, Term::signal(own))];
        let next = (k + 1) % n;
        let factor = of("cos", signals(k as u16)[2]);
        law.push((
            0.3 + 0.2 * draw.next().abs(),
            Term::signal(signals(next as u16)[0]).mul(&factor),
        ));
        while law.len() < 4 {
            let place = ((draw.next().abs() * 1e6) as usize) % plain.len();
            let term = plain[place].clone();
            if law.iter().all(|(_, t)| *t != term) {
                law.push((
                    if law.len() == 2 { -1.0 } else { 1.0 } * (0.5 + draw.next().abs()),
                    term,
                ));
            }
        }
        laws.push(law);
    }
    laws
}

/// law + factor · m · other
fn mixed(law: &Law, factor: f64, m: &Term, other: &Law) -> Law {
    let own = law.iter().map(|(a, t)| Expr::from((*a, t.clone())));
    let more = other
        .iter()
        .map(|(a, t)| Expr::from((factor * a, t.mul(m))));
    let sum: Expr = own.chain(more).sum();
    sum.terms().map(|(a, t)| (a, t.clone())).collect()
}

/// Signals at random on rows, highest derivatives solved from the laws; `error` is added to them.
fn samples(n: usize, laws: &Laws, error: f64, draw: &mut Numbers) -> Samples {
    let free: Vec<Signal> = (0..n as u16)
        .flat_map(|k| signals(k)[1..].to_vec())
        .chain([force(n)])
        .collect();
    let top: Vec<Signal> = (0..n as u16).map(|k| signals(k)[0]).collect();
    let mut columns: Vec<(Signal, Vec<f64>)> =
        free.iter().chain(&top).map(|s| (*s, Vec::new())).collect();
    for _ in 0..ROWS {
        let values: Vec<f64> = free.iter().map(|_| 1.5 * draw.next()).collect();
        let at = |s: Signal, q: &[f64]| {
            let place = free.iter().position(|f| *f == s).map(|k| values[k]);
            place.unwrap_or_else(|| q[top.iter().position(|f| *f == s).unwrap()])
        };
        let sum = |law: &Law, q: &[f64]| {
            law.iter()
                .map(|(a, t)| a * t.eval(&|s| at(s, q)))
                .sum::<f64>()
        };
        let zero = vec![0.0; n];
        let rest = DVector::from_iterator(n, laws.iter().map(|l| -sum(l, &zero)));
        let mass = DMatrix::from_fn(n, n, |i, j| {
            let mut unit = zero.clone();
            unit[j] = 1.0;
            sum(&laws[i], &unit) - sum(&laws[i], &zero)
        });
        let q = mass.lu().solve(&rest).unwrap();
        for (s, column) in &mut columns {
            let more = if top.contains(s) {
                error * draw.next()
            } else {
                0.0
            };
            column.push(at(*s, q.as_slice()) + more);
        }
    }
    let column = |(signal, values)| Column {
        signal,
        values,
        origin: Origin::Measured { noise: None },
    };
    let mut columns: Vec<Column> = columns.into_iter().map(column).collect();
    columns.sort_by_key(|c| c.signal);
    Samples {
        trajectory: vec![0; ROWS],
        time: (0..ROWS).map(|k| k as f64).collect(),
        columns,
    }
}

/// The laws as equations, each solved for its own acceleration.
fn discovery(n: usize, laws: &Laws) -> Discovery {
    let variable = |name: String, kind| Variable {
        name,
        kind,
        order: 2,
        unit: None,
    };
    let mut variables = vec![variable("t".into(), VarKind::Time)];
    variables.extend((0..n).map(|k| variable(format!("q{k}"), VarKind::State)));
    variables.push(variable("u".into(), VarKind::Input));
    let equation = |(k, law): (usize, &Law)| {
        let target = signals(k as u16)[0];
        let own = Term::signal(target);
        let by = law.iter().find(|(_, t)| *t == own).unwrap().0;
        let right = law.iter().filter(|(_, t)| *t != own);
        Equation {
            target,
            terms: right
                .map(|(a, t)| FoundTerm {
                    term: t.clone(),
                    coefficient: -a / by,
                    fixed: false,
                    standard_error: None,
                    evidence: None,
                    runs: Vec::new(),
                })
                .collect(),
            status: Status::Pass,
            reasons: Vec::new(),
            evidence: Some(Evidence::default()),
            path: Vec::new(),
        }
    };
    Discovery {
        variables,
        equations: laws.iter().enumerate().map(equation).collect(),
        ..Discovery::default()
    }
}

/// What is said of these laws on rows where they hold. The libraries have the terms of all laws given.
fn said(
    n: usize,
    (laws, truth): (&Laws, &Laws),
    error: f64,
    draw: &mut Numbers,
) -> Option<RelationChoices> {
    let rows = samples(n, truth, error, draw);
    let mut terms: Vec<Term> = laws
        .iter()
        .chain(truth)
        .flatten()
        .map(|(_, t)| t.clone())
        .collect();
    terms.sort();
    terms.dedup();
    let libraries = vec![Some(Library::listed(terms)); n];
    let mut d = discovery(n, laws);
    describe_relations(&mut d, &rows, &libraries, (&Homotopy, &mut Unwatched));
    d.relations.map(|r| *r)
}

fn fewer(choices: Option<RelationChoices>) -> FewerTerms {
    choices.and_then(|c| c.fewer).unwrap()
}

/// The terms of a law, whatever it is solved for.
fn names(left: &str, right: impl IntoIterator<Item = String>) -> BTreeSet<String> {
    right.into_iter().chain([left.to_string()]).collect()
}

fn written(d: &Discovery, law: &Law) -> BTreeSet<String> {
    law.iter().map(|(_, t)| Language(d).term(t)).collect()
}

/// Law 0 gets a multiple of law 1: by a number, or by the cosine of its angle, and is found again.
#[test]
fn a_law_that_was_mixed_with_another_is_found_again() {
    let mut tried = 0;
    for (seed, n, turns) in cases() {
        let mut draw = Numbers(seed);
        let truth = sparse_laws(n, &mut draw);
        let m = if turns {
            of("cos", signals(0)[2])
        } else {
            Term::one()
        };
        let mut laws = truth.clone();
        laws[0] = mixed(&truth[0], 0.7, &m, &truth[1]);
        if laws[0].len() <= truth[0].len() {
            continue;
        }
        tried += 1;
        let found = fewer(said(n, (&laws, &truth), 0.0, &mut draw));
        let d = discovery(n, &laws);
        let hidden = written(&d, &truth[0]);
        let all: Vec<BTreeSet<String>> = (found.laws.iter())
            .map(|l| names(&l.law.left, l.law.terms.iter().map(|(t, _)| t.clone())))
            .collect();
        // Another law may have as few terms as the hidden one.
        let recovered = all.iter().any(|l| *l == hidden || l.len() <= hidden.len());
        assert!(
            recovered,
            "seed {seed}, {n}, {turns}: {hidden:?} not in {found:#?}"
        );
        for l in &found.laws {
            assert!(l.residual < 1e-9 && l.law.terms.len() < l.before, "{l:?}");
        }
    }
    assert!(tried > 30, "{tried}");
}

/// All laws mixed by a random matrix near 1.
#[test]
fn laws_that_were_all_mixed_by_numbers_come_apart() {
    for (seed, n, _) in cases() {
        let mut draw = Numbers(seed);
        let truth = sparse_laws(n, &mut draw);
        let mut laws = truth.clone();
        for (i, law) in laws.iter_mut().enumerate() {
            for j in (0..n).filter(|j| *j != i) {
                *law = mixed(law, 0.2 + 0.1 * draw.next(), &Term::one(), &truth[j]);
            }
        }
        let found = fewer(said(n, (&laws, &truth), 0.0, &mut draw));
        let after: usize = found.laws.iter().map(|l| l.law.terms.len() + 1).sum();
        let hidden: usize = truth.iter().map(Vec::len).sum();
        assert_eq!(found.laws.len(), n, "seed {seed}: {found:#?}");
        assert!(
            after <= hidden,
            "seed {seed}: {after} terms, not {hidden}: {found:#?}"
        );
    }
}

/// Seeds, numbers of laws, and whether a multiplier turns with the angle.
fn cases() -> impl Iterator<Item = (u64, usize, bool)> {
    (0..48).map(|k| (0x9e37_79b9 * (k + 1), 2 + (k % 2) as usize, k % 4 > 1))
}

#[test]
fn sparse_laws_are_left_alone_and_the_search_is_told() {
    let mut draw = Numbers(7);
    let truth = sparse_laws(3, &mut draw);
    let found = fewer(said(3, (&truth, &truth), 0.0, &mut draw));
    assert!(found.laws.is_empty(), "{found:?}");
    assert_eq!(found.multipliers[0], "1");
    assert!(found.multiples > 3 && found.sums >= 3, "{found:?}");
}

#[test]
fn in_noise_nothing_is_looked_for() {
    let mut draw = Numbers(7);
    let truth = sparse_laws(2, &mut draw);
    let mut laws = truth.clone();
    laws[0] = mixed(&truth[0], 0.7, &Term::one(), &truth[1]);
    let choices = said(2, (&laws, &truth), 1e-3, &mut draw).unwrap();
    assert_eq!(choices.fewer, None);
    assert!(choices.targets.is_some());
}

#[test]
fn equations_that_are_not_coupled_say_nothing() {
    let mut draw = Numbers(7);
    let law = |k: u16| {
        vec![
            (1.0, Term::signal(signals(k)[0])),
            (2.0, Term::signal(signals(k)[2])),
        ]
    };
    let laws = vec![law(0), law(1)];
    assert_eq!(said(2, (&laws, &laws), 0.0, &mut draw), None);
}

/// The first law hardly has its own acceleration: q̈₀ + 40 q̈₁ + 60 u = 0.
#[test]
fn laws_of_each_others_accelerations_are_said_the_other_way_round() {
    let mut draw = Numbers(3);
    let [a, b] = [0, 1].map(|k| Term::signal(signals(k)[0]));
    let turned = |t: &Term, k: u16| t.mul(&of("cos", signals(k)[2]));
    let laws = vec![
        vec![
            (1.0, a.clone()),
            (40.0, b.clone()),
            (60.0, Term::signal(force(2))),
        ],
        vec![
            (1.0, b.clone()),
            (0.8, a.clone()),
            (0.1, turned(&b, 1)),
            (-2.0, Term::signal(signals(1)[1])),
        ],
    ];
    let choices = said(2, (&laws, &laws), 0.0, &mut draw);
    let choice = choices.and_then(|c| c.targets).unwrap();
    let better = choice
        .better
        .clone()
        .unwrap_or_else(|| panic!("{choice:?}"));
    assert!(better.condition * 3.0 <= choice.condition, "{choice:?}");
    let lefts: Vec<&str> = better.laws.iter().map(|l| l.left.as_str()).collect();
    assert_eq!(lefts, ["ddq1", "ddq0"]);
    let coefficient = |law: usize, name: &str| {
        let found = better.laws[law].terms.iter().find(|(t, _)| t == name);
        found.unwrap_or_else(|| panic!("{better:?}")).1
    };
    assert!((coefficient(0, "ddq0") + 1.0 / 40.0).abs() < 1e-12);
    assert!((coefficient(0, "u") + 1.5).abs() < 1e-12);
    assert!((coefficient(1, "dq1") - 2.5).abs() < 1e-12);
    assert_eq!(
        (better.laws[0].terms.len(), better.laws[1].terms.len()),
        (2, 3)
    );
}
