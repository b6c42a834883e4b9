//! Finds libraries of a checked model by position.
//!
//! In: a program. Out: the terms of an equation, a named library or a generator, as expanded for one equation.

use sidc::pipeline::Program;
use sidc_lang::library::{self, Library, MEMORY};
use sidc_lang::model::{Equation, LibExpr, LibKind, RightSide};
use sidc_lang::source::Span;

/// The library expression of an equation that is searched for.
pub fn written(equation: &Equation) -> Option<&LibExpr> {
    match &equation.right {
        RightSide::Search { library, .. } => library.as_ref(),
        RightSide::Known(_) => None,
    }
}

/// Equations that are searched for, with their libraries.
pub fn sought(program: &Program) -> impl Iterator<Item = (&Equation, &Library)> {
    let pairs = program.model.equations.iter().zip(&program.libraries);
    pairs.filter_map(|(e, l)| Some((e, l.as_ref()?)))
}

/// A part of a library, and the equation that it is expanded for.
pub struct Part<'a> {
    pub equation: &'a Equation,
    pub part: &'a LibExpr,
}

impl Part<'_> {
    pub fn library(&self, program: &Program) -> Library {
        library::expand(&program.model, self.equation.target, self.part, MEMORY).0
    }
}

/// The generator whose name is at a position.
pub fn generated(program: &Program, at: usize) -> Option<Part<'_>> {
    find(program, &|e| match &e.kind {
        LibKind::Generate { name_span, .. } => holds(*name_span, at),
        _ => false,
    })
}

/// The library that a `let` names.
pub fn named<'a>(program: &'a Program, wanted: &str) -> Option<Part<'a>> {
    find(program, &|e| match &e.kind {
        LibKind::Named { name, .. } => name == wanted,
        _ => false,
    })
}

fn holds(span: Span, at: usize) -> bool {
    span.start <= at && at <= span.end
}

fn find<'a>(program: &'a Program, wanted: &impl Fn(&LibExpr) -> bool) -> Option<Part<'a>> {
    program.model.equations.iter().find_map(|equation| {
        let part = search(written(equation)?, wanted)?;
        Some(Part { equation, part })
    })
}

fn search<'a>(e: &'a LibExpr, wanted: &impl Fn(&LibExpr) -> bool) -> Option<&'a LibExpr> {
    if wanted(e) {
        return Some(e);
    }
    match &e.kind {
        LibKind::Term(_) => None,
        LibKind::List(items) => items.iter().find_map(|x| search(x, wanted)),
        LibKind::Generate { args, .. } => args.iter().find_map(|x| search(x, wanted)),
        LibKind::Power(a, _) => search(a, wanted),
        LibKind::Named { body, .. } | LibKind::Required(body) => search(body, wanted),
        LibKind::Union(a, b)
        | LibKind::Difference(a, b)
        | LibKind::Product(a, b)
        | LibKind::Quotient(a, b) => search(a, wanted).or_else(|| search(b, wanted)),
    }
}
