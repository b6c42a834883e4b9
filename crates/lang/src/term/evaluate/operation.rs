//! What one operation of straight-line code does to numbers: the arithmetic that every evaluator shares.
//!
//! In: nodes of the graph of expressions, and the place of each. Out: operations on places, run on whatever holds their values:
//! one point, or a block of points. Works in the order of `Expr::eval`; never reorders a sum or a product.

use std::ops::Range;

use super::expression_graph::Node;
use crate::term::Func;

/// Operands are places: registers or slots.
#[derive(Clone, Debug)]
pub(super) enum Operation {
    Product(usize, usize),
    Reciprocal(usize),
    Root(usize),
    Power(usize, f64),
    SymbolicPower(usize, usize),
    Call(Func, usize),
    /// Two or more arguments: a range of [`Operands::arguments`].
    CallMany(Func, Range<usize>),
    /// A start, and a range of [`Operands::summands`].
    Sum(f64, Range<usize>),
}

/// Operands of operations with many, one after the other.
#[derive(Clone, Debug, Default)]
pub(super) struct Operands {
    summands: Vec<(f64, usize)>,
    arguments: Vec<usize>,
}

/// Where the values are: an operation reads places, applies a function, and writes its result.
pub(super) trait Values {
    fn unary(self, a: usize, f: impl Fn(f64) -> f64);
    fn binary(self, a: usize, b: usize, f: impl Fn(f64, f64) -> f64);
    fn variadic(self, arguments: &[usize], f: impl Fn(&[f64]) -> f64);
    /// start + Σ weight·place, from left to right.
    fn sum(self, start: f64, summands: &[(f64, usize)]);
}

/// What a node becomes in an evaluator.
pub(super) enum Lowered {
    /// A row of the inputs.
    Input(usize),
    Number(f64),
    Operation(Operation),
}

impl Operands {
    /// The operation of a node; `place` gives the places of the nodes that it uses.
    pub fn lower(&mut self, node: &Node, place: impl Fn(usize) -> usize) -> Lowered {
        Lowered::Operation(match node {
            Node::Input(row) => return Lowered::Input(*row),
            Node::Number(bits) => return Lowered::Number(f64::from_bits(*bits)),
            Node::Product(a, b) => Operation::Product(place(*a), place(*b)),
            Node::Reciprocal(a) => Operation::Reciprocal(place(*a)),
            Node::Root(a) => Operation::Root(place(*a)),
            Node::Power(a, bits) => Operation::Power(place(*a), f64::from_bits(*bits)),
            Node::SymbolicPower(a, b) => Operation::SymbolicPower(place(*a), place(*b)),
            Node::Call(f, args) => match args.as_slice() {
                [a] => Operation::Call(*f, place(*a)),
                many => {
                    let from = self.arguments.len();
                    self.arguments.extend(many.iter().map(|a| place(*a)));
                    Operation::CallMany(*f, from..self.arguments.len())
                }
            },
            Node::Sum(start, parts) => {
                let from = self.summands.len();
                let part = |(bits, a): &(u64, usize)| (f64::from_bits(*bits), place(*a));
                self.summands.extend(parts.iter().map(part));
                Operation::Sum(f64::from_bits(*start), from..self.summands.len())
            }
        })
    }
}

impl Operation {
    #[inline]
    pub fn run(&self, operands: &Operands, values: impl Values) {
        match self {
            Operation::Product(a, b) => values.binary(*a, *b, |x, y| x * y),
            Operation::Reciprocal(a) => values.unary(*a, |x| 1.0 / x),
            Operation::Root(a) => values.unary(*a, root),
            Operation::Power(a, p) => values.unary(*a, |x| x.powf(*p)),
            Operation::SymbolicPower(a, b) => values.binary(*a, *b, f64::powf),
            Operation::Call(f, a) => values.unary(*a, |x| (f.eval)(&[x])),
            Operation::CallMany(f, arguments) => match &operands.arguments[arguments.clone()] {
                [a, b] => values.binary(*a, *b, |x, y| (f.eval)(&[x, y])),
                many => values.variadic(many, f.eval),
            },
            Operation::Sum(start, summands) => {
                values.sum(*start, &operands.summands[summands.clone()]);
            }
        }
    }
}

/// √x with the special cases of `powf(x, 0.5)`: +0 for −0, +∞ for −∞.
#[inline]
fn root(x: f64) -> f64 {
    match x == f64::NEG_INFINITY {
        true => f64::INFINITY,
        false => (x + 0.0).sqrt(),
    }
}
