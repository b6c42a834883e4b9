//! `when y < 0 : dy -> -e*dy`
//!
//! In: the parts of such a statement. Out: its node.

use pest::iterators::Pairs;

use super::{AstBuilder, Result, relation};
use crate::ast::{Expr, ExprKind, StatementKind};
use crate::parse::grammar::Rule;

impl AstBuilder<'_> {
    /// `reset = { SOI ~ "when" ~ expr ~ relation ~ expr ~ ":" ~ jump ~ ("," ~ jump)* ~ EOI }`, `jump = { name ~ "->" ~ expr }`
    pub(super) fn reset(&self, mut inner: Pairs<Rule>) -> Result<StatementKind> {
        let left = self.expr(self.next(&mut inner)?)?;
        let relation = relation(&self.next(&mut inner)?);
        let right = self.expr(self.next(&mut inner)?)?;
        let mut jumps = Vec::new();
        for pair in inner.filter(|p| p.as_rule() == Rule::jump) {
            let mut parts = pair.into_inner();
            let name = self.ident(&self.next(&mut parts)?);
            let name = Expr::new(name.span, ExprKind::Name(name.text));
            jumps.push((name, self.expr(self.next(&mut parts)?)?));
        }
        Ok(StatementKind::Reset {
            left,
            relation,
            right,
            jumps,
        })
    }
}
