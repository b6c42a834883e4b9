//! Python modules for libraries with automatic differentiation: rates and outputs, no Jacobians.
//!
//! In: what is specific to one library, an [`Autodiff`]. Out: a [`Language`].

use std::marker::PhantomData;

use crate::code::infix::Syntax;
use crate::code::printer::{Dialect, Language, Printer, used_helpers};
use crate::code::program::{Function, Kind, Newton, Program, Step};
use crate::code::python_modules::{definition, newton};
use sidc_lang::term::Func;
use sidc_system::discovery::Discovery;

/// A library with automatic differentiation.
pub(crate) trait Autodiff: 'static {
    const DIALECT: Dialect;
    /// The name under which its module is imported.
    const MODULE: &'static str;
    /// The function that turns a number into an array: dividing Python's own numbers by zero raises an exception, dividing an array gives
    /// infinity.
    const NUMBER: &'static str;
    const INFINITY: &'static str;
    const NAN: &'static str;
    /// The helper `_solve`.
    const SOLVE: &'static str;
    /// The helper `_newton`, or why there is none.
    const NEWTON: Result<&'static str, &'static str>;

    /// The library's name for a function of the model language; empty if there is none.
    fn spelling(f: Func) -> &'static str;

    /// Text before the first function.
    fn header(d: &Discovery, program: &Program) -> String;

    /// A vector with these entries.
    fn vector(entries: &str) -> String;

    /// Text after the last function, called once for each function.
    fn last(_program: &Program, _f: &Function) -> String {
        String::new()
    }
}

/// A library as a target language.
pub(crate) struct Module<A>(PhantomData<fn() -> A>);

impl<A> Module<A> {
    pub(crate) const NEW: Module<A> = Module(PhantomData);
}

impl<A: Autodiff> Language for Module<A> {
    const DIALECT: Dialect = A::DIALECT;

    fn spelling(f: Func) -> &'static str {
        A::spelling(f)
    }

    fn check(&self, program: &Program) -> Result<(), String> {
        program.refuse_jumps(Self::DIALECT.language)?;
        match A::NEWTON {
            Err(why) if !program.form.linear => Err(why.into()),
            _ => Ok(()),
        }
    }

    fn writes(&self, kind: Kind) -> bool {
        matches!(kind, Kind::Rates | Kind::Outputs)
    }

    fn header(&self, d: &Discovery, program: &Program) -> String {
        A::header(d, program)
    }

    fn opening(&self, program: &Program, f: &Function) -> String {
        format!("\n\n{}", definition(program, f))
    }

    fn bare_number(&self, number: String) -> String {
        format!("{}({number})", A::NUMBER)
    }

    fn solver(&self, _: usize) -> &'static str {
        "_solve"
    }

    fn newton(&self, p: &Printer<Self>, n: &Newton) -> String {
        newton(p, n)
    }

    fn vector(&self, _: &Printer<Self>, entries: &[String]) -> String {
        format!("    return {}\n", A::vector(&entries.join(", ")))
    }

    /// No matrix is written.
    fn matrix(&self, _: &Function) -> (String, String) {
        (String::new(), String::new())
    }

    fn cell(&self, _: &Function, _: usize, _: usize) -> String {
        String::new()
    }

    fn helpers(&self, program: &Program) -> String {
        let newton = program.makes(|s| matches!(s, Step::Newton(_)));
        used_helpers(&[
            (program.solves(|_| true), A::SOLVE),
            (newton, A::NEWTON.unwrap_or_default()),
        ])
    }

    fn last(&self, program: &Program) -> String {
        let written = program.functions.iter().filter(|f| self.writes(f.kind));
        written.map(|f| A::last(program, f)).collect()
    }
}

impl<A: Autodiff> Syntax for Module<A> {
    const INFINITY: &'static str = A::INFINITY;
    const NAN: &'static str = A::NAN;

    fn function(&self, f: Func) -> String {
        format!("{}.{}", A::MODULE, A::spelling(f))
    }

    fn root(&self, x: &str) -> String {
        format!("{}.sqrt({x})", A::MODULE)
    }

    fn power(&self, x: &str, p: &str) -> String {
        format!("{}.power({x}, {p})", A::MODULE)
    }
}
