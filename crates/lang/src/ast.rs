//! The abstract syntax tree: what was written, statement by statement, before any name is looked up.
//!
//! Made by [`mod@super::parse`], read by [`super::check`]. Chains of one precedence are flat (`a + b - c` is one
//! [`ExprKind::Sum`]), so depth is bounded by the nesting of brackets, never by the length of a line.

mod unknown_groups;

pub use unknown_groups::{UnknownGroup, unknown_groups};

use crate::source::{FileId, Span};

/// One `.sid` file, with each `include` replaced by the statements of the included file.
#[derive(Clone, Debug)]
pub struct File {
    pub id: FileId,
    /// The text itself, so that a message can quote it.
    pub text: String,
    /// All included files, direct and indirect, each once.
    pub included: Vec<(FileId, String)>,
    pub statements: Vec<Statement>,
    /// Statements that could not be understood; their errors are reported already.
    pub broken: Vec<Broken>,
}

/// What a broken statement would have declared. Uses of these names are not reported as unknown: the cause is reported already.
#[derive(Clone, Debug)]
pub struct Broken {
    pub keyword: Option<Keyword>,
    pub names: Vec<String>,
    pub span: Span,
}

/// A word that opens a statement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Keyword {
    Sidc,
    System,
    State,
    Input,
    Output,
    Param,
    Unknown,
    Let,
    Data,
    Constrain,
    Coef,
    Symmetry,
    When,
    Limit,
    Prefer,
    Include,
}

#[derive(Clone, Debug)]
pub struct Statement {
    pub span: Span,
    pub kind: StatementKind,
}

#[derive(Clone, Debug)]
pub enum StatementKind {
    /// `sidc 1`
    Version(f64),
    /// `system NAME`
    System(Ident),
    /// `state NAMES : attributes`, and the same for inputs, outputs and parameters.
    Declare {
        keyword: Keyword,
        names: Vec<Expr>,
        attributes: Vec<Attribute>,
    },
    /// `unknown k in 0.1 .. 10, unit "1/s"`; the range is an [`ExprKind::Range`]. Constants behind the first range stand among the
    /// attributes, with their ranges as values: [`unknown_groups`] takes them apart.
    Unknown {
        names: Vec<Ident>,
        range: Option<Expr>,
        attributes: Vec<Attribute>,
    },
    /// `let NAME = EXPR`
    Let { name: Ident, body: Expr },
    /// `let NAME(ARGUMENTS) = EXPR`
    Function {
        name: Ident,
        params: Vec<Ident>,
        body: Expr,
    },
    /// `TARGETS ~ EXPR`, or `TARGET = EXPR` if `known`.
    Equation {
        targets: Vec<Expr>,
        known: bool,
        right: Expr,
        /// The equation as it would be written alone, if it is a member of a family.
        written: Option<String>,
    },
    /// `dx[i] ~ <x[i-1], x[i]>, i = 1..10`: an equation, a constraint or a statement about coefficients; [`crate::check`] expands it.
    Family {
        statement: Box<StatementKind>,
        over: Box<IndexRange>,
    },
    /// `coef(ddx, u) : per run`
    PerRun {
        coefficients: Vec<Expr>,
        attribute: Attribute,
    },
    /// `constrain EXPR > EXPR`, or a chain `EXPR < EXPR < EXPR`.
    Constrain {
        first: Expr,
        rest: Vec<(&'static str, Expr)>,
    },
    /// `symmetry NAMES -> IMAGE`
    Symmetry { names: Vec<Expr>, image: Image },
    /// `when EXPR < EXPR : NAME -> EXPR, …`
    Reset {
        left: Expr,
        relation: &'static str,
        right: Expr,
        /// Each name with its value.
        jumps: Vec<(Expr, Expr)>,
    },
    /// `limit degree 4`
    Limit(Vec<Attribute>),
    /// `prefer degree`
    Prefer(Attribute),
    /// `data { ... }`
    Data(Vec<Entry>),
    /// `include "constants.sid"`; [`crate::includes`] puts the statements of that file in its place.
    Include { path: String, at: Span },
}

/// `i = 1..10 cyclic`
#[derive(Clone, Debug)]
pub struct IndexRange {
    pub span: Span,
    pub name: Ident,
    pub from: Expr,
    pub to: Expr,
    /// Whether the first is the neighbour of the last.
    pub cyclic: bool,
}

/// One line of a data block.
#[derive(Clone, Debug)]
pub struct Entry {
    pub span: Span,
    pub kind: EntryKind,
}

#[derive(Clone, Debug)]
pub enum EntryKind {
    /// `NAME = EXPR`; the checker gives `run` and `none` their meaning.
    Source {
        name: Ident,
        value: Expr,
        /// The sources of further runs, for experiments side by side.
        beside: Vec<Expr>,
    },
    /// `step 0.01`
    Step(Expr),
}

/// The right side of a symmetry.
#[derive(Clone, Debug)]
pub struct Image {
    pub span: Span,
    /// True for `-(NAMES)`.
    pub flipped: bool,
    pub items: Vec<Expr>,
}

/// A name as written (primes included), normalised to NFC.
#[derive(Clone, Debug)]
pub struct Ident {
    pub text: String,
    pub span: Span,
}

/// `key`, `key value` or `key in FROM .. TO`, whose value is a range.
#[derive(Clone, Debug)]
pub struct Attribute {
    pub key: Ident,
    pub value: Option<Expr>,
}

#[derive(Clone, Debug)]
pub struct Expr {
    pub span: Span,
    pub kind: ExprKind,
}

#[derive(Clone, Debug)]
pub enum ExprKind {
    Number(f64),
    /// `2%`, stored as 0.02.
    Share(f64),
    /// A quoted header or unit, without its quotes.
    Text(String),
    Name(String),
    Negate(Box<Expr>),
    /// `a + b - c`; the sign of the first is plus.
    Sum(Vec<(Sign, Expr)>),
    /// `a * b / c`; the first is multiplied.
    Product(Vec<(Side, Expr)>),
    Power(Box<Expr>, Box<Expr>),
    /// Parentheses.
    Group(Box<Expr>),
    /// `<a, b, c>`
    List(Vec<Expr>),
    /// `a..b`
    Range(Box<Expr>, Box<Expr>),
    Call(Call),
    /// `x[i + 1]`, in a family of equations.
    Indexed(Ident, Box<Expr>),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sign {
    Plus,
    Minus,
}

/// Whether a factor multiplies or divides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    Above,
    Below,
}

/// `name(args; numbers)`, or `name arg` if juxtaposed.
#[derive(Clone, Debug)]
pub struct Call {
    pub name: Ident,
    /// The 2 of `sin^2 theta`.
    pub power: Option<(f64, Span)>,
    pub args: Vec<Expr>,
    /// What stood after the `;`, if there was one.
    pub numbers: Option<Vec<Expr>>,
    pub juxtaposed: bool,
}

impl File {
    /// The whole text of this file or of one that it includes.
    pub fn text_of(&self, file: FileId) -> &str {
        let included = self.included.iter().find(|(id, _)| *id == file);
        included.map_or(&self.text, |(_, text)| text)
    }

