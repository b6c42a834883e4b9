//! A checked model: every name resolved, every statement understood, every node with its span.
//!
//! Made by [`super::check`]; read by the library, the data reader and the emitters. Never holds data.

use std::collections::BTreeMap;

use crate::sensor_noise::SensorNoise;
use crate::source::Span;
use crate::term::{Expr, Func, Signal, SignalNames, Term, VarId};
use crate::units;
use crate::units::Unit;

pub use crate::reset::{Condition, Reset};
pub use crate::unknown_constant::UnknownConstant;

#[derive(Clone, Debug, Default)]
pub struct Model {
    /// Name of the `system` statement.
    pub system: Option<String>,
    /// Declared variables; index 0 is time `t`.
    pub vars: Vec<Var>,
    /// True if the model mentions `next` or lagged samples: times are sample numbers, derivatives do not exist.
    pub discrete: bool,
    pub equations: Vec<Equation>,
    /// The variables of kind [`VarKind::Unknown`], in order of declaration.
    pub unknowns: Vec<UnknownConstant>,
    pub constraints: Vec<Constraint>,
    /// Coefficients that may differ from run to run.
    pub per_run: Vec<Coefficient>,
    /// What `when` states, in order.
    pub resets: Vec<Reset>,
    pub symmetries: Vec<Symmetry>,
    /// Largest sum of |exponents| of a term, if limited.
    pub degree: Option<f64>,
    /// The norms that `prefer` states.
    pub norms: PreferredNorms,
    pub data: DataBlock,
}

/// The norms that an answer may minimise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PreferredNorms {
    /// The answer with the fewest terms among those of all norms.
    #[default]
    Any,
    /// `prefer plain`: the weight of a term is the length of its column.
    Plain,
    /// `prefer degree`: the weight of a term grows with its degree.
    Degree,
}

/// `symmetry y, theta -> -(y, theta)`: the equations also hold with the signs of these variables changed.
#[derive(Clone, Debug)]
pub struct Symmetry {
    pub flipped: Vec<VarId>,
    pub span: Span,
}

impl Symmetry {
    /// True if the symmetry changes the sign of a signal. Derivatives and shifted samples change with their variable; a change of
    /// the sign of time adds one change for each derivative.
    pub fn flips(&self, s: Signal) -> bool {
        let has = |var: VarId| self.flipped.contains(&var);
        has(s.var) ^ (has(VarId::TIME) && s.der % 2 == 1)
    }
}

#[derive(Clone, Debug)]
pub struct Var {
    pub name: String,
    pub kind: VarKind,
    /// Highest derivative that exists.
    pub order: u8,
    /// Noise of the sensor by order of derivative.
    pub noise: BTreeMap<u8, SensorNoise>,
    /// Time constant of the noise of a state's own sensor, if declared: 0 for white noise. Finite, not negative.
    pub noise_time_constant: Option<f64>,
    /// Its unit. In a model with units, time is in seconds unless declared otherwise.
    pub unit: Option<Unit>,
    /// How an input moves between samples, if declared.
    pub between: Option<Between>,
    /// How late an input acts, or the sensor of a state reads, if declared.
    pub delay: Option<Delay>,
    /// Whether it is a state that nothing measures.
    pub hidden: bool,
    /// Where it was declared; `None` for time.
    pub span: Option<Span>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VarKind {
    Time,
    State,
    Input,
    Output,
    /// Constant along a trajectory.
    Param,
    /// A constant that is estimated with the coefficients: [`Model::unknowns`].
    Unknown,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Between {
    /// Zero-order hold: the value of a sample lasts until the next.
    Hold,
    Linear,
    /// Along the cubic through the four nearest samples.
    Cubic,
}

impl Between {
    /// The attribute that declares it.
    pub fn word(self) -> &'static str {
        match self {
            Between::Hold => "hold",
            Between::Linear => "linear",
            Between::Cubic => "cubic",
        }
    }

    pub fn named(word: &str) -> Option<Between> {
        let all = [Between::Hold, Between::Linear, Between::Cubic];
        all.into_iter().find(|b| b.word() == word)
    }
}

/// How late an input acts, or a sensor reads a state, in seconds. Finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Delay {
    /// `delay 0.09`, not negative.
    Known(f64),
    /// `delay in 0 .. 0.2`: estimated within this range, ends included; `from` is below `to`.
    Within { from: f64, to: f64 },
}

/// One equation: the target signal, and what is known or asked about it.
#[derive(Clone, Debug)]
pub struct Equation {
    pub target: Signal,
    pub target_span: Span,
    /// The whole statement.
    pub span: Span,
    /// The statement as it was written, on one line, without comments.
    pub written: String,
    pub right: RightSide,
}

