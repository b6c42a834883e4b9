//! Expressions on a run of rows: each function is applied along the run, not row by row.
//!
//! In: samples, rows, an atom or a term. Out: its values, finite or not. A signal that the samples lack gives NaN: callers provide every
//! signal.

use std::ops::Range;

use sidc_data::Samples;
use sidc_lang::term::{Atom, Expr, Signal, Term, power};

/// Rows of the samples that are evaluated together.
pub(super) struct RowBlock<'a> {
    pub samples: &'a Samples,
    pub rows: Range<usize>,
}

impl RowBlock<'_> {
    /// The values of an atom, written to `out` (length of the run).
    pub fn atom(&self, atom: &Atom, out: &mut [f64]) {
        match atom {
            Atom::Signal(s) => self.signal(*s, out),
            Atom::Sum(e) => self.expr(e, out),
            Atom::Call(f, args) => match args.as_ref() {
                [x] => {
                    self.expr(x, out);
                    out.iter_mut().for_each(|v| *v = (f.eval)(&[*v]));
                }
                many => self.call(f.eval, many, out),
            },
        }
    }

    /// The values of a term.
    pub fn term(&self, term: &Term, out: &mut [f64]) {
        let mut factor = vec![0.0; out.len()];
        out.fill(1.0);
        for (atom, exponent) in term.factors() {
            self.atom(atom, &mut factor);
            let factors = factor.iter().map(|x| power(*x, exponent));
            out.iter_mut().zip(factors).for_each(|(v, f)| *v *= f);
        }
    }

    fn expr(&self, e: &Expr, out: &mut [f64]) {
        let mut values = vec![0.0; out.len()];
        out.fill(0.0);
        for (weight, term) in e.terms() {
            self.term(term, &mut values);
            let weighted = values.iter().map(|v| weight * v);
            out.iter_mut().zip(weighted).for_each(|(s, v)| *s += v);
        }
    }

    fn call(&self, f: fn(&[f64]) -> f64, args: &[Expr], out: &mut [f64]) {
        let rows = out.len();
        let mut columns = vec![0.0; rows * args.len()];
        for (arg, column) in args.iter().zip(columns.chunks_exact_mut(rows.max(1))) {
            self.expr(arg, column);
        }
        let mut values = vec![0.0; args.len()];
        for (row, out) in out.iter_mut().enumerate() {
            for (value, column) in values.iter_mut().zip(columns.chunks_exact(rows)) {
                *value = column[row];
            }
            *out = f(&values);
        }
    }

    fn signal(&self, s: Signal, out: &mut [f64]) {
        match self.samples.column(s) {
            Some(column) => out.copy_from_slice(&column.values[self.rows.clone()]),
            None => out.fill(f64::NAN),
        }
    }
}
