//! Coupled equations solved in symbols by Cramer's rule.
//!
//! In: a form and a block of its rows. Out: one fraction for each unknown, or why there is none to print. Exact up to
//! rounding of coefficients.

use crate::algebra::Block;
use crate::algebra::expand::{expanded, times};
use crate::algebra::fraction::Fraction;
use crate::algebra::thresholds::SYMBOLIC;
use crate::algebra::trigonometric_identity::simplified;
use crate::discovery::Form;
use sidc_lang::term::Expr;

/// Why there is no solution in symbols.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unsolved {
    /// Some unknown does not occur linearly.
    Nonlinear,
    /// More than [`largest_tie`](super::thresholds::Symbolic::largest_tie) unknowns: their number.
    ManyUnknowns(usize),
    /// More than [`longest`](super::thresholds::Symbolic::longest) terms: their number, where it is known.
    ManyTerms(Option<usize>),
    /// det M is identically zero.
    Singular,
}

/// The unknowns of a block, in the order of its rows.
///
/// # Errors
/// Why the block is not solved in symbols.
pub fn solved(form: &Form, block: &Block) -> Result<Vec<Fraction>, Unsolved> {
    if !block.linear {
        return Err(Unsolved::Nonlinear);
    }
    if block.rows.len() > SYMBOLIC.largest_tie {
        return Err(Unsolved::ManyUnknowns(block.rows.len()));
    }
    let all = cramer(form, &block.rows).ok_or(Unsolved::ManyTerms(None))?;
    let all = all.ok_or(Unsolved::Singular)?;
    let above: usize = all.iter().map(|f| f.sum.terms().len()).sum();
    let below = all.iter().map(|f| f.below.terms().len()).max().unwrap_or(0);
    match above + below <= SYMBOLIC.longest {
        true => Ok(all),
        false => Err(Unsolved::ManyTerms(Some(above + below))),
    }
}

/// The outer `None` means too many terms on the way, the inner one a singular matrix.
fn cramer(form: &Form, rows: &[usize]) -> Option<Option<Vec<Fraction>>> {
    let mut mass: Vec<Vec<Expr>> = Vec::new();
    let mut force: Vec<Expr> = Vec::new();
    for row in rows.iter().filter_map(|i| form.rows.get(*i)) {
        let line: Option<Vec<Expr>> = rows.iter().map(|j| expanded(row.mass.get(*j)?)).collect();
        mass.push(line?);
        force.push(expanded(&row.force)?);
    }
    let below = simplified(&determinant(&mass)?);
    if below.as_number() == Some(0.0) {
        return Some(None);
    }
    let unknown = |j: usize| {
        let mut replaced = mass.clone();
        for (line, f) in replaced.iter_mut().zip(&force) {
            if let Some(cell) = line.get_mut(j) {
                *cell = f.clone();
            }
        }
        Fraction::new(simplified(&determinant(&replaced)?), below.clone())
    };
    let all: Option<Vec<Fraction>> = (0..rows.len()).map(unknown).collect();
    all.map(Some)
}

/// Laplace expansion along the first row.
fn determinant(m: &[Vec<Expr>]) -> Option<Expr> {
    let Some((first, rest)) = m.split_first() else {
        return Some(Expr::number(1.0));
    };
    let mut all = Vec::new();
    for (j, cell) in first.iter().enumerate() {
        if cell.as_number() == Some(0.0) {
            continue;
        }
        let without = |line: &Vec<Expr>| -> Vec<Expr> {
            let others = line.iter().enumerate().filter(|(k, _)| *k != j);
            others.map(|(_, e)| e.clone()).collect()
        };
        let minor: Vec<Vec<Expr>> = rest.iter().map(without).collect();
        let part = times(cell, &determinant(&minor)?)?;
        let sign = if j % 2 == 0 { 1.0 } else { -1.0 };
        all.extend(part.terms().map(|(w, t)| (sign * w, t.clone())));
    }
    // Sums below a fraction bar may have moved above it, and are expanded too.
    expanded(&crate::algebra::expand::collected(all))
}
