//! The grammar of `crates/lang/grammar/sid.pest` as a parser, and how tightly its operators bind.
//!
//! In: the text of one statement and the rule for it. Out: pest's tree of pairs. Knows no tokens and no ast.

use std::sync::LazyLock;

use pest::pratt_parser::{Assoc, Op, PrattParser};
use pest_derive::Parser;

#[derive(Parser)]
#[grammar = "grammar/sid.pest"]
pub struct SidParser;

/// Operators from loosest to tightest: `+ -`, `* /`, the minus of `-x`, `^`.
pub static PRECEDENCE: LazyLock<PrattParser<Rule>> = LazyLock::new(|| {
    PrattParser::new()
        .op(Op::infix(Rule::add, Assoc::Left) | Op::infix(Rule::subtract, Assoc::Left))
        .op(Op::infix(Rule::multiply, Assoc::Left) | Op::infix(Rule::divide, Assoc::Left))
        .op(Op::prefix(Rule::negate))
        .op(Op::postfix(Rule::power))
});