    /// The texts of this file and of all that it includes.
    pub fn texts(&self) -> impl Iterator<Item = &str> {
        let included = self.included.iter().map(|(_, text)| text.as_str());
        std::iter::once(self.text.as_str()).chain(included)
    }

    /// The text at a place.
    pub fn slice(&self, at: Span) -> &str {
        self.text_of(at.file).get(at.start..at.end).unwrap_or("")
    }

    /// The statement that holds a place.
    pub fn statement_at(&self, at: Span) -> Option<&Statement> {
        self.statements.iter().find(|s| s.span.holds(at))
    }

    /// The text of `whole` with replacements.
    pub fn edited(&self, whole: Span, mut edits: Vec<(Span, String)>) -> String {
        edits.sort_by_key(|(at, _)| at.start);
        let text = |from: usize, to: usize| self.slice(Span::new(whole.file, from, to));
        let (mut out, mut from) = (String::new(), whole.start);
        for (at, new) in edits {
            out.push_str(text(from, at.start));
            out.push_str(&new);
            from = at.end;
        }
        out.push_str(text(from, whole.end));
        out
    }

    /// A product of these factors as they were written; empty if there are none.
    pub fn product_of<'a>(&self, factors: impl IntoIterator<Item = &'a (Side, Expr)>) -> String {
        let mut out = String::new();
        for (side, x) in factors {
            out.push_str(match (out.is_empty(), side) {
                (true, Side::Above) => "",
                (true, Side::Below) => "1/",
                (false, Side::Above) => "*",
                (false, Side::Below) => "/",
            });
            out.push_str(self.slice(x.span));
        }
        out
    }
}

impl StatementKind {
    /// The expressions of an equation, a constraint or a statement about coefficients.
    pub fn expressions_mut(&mut self) -> Vec<&mut Expr> {
        match self {
            StatementKind::Equation { targets, right, .. } => {
                targets.iter_mut().chain([right]).collect()
            }
            StatementKind::Constrain { first, rest } => {
                let rest = rest.iter_mut().map(|(_, e)| e);
                [first].into_iter().chain(rest).collect()
            }
            StatementKind::PerRun { coefficients, .. } => coefficients.iter_mut().collect(),
            _ => Vec::new(),
        }
    }
}

impl Expr {
    pub fn new(span: Span, kind: ExprKind) -> Self {
        Expr { span, kind }
    }

    /// The expression inside any parentheses around it.
    pub fn ungrouped(&self) -> &Expr {
        let mut e = self;
        while let ExprKind::Group(inner) = &e.kind {
            e = inner;
        }
        e
    }

