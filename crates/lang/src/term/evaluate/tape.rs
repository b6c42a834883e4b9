//! Straight-line code run at many points at once.
//!
//! In: expressions, then the values of their signals at many points. Out: the values of the expressions, equal to those of `Expr::eval` to
//! rounding. Allocates only what `work` lacks, and a little in each block for functions of three or more arguments.

use super::expression_graph::{Graph, Node};
use super::operation::{Lowered, Operands, Operation, Values};
use crate::term::{Expr, Signal};

/// Values in all registers together: 32 KiB, the size of a first-level cache.
const CACHED: usize = 4096;

/// Fewest and most points in a block. The cost of decoding an instruction is spread over a block.
const BLOCK: (usize, usize) = (32, 256);

/// Straight-line code for a list of expressions, common subexpressions evaluated once.
#[derive(Clone, Debug, Default)]
pub struct Tape {
    code: Vec<Instruction>,
    operands: Operands,
    registers: usize,
    inputs: usize,
    outputs: usize,
}

#[derive(Clone, Debug)]
struct Instruction {
    action: Action,
    to: Place,
}

#[derive(Clone, Copy, Debug)]
enum Place {
    Register(usize),
    /// A row of the output.
    Row(usize),
}

#[derive(Clone, Debug)]
enum Action {
    /// From a row of the inputs.
    Input(usize),
    Number(f64),
    /// From a register.
    Copy(usize),
    Compute(Operation),
}

impl Tape {
    /// `inputs` are the signals in the order of the rows of [`Tape::eval`]. `Err` is a signal that an expression mentions and `inputs`
    /// lacks.
    pub fn new(outputs: &[Expr], inputs: &[Signal]) -> Result<Tape, Signal> {
        let mut graph = Graph::new(inputs);
        let roots = graph.all(outputs)?;
        let (code, operands, registers) = Allocation::of(graph.nodes(), &roots).emit(graph.nodes());
        Ok(Tape {
            code,
            operands,
            registers,
            inputs: inputs.len(),
            outputs: outputs.len(),
        })
    }

    /// How many expressions there are.
    pub fn outputs(&self) -> usize {
        self.outputs
    }

    /// Number of signals at a point.
    pub fn inputs(&self) -> usize {
        self.inputs
    }

    /// The value of every expression at every point: that of [`Expr::eval`] to rounding, NaN and ±∞ included.
    ///
    /// `inputs` is inputs × points, all values of the first signal, then of the second; `out` likewise is outputs × points. Values beyond
    /// these are neither read nor written; slices that are too short panic. `work` is scratch of any content, grown as needed.
    pub fn eval(&self, inputs: &[f64], points: usize, out: &mut [f64], work: &mut Vec<f64>) {
        let block = (CACHED / self.registers.max(1)).clamp(BLOCK.0, BLOCK.1);
        let width = points.min(block);
        if work.len() < self.registers * width {
            work.resize(self.registers * width, 0.0);
        }
        for start in (0..points).step_by(block) {
            let count = (points - start).min(block);
            for Instruction { action, to } in &self.code {
                let (target, below, above, cut) = match *to {
                    Place::Register(r) => {
                        let (below, rest) = work.split_at_mut(r * width);
                        let (target, above) = rest.split_at_mut(width);
                        (&mut target[..count], &*below, &*above, r)
                    }
                    Place::Row(row) => {
                        let target = &mut out[row * points + start..][..count];
                        (target, work.as_slice(), &[][..], self.registers)
                    }
                };
                let registers = Registers {
                    below,
                    above,
                    cut,
                    width,
                    count,
                };
                match action {
                    Action::Input(row) => {
                        target.copy_from_slice(&inputs[row * points + start..][..count]);
                    }
                    Action::Number(value) => target.fill(*value),
                    Action::Copy(a) => target.copy_from_slice(registers.get(*a)),
                    Action::Compute(operation) => {
                        operation.run(&self.operands, Block { target, registers });
                    }
                }
            }
        }
    }
}

/// All registers except the one that is written.
struct Registers<'a> {
    below: &'a [f64],
    above: &'a [f64],
    /// The register in between.
    cut: usize,
    width: usize,
    /// Points in this block.
    count: usize,
}

impl Registers<'_> {
    #[inline]
    fn get(&self, r: usize) -> &[f64] {
        match r.checked_sub(self.cut + 1) {
            None => &self.below[r * self.width..][..self.count],
            Some(r) => &self.above[r * self.width..][..self.count],
        }
    }
}

/// The values of a block of points, and the register or row that is written.
struct Block<'a> {
    target: &'a mut [f64],
    registers: Registers<'a>,
}

