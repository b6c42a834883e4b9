//! How large an expression is once every `let` in it is written out.
//!
//! A chain of `let`s can double its size in each line, and a range stands for ten thousand names; the caps stop that before memory is taken.

use super::Checker;
use crate::lang::ast::{Expr, ExprKind};
use crate::lang::source::Span;

/// Nodes of one statement, `let`s written out: a library of 10⁵ listed terms fits.
pub const MAX_NODES: usize = 500_000;
/// Nodes of a whole model, ranges and copies for several targets written out too: some 500 MB.
const MAX_MODEL: usize = 4 * MAX_NODES;
/// Nesting, `let`s written out; what recursive passes must survive.
pub const MAX_DEPTH: usize = 300;

/// Nodes and nesting of an expression.
#[derive(Clone, Copy, Debug)]
pub struct Size {
    pub nodes: usize,
    pub depth: usize,
}

impl Checker<'_> {
    /// The size of an expression; `None`, reported, if it is beyond the caps.
    pub fn sized(&mut self, e: &Expr) -> Option<Size> {
        let size = self.size(e);
        if size.nodes > MAX_NODES || size.depth > MAX_DEPTH {
            return self.fail(super::complain::too_large(e.span, size));
        }
        self.afford(e.span, size.nodes)?;
        Some(size)
    }

    /// Counts what is about to be written out; `None`, reported once, if the model has become too large. A line of ten characters may
    /// stand for 10⁵ nodes, so statements that are small enough are not enough.
    pub fn afford(&mut self, at: Span, nodes: usize) -> Option<()> {
        self.written = self.written.saturating_add(nodes);
        if self.written <= MAX_MODEL {
            return Some(());
        }
        if self.reported.insert("\0model".to_string()) {
            self.say(super::complain::model_too_large(at, MAX_MODEL));
        }
        None
    }

    fn size(&self, e: &Expr) -> Size {
        match &e.kind {
            ExprKind::Number(_) | ExprKind::Text(_) => Size { nodes: 1, depth: 1 },
            ExprKind::Name(text) => {
                self.scope
                    .lets
                    .get(text)
                    .map_or(Size { nodes: 1, depth: 1 }, |l| Size {
                        nodes: l.nodes,
                        depth: l.depth,
                    })
            }
            ExprKind::Negate(x) | ExprKind::Group(x) => self.sum_sizes([&**x]),
            ExprKind::Power(x, y) | ExprKind::Range(x, y) => self.sum_sizes([&**x, &**y]),
            ExprKind::Sum(parts) => self.sum_sizes(parts.iter().map(|(_, x)| x)),
            ExprKind::Product(parts) => self.sum_sizes(parts.iter().map(|(_, x)| x)),
            ExprKind::List(items) => self.sum_sizes(items),
            ExprKind::Call(call) => self.sum_sizes(&call.args),
        }
    }

    fn sum_sizes<'e>(&self, parts: impl IntoIterator<Item = &'e Expr>) -> Size {
        let mut total = Size { nodes: 1, depth: 0 };
        for part in parts {
            let size = self.size(part);
            total.nodes = total.nodes.saturating_add(size.nodes);
            total.depth = total.depth.max(size.depth);
        }
        total.depth += 1;
        total
    }
}
