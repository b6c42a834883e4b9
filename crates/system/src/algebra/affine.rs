//! Tests whether a system is linear with constant coefficients.
//!
//! In: a form. Out: yes or no, from how the equations are written; nothing is evaluated.

use crate::algebra::expand::expanded;
use crate::discovery::Form;
use sidc_lang::term::{Atom, Expr, Signal};

/// True if every equation is a constant plus numbers times single states, inputs, lagged samples and unknowns.
pub fn affine(form: &Form) -> bool {
    let known = |s: Signal| {
        let places = [&form.state, &form.inputs, &form.history, &form.unknowns];
        places.iter().any(|names| names.contains(&s))
    };
    let line = |e: &Expr| {
        expanded(e).is_some_and(|e| {
            e.terms().all(|(_, t)| {
                let mut factors = t.factors();
                match (factors.next(), factors.next()) {
                    (None, _) => true,
                    (Some((Atom::Signal(s), 1.0)), None) => known(*s),
                    _ => false,
                }
            })
        })
    };
    form.rows.iter().all(|r| line(&r.right)) && form.outputs.iter().all(|(_, e)| line(e))
}
