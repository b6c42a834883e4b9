//! Statements of a straight-line program, for every language with assignments.
//!
//! In: a discovery and the description of a language. Out: a source file: declarations, linear solves, Newton loops, results.
//! What is computed, and when, was decided by [`super::program`]; expressions are written by [`super::infix`].

use crate::code::bracket_lists::{list, solver_call, unpacked_names};
use crate::code::identifiers::Identifiers;
use crate::code::infix::{Infix, Syntax};
use crate::code::program::{Function, Kind, Name, Newton, Program, Solve, Step};
use crate::target::{Target, Written};
use sidc_lang::term::{Func, Node, Signal};
use sidc_system::discovery::Discovery;
use sidc_system::switching::ResetMap;

/// How the statements of a language look.
pub(crate) struct Dialect {
    /// What `--to` takes.
    pub target: &'static str,
    /// One line for help texts.
    pub about: &'static str,
    /// The name of the language in error messages.
    pub language: &'static str,
    pub indent: &'static str,
    /// Text before a name in its declaration.
    pub declares: &'static str,
    /// What ends a statement.
    pub end: &'static str,
    /// Index of an array's first element, and the brackets around an index.
    pub index: (usize, &'static str, &'static str),
    /// What ends a function.
    pub close: &'static str,
    /// True if a function must stand before its callers.
    pub helpers_first: bool,
    /// Words that cannot be names.
    pub reserved: &'static [&'static str],
}

/// A language: its dialect, and the code that it shares with no other.
pub(crate) trait Language: Syntax + Sized + Sync {
    const DIALECT: Dialect;

    /// The name of a function of the model language in this language; empty if there is none.
    fn spelling(f: Func) -> &'static str;

    /// # Errors
    /// What this language cannot express.
    fn check(&self, _program: &Program) -> Result<(), String> {
        Ok(())
    }

    /// Whether a function is written; languages with automatic differentiation need no Jacobians.
    fn writes(&self, _kind: Kind) -> bool {
        true
    }

    /// Text before the first function.
    fn header(&self, d: &Discovery, program: &Program) -> String;

    /// A function up to its first statement.
    fn opening(&self, program: &Program, f: &Function) -> String;

    /// A number that is assigned to a name without further computation.
    fn bare_number(&self, number: String) -> String {
        number
    }

    /// The name of the helper that solves this many linear equations and returns rows.
    fn solver(&self, _equations: usize) -> &'static str {
        ""
    }

    /// A linear solve. The default unpacks what [`Language::solver`] returns.
    fn solve(&self, p: &Printer<Self>, s: &Solve) -> String {
        let names: Vec<String> = s
            .signals
            .iter()
            .map(|row| unpacked_names(&p.infix, row))
            .collect();
        p.declare(1, &list(&names), &p.solver_call(&s.mass, &s.right, 1))
    }

    fn newton(&self, p: &Printer<Self>, n: &Newton) -> String;

    /// Returns a vector with these entries.
    fn vector(&self, p: &Printer<Self>, entries: &[String]) -> String;

    /// Text before and after the assignments to the nonzero entries of a matrix.
    fn matrix(&self, f: &Function) -> (String, String);

    /// An entry of the matrix.
    fn cell(&self, f: &Function, row: usize, column: usize) -> String;

    /// The helpers that the code calls.
    fn helpers(&self, program: &Program) -> String;

    /// Last changes to the whole file.
    fn finished(&self, _program: &Program, text: String) -> String {
        text
    }

    /// Text after the last function.
    fn last(&self, _program: &Program) -> String {
        String::new()
    }
}

impl<L: Language> Target for L {
    fn name(&self) -> &'static str {
        L::DIALECT.target
    }

    fn about(&self) -> &'static str {
        L::DIALECT.about
    }

    fn emit(&self, d: &Discovery) -> Result<Written, String> {
        let program = Program::new(d)?;
        self.check(&program)?;
        program.check_calls(L::DIALECT.language, L::spelling)?;
        let reserved = L::DIALECT.reserved.iter().copied();
        // `finished` may rename the emitted functions; their new names are reserved, too.
        let finished: Vec<String> = reserved
            .clone()
            .map(|word| self.finished(&program, word.into()))
            .collect();
        let reserved = reserved.chain(finished.iter().map(String::as_str));
        let names = Identifiers::new(program.names.iter().cloned(), reserved);
        let functions = program.functions.iter().filter(|f| self.writes(f.kind));
        let functions = functions.map(|f| function(self, &program, f, &names));
        let mut parts = [functions.collect(), self.helpers(&program)];
        if L::DIALECT.helpers_first {
            parts.reverse();
        }
        let text = self.header(d, &program) + &parts.concat() + &self.last(&program);
        Ok(self.finished(&program, text).into())
    }
}

