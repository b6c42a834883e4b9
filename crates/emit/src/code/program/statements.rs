//! Straight-line code: the statements of one function over a graph in which common subexpressions are one node.
//!
//! Plain data that [`super::schedule`] fills and the targets write down. Knows no language.

use sidc_lang::term::{Graph, Node, Signal};

/// A vector argument of all functions.
pub(crate) struct Argument {
    pub name: &'static str,
    pub about: &'static str,
    pub signals: Vec<Signal>,
    /// Their names as the user wrote them.
    pub names: Vec<String>,
}

/// Straight-line code.
pub(crate) struct Body {
    pub graph: Graph,
    pub inputs: Vec<Signal>,
    /// Entries of arguments that are used.
    pub reads: Vec<Read>,
    pub steps: Vec<Step>,
    /// Rows × columns.
    pub results: Vec<Vec<usize>>,
    /// Preferred names of nodes and signals that are neither argument nor unknown.
    pub preferred_names: Vec<(Name, String)>,
}

/// `signal` is entry `place` of the argument of that name.
pub(crate) struct Read {
    pub argument: &'static str,
    pub place: usize,
    pub signal: Signal,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Name {
    Signal(Signal),
    Node(usize),
}

pub(crate) enum Step {
    /// Assigns a node to a name.
    Let(Name, usize),
    Solve(Solve),
    Newton(Newton),
}

/// mass · signals = right, for all columns at once; NaN where mass is singular.
pub(crate) struct Solve {
    pub mass: Vec<Vec<usize>>,
    pub right: Vec<Vec<usize>>,
    /// `None` for values that nothing uses.
    pub signals: Vec<Vec<Option<Signal>>>,
}

/// mass · signals = right, where both depend on the signals: Newton's method from zero, as `Form::solve` does.
pub(crate) struct Newton {
    pub signals: Vec<Signal>,
    /// The same; `None` for values that nothing after the loop uses.
    pub used_after: Vec<Option<Signal>>,
    /// The same; `None` for values that the loop itself does not use.
    pub used_inside: Vec<Option<Signal>>,
    /// Nodes named within the loop, in order.
    pub named_inside: Vec<usize>,
    pub mass: Vec<Vec<usize>>,
    /// One column.
    pub right: Vec<Vec<usize>>,
}

impl Body {
    pub fn nodes(&self) -> &[Node] {
        self.graph.nodes()
    }

    /// The signal of an input node.
    pub fn input(&self, row: usize) -> Signal {
        self.inputs.get(row).copied().unwrap_or(Signal::TIME)
    }

    pub fn is_zero(&self, node: usize) -> bool {
        matches!(self.nodes().get(node), Some(Node::Number(bits)) if f64::from_bits(*bits) == 0.0)
    }

    pub fn mentions(&self, s: Signal) -> bool {
        self.nodes()
            .iter()
            .any(|n| matches!(n, Node::Input(row) if self.input(*row) == s))
    }

    pub fn mentions_time(&self) -> bool {
        self.mentions(Signal::TIME)
    }
}

impl Step {
    /// Nodes that this step names.
    pub fn named(&self) -> Vec<usize> {
        match self {
            Step::Let(Name::Node(node), _) => vec![*node],
            Step::Newton(newton) => newton.named_inside.clone(),
            Step::Let(..) | Step::Solve(_) => Vec::new(),
        }
    }
}