impl Values for Block<'_> {
    #[inline]
    fn unary(self, a: usize, f: impl Fn(f64) -> f64) {
        for (t, a) in self.target.iter_mut().zip(self.registers.get(a)) {
            *t = f(*a);
        }
    }

    #[inline]
    fn binary(self, a: usize, b: usize, f: impl Fn(f64, f64) -> f64) {
        let pairs = self.registers.get(a).iter().zip(self.registers.get(b));
        for (t, (a, b)) in self.target.iter_mut().zip(pairs) {
            *t = f(*a, *b);
        }
    }

    fn variadic(self, arguments: &[usize], f: impl Fn(&[f64]) -> f64) {
        let rows: Vec<&[f64]> = arguments.iter().map(|a| self.registers.get(*a)).collect();
        let mut point = vec![0.0; rows.len()];
        for (i, t) in self.target.iter_mut().enumerate() {
            point.iter_mut().zip(&rows).for_each(|(p, row)| *p = row[i]);
            *t = f(&point);
        }
    }

    /// Four operands in each pass over the target.
    fn sum(self, start: f64, summands: &[(f64, usize)]) {
        let (target, from) = (self.target, &self.registers);
        let mut start = Some(start);
        for part in summands.chunks(4) {
            match part {
                [a, b, c, d] => add(target, start, [*a, *b, *c, *d], from),
                [a, b, c] => add(target, start, [*a, *b, *c], from),
                [a, b] => add(target, start, [*a, *b], from),
                [a] => add(target, start, [*a], from),
                _ => {}
            }
            start = None;
        }
    }
}

/// target = (start or target) + Σ weight·operand, from left to right.
#[inline]
fn add<const N: usize>(
    target: &mut [f64],
    start: Option<f64>,
    parts: [(f64, usize); N],
    from: &Registers,
) {
    let count = target.len();
    let rows = parts.map(|(_, a)| &from.get(a)[..count]);
    let onto = |before: f64, i: usize| (0..N).fold(before, |sum, k| sum + parts[k].0 * rows[k][i]);
    match start {
        Some(start) => (0..count).for_each(|i| target[i] = onto(start, i)),
        None => (0..count).for_each(|i| target[i] = onto(target[i], i)),
    }
}

/// Register allocation by linear scan (Poletto and Sarkar 1999): which register holds which node, and until when.
struct Allocation {
    /// The last node that uses this one.
    last_use: Vec<Option<usize>>,
    /// The rows of the output that a node goes to.
    rows: Vec<Vec<usize>>,
    register: Vec<usize>,
    free: Vec<usize>,
    count: usize,
    operands: Operands,
}

impl Allocation {
    fn of(nodes: &[Node], roots: &[usize]) -> Allocation {
        let mut rows = vec![Vec::new(); nodes.len()];
        for (row, root) in roots.iter().enumerate() {
            rows[*root].push(row);
        }
        // Backwards, the first use found is the last one, and nodes that only dead nodes use are dead.
        let mut last_use = vec![None; nodes.len()];
        for (i, node) in nodes.iter().enumerate().rev() {
            if last_use[i].is_some() || !rows[i].is_empty() {
                node.for_each_use(|a| {
                    last_use[a].get_or_insert(i);
                });
            }
        }
        Allocation {
            last_use,
            rows,
            register: vec![0; nodes.len()],
            free: Vec::new(),
            count: 0,
            operands: Operands::default(),
        }
    }

    /// The code, its operands, and how many registers it needs.
    fn emit(mut self, nodes: &[Node]) -> (Vec<Instruction>, Operands, usize) {
        let mut code = Vec::with_capacity(nodes.len() + self.rows.len());
        for (i, node) in nodes.iter().enumerate() {
            if self.last_use[i].is_none() && self.rows[i].is_empty() {
                continue;
            }
            let action = self.action(node);
            if let (None, [row]) = (self.last_use[i], self.rows[i].as_slice()) {
                let to = Place::Row(*row);
                code.push(Instruction { action, to });
                self.release(i, node);
                continue;
            }
            let r = self.take();
            self.register[i] = r;
            let to = Place::Register(r);
            code.push(Instruction { action, to });
            code.extend(self.rows[i].iter().map(|row| Instruction {
                action: Action::Copy(r),
                to: Place::Row(*row),
            }));
            self.release(i, node);
            if self.last_use[i].is_none() {
                self.free.push(r);
            }
        }
        (code, self.operands, self.count)
    }

    /// The register that was freed last, since it is still cached, or a new one.
    fn take(&mut self) -> usize {
        self.free.pop().unwrap_or_else(|| {
            self.count += 1;
            self.count - 1
        })
    }

    /// Frees the registers that node `i` uses last. Called after the node has its own register, so that no instruction writes what
    /// it reads.
    fn release(&mut self, i: usize, node: &Node) {
        let (last_use, register, free) = (&mut self.last_use, &self.register, &mut self.free);
        node.for_each_use(|a| {
            // An operand that a node uses twice is freed once.
            if last_use[a] == Some(i) {
                last_use[a] = None;
                free.push(register[a]);
            }
        });
    }

    fn action(&mut self, node: &Node) -> Action {
        let register = &self.register;
        match self.operands.lower(node, |a| register[a]) {
            Lowered::Input(row) => Action::Input(row),
            Lowered::Number(value) => Action::Number(value),
            Lowered::Operation(operation) => Action::Compute(operation),
        }
    }
}
