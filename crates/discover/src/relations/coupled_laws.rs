//! Coupled equations as laws on the rows where they are compared.
//!
//! In: a discovery, samples, libraries. Out: the laws with the values of all signals that they and the libraries have; laws as text.
//! Judges nothing.

use std::collections::BTreeSet;

use crate::redundancy::gradients::SampledSignals;
use crate::regression::task::simpler;
use crate::relations::multiples::Law;
use sidc_data::Samples;
use sidc_lang::library::Library;
use sidc_lang::term::{Expr, Language, Signal, SignalNames, Term};
use sidc_system::discovery::{Discovery, Equation, Form, WrittenLaw};

/// Coupled laws on the rows where they are compared.
pub(super) struct Coupled<'a> {
    pub names: &'a Discovery,
    pub form: &'a Form,
    /// In the order of the rows of the form.
    pub equations: Vec<&'a Equation>,
    pub laws: Vec<Law>,
    pub rows: SampledSignals,
}

/// The coupled laws of a discovery; `None` where there are none that can be judged on rows.
pub(super) fn coupled<'a>(
    d: &'a Discovery,
    form: &'a Form,
    samples: &Samples,
    libraries: &[Option<Library>],
) -> Option<Coupled<'a>> {
    let judged = |e: &Equation| e.evidence.as_ref().is_none_or(|e| e.joint.is_none());
    let whole = d.failed.is_empty() && d.equations.iter().all(judged);
    if form.rows.len() < 2 || !form.coupled() || samples.is_empty() || !whole {
        return None;
    }
    let of = |u: &Signal| d.equations.iter().find(|e| e.target == *u);
    let equations: Option<Vec<&Equation>> = form.unknowns.iter().map(of).collect();
    let equations = equations?;
    // Multipliers may have any factor of a library.
    let mut signals: Vec<Signal> = libraries
        .iter()
        .flatten()
        .flat_map(Library::signals)
        .collect();
    for t in equations.iter().flat_map(|e| &e.terms) {
        t.term.for_each_signal(&mut |s| signals.push(s));
    }
    let rows = SampledSignals::new(form, signals, samples)?;
    let laws = equations.iter().map(|e| law(e)).collect();
    Some(Coupled {
        names: d,
        form,
        equations,
        laws,
        rows,
    })
}

/// target − right side = 0
fn law(e: &Equation) -> Law {
    let right = e
        .terms
        .iter()
        .map(|t| Expr::from((-t.coefficient, t.term.clone())));
    let sum = Expr::signal(e.target) + right.sum();
    sum.terms().map(|(a, t)| (a, t.clone())).collect()
}

impl Coupled<'_> {
    /// The law solved for one of its terms, or for the highest derivative in it.
    pub fn written(&self, left: &Term, right: &[(f64, Term)]) -> WrittenLaw {
        let language = Language(self.names);
        let mut terms: Vec<&(f64, Term)> = right.iter().collect();
        terms.sort_by(|a, b| simpler(&a.1, &b.1));
        WrittenLaw {
            left: language.term(left),
            terms: (terms.into_iter())
                .map(|(a, t)| (language.term(t), *a))
                .collect(),
        }
    }

    pub fn name(&self, row: usize) -> String {
        let signal = self.form.unknowns.get(row);
        signal.map_or_else(String::new, |s| self.names.name(*s))
    }

    /// Terms that are a highest derivative alone.
    pub fn unknowns(&self) -> BTreeSet<Term> {
        self.form
            .unknowns
            .iter()
            .map(|u| Term::signal(*u))
            .collect()
    }
}
