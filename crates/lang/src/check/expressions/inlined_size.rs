//! The size of an expression with every `let` in it written out.
//!
//! In: an expression. Out: its nodes and depth, or an error beyond the limits. A chain of `let`s can double in each line, and a range
//! stands for ten thousand names, so sizes are computed before anything is written out.

use crate::ast::{Expr, ExprKind};
use crate::check::checker::Checker;
use crate::check::errors;
use crate::source::Span;
use crate::thresholds::MODEL;

/// Nodes and nesting of an expression.
#[derive(Clone, Copy, Debug)]
pub struct Size {
    pub nodes: usize,
    pub depth: usize,
}

impl Checker<'_> {
    /// The size of an expression; `None` after an error if it is beyond the limits.
    pub fn sized(&mut self, e: &Expr) -> Option<Size> {
        let size = self.size(e);
        if size.nodes > MODEL.statement_nodes || size.depth > MODEL.depth {
            return self.fail(errors::too_large(e.span, size.depth));
        }
        self.afford(e.span, size.nodes)?;
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

    fn size(&self, e: &Expr) -> Size {
        if let ExprKind::Name(text) = &e.kind
            && let Some(l) = self.scope.lets.get(text)
        {
            return Size {
                nodes: l.nodes,
                depth: l.depth,
            };
        }
        let mut total = Size { nodes: 1, depth: 1 };
        for part in e.children() {
            let size = self.size(part);
            total.nodes = total.nodes.saturating_add(size.nodes);
            total.depth = total.depth.max(size.depth + 1);
        }
        total
    }
}