fn function<L: Language>(
    language: &L,
    program: &Program,
    f: &Function,
    names: &Identifiers,
) -> String {
    let p = Printer {
        language,
        function: f,
        infix: Infix::new(language, &f.body, names),
    };
    let mut out = language.opening(program, f);
    for read in &f.body.reads {
        let value = p.element(read.argument, read.place);
        out.push_str(&p.declare(1, &p.infix.signal(read.signal), &value));
    }
    for step in &f.body.steps {
        out.push_str(&match step {
            Step::Let(name, node) => p.declare(1, &p.infix.name(*name), &p.value(*name, *node)),
            Step::Solve(s) => language.solve(&p, s),
            Step::Newton(n) => language.newton(&p, n),
        });
    }
    if f.kind.is_matrix() {
        let (before, after) = language.matrix(f);
        out.push_str(&before);
        for (i, j, node) in f.entries() {
            out.push_str(&p.assign(1, &language.cell(f, i, j), &p.infix.text(node)));
        }
        out.push_str(&after);
    } else {
        out.push_str(&language.vector(&p, &p.infix.flat(&f.body.results)));
    }
    out + L::DIALECT.close
}

/// Writes the statements of one function. `depth` is the number of indentations.
pub(crate) struct Printer<'a, L> {
    language: &'a L,
    pub function: &'a Function,
    pub infix: Infix<'a, L>,
}

impl<L: Language> Printer<'_, L> {
    pub fn assign(&self, depth: usize, place: &str, value: &str) -> String {
        let indent = L::DIALECT.indent.repeat(depth);
        format!("{indent}{place} = {value}{}\n", L::DIALECT.end)
    }

    pub fn declare(&self, depth: usize, name: &str, value: &str) -> String {
        self.assign(depth, &format!("{}{name}", L::DIALECT.declares), value)
    }

    /// An element of an array, counted from 0.
    pub fn element(&self, array: &str, place: usize) -> String {
        let (first, open, close) = L::DIALECT.index;
        format!("{array}{open}{}{close}", place + first)
    }

    /// Declares signals as elements of an array; `None` is skipped.
    pub fn unpack(&self, depth: usize, array: &str, signals: &[Option<Signal>]) -> String {
        let named = signals.iter().enumerate();
        let named = named.filter_map(|(i, s)| Some((i, (*s)?)));
        named
            .map(|(i, s)| self.declare(depth, &self.infix.signal(s), &self.element(array, i)))
            .collect()
    }

    /// Declares the nodes that a Newton loop names.
    pub fn named_inside(&self, n: &Newton) -> String {
        let each = n.named_inside.iter().map(|node| {
            let name = self.infix.name(Name::Node(*node));
            self.declare(2, &name, &self.infix.value(*node))
        });
        each.collect()
    }

    /// A call of the helper that solves mass · x = right.
    pub fn solver_call(&self, mass: &[Vec<usize>], right: &[Vec<usize>], depth: usize) -> String {
        let indent = L::DIALECT.indent.repeat(depth);
        let solver = self.language.solver(mass.len());
        solver_call(solver, &self.infix, (mass, right), &indent)
    }

    fn value(&self, name: Name, node: usize) -> String {
        let value = self.infix.assigned(name, node);
        match (name, self.function.body.nodes().get(node)) {
            (Name::Signal(_), Some(Node::Number(_))) => self.language.bare_number(value),
            _ => value,
        }
    }
}

/// A line of comment for each line of text.
pub(crate) fn commented(mark: &str, lines: impl Iterator<Item = String>) -> String {
    lines.map(|line| format!("{mark}{line}\n")).collect()
}

/// The helper functions whose condition holds.
pub(crate) fn used_helpers(all: &[(bool, &str)]) -> String {
    let used = all.iter().filter(|(used, _)| *used);
    used.map(|(_, text)| *text).collect()
}

/// Fills in numbers of states, switches and jumps, and the arguments as declared and as passed. Lines from `@JUMPS` to `@END` are for
/// states that jump, those from `@STILL` for others.
pub(crate) fn fill_placeholders(
    program: &Program,
    text: &str,
    arguments: (String, String),
) -> String {
    let (declared, passed) = arguments;
    let resets = &program.switches.resets;
    let of_resets = |text: &dyn Fn(&ResetMap) -> String| {
        let all: Vec<String> = resets.iter().map(text).collect();
        all.join(", ")
    };
    let guards = of_resets(&|r| r.switch.to_string());
    let sides = of_resets(&|r| format!("{:?}", r.leaves.side()));
    let pairs = of_resets(&|r| format!("{:?}", (r.switch, r.leaves.side())));
    let gap = |gap: Option<usize>| gap.map_or("-1".into(), |gap| gap.to_string());
    let gaps: Vec<String> = program.gaps().map(gap).collect();
    for_jumps(text, program.has_jumps())
        .replace("@N@", &program.form.state.len().to_string())
        .replace("@K@", &program.switches.len().to_string())
        .replace("@R@", &resets.len().to_string())
        .replace("@JUMP_PAIRS@", &pairs)
        .replace("@JUMP_GUARDS@", &guards)
        .replace("@JUMP_SIDES@", &sides)
        .replace("@GAPS@", &gaps.join(", "))
        .replace("@ARGS@", &declared)
        .replace("@PASS@", &passed)
}

/// The lines of a text for systems whose states jump, or do not.
fn for_jumps(text: &str, jumps: bool) -> String {
    let mut is_kept = true;
    let mut out = String::with_capacity(text.len());
    for line in text.split_inclusive('\n') {
        match line.trim_end() {
            "@JUMPS" => is_kept = jumps,
            "@STILL" => is_kept = !jumps,
            "@END" => is_kept = true,
            _ if is_kept => out.push_str(line),
            _ => {}
        }
    }
    out
}
