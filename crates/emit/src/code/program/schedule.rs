//! The order of the steps, and common subexpression elimination.
//!
//! In: definitions and the expressions to compute. Out: a body. Only what is used is computed. What is used once is
//! written in place; what is used more often is named before its first use.

use std::collections::BTreeSet;

use crate::code::program::definitions::{Definition, System};
use crate::code::program::statements::{Body, Name, Newton, Solve, Step};
use sidc_lang::term::{Expr, Graph, Node, Signal};

/// The steps that compute `results` (rows × columns) from `inputs`, some of which are constants. Reads and names are left empty.
///
/// # Errors
/// A signal that is not among the inputs.
pub(crate) fn schedule(
    definitions: Vec<Definition>,
    results: &[Vec<Expr>],
    (inputs, constants): (Vec<Signal>, &[Signal]),
) -> Result<Body, Signal> {
    let definitions = used(definitions, results);
    let mut graph = Graph::new(&inputs).with_constants(constants);
    let planned: Result<Vec<Planned>, Signal> = definitions
        .iter()
        .map(|d| Planned::new(d, &mut graph))
        .collect();
    let results: Result<Vec<Vec<usize>>, Signal> =
        results.iter().map(|row| nodes(row, &mut graph)).collect();
    Ok(Schedule::new(graph, inputs).run(planned?, results?))
}

/// The definitions that the results depend on.
fn used(definitions: Vec<Definition>, results: &[Vec<Expr>]) -> Vec<Definition> {
    let mut needed = BTreeSet::new();
    let need = |e: &Expr, needed: &mut BTreeSet<Signal>| {
        e.for_each_signal(&mut |s| {
            needed.insert(s);
        });
    };
    results.iter().flatten().for_each(|e| need(e, &mut needed));
    let mut kept = Vec::new();
    for definition in definitions.into_iter().rev() {
        if definition.signals().iter().any(|s| needed.contains(s)) {
            definition
                .exprs()
                .into_iter()
                .for_each(|e| need(e, &mut needed));
            kept.push(definition);
        }
    }
    kept.reverse();
    kept
}

fn nodes(row: &[Expr], graph: &mut Graph) -> Result<Vec<usize>, Signal> {
    row.iter().map(|e| graph.expr(e)).collect()
}

/// A definition as nodes.
enum Planned {
    Formula(Signal, usize),
    Linear(PlannedSystem),
    Newton(PlannedSystem),
}

struct PlannedSystem {
    mass: Vec<Vec<usize>>,
    right: Vec<Vec<usize>>,
    signals: Vec<Vec<Signal>>,
}

impl Planned {
    fn new(definition: &Definition, graph: &mut Graph) -> Result<Planned, Signal> {
        let mut system = |s: &System| -> Result<PlannedSystem, Signal> {
            let mass: Result<_, Signal> = s.mass.iter().map(|row| nodes(row, graph)).collect();
            let right: Result<_, Signal> = s.right.iter().map(|row| nodes(row, graph)).collect();
            Ok(PlannedSystem {
                mass: mass?,
                right: right?,
                signals: s.signals.clone(),
            })
        };
        Ok(match definition {
            Definition::Linear(s) => Planned::Linear(system(s)?),
            Definition::Newton(s) => Planned::Newton(system(s)?),
            Definition::Formula(s, e) => Planned::Formula(*s, graph.expr(e)?),
        })
    }

    fn roots(&self) -> Vec<usize> {
        match self {
            Planned::Formula(_, node) => vec![*node],
            Planned::Linear(s) | Planned::Newton(s) => s.roots(),
        }
    }
}

impl PlannedSystem {
    fn roots(&self) -> Vec<usize> {
        self.mass
            .iter()
            .chain(&self.right)
            .flatten()
            .copied()
            .collect()
    }
}

/// Emits steps in order; a node is named just before its first use.
struct Schedule {
    body: Body,
    uses: Vec<usize>,
    named: BTreeSet<usize>,
}

impl Schedule {
    fn new(graph: Graph, inputs: Vec<Signal>) -> Schedule {
        let uses = vec![0; graph.nodes().len()];
        let body = Body {
            graph,
            inputs,
            reads: Vec::new(),
            steps: Vec::new(),
            results: Vec::new(),
            preferred_names: Vec::new(),
        };
        Schedule {
            body,
            uses,
            named: BTreeSet::new(),
        }
    }

