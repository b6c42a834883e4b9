//! Expressions as text, for languages with `+ - * /` and functions called as `f(x)`.
//!
//! In: the body of a function, and how a language writes numbers, roots and powers. Out: expressions with as few parentheses as possible;
//! they round like those of sidc's own evaluator. Never writes a statement.

use crate::code::identifiers::Identifiers;
use crate::code::program::{Body, Name};
use sidc_lang::term::{Func, Node, Precedence, Signal};
use std::collections::BTreeMap;

/// How a language writes numbers, functions and powers.
pub(crate) trait Syntax {
    const INFINITY: &'static str;
    const NAN: &'static str;

    /// A finite number that is not negative.
    fn finite(&self, x: f64) -> String {
        format!("{x:?}")
    }
    /// The name of a function; by default that of the model language.
    fn function(&self, f: Func) -> String {
        f.name.into()
    }
    /// x^½: +0 for −0, NaN for negative x.
    fn root(&self, x: &str) -> String {
        format!("sqrt({x})")
    }
    /// x^p, where p is a symbol, not whole or very large.
    fn power(&self, x: &str, p: &str) -> String;
}

/// The identifiers of one body.
pub(crate) struct BodyNames {
    own: BTreeMap<Name, String>,
    identifiers: Identifiers,
}

impl BodyNames {
    /// `identifiers` holds arguments and unknowns; other names of the body get free identifiers.
    pub fn new(body: &Body, identifiers: &Identifiers) -> BodyNames {
        let mut identifiers = identifiers.clone();
        let fresh = |(name, preferred): &(Name, String)| (*name, identifiers.fresh(preferred));
        let own = body.preferred_names.iter().map(fresh).collect();
        BodyNames { own, identifiers }
    }

    pub fn signal(&self, s: Signal) -> String {
        if s == Signal::TIME {
            return "t".into();
        }
        let own = self.own.get(&Name::Signal(s)).cloned();
        own.unwrap_or_else(|| self.identifiers.get(s).to_string())
    }

    pub fn name(&self, name: Name) -> String {
        match name {
            Name::Signal(s) => self.signal(s),
            Name::Node(node) => self.node(node).cloned().unwrap_or_default(),
        }
    }

    /// The name of a node; `None` if it is written where it is used.
    pub fn node(&self, node: usize) -> Option<&String> {
        self.own.get(&Name::Node(node))
    }
}

/// Writes the nodes of one body.
pub(crate) struct Infix<'a, S> {
    syntax: &'a S,
    body: &'a Body,
    names: BodyNames,
}

impl<'a, S: Syntax> Infix<'a, S> {
    /// As [`BodyNames::new`].
    pub fn new(syntax: &'a S, body: &'a Body, identifiers: &Identifiers) -> Self {
        Infix {
            syntax,
            body,
            names: BodyNames::new(body, identifiers),
        }
    }

    pub fn signal(&self, s: Signal) -> String {
        self.names.signal(s)
    }

    pub fn name(&self, name: Name) -> String {
        self.names.name(name)
    }

    /// The name of a node, or else its value.
    pub fn text(&self, node: usize) -> String {
        self.parenthesized(node, Precedence::Sum)
    }

    /// The expression that computes a node.
    pub fn value(&self, node: usize) -> String {
        self.computed(node).0
    }

    /// The right side of an assignment: for a node its expression, for a signal the name or expression of what it equals.
    pub fn assigned(&self, name: Name, node: usize) -> String {
        match name {
            Name::Node(_) => self.value(node),
            Name::Signal(_) => self.text(node),
        }
    }

    /// All entries, row by row.
    pub fn flat(&self, rows: &[Vec<usize>]) -> Vec<String> {
        rows.iter().flat_map(|row| self.texts(row)).collect()
    }

    pub fn texts(&self, nodes: &[usize]) -> Vec<String> {
        nodes.iter().map(|n| self.text(*n)).collect()
    }

    fn piece(&self, node: usize) -> (String, Precedence) {
        match self.names.node(node) {
            Some(name) => (name.clone(), Precedence::Atom),
            None => self.computed(node),
        }
    }

    fn parenthesized(&self, node: usize, needs: Precedence) -> String {
        match self.piece(node) {
            (text, has) if has < needs => format!("({text})"),
            (text, _) => text,
        }
    }

