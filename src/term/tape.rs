//! Straight-line code: many expressions at many points at once.
//!
//! In: expressions; then the values of their signals, point after point. Out: the values of the expressions, as
//! `Expr::eval` gives them. Never allocates in the loop but what `work` lacks.

use super::graph::{Graph, Node};
use super::{Expr, Func, Signal};

/// Values in all registers together: they fit the first cache (32 KB).
const CACHED: usize = 4096;

/// Fewest and most points at a time: what an instruction costs beside its points is spread over them.
const BLOCK: (usize, usize) = (32, 256);

/// Straight-line code for a list of expressions, common subexpressions evaluated once.
#[derive(Clone, Debug, Default)]
pub struct Tape {
    code: Vec<Instruction>,
    registers: usize,
    inputs: usize,
    outputs: usize,
}

#[derive(Clone, Debug)]
struct Instruction {
    op: Op,
    to: Place,
}

#[derive(Clone, Copy, Debug)]
enum Place {
    Register(usize),
    /// A row of the output.
    Row(usize),
}

/// Operands are registers.
#[derive(Clone, Debug)]
enum Op {
    Input(usize),
    Number(f64),
    Copy(usize),
    Product(usize, usize),
    Reciprocal(usize),
    Root(usize),
    Power(usize, f64),
    Call(Func, Box<[usize]>),
    Sum(f64, Box<[(f64, usize)]>),
}

impl Tape {
    /// `inputs`: the signals that points give, in the order of the rows of [`Tape::eval`]. `Err` is a signal that an
    /// expression mentions and that is not there.
    pub fn new(outputs: &[Expr], inputs: &[Signal]) -> Result<Tape, Signal> {
        let mut graph = Graph::new(inputs);
        let roots: Result<Vec<usize>, Signal> = outputs.iter().map(|e| graph.expr(e)).collect();
        let (code, registers) = Allocation::of(graph.nodes(), &roots?).emit(graph.nodes());
        Ok(Tape {
            code,
            registers,
            inputs: inputs.len(),
            outputs: outputs.len(),
        })
    }

    /// How many expressions there are.
    pub fn outputs(&self) -> usize {
        self.outputs
    }

    /// How many signals a point gives.
    pub fn inputs(&self) -> usize {
        self.inputs
    }

    /// The value of every expression at every point: that of [`Expr::eval`] to rounding, NaN and ±∞ included.
    ///
    /// `inputs` is inputs × points, all values of the first signal, then of the second; `out` likewise is outputs × points. What
    /// lies behind is neither read nor written; slices that are too short panic. `work` is scratch of any content, grown
    /// as needed.
    pub fn eval(&self, inputs: &[f64], points: usize, out: &mut [f64], work: &mut Vec<f64>) {
        let block = (CACHED / self.registers.max(1)).clamp(BLOCK.0, BLOCK.1);
        let width = points.min(block);
        if work.len() < self.registers * width {
            work.resize(self.registers * width, 0.0);
        }
        for start in (0..points).step_by(block) {
            let count = (points - start).min(block);
            for Instruction { op, to } in &self.code {
                let (target, operands) = match *to {
                    Place::Register(r) => {
                        let (below, rest) = work.split_at_mut(r * width);
                        let (target, above) = rest.split_at_mut(width);
                        let cut = r;
                        (
                            &mut target[..count],
                            Registers {
                                below,
                                above,
                                cut,
                                width,
                                count,
                            },
                        )
                    }
                    Place::Row(row) => {
                        let target = &mut out[row * points + start..][..count];
                        let cut = self.registers;
                        (
                            target,
                            Registers {
                                below: work,
                                above: &[],
                                cut,
                                width,
                                count,
                            },
                        )
                    }
                };
                match op {
                    Op::Input(row) => {
                        target.copy_from_slice(&inputs[row * points + start..][..count]);
                    }
                    op => op.run(target, &operands),
                }
            }
        }
    }
}

/// All registers but the one that is written.
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

impl Op {
    fn run(&self, target: &mut [f64], from: &Registers) {
        match self {
            // Written by the caller, who has the inputs.
            Op::Input(_) => {}
            Op::Number(value) => target.fill(*value),
            Op::Copy(a) => target.copy_from_slice(from.get(*a)),
            Op::Product(a, b) => {
                let pairs = from.get(*a).iter().zip(from.get(*b));
                for (t, (a, b)) in target.iter_mut().zip(pairs) {
                    *t = a * b;
                }
            }
            Op::Reciprocal(a) => each(target, from.get(*a), |x| 1.0 / x),
            // As `powf` has it: +0 for −0, +∞ for −∞.
            Op::Root(a) => each(target, from.get(*a), |x| match x == f64::NEG_INFINITY {
                true => f64::INFINITY,
                false => (x + 0.0).sqrt(),
            }),
            Op::Power(a, p) => each(target, from.get(*a), |x| x.powf(*p)),
            Op::Call(f, args) => call(target, *f, args, from),
            Op::Sum(start, parts) => sum(target, *start, parts, from),
        }
    }
}