    /// The first call that satisfies the condition, depth first, a call before its arguments.
    pub fn find_call(&self, sought: &impl Fn(&Call) -> bool) -> Option<&Expr> {
        self.find(&|e| matches!(&e.kind, ExprKind::Call(call) if sought(call)))
    }

    /// The first expression that satisfies the condition, depth first, each before its parts.
    pub fn find(&self, sought: &impl Fn(&Expr) -> bool) -> Option<&Expr> {
        match sought(self) {
            true => Some(self),
            false => self.children().into_iter().find_map(|x| x.find(sought)),
        }
    }

    /// The places of a name, including those in the numbers of generators.
    pub fn places_of(&self, name: &str) -> Vec<Span> {
        let mut out = Vec::new();
        self.find_places(name, &mut out);
        out
    }

    fn find_places(&self, name: &str, out: &mut Vec<Span>) {
        if self.as_name() == Some(name) {
            out.push(self.span);
        }
        let children = self.children().into_iter();
        children.for_each(|x| x.find_places(name, out));
        if let ExprKind::Call(call) = &self.kind {
            let numbers = call.numbers.iter().flatten();
            numbers.for_each(|x| x.find_places(name, out));
        }
    }

    /// The operands, items or arguments, in order; the numbers of a generator are not among them.
    pub fn children(&self) -> Vec<&Expr> {
        match &self.kind {
            ExprKind::Number(_) | ExprKind::Share(_) | ExprKind::Text(_) | ExprKind::Name(_) => {
                Vec::new()
            }
            ExprKind::Negate(x) | ExprKind::Group(x) => vec![x],
            ExprKind::Power(x, y) | ExprKind::Range(x, y) => vec![x, y],
            ExprKind::Sum(parts) => parts.iter().map(|(_, x)| x).collect(),
            ExprKind::Product(parts) => parts.iter().map(|(_, x)| x).collect(),
            ExprKind::List(items) => items.iter().collect(),
            ExprKind::Call(call) => call.args.iter().collect(),
            ExprKind::Indexed(_, index) => vec![index],
        }
    }

    /// [`Expr::children`] and the numbers of a generator, mutable.
    pub fn children_mut(&mut self) -> Vec<&mut Expr> {
        match &mut self.kind {
            ExprKind::Number(_) | ExprKind::Share(_) | ExprKind::Text(_) | ExprKind::Name(_) => {
                Vec::new()
            }
            ExprKind::Negate(x) | ExprKind::Group(x) | ExprKind::Indexed(_, x) => vec![x],
            ExprKind::Power(x, y) | ExprKind::Range(x, y) => vec![x, y],
            ExprKind::Sum(parts) => parts.iter_mut().map(|(_, x)| x).collect(),
            ExprKind::Product(parts) => parts.iter_mut().map(|(_, x)| x).collect(),
            ExprKind::List(items) => items.iter_mut().collect(),
            ExprKind::Call(call) => {
                let numbers = call.numbers.iter_mut().flatten();
                call.args.iter_mut().chain(numbers).collect()
            }
        }
    }

    /// The text of a bare name.
    pub fn as_name(&self) -> Option<&str> {
        match &self.kind {
            ExprKind::Name(text) => Some(text),
            _ => None,
        }
    }
}

/// Every keyword with its spelling.
pub const KEYWORDS: &[(&str, Keyword)] = &[
    ("sidc", Keyword::Sidc),
    ("system", Keyword::System),
    ("state", Keyword::State),
    ("input", Keyword::Input),
    ("output", Keyword::Output),
    ("param", Keyword::Param),
    ("unknown", Keyword::Unknown),
    ("let", Keyword::Let),
    ("data", Keyword::Data),
    ("constrain", Keyword::Constrain),
    ("coef", Keyword::Coef),
    ("symmetry", Keyword::Symmetry),
    ("when", Keyword::When),
    ("limit", Keyword::Limit),
    ("prefer", Keyword::Prefer),
    ("include", Keyword::Include),
];

/// Every word that opens an attribute of a declaration.
pub const ATTRIBUTES: [&str; 9] = [
    "order", "noise", "memory", "unit", "hold", "linear", "cubic", "delay", "hidden",
];

impl Keyword {
    pub fn named(text: &str) -> Option<Keyword> {
        KEYWORDS.iter().find(|(t, _)| *t == text).map(|(_, k)| *k)
    }

    /// Whether `<` and `>` compare in its statement, and are not the brackets of a list.
    pub fn compares(self) -> bool {
        matches!(self, Keyword::Constrain | Keyword::When)
    }

    pub fn text(self) -> &'static str {
        KEYWORDS
            .iter()
            .find(|(_, k)| *k == self)
            .map_or("", |(t, _)| t)
    }
}
