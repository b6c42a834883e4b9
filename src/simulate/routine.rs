//! Expressions as a list of operations on numbers, run at one point at a time.
//!
//! In: expressions and the signals that will be given. Out: their values, in slots of a buffer that the caller keeps. Never
//! allocates while it runs: integrators call it millions of times.

use crate::term::{Expr, Func, Graph, Node, Signal};

/// Operations in order; every node of the graph has a slot of its own.
#[derive(Clone, Debug, Default)]
pub(super) struct Routine {
    ops: Vec<(usize, Op)>,
    parts: Vec<(f64, usize)>,
    args: Vec<usize>,
    /// Slots as they begin: numbers in their places, zeros elsewhere.
    initial: Vec<f64>,
    /// The slot of every expression.
    pub outputs: Vec<usize>,
}

/// Operands are slots.
#[derive(Clone, Copy, Debug)]
enum Op {
    Product(usize, usize),
    Reciprocal(usize),
    Root(usize),
    Power(usize, f64),
    Call(Func, usize),
    /// Arguments in a range of `args`.
    Calls(Func, usize, usize),
    /// Start, and a range of `parts`.
    Sum(f64, usize, usize),
}

impl Routine {
    /// `inputs`: the signals that the first slots hold, in order. `Err` is a signal that an expression mentions and that is
    /// not there.
    pub fn new(outputs: &[Expr], inputs: &[Signal]) -> Result<Routine, Signal> {
        let mut graph = Graph::new(inputs);
        let roots: Result<Vec<usize>, Signal> = outputs.iter().map(|e| graph.expr(e)).collect();
        let roots = roots?;
        let mut routine = Routine {
            initial: vec![0.0; inputs.len()],
            ..Routine::default()
        };
        let wanted = wanted(graph.nodes(), &roots);
        let mut slots: Vec<usize> = Vec::with_capacity(graph.nodes().len());
        for (node, wanted) in graph.nodes().iter().zip(wanted) {
            slots.push(if wanted {
                routine.node(node, &slots)
            } else {
                0
            });
        }
        routine.outputs = roots.iter().map(|r| slots[*r]).collect();
        Ok(routine)
    }

    /// A buffer to run in.
    pub fn slots(&self) -> Vec<f64> {
        self.initial.clone()
    }

    /// Takes the first slots as the inputs and fills the others. `slots` are of this routine's own making.
    pub fn run(&self, slots: &mut [f64]) {
        for (to, op) in &self.ops {
            slots[*to] = match *op {
                Op::Product(a, b) => slots[a] * slots[b],
                Op::Reciprocal(a) => 1.0 / slots[a],
                // As `powf` has it: +0 for −0, +∞ for −∞.
                Op::Root(a) if slots[a] == f64::NEG_INFINITY => f64::INFINITY,
                Op::Root(a) => (slots[a] + 0.0).sqrt(),
                Op::Power(a, p) => slots[a].powf(p),
                Op::Call(f, a) => (f.eval)(&[slots[a]]),
                Op::Calls(f, from, to) => self.call(f, &self.args[from..to], slots),
                Op::Sum(start, from, to) => {
                    let parts = self.parts[from..to].iter();
                    parts.fold(start, |sum, (weight, a)| sum + weight * slots[*a])
                }
            };
        }
    }

    /// Functions of several arguments take up to sixteen.
    fn call(&self, f: Func, args: &[usize], slots: &[f64]) -> f64 {
        let mut values = [0.0; 16];
        match values.get_mut(..args.len()) {
            Some(values) => {
                values
                    .iter_mut()
                    .zip(args)
                    .for_each(|(v, a)| *v = slots[*a]);
                (f.eval)(values)
            }
            None => (f.eval)(&args.iter().map(|a| slots[*a]).collect::<Vec<_>>()),
        }
    }

    fn node(&mut self, node: &Node, slots: &[usize]) -> usize {
        let at = |a: &usize| slots[*a];
        let op = match node {
            Node::Input(row) => return *row,
            Node::Number(bits) => {
                self.initial.push(f64::from_bits(*bits));
                return self.initial.len() - 1;
            }
            Node::Product(a, b) => Op::Product(at(a), at(b)),
            Node::Reciprocal(a) => Op::Reciprocal(at(a)),
            Node::Root(a) => Op::Root(at(a)),
            Node::Power(a, bits) => Op::Power(at(a), f64::from_bits(*bits)),
            Node::Call(f, args) => match args.as_slice() {
                [a] => Op::Call(*f, at(a)),
                many => {
                    let from = self.args.len();
                    self.args.extend(many.iter().map(at));
                    Op::Calls(*f, from, self.args.len())
                }
            },
            Node::Sum(start, parts) => {
                let from = self.parts.len();
                let part = |(bits, a): &(u64, usize)| (f64::from_bits(*bits), at(a));
                self.parts.extend(parts.iter().map(part));
                Op::Sum(f64::from_bits(*start), from, self.parts.len())
            }
        };
        self.initial.push(0.0);
        let to = self.initial.len() - 1;
        self.ops.push((to, op));
        to
    }
}

/// Which nodes the roots need.
fn wanted(nodes: &[Node], roots: &[usize]) -> Vec<bool> {
    let mut wanted = vec![false; nodes.len()];
    roots.iter().for_each(|r| wanted[*r] = true);
    for (i, node) in nodes.iter().enumerate().rev() {
        if wanted[i] {
            node.for_each_use(|a| wanted[a] = true);
        }
    }
    wanted
}