#[inline]
fn each(target: &mut [f64], a: &[f64], f: impl Fn(f64) -> f64) {
    for (t, a) in target.iter_mut().zip(a) {
        *t = f(*a);
    }
}

fn call(target: &mut [f64], f: Func, args: &[usize], from: &Registers) {
    match args {
        [a] => each(target, from.get(*a), |x| (f.eval)(&[x])),
        [a, b] => {
            let pairs = from.get(*a).iter().zip(from.get(*b));
            for (t, (a, b)) in target.iter_mut().zip(pairs) {
                *t = (f.eval)(&[*a, *b]);
            }
        }
        many => {
            let rows: Vec<&[f64]> = many.iter().map(|a| from.get(*a)).collect();
            let mut point = vec![0.0; rows.len()];
            for (i, t) in target.iter_mut().enumerate() {
                point.iter_mut().zip(&rows).for_each(|(p, row)| *p = row[i]);
                *t = (f.eval)(&point);
            }
        }
    }
}

/// start + Σ weight·operand, four operands a pass over the target.
fn sum(target: &mut [f64], start: f64, parts: &[(f64, usize)], from: &Registers) {
    let mut start = Some(start);
    for part in parts.chunks(4) {
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

/// Which register holds which node, and until when.
struct Allocation {
    /// The last node that uses this one.
    last_use: Vec<Option<usize>>,
    /// The rows of the output that a node is.
    rows: Vec<Vec<usize>>,
    register: Vec<usize>,
    free: Vec<usize>,
    count: usize,
}

impl Allocation {
    fn of(nodes: &[Node], roots: &[usize]) -> Allocation {
        let mut rows = vec![Vec::new(); nodes.len()];
        for (row, root) in roots.iter().enumerate() {
            rows[*root].push(row);
        }
        // Backwards: the first use met is the last, and what only dead nodes use is dead.
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
        }
    }

    /// The code, and how many registers it needs.
    fn emit(mut self, nodes: &[Node]) -> (Vec<Instruction>, usize) {
        let mut code = Vec::with_capacity(nodes.len() + self.rows.len());
        for (i, node) in nodes.iter().enumerate() {
            if self.last_use[i].is_none() && self.rows[i].is_empty() {
                continue;
            }
            let op = self.op(node);
            if let (None, [row]) = (self.last_use[i], self.rows[i].as_slice()) {
                let to = Place::Row(*row);
                code.push(Instruction { op, to });
                self.release(i, node);
                continue;
            }
            let r = self.take();
            self.register[i] = r;
            let to = Place::Register(r);
            code.push(Instruction { op, to });
            code.extend(self.rows[i].iter().map(|row| Instruction {
                op: Op::Copy(r),
                to: Place::Row(*row),
            }));
            self.release(i, node);
            if self.last_use[i].is_none() {
                self.free.push(r);
            }
        }
        (code, self.count)
    }

    /// The register freed last, which is still in the cache, or a new one.
    fn take(&mut self) -> usize {
        self.free.pop().unwrap_or_else(|| {
            self.count += 1;
            self.count - 1
        })
    }

    /// Frees what node `i` uses last. Only after its own register is taken: no instruction writes what it reads.
    fn release(&mut self, i: usize, node: &Node) {
        let (last_use, register, free) = (&mut self.last_use, &self.register, &mut self.free);
        node.for_each_use(|a| {
            // Twice in one node is freed once.
            if last_use[a] == Some(i) {
                last_use[a] = None;
                free.push(register[a]);
            }
        });
    }

    fn op(&self, node: &Node) -> Op {
        let at = |a: &usize| self.register[*a];
        match node {
            Node::Input(row) => Op::Input(*row),
            Node::Number(bits) => Op::Number(f64::from_bits(*bits)),
            Node::Product(a, b) => Op::Product(at(a), at(b)),
            Node::Reciprocal(a) => Op::Reciprocal(at(a)),
            Node::Root(a) => Op::Root(at(a)),
            Node::Power(a, bits) => Op::Power(at(a), f64::from_bits(*bits)),
            Node::Call(f, args) => Op::Call(*f, args.iter().map(at).collect()),
            Node::Sum(start, parts) => {
                let part = |(bits, a): &(u64, usize)| (f64::from_bits(*bits), at(a));
                Op::Sum(f64::from_bits(*start), parts.iter().map(part).collect())
            }
        }
    }
}
