//! What is printed after the equations because it follows from them: tied equations as a matrix equation and solved, linear
//! systems as A and B.
//!
//! In: a discovery. Out: what there is to print, in signals and numbers. Never says how it looks: text and LaTeX do.

use crate::algebra::{self, Fraction, LARGEST_TIE, LONGEST, Linear, Point, Unsolved};
use crate::discover::{Discovery, Form};
use crate::term::{Expr, Signal, Term};

/// Largest A that is printed without being asked for.
const WIDEST: usize = 12;

/// What follows from the equations.
pub(super) struct Derived {
    pub ties: Vec<Tie>,
    /// A, B of a linear system with two states or more.
    pub linear: Option<Linear>,
    /// How many states a linear system has, if they are too many for that.
    pub too_wide: Option<usize>,
}

/// Equations that are solved together: mass · unknowns = force.
pub(super) struct Tie {
    pub unknowns: Vec<Signal>,
    pub mass: Vec<Vec<Expr>>,
    pub force: Vec<Expr>,
    pub solved: Solved,
}

pub(super) enum Solved {
    Form(Vec<Fraction>),
    /// Why it is not printed.
    Not(String),
    /// A and B say it.
    Matrices,
}

impl Derived {
    pub fn of(d: &Discovery) -> Derived {
        let form = Form::new(d);
        let states = match algebra::affine(&form) {
            true => Linear::frame(&form).states.len(),
            false => 0,
        };
        let linear = match (2..=WIDEST).contains(&states) {
            true => algebra::linear(&form, &Point::default()).ok(),
            false => None,
        };
        let ties = algebra::blocks(&form).into_iter();
        let ties = ties.filter(|b| b.linear || b.rows.len() > 1).map(|block| {
            let rows = || block.rows.iter().filter_map(|i| form.rows.get(*i));
            let cells = |masses: &[Expr]| -> Vec<Expr> {
                let cell = |j: &usize| masses.get(*j).cloned().unwrap_or_default();
                block.rows.iter().map(cell).collect()
            };
            let unknowns = block.rows.iter().filter_map(|i| form.unknowns.get(*i));
            Tie {
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
        Derived {
            ties: ties.collect(),
            linear,
            too_wide: Some(states).filter(|n| *n > WIDEST),
        }
    }
}

fn reason(why: Unsolved) -> String {
    match why {
        Unsolved::Nonlinear => {
            "some unknown does not occur linearly, so there is no mass matrix either".into()
        }
        Unsolved::ManyUnknowns(n) => {
            format!("{n} equations are tied, and more than {LARGEST_TIE} are not solved in symbols")
        }
        Unsolved::ManyTerms(Some(n)) => {
            format!("it has {n} terms, and more than {LONGEST} are not printed")
        }
        Unsolved::ManyTerms(None) => "it has thousands of terms".into(),
        Unsolved::Singular => {
            "det M = 0: the equations are one relation written twice, and have no unique solution"
                .into()
        }
    }
}

/// Simple terms first, as in the equations.
pub(super) fn simplest_first(e: &Expr) -> Vec<(f64, &Term)> {
    let mut terms: Vec<(f64, &Term)> = e.terms().collect();
    terms.sort_by(|(_, a), (_, b)| a.degree().total_cmp(&b.degree()).then_with(|| a.cmp(b)));
    terms
}