impl Equation {
    /// The statement with further terms in its library.
    pub fn with(&self, terms: &[String]) -> String {
        format!("{} + <{}>", self.written, terms.join(", "))
    }

    /// The statement with these terms taken out of the library of the target `name`; the other targets of the statement keep theirs.
    pub fn without(&self, name: &str, terms: &[String]) -> Vec<String> {
        let terms = terms.join(", ");
        let (left, right) = self.written.split_once('~').unwrap_or((name, ""));
        let others = left.split(',').map(str::trim).filter(|t| *t != name);
        let others: Vec<&str> = others.collect();
        let mut lines = vec![format!("{name} ~{right} - <{terms}>")];
        if !others.is_empty() {
            lines.push(format!("{} ~{right}", others.join(", ")));
        }
        lines
    }
}

#[derive(Clone, Debug)]
pub enum RightSide {
    /// `TARGET = EXPR`
    Known(Expr),
    /// `TARGET ~ known(EXPR) + LIBRARY`; `library` is `None` if only known parts were written.
    Search {
        known: Vec<(Expr, Span)>,
        library: Option<LibExpr>,
    },
}

/// An expression over sets of terms, names resolved, not yet expanded.
#[derive(Clone, Debug)]
pub struct LibExpr {
    pub span: Span,
    pub kind: LibKind,
}

impl LibExpr {
    pub fn new(span: Span, kind: LibKind) -> Self {
        LibExpr { span, kind }
    }
}

#[derive(Clone, Debug)]
pub enum LibKind {
    /// A bare term: a set of one. The numeric factor is kept so that a note can name it.
    Term(Expr),
    /// `< a, b, trig >`: items are terms or whole libraries.
    List(Vec<LibExpr>),
    Union(Box<LibExpr>, Box<LibExpr>),
    Difference(Box<LibExpr>, Box<LibExpr>),
    Product(Box<LibExpr>, Box<LibExpr>),
    /// The divisor must expand to exactly one term.
    Quotient(Box<LibExpr>, Box<LibExpr>),
    /// The base must expand to exactly one term.
    Power(Box<LibExpr>, f64),
    /// `name(args; numbers)`
    Generate {
        name: String,
        name_span: Span,
        args: Vec<LibExpr>,
        numbers: Vec<NumberArg>,
    },
    /// `required(A)`: the same terms, which stay in every answer.
    Required(Box<LibExpr>),
    /// A `let` library used by name: `span` is the use, `body.span` the definition.
    Named {
        name: String,
        body: Box<LibExpr>,
    },
}

/// A number after the `;` of a generator: `2` is `2..2`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NumberArg {
    pub from: f64,
    pub to: f64,
    /// True if written as a range `a..b`.
    pub range: bool,
    pub span: Span,
}

