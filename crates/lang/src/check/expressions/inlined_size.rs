//! The size of an expression with every `let` and every function in it written out.
//!
//! In: an expression. Out: its nodes and depth, or an error beyond the limits. A chain of `let`s can double in each line, and a range
//! stands for ten thousand names, so sizes are computed before anything is written out.

use crate::ast::{Expr, ExprKind, Ident};
use crate::check::checker::Checker;
use crate::check::errors;
use crate::check::own_functions::{Shape, Size};
use crate::source::Span;
use crate::thresholds::MODEL;

impl Checker<'_> {
    /// The size of an expression; `None` after an error if it is beyond the limits.
    pub fn sized(&mut self, e: &Expr) -> Option<Size> {
        let size = self.shape(e, &[]).own;
        self.within_limits(e.span, size)
    }

    /// The size, or `None` after an error if it is beyond the limits of one statement.
    pub fn within_limits(&mut self, at: Span, size: Size) -> Option<Size> {
        if size.nodes > MODEL.statement_nodes || size.depth > MODEL.depth {
            return self.fail(errors::too_large(at, size.depth));
        }
        self.afford(at, size.nodes)?;
        Some(size)
    }

    /// Counts nodes that are about to be written out; `None` after one error if the model becomes too large. Limits on single
    /// statements are not enough, since a line of ten characters may stand for 10⁵ nodes.
    pub fn afford(&mut self, at: Span, nodes: usize) -> Option<()> {
        self.written = self.written.saturating_add(nodes);
        if self.written <= MODEL.model_nodes {
            return Some(());
        }
        if self.reported.insert("\0model".to_string()) {
            self.say(errors::model_too_large(at, MODEL.model_nodes));
        }
        None
    }

    /// The size of an expression in which these names are arguments.
    pub fn shape(&self, e: &Expr, params: &[Ident]) -> Shape {
        let one = Size { nodes: 1, depth: 1 };
        let name = e.as_name();
        if let Some(i) = params.iter().position(|p| Some(p.text.as_str()) == name) {
            let mut shape = Shape::of(Size { nodes: 0, depth: 0 }, params.len());
            if let Some(size) = shape.params.get_mut(i) {
                *size = one;
            }
            return shape;
        }
        if let Some(l) = name.and_then(|text| self.scope.lets.get(text)) {
            let (nodes, depth) = (l.nodes, l.depth);
            return Shape::of(Size { nodes, depth }, params.len());
        }
        let mut total = Shape::of(one, params.len());
        let called = match &e.kind {
            ExprKind::Call(call) => self.functions.get(&call.name.text),
            _ => None,
        };
        for (i, part) in e.children().into_iter().enumerate() {
            let (times, levels) = match called.map(|f| f.shape.params.get(i)) {
                None => (1, 1),
                // Once for each occurrence in the body, and once to read it.
                Some(size) => size.map_or((1, 1), |s| (s.nodes.saturating_add(1), s.depth + 1)),
            };
            total.add(&self.shape(part, params), times, levels);
        }
        if let Some(f) = called {
            let body = Shape::of(f.shape.own, params.len());
            total.add(&body, 1, 1);
        }
        total
    }
}
