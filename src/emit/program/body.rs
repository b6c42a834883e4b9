//! The statements of one function: steps over a graph in which common subexpressions are one node.
//!
//! In: definitions and the expressions wanted. Out: what a target writes down: which entries of arguments are read, the steps, the
//! results, and what the named would like to be called. Never knows a language.

use std::collections::BTreeSet;

use super::Program;
use super::motion::Motion;
use super::schedule::schedule;
use crate::term::{Expr, Graph, Node, Signal};

/// Straight-line code.
pub(in crate::emit) struct Body {
    pub(super) graph: Graph,
    pub(super) inputs: Vec<Signal>,
    /// Entries of arguments that are used.
    pub reads: Vec<Read>,
    pub steps: Vec<Step>,
    /// Rows × columns.
    pub results: Vec<Vec<usize>>,
    /// What the named would like to be called, if it is not an argument or an unknown.
    pub wishes: Vec<(Name, String)>,
}

/// `signal` is entry `place` of the argument of that name.
pub(in crate::emit) struct Read {
    pub argument: &'static str,
    pub place: usize,
    pub signal: Signal,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::emit) enum Name {
    Signal(Signal),
    Node(usize),
}

pub(in crate::emit) enum Step {
    /// The node under its name.
    Let(Name, usize),
    Solve(Solve),
    Newton(Newton),
}

/// mass · signals = right for all columns at once; NaN where mass is singular.
pub(in crate::emit) struct Solve {
    pub mass: Vec<Vec<usize>>,
    pub right: Vec<Vec<usize>>,
    /// `None` where nobody asks.
    pub signals: Vec<Vec<Option<Signal>>>,
}

/// mass · signals = right, where both depend on the signals: solved from zero on, again and again, as `Form::solve` does.
pub(in crate::emit) struct Newton {
    pub signals: Vec<Signal>,
    /// The same, `None` where nobody asks behind the loop.
    pub asked: Vec<Option<Signal>>,
    /// The same, `None` where the loop itself does not ask.
    pub moving: Vec<Option<Signal>>,
    /// Named within the loop, in order.
    pub inside: Vec<usize>,
    pub mass: Vec<Vec<usize>>,
    /// One column.
    pub right: Vec<Vec<usize>>,
}

impl Body {
    pub(super) fn new(
        program: &Program,
        motion: Motion,
        results: Vec<Vec<Expr>>,
    ) -> Result<Body, Signal> {
        let mut inputs = vec![Signal::TIME];
        inputs.extend(program.names.iter().map(|(s, _)| *s));
        inputs.extend(motion.slopes.iter().map(|(s, ..)| *s));
        let mut body = schedule(motion.definitions, &results, inputs)?;
        body.reads = body.all_reads(program);
        body.wishes = body.all_wishes(program, &motion.slopes);
        Ok(body)
    }

    pub fn nodes(&self) -> &[Node] {
        self.graph.nodes()
    }

    /// The signal that an input node is.
    pub fn input(&self, row: usize) -> Signal {
        self.inputs.get(row).copied().unwrap_or(Signal::TIME)
    }

    pub fn is_zero(&self, node: usize) -> bool {
        matches!(self.nodes().get(node), Some(Node::Number(bits)) if f64::from_bits(*bits) == 0.0)
    }

    pub(super) fn mentions(&self, s: Signal) -> bool {
        self.nodes()
            .iter()
            .any(|n| matches!(n, Node::Input(row) if self.input(*row) == s))
    }

    pub fn mentions_time(&self) -> bool {
        self.mentions(Signal::TIME)
    }

    fn all_reads(&self, program: &Program) -> Vec<Read> {
        let mentioned: BTreeSet<Signal> = self
            .nodes()
            .iter()
            .filter_map(|n| match n {
                Node::Input(row) => Some(self.input(*row)),
                _ => None,
            })
            .collect();
        let entries = program.arguments.iter().flat_map(|a| {
            a.signals.iter().enumerate().map(move |(place, s)| Read {
                argument: a.name,
                place,
                signal: *s,
            })
        });
        entries.filter(|r| mentioned.contains(&r.signal)).collect()
    }

    /// `sin_theta` for a function of one signal, `ddx_by_x` for a derivative, else a number.
    fn all_wishes(
        &self,
        program: &Program,
        slopes: &[(Signal, Signal, Signal)],
    ) -> Vec<(Name, String)> {
        let name = |s: Signal| {
            let found = program.names.iter().find(|(known, _)| *known == s);
            found.map_or_else(|| "t".to_string(), |(_, n)| n.clone())
        };
        let slopes = slopes
            .iter()
            .map(|(s, of, by)| (Name::Signal(*s), format!("{}_by_{}", name(*of), name(*by))));
        let mut wishes: Vec<(Name, String)> = slopes.collect();
        let mut count = 0;
        let mut named = BTreeSet::new();
        for node in self.steps.iter().flat_map(Step::named) {
            if !named.insert(node) {
                continue;
            }
            let wish = self.word(node, &name).unwrap_or_else(|| {
                count += 1;
                format!("w{count}")
            });
            wishes.push((Name::Node(node), wish));
        }
        wishes
    }

    fn word(&self, node: usize, name: &impl Fn(Signal) -> String) -> Option<String> {
        let Node::Call(f, args) = self.nodes().get(node)? else {
            return None;
        };
        match (
            args.as_slice(),
            args.first().and_then(|a| self.nodes().get(*a)),
        ) {
            ([_], Some(Node::Input(row))) => Some(format!("{}_{}", f.name, name(self.input(*row)))),
            _ => None,
        }
    }
}

impl Step {
    /// Nodes that get a name.
    fn named(&self) -> Vec<usize> {
        match self {
            Step::Let(Name::Node(node), _) => vec![*node],
            Step::Newton(newton) => newton.inside.clone(),
            Step::Let(..) | Step::Solve(_) => Vec::new(),
        }
    }
}
