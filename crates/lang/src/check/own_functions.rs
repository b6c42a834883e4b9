//! Functions that a model defines, `let sat(v) = tanh(v/vs)`: their definitions, and their arguments while a body is read.
//!
//! In: definitions and arguments. Out: what a call needs. Each call reads the body again with its arguments, so that terms get the same
//! normal form as if they were written out by hand.

use std::collections::BTreeMap;
use std::rc::Rc;

use crate::ast::{Expr as Ast, Ident};
use crate::source::Span;
use crate::term::{Expr, Signal};

/// `let NAME(ARGUMENTS) = BODY`
#[derive(Clone, Debug)]
pub struct OwnFunction<'a> {
    pub span: Span,
    pub params: &'a [Ident],
    pub body: &'a Ast,
    /// Whether its body is a library.
    pub library: bool,
    /// Whether it is wrong; the error is reported already.
    pub wrong: bool,
    /// The size of a call, depending on the sizes of its arguments.
    pub shape: Rc<Shape>,
}

/// What the name of an argument stands for.
#[derive(Clone, Debug)]
pub enum Argument {
    Value(Expr),
    /// While the definition itself is checked.
    Name,
}

impl Argument {
    /// The signal, if it is one and nothing else.
    pub fn as_signal(&self) -> Option<Signal> {
        let Argument::Value(value) = self else {
            return None;
        };
        let mut found = None;
        value.for_each_signal(&mut |s| found = Some(s));
        found.filter(|s| *value == Expr::signal(*s))
    }
}

pub type Arguments = BTreeMap<String, Argument>;

/// Nodes and nesting of an expression.
#[derive(Clone, Copy, Debug)]
pub struct Size {
    pub nodes: usize,
    pub depth: usize,
}

/// The size of a function's body without its arguments, and for each argument how often it occurs in the body, and how deep.
#[derive(Clone, Debug)]
pub struct Shape {
    pub own: Size,
    pub params: Vec<Size>,
}

impl Shape {
    pub fn of(own: Size, params: usize) -> Shape {
        let none = Size { nodes: 0, depth: 0 };
        Shape {
            own,
            params: vec![none; params],
        }
    }

    /// Adds an inner expression that occurs `times` times, `levels` deeper.
    pub fn add(&mut self, inner: &Shape, times: usize, levels: usize) {
        let inner_sizes = std::iter::once(&inner.own).chain(&inner.params);
        let own = std::iter::once(&mut self.own).chain(&mut self.params);
        for (size, inner) in own.zip(inner_sizes) {
            let more = inner.nodes.saturating_mul(times);
            size.nodes = size.nodes.saturating_add(more);
            if more > 0 {
                size.depth = size.depth.max(inner.depth.saturating_add(levels));
            }
        }
    }
}
