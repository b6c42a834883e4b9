//! Straight-line code run at one point at a time.
//!
//! In: expressions and their input signals. Out: their values, in slots of a buffer that the caller keeps. Every node has a slot of its
//! own, so that numbers are written once and not at each point. Never allocates while it runs: integrators call it millions of times.

use super::expression_graph::{Graph, used_nodes};
use super::operation::{Lowered, Operands, Operation, Values};
use crate::term::{Expr, Signal};

/// Straight-line code for a list of expressions, common subexpressions evaluated once.
#[derive(Clone, Debug, Default)]
pub struct PointTape {
    /// Operations in order, each with the slot that it writes.
    operations: Vec<(usize, Operation)>,
    operands: Operands,
    /// Slots as they begin: numbers in their places, zeros elsewhere.
    initial: Vec<f64>,
    /// The slot of every expression.
    pub outputs: Vec<usize>,
}

impl PointTape {
    /// `inputs`: the signals that the first slots hold, in order.
    ///
    /// # Errors
    /// A signal that an expression mentions and `inputs` lacks.
    pub fn new(outputs: &[Expr], inputs: &[Signal]) -> Result<PointTape, Signal> {
        let mut graph = Graph::new(inputs);
        let roots = graph.all(outputs)?;
        let mut tape = PointTape {
            initial: vec![0.0; inputs.len()],
            ..PointTape::default()
        };
        let used = used_nodes(graph.nodes(), &roots);
        let mut slots: Vec<usize> = Vec::with_capacity(graph.nodes().len());
        for (node, used) in graph.nodes().iter().zip(used) {
            slots.push(match used {
                false => 0,
                true => match tape.operands.lower(node, |a| slots[a]) {
                    Lowered::Input(row) => row,
                    Lowered::Number(value) => tape.slot(value),
                    Lowered::Operation(operation) => {
                        let to = tape.slot(0.0);
                        tape.operations.push((to, operation));
                        to
                    }
                },
            });
        }
        tape.outputs = roots.iter().map(|r| slots[*r]).collect();
        Ok(tape)
    }

    /// A buffer to run in.
    pub fn slots(&self) -> Vec<f64> {
        self.initial.clone()
    }

    /// Takes the first slots as the inputs and fills the others. `slots` were made by [`PointTape::slots`].
    pub fn run(&self, slots: &mut [f64]) {
        for (to, operation) in &self.operations {
            operation.run(&self.operands, Point { slots, to: *to });
        }
    }

    fn slot(&mut self, initial: f64) -> usize {
        self.initial.push(initial);
        self.initial.len() - 1
    }
}

/// The values at one point, and the slot that is written.
struct Point<'a> {
    slots: &'a mut [f64],
    to: usize,
}

impl Values for Point<'_> {
    #[inline]
    fn unary(self, a: usize, f: impl Fn(f64) -> f64) {
        self.slots[self.to] = f(self.slots[a]);
    }

    #[inline]
    fn binary(self, a: usize, b: usize, f: impl Fn(f64, f64) -> f64) {
        self.slots[self.to] = f(self.slots[a], self.slots[b]);
    }

    fn variadic(self, arguments: &[usize], f: impl Fn(&[f64]) -> f64) {
        // Functions take up to sixteen arguments.
        let mut buffer = [0.0; 16];
        let value = match buffer.get_mut(..arguments.len()) {
            Some(values) => {
                let pairs = values.iter_mut().zip(arguments);
                pairs.for_each(|(v, a)| *v = self.slots[*a]);
                f(values)
            }
            None => f(&arguments.iter().map(|a| self.slots[*a]).collect::<Vec<_>>()),
        };
        self.slots[self.to] = value;
    }

    #[inline]
    fn sum(self, start: f64, summands: &[(f64, usize)]) {
        let add = |sum, (weight, a): &(f64, usize)| sum + weight * self.slots[*a];
        self.slots[self.to] = summands.iter().fold(start, add);
    }
}
