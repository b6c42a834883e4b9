//! The expression graph: a directed acyclic graph in which equal subexpressions are one node (value numbering).
//!
//! In: expressions and their input signals. Out: nodes in topological order. Keeps the order of operations of `Expr::eval`; never reorders
//! a sum or a product.

use std::collections::HashMap;

use crate::term::{Atom, Expr, Func, Signal, Term};

/// An operation on earlier nodes; numbers by their bits, so that equal means the same f64.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Node {
    /// An input signal, by its row.
    Input(usize),
    Number(u64),
    Product(usize, usize),
    Reciprocal(usize),
    /// Square root.
    Root(usize),
    Power(usize, u64),
    /// A power whose exponent is a node too.
    SymbolicPower(usize, usize),
    Call(Func, Vec<usize>),
    /// start + Σ weight·node, from left to right.
    Sum(u64, Vec<(u64, usize)>),
}

impl Node {
    /// Calls `visit` for every node that this one uses.
    pub fn for_each_use(&self, mut visit: impl FnMut(usize)) {
        match self {
            Node::Input(_) | Node::Number(_) => {}
            Node::Product(a, b) | Node::SymbolicPower(a, b) => {
                visit(*a);
                visit(*b);
            }
            Node::Reciprocal(a) | Node::Root(a) | Node::Power(a, _) => visit(*a),
            Node::Call(_, args) => args.iter().copied().for_each(visit),
            Node::Sum(_, parts) => parts.iter().for_each(|(_, a)| visit(*a)),
        }
    }
}

/// Nodes in topological order: what evaluators run and code generators write.
#[derive(Default)]
pub struct Graph {
    nodes: Vec<Node>,
    known: HashMap<Node, usize>,
    inputs: HashMap<Signal, usize>,
    /// Signals that may stand in exponents.
    constants: Vec<Signal>,
}

impl Graph {
    /// `inputs` are the signals that expressions may mention, in the order of their rows. Of two equal ones the first counts.
    pub fn new(inputs: &[Signal]) -> Graph {
        let mut graph = Graph::default();
        for (row, s) in inputs.iter().enumerate() {
            graph.inputs.entry(*s).or_insert(row);
        }
        graph
    }

    /// Makes b^e one operation if the exponent has only these signals.
    #[must_use]
    pub fn with_constants(mut self, constants: &[Signal]) -> Graph {
        self.constants = constants.to_vec();
        self
    }

    /// All nodes, each after those that it uses. Some may be used by nothing.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// The nodes of expressions; `Err` is a signal that is not among the inputs.
    pub(super) fn all(&mut self, expressions: &[Expr]) -> Result<Vec<usize>, Signal> {
        expressions.iter().map(|e| self.expr(e)).collect()
    }

    /// The node of an expression; `Err` is a signal that is not among the inputs.
    pub fn expr(&mut self, e: &Expr) -> Result<usize, Signal> {
        // −0 is the neutral element of addition; +0 would change a sum of −0.
        let (mut start, mut parts) = (-0.0, Vec::with_capacity(e.terms().len()));
        for (weight, term) in e.terms() {
            let node = self.term(term)?;
            match self.number(node) {
                Some(value) => start += weight * value,
                None => parts.push((weight, node)),
            }
        }
        Ok(match parts.as_slice() {
            // An empty sum is +0.
            [] => self.add(Node::Number((start + 0.0).to_bits())),
            [(1.0, node)] if start == 0.0 => *node,
            _ => {
                let bits = |(weight, node): (f64, usize)| (weight.to_bits(), node);
                self.add(Node::Sum(
                    start.to_bits(),
                    parts.into_iter().map(bits).collect(),
                ))
            }
        })
    }

    /// Multiplied from left to right, so that terms with the same first factors share their product.
    fn term(&mut self, t: &Term) -> Result<usize, Signal> {
        let mut product = None;
        for (atom, power) in t.factors() {
            let base = self.atom(atom)?;
            let factor = self.power(base, power);
            product = Some(match product {
                None => factor,
                Some(before) => self.product(before, factor),
            });
        }
        Ok(product.unwrap_or_else(|| self.add(Node::Number(1f64.to_bits()))))
    }

    fn atom(&mut self, atom: &Atom) -> Result<usize, Signal> {
        match atom {
            Atom::Signal(s) => match self.inputs.get(s) {
                Some(row) => Ok(self.add(Node::Input(*row))),
                None => Err(*s),
            },
            Atom::Call(f, args) => {
                if let Some((base, exponent)) = atom.as_power(&|s| self.constants.contains(&s)) {
                    let (base, exponent) = (self.expr(base)?, self.expr(&exponent)?);
                    return Ok(self.add(Node::SymbolicPower(base, exponent)));
                }
                let args: Result<Vec<usize>, Signal> = args.iter().map(|a| self.expr(a)).collect();
                match (f.name, Func::named("sign")) {
                    // No target language has a step that is ½ at zero.
                    ("step", Some(sign)) => {
                        let half = 0.5f64.to_bits();
                        let side = self.add(Node::Call(sign, args?));
                        Ok(self.add(Node::Sum(half, vec![(half, side)])))
                    }
                    _ => Ok(self.add(Node::Call(*f, args?))),
                }
            }
            Atom::Sum(e) => self.expr(e),
        }
    }

    fn power(&mut self, base: usize, p: f64) -> usize {
        let size = p.abs();
        if p.fract() == 0.0 && (1.0..=1024.0).contains(&size) {
            let whole = self.whole_power(base, size as u32);
            self.inverse_if(p < 0.0, whole)
        } else if size == 0.5 {
            let root = self.add(Node::Root(base));
            self.inverse_if(p < 0.0, root)
        } else {
            self.add(Node::Power(base, p.to_bits()))
        }
    }

    /// By repeated squaring in the order of `powi`; all powers up to n together take n − 1 products.
    fn whole_power(&mut self, base: usize, n: u32) -> usize {
        if n <= 1 {
            return base;
        }
        let top = 1 << n.ilog2();
        let (a, b) = match n - top {
            0 => (n / 2, n / 2),
            rest => (rest, top),
        };
        let (a, b) = (self.whole_power(base, a), self.whole_power(base, b));
        self.product(a, b)
    }

    fn inverse_if(&mut self, inverse: bool, a: usize) -> usize {
        match inverse {
            true => self.add(Node::Reciprocal(a)),
            false => a,
        }
    }

    fn product(&mut self, a: usize, b: usize) -> usize {
        self.add(Node::Product(a.min(b), a.max(b)))
    }

    fn number(&self, node: usize) -> Option<f64> {
        match self.nodes.get(node) {
            Some(Node::Number(bits)) => Some(f64::from_bits(*bits)),
            _ => None,
        }
    }

    fn add(&mut self, node: Node) -> usize {
        if let Some(known) = self.known.get(&node) {
            return *known;
        }
        self.nodes.push(node.clone());
        self.known.insert(node, self.nodes.len() - 1);
        self.nodes.len() - 1
    }
}

/// Which nodes the roots need.
pub(super) fn used_nodes(nodes: &[Node], roots: &[usize]) -> Vec<bool> {
    let mut used = vec![false; nodes.len()];
    roots.iter().for_each(|r| used[*r] = true);
    for (i, node) in nodes.iter().enumerate().rev() {
        if used[i] {
            node.for_each_use(|a| used[a] = true);
        }
    }
    used
}