/// `Σ weight · coef(target, term) + constant  RELATION  0`
#[derive(Clone, Debug)]
pub struct Constraint {
    pub coefficients: Vec<Coefficient>,
    pub constant: f64,
    pub relation: Relation,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub struct Coefficient {
    pub weight: f64,
    pub target: Signal,
    pub term: Term,
    pub span: Span,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Relation {
    Less,
    LessOrEqual,
    Equal,
    GreaterOrEqual,
    Greater,
}

/// Where signals come from; without an entry, columns match by name.
#[derive(Clone, Debug, Default)]
pub struct DataBlock {
    /// The whole block, if written.
    pub span: Option<Span>,
    pub entries: Vec<DataEntry>,
    /// `step 0.01`: sampling interval in seconds if there is no time column.
    pub step: Option<(f64, Span)>,
    /// `run = "exp_id"`: the column that splits one file into trajectories.
    pub run: Option<(String, Span)>,
}

impl DataBlock {
    /// How many experiments stand side by side in a table.
    pub fn side_by_side(&self) -> usize {
        let further = self.entries.iter().map(|e| e.beside.len());
        1 + further.max().unwrap_or(0)
    }

    /// The header of the column that a signal called `name` is read from unchanged; `None` if the block converts it, leaves it out, or has
    /// a column for each run.
    pub fn column<'a>(&'a self, signal: Signal, name: &'a str) -> Option<&'a str> {
        let Some(entry) = self.entries.iter().find(|e| e.signal == signal) else {
            return Some(name);
        };
        match &entry.source.as_ref()?.kind {
            _ if !entry.beside.is_empty() => None,
            ColumnKind::Column(header) => Some(header),
            _ => None,
        }
    }
}

#[derive(Clone, Debug)]
pub struct DataEntry {
    pub signal: Signal,
    /// The name on the left.
    pub span: Span,
    /// `None` for `dy = none`.
    pub source: Option<ColumnExpr>,
    /// The sources in the second run and later ones, for experiments side by side; empty if all runs read the same source.
    pub beside: Vec<ColumnExpr>,
}

impl DataEntry {
    /// The source in one of the runs that stand side by side, counted from 0.
    pub fn source_of(&self, run: usize) -> Option<&ColumnExpr> {
        let other = run.checked_sub(1).and_then(|k| self.beside.get(k));
        other.or(self.source.as_ref())
    }
}

/// Arithmetic on the columns of a data file.
#[derive(Clone, Debug)]
pub struct ColumnExpr {
    pub span: Span,
    pub kind: ColumnKind,
}

#[derive(Clone, Debug)]
pub enum ColumnKind {
    Number(f64),
    /// A header, trimmed.
    Column(String),
    Negate(Box<ColumnExpr>),
    Add(Box<ColumnExpr>, Box<ColumnExpr>),
    Subtract(Box<ColumnExpr>, Box<ColumnExpr>),
    Multiply(Box<ColumnExpr>, Box<ColumnExpr>),
    Divide(Box<ColumnExpr>, Box<ColumnExpr>),
    Power(Box<ColumnExpr>, f64),
    Call(Func, Vec<ColumnExpr>),
    /// `unwrap(column, period)`: jumps of more than half a period are undone.
    Unwrap(Box<ColumnExpr>, f64),
}

impl Model {
    /// What time is counted in.
    pub fn time_unit(&self) -> String {
        let time = self.var(VarId::TIME);
        units::of_time(self.discrete, time.and_then(|t| t.unit.as_ref()))
    }

    pub fn var(&self, id: VarId) -> Option<&Var> {
        self.vars.get(id.0 as usize)
    }

    /// Noise of a signal's sensor, if declared.
    pub fn noise(&self, s: Signal) -> Option<SensorNoise> {
        self.var(s.var)?.noise.get(&s.der).copied()
    }

    /// Time constant of the noise of a state's own sensor, if declared.
    pub fn noise_time_constant(&self, s: Signal) -> Option<f64> {
        self.var(s.var)?.noise_time_constant.filter(|_| s.der == 0)
    }

    /// States whose noise is declared to be autocorrelated, in order of declaration.
    pub fn autocorrelated_noise(&self) -> impl Iterator<Item = Signal> {
        let states = self.vars_of(VarKind::State);
        let lasting = states.filter(|(_, v)| v.noise_time_constant.is_some_and(|m| m > 0.0));
        lasting.map(|(id, _)| Signal::new(id))
    }

    /// Inputs whose noise is declared, in order of declaration.
    pub fn noisy_inputs(&self) -> impl Iterator<Item = (Signal, SensorNoise)> {
        let inputs = self.vars_of(VarKind::Input);
        inputs.filter_map(|(id, v)| Some((Signal::new(id), *v.noise.get(&0)?)))
    }

    /// Inputs and states with a declared delay, in order of declaration.
    pub fn delays(&self) -> impl Iterator<Item = (VarId, Delay)> {
        let all = (0..).map(VarId).zip(&self.vars);
        all.filter_map(|(id, v)| Some((id, v.delay?)))
    }

    /// States that nothing measures, in order of declaration.
    pub fn hidden_states(&self) -> impl Iterator<Item = (VarId, &Var)> {
        self.vars_of(VarKind::State).filter(|(_, v)| v.hidden)
    }

    /// Whether a variable is a state that nothing measures.
    pub fn is_hidden(&self, id: VarId) -> bool {
        self.var(id).is_some_and(|v| v.hidden)
    }

    /// True if some delay is to be estimated.
    pub fn has_unknown_delays(&self) -> bool {
        self.delays()
            .any(|(_, d)| matches!(d, Delay::Within { .. }))
    }

    /// The unit of a signal, if its variable declares one.
    pub fn unit(&self, s: Signal) -> Option<Unit> {
        let of = |id: VarId| self.var(id)?.unit.as_ref();
        units::derivative(of(s.var)?, of(VarId::TIME)?, s.der)
    }

    /// True if a variable, one of its derivatives or its next sample has an equation.
    pub fn has_equation(&self, id: VarId) -> bool {
        self.equations.iter().any(|e| e.target.var == id)
    }

    /// Declared variables of one kind, in order of declaration.
    pub fn vars_of(&self, kind: VarKind) -> impl Iterator<Item = (VarId, &Var)> {
        self.vars
            .iter()
            .enumerate()
            .filter(move |(_, v)| v.kind == kind)
            .map(|(i, v)| (VarId(i as u16), v))
    }
}

impl SignalNames for Model {
    fn is_constant(&self, var: VarId) -> bool {
        self.var(var).is_some_and(|v| v.kind == VarKind::Unknown)
    }

    fn variable(&self, var: VarId) -> &str {
        self.var(var).map_or("?", |v| &v.name)
    }
}