    fn run(mut self, planned: Vec<Planned>, results: Vec<Vec<usize>>) -> Body {
        let roots = planned
            .iter()
            .flat_map(Planned::roots)
            .chain(results.iter().flatten().copied());
        let uses = &mut self.uses;
        let mut count = |node: usize| uses.iter_mut().skip(node).take(1).for_each(|n| *n += 1);
        roots.for_each(&mut count);
        self.body
            .graph
            .nodes()
            .iter()
            .for_each(|n| n.for_each_use(&mut count));
        let wanted: Vec<usize> = results.iter().flatten().copied().collect();
        for (i, plan) in planned.iter().enumerate() {
            match plan {
                Planned::Formula(signal, node) => {
                    self.prepare(&[*node]);
                    self.body
                        .steps
                        .push(Step::Let(Name::Signal(*signal), *node));
                }
                Planned::Linear(s) => {
                    self.prepare(&s.roots());
                    let used = |s: &Signal| Some(*s).filter(|s| self.body.mentions(*s));
                    let signals = s
                        .signals
                        .iter()
                        .map(|row| row.iter().map(used).collect())
                        .collect();
                    self.body.steps.push(Step::Solve(Solve {
                        mass: s.mass.clone(),
                        right: s.right.clone(),
                        signals,
                    }));
                }
                Planned::Newton(s) => {
                    let later = planned.iter().skip(i + 1).flat_map(Planned::roots);
                    let later: Vec<usize> = later.chain(wanted.iter().copied()).collect();
                    self.newton(s, &later);
                }
            }
        }
        self.prepare(&wanted);
        self.body.results = results;
        self.body
    }

    fn node(&self, node: usize) -> Option<&Node> {
        self.body.graph.nodes().get(node)
    }

    /// True for inputs and numbers, which need no computation.
    fn is_given(&self, node: usize) -> bool {
        matches!(
            self.node(node),
            None | Some(Node::Input(_) | Node::Number(_))
        )
    }

    fn operands(&self, node: usize) -> Vec<usize> {
        let mut all = Vec::new();
        if let Some(n) = self.node(node) {
            n.for_each_use(|a| all.push(a));
        }
        all
    }

    /// Names the shared nodes below these roots, as steps.
    fn prepare(&mut self, roots: &[usize]) {
        let mut lets = Vec::new();
        roots.iter().for_each(|r| self.name(*r, &mut lets));
        self.body
            .steps
            .extend(lets.into_iter().map(|n| Step::Let(Name::Node(n), n)));
    }

    /// Names a node and its operands, if they are used more than once and not named yet.
    fn name(&mut self, node: usize, lets: &mut Vec<usize>) {
        if self.is_given(node) || self.named.contains(&node) {
            return;
        }
        self.operands(node)
            .into_iter()
            .for_each(|a| self.name(a, lets));
        if self.uses.get(node).is_some_and(|n| *n > 1) {
            self.named.insert(node);
            lets.push(node);
        }
    }

    /// `later`: the roots computed after the loop.
    fn newton(&mut self, s: &PlannedSystem, later: &[usize]) {
        let signals: Vec<Signal> = s.signals.concat();
        let among = |roots: &[usize]| -> Vec<Option<Signal>> {
            let below = self.signals_below(roots);
            signals
                .iter()
                .map(|s| Some(*s).filter(|s| below.contains(s)))
                .collect()
        };
        let (used_after, used_inside) = (among(later), among(&s.roots()));
        let dependent = self.dependent(&signals);
        let roots = s.roots();
        let mut before = Vec::new();
        let mut seen = BTreeSet::new();
        roots
            .iter()
            .for_each(|r| self.hoist(*r, &dependent, &mut seen, &mut before));
        self.body
            .steps
            .extend(before.into_iter().map(|n| Step::Let(Name::Node(n), n)));
        let mut named_inside = Vec::new();
        roots.iter().for_each(|r| self.name(*r, &mut named_inside));
        // Names inside the loop are not visible after it, and their values belong to the iteration before the last.
        named_inside.iter().for_each(|n| {
            self.named.remove(n);
        });
        self.body.steps.push(Step::Newton(Newton {
            signals,
            used_after,
            used_inside,
            named_inside,
            mass: s.mass.clone(),
            right: s.right.clone(),
        }));
    }

    fn signals_below(&self, roots: &[usize]) -> BTreeSet<Signal> {
        let (mut open, mut seen, mut found) = (roots.to_vec(), BTreeSet::new(), BTreeSet::new());
        while let Some(node) = open.pop() {
            if seen.insert(node) {
                if let Some(Node::Input(row)) = self.node(node) {
                    found.insert(self.body.input(*row));
                }
                open.extend(self.operands(node));
            }
        }
        found
    }

    /// Which nodes depend on the signals.
    fn dependent(&self, signals: &[Signal]) -> Vec<bool> {
        let mut dependent: Vec<bool> = Vec::with_capacity(self.uses.len());
        for node in self.body.graph.nodes() {
            let mut moves =
                matches!(node, Node::Input(row) if signals.contains(&self.body.input(*row)));
            node.for_each_use(|a| moves |= dependent.get(a) == Some(&true));
            dependent.push(moves);
        }
        dependent
    }

    /// Names the largest parts below `node` that do not depend on the signals, so that they are computed before the
    /// loop.
    fn hoist(
        &mut self,
        node: usize,
        dependent: &[bool],
        seen: &mut BTreeSet<usize>,
        lets: &mut Vec<usize>,
    ) {
        if self.is_given(node) || self.named.contains(&node) || !seen.insert(node) {
            return;
        }
        if dependent.get(node) == Some(&true) {
            self.operands(node)
                .into_iter()
                .for_each(|a| self.hoist(a, dependent, seen, lets));
            return;
        }
        self.operands(node)
            .into_iter()
            .for_each(|a| self.name(a, lets));
        self.named.insert(node);
        lets.push(node);
    }
}