    fn computed(&self, node: usize) -> (String, Precedence) {
        match self.body.nodes().get(node) {
            None => (String::new(), Precedence::Atom),
            Some(Node::Input(row)) => (self.signal(self.body.input(*row)), Precedence::Atom),
            Some(Node::Number(bits)) => {
                let x = f64::from_bits(*bits);
                // A sign binds as loosely as a sum.
                let binds = if is_negative(x) {
                    Precedence::Sum
                } else {
                    Precedence::Atom
                };
                (self.literal(x), binds)
            }
            Some(Node::Product(a, b)) => (self.product(*a, *b), Precedence::Product),
            Some(Node::Reciprocal(a)) => {
                let below = self.parenthesized(*a, Precedence::Power);
                (
                    format!("{} / {below}", self.number(1.0)),
                    Precedence::Product,
                )
            }
            Some(Node::Root(a)) => (self.syntax.root(&self.text(*a)), Precedence::Atom),
            Some(Node::Power(a, p)) => {
                let p = self.literal(f64::from_bits(*p));
                (self.syntax.power(&self.text(*a), &p), Precedence::Atom)
            }
            Some(Node::SymbolicPower(a, p)) => {
                let power = self.syntax.power(&self.text(*a), &self.text(*p));
                (power, Precedence::Atom)
            }
            Some(Node::Call(f, args)) => (self.call(*f, args), Precedence::Atom),
            Some(Node::Sum(start, parts)) => self.sum(f64::from_bits(*start), parts),
        }
    }

    fn is_inline(&self, node: usize, is: impl Fn(&Node) -> bool) -> bool {
        self.names.node(node).is_none() && self.body.nodes().get(node).is_some_and(is)
    }

    /// Products associate to the left. Swapping two factors does not change the rounding, so a factor that is a product goes first and
    /// needs no parentheses.
    fn product(&self, a: usize, b: usize) -> String {
        let reciprocal = |n| self.is_inline(n, |n| matches!(n, Node::Reciprocal(_)));
        let product = |n| self.is_inline(n, |n| matches!(n, Node::Product(..)));
        let (a, b) = match () {
            () if reciprocal(a) && !reciprocal(b) => (b, a),
            () if product(b) && !product(a) && !reciprocal(b) => (b, a),
            () => (a, b),
        };
        let left = self.parenthesized(a, Precedence::Product);
        match self.body.nodes().get(b) {
            Some(Node::Reciprocal(below)) if reciprocal(b) => {
                format!("{left} / {}", self.parenthesized(*below, Precedence::Power))
            }
            _ => format!("{left} * {}", self.parenthesized(b, Precedence::Power)),
        }
    }

    fn call(&self, f: Func, args: &[usize]) -> String {
        let name = self.syntax.function(f);
        let args = self.texts(args);
        let Some((first, rest)) = args.split_first() else {
            return format!("{name}()");
        };
        let Some((second, rest)) = rest.split_first() else {
            return format!("{name}({first})");
        };
        let pair = format!("{name}({first}, {second})");
        rest.iter()
            .fold(pair, |before, arg| format!("{name}({before}, {arg})"))
    }

    fn sum(&self, start: f64, parts: &[(u64, usize)]) -> (String, Precedence) {
        let mut out = String::new();
        if start != 0.0 {
            out = self.literal(start);
        }
        for (bits, node) in parts {
            let weight = f64::from_bits(*bits);
            out.push_str(match (out.is_empty(), is_negative(weight)) {
                (true, true) => "-",
                (true, false) => "",
                (false, true) => " - ",
                (false, false) => " + ",
            });
            out.push_str(&self.weighted(weight.abs(), *node));
        }
        match parts {
            [(bits, _)] if start == 0.0 && !is_negative(f64::from_bits(*bits)) => {
                (out, Precedence::Product)
            }
            _ => (out, Precedence::Sum),
        }
    }

    /// Parentheses around a product keep the order of roundings.
    fn weighted(&self, weight: f64, node: usize) -> String {
        if weight == 1.0 {
            return self.parenthesized(node, Precedence::Product);
        }
        format!(
            "{} * {}",
            self.number(weight),
            self.parenthesized(node, Precedence::Power)
        )
    }

    fn literal(&self, x: f64) -> String {
        match is_negative(x) {
            true => format!("-{}", self.number(-x)),
            false => self.number(x),
        }
    }

    /// A number that is not negative.
    fn number(&self, x: f64) -> String {
        match x {
            f64::INFINITY => S::INFINITY.into(),
            x if x.is_nan() => S::NAN.into(),
            x => self.syntax.finite(x),
        }
    }
}

/// False for −0 and NaN, so that their signs are not written.
fn is_negative(x: f64) -> bool {
    x < 0.0
}
