//! What follows from the equations and is printed after them: coupled equations as a matrix equation and its solution, linear systems as A
//! and B.
//!
//! In: a discovery. Out: expressions and matrices. Layout is left to text and LaTeX.

use crate::thresholds::PRINTED;
use sidc_lang::term::{Expr, Signal, Term};
use sidc_system::algebra;
use sidc_system::algebra::thresholds::SYMBOLIC;
use sidc_system::algebra::{Fraction, Linear, Point, Unsolved};
use sidc_system::discovery::{Discovery, Form};

/// What follows from the equations.
pub(crate) struct DerivedForms {
    pub coupled: Vec<CoupledEquations>,
    /// A, B of a linear system with two states or more.
    pub linear: Option<Linear>,
    /// The number of states of a linear system too large to be printed.
    pub unprinted_states: Option<usize>,
}

/// Equations that are solved together: mass · unknowns = force.
pub(crate) struct CoupledEquations {
    pub unknowns: Vec<Signal>,
    pub mass: Vec<Vec<Expr>>,
    pub force: Vec<Expr>,
    pub solved: Solved,
}

pub(crate) enum Solved {
    Form(Vec<Fraction>),
    /// Why it is not printed.
    Not(String),
    /// The state-space matrices already show it.
    Matrices,
}

impl DerivedForms {
    pub fn of(d: &Discovery) -> DerivedForms {
        let valued = Form::new(d);
        let states = match algebra::affine(&valued) {
            true => Linear::without_matrices(&valued).states.len(),
            false => 0,
        };
        let linear = match (2..=PRINTED.printed_states).contains(&states) {
            true => algebra::linear(&valued, &Point::default()).ok(),
            false => None,
        };
        let form = Form::symbolic(d);
        let coupled = algebra::blocks(&form).into_iter();
        let coupled = coupled
            .filter(|b| b.linear || b.rows.len() > 1)
            .map(|block| {
                let rows = || block.rows.iter().filter_map(|i| form.rows.get(*i));
                let cells = |masses: &[Expr]| -> Vec<Expr> {
                    let cell = |j: &usize| masses.get(*j).cloned().unwrap_or_default();
                    block.rows.iter().map(cell).collect()
                };
                let unknowns = block.rows.iter().filter_map(|i| form.unknowns.get(*i));
                CoupledEquations {
                    unknowns: unknowns.copied().collect(),
                    mass: match block.linear {
                        true => rows().map(|r| cells(&r.mass)).collect(),
                        false => Vec::new(),
                    },
                    force: rows().map(|r| r.force.clone()).collect(),
                    solved: match (&linear, algebra::solved(&form, &block)) {
                        (Some(_), Ok(_)) => Solved::Matrices,
                        (_, Ok(all)) => Solved::Form(all),
                        (_, Err(why)) => Solved::Not(reason(why)),
                    },
                }
            });
        DerivedForms {
            coupled: coupled.collect(),
            linear,
            unprinted_states: Some(states).filter(|n| *n > PRINTED.printed_states),
        }
    }
}

fn reason(why: Unsolved) -> String {
    match why {
        Unsolved::Nonlinear => {
            "some unknown does not occur linearly, so there is no mass matrix either".into()
        }
        Unsolved::ManyUnknowns(n) => {
            let most = SYMBOLIC.largest_tie;
            format!("{n} equations are tied, and more than {most} are not solved in symbols")
        }
        Unsolved::ManyTerms(Some(n)) => {
            let most = SYMBOLIC.longest;
            format!("it has {n} terms, and more than {most} are not printed")
        }
        Unsolved::ManyTerms(None) => "it has thousands of terms".into(),
        Unsolved::Singular => {
            "det M = 0: the equations are one relation written twice, and have no unique solution"
                .into()
        }
    }
}

/// The terms in the order of the equations: lowest degree first.
pub(crate) fn simplest_first(e: &Expr) -> Vec<(f64, &Term)> {
    let mut terms: Vec<(f64, &Term)> = e.terms().collect();
    terms.sort_by(|(_, a), (_, b)| a.degree().total_cmp(&b.degree()).then_with(|| a.cmp(b)));
    terms
}
