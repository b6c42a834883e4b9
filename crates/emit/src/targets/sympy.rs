//! SymPy: expressions to calculate with: mass matrix, force, equations as found, solved rates.
//!
//! Numbers are the doubles of the result; whole ones are integers. Equations that are not linear in the highest
//! derivatives are not solved.

use crate::caveats::{caveats, python_constants};
use crate::code::identifiers::{Identifiers, plain, space_and_name};
use crate::code::infix::{Infix, Syntax};
use crate::code::printer::commented;
use crate::code::program::{Body, Name, Program, Step};
use crate::target::{Target, Written};
use sidc_lang::term::{Func, Signal};
use sidc_system::discovery::{Discovery, Rate};

pub(crate) struct Sympy;

impl Target for Sympy {
    fn name(&self) -> &'static str {
        "sympy"
    }

    fn about(&self) -> &'static str {
        "SymPy expressions: mass matrix, force, rates, outputs"
    }

    fn emit(&self, d: &Discovery) -> Result<Written, String> {
        let program = Program::new(d)?;
        program.refuse_jumps("SymPy")?;
        program.check_calls("SymPy", |f| f.spelling.sympy)?;
        let names = Identifiers::new(program.names.iter().cloned(), RESERVED.iter().copied());
        let body = program.sides()?;
        let infix = Infix::new(&Words, &body, &names);
        let mut out = header(d, &program);
        out.push_str(&symbols(d, &program, &names));
        out.push_str(&lets(&infix, &body));
        out.push_str(&sides(&program, &infix, &body));
        out.push_str(&rates(&program, &infix));
        Ok(out.into())
    }
}

fn header(d: &Discovery, program: &Program) -> String {
    let system = space_and_name(program.system.as_deref());
    let unknown = match program.discrete {
        true => "next state",
        false => "highest derivatives",
    };
    let mut out = format!("\"\"\"Written by sidc: the identified system{system}, for SymPy.\n\n");
    if !program.form.rows.is_empty() {
        out.push_str(&format!(
            "mass * unknown = force for the {unknown}; unknown = right as it was found.\n"
        ));
        out.push_str(match program.form.linear {
            true => "rates() is solved for them.\n",
            false => "mass and force depend on them: there is no closed form, and no rates().\n",
        });
    }
    if !program.constants.is_empty() {
        out.push_str(
            "subs(dict(zip(constant, SIDC_CONSTANTS))) puts the constants that were found in place.\n",
        );
    }
    out.push('\n');
    out.push_str(&commented("", caveats(d).into_iter()));
    out.push_str("\"\"\"\nimport sympy as sp\n\n");
    out.push_str(&python_constants(d, &program.form.inputs));
    out.push_str(&program.python_constants());
    out.push('\n');
    out
}

/// A symbol for every signal; a column of symbols for every argument.
fn symbols(d: &Discovery, program: &Program, names: &Identifiers) -> String {
    let mut out = String::from("t = sp.Symbol(\"t\", real=True)\n");
    for (s, shown) in &program.names {
        let name = names.get(*s);
        let note = match name == shown {
            true => String::new(),
            false => format!("  # {}", plain(shown)),
        };
        out.push_str(&format!(
            "{name} = sp.Symbol(\"{name}\", real=True){note}\n"
        ));
    }
    out.push('\n');
    let mut group = |title: &str, signals: &[Signal]| {
        let all: Vec<&str> = signals.iter().map(|s| names.get(*s)).collect();
        out.push_str(&format!("{title} = {}\n", column(&all)));
    };
    for a in &program.arguments {
        group(a.name, &a.signals);
    }
    group("unknown", &program.form.unknowns);
    let outputs = program.outputs(d);
    if !outputs.is_empty() {
        out.push_str(&format!(
            "# The outputs are {}.\n",
            plain(&outputs.join(", "))
        ));
    }
    out
}

fn column<T: AsRef<str>>(entries: &[T]) -> String {
    let entries: Vec<&str> = entries.iter().map(AsRef::as_ref).collect();
    match entries.len() {
        0 => "sp.zeros(0, 1)".to_string(),
        _ => format!("sp.Matrix([{}])", entries.join(", ")),
    }
}

fn lets(infix: &Infix<Words>, body: &Body) -> String {
    let named = body.steps.iter().filter_map(|step| match step {
        Step::Let(Name::Node(node), _) => Some(*node),
        _ => None,
    });
    let lines =
        named.map(|node| format!("{} = {}\n", infix.name(Name::Node(node)), infix.value(node)));
    format!("\n{}", lines.collect::<String>())
}

/// Rows of `body`: for each equation its row of the mass matrix, its force and its right side; then the outputs.
fn sides(program: &Program, infix: &Infix<Words>, body: &Body) -> String {
    let n = program.form.rows.len();
    let (rows, outputs) = body.results.split_at(n.min(body.results.len()));
    let (mut mass, mut force, mut right) = (Vec::new(), Vec::new(), Vec::new());
    for row in rows {
        if let [entries @ .., f, r] = row.as_slice() {
            mass.push(format!("    [{}],\n", infix.texts(entries).join(", ")));
            force.push(infix.text(*f));
            right.push(infix.text(*r));
        }
    }
    let mut out = String::new();
    if n > 0 {
        out.push_str(&format!("mass = sp.Matrix([\n{}])\n", mass.concat()));
        out.push_str(&format!(
            "force = {}\nright = {}\n",
            column(&force),
            column(&right)
        ));
    }
    if !outputs.is_empty() {
        let values = column(&infix.flat(outputs));
        out.push_str(&format!("outputs = {values}\n"));
    }
    out
}

fn rates(program: &Program, infix: &Infix<Words>) -> String {
    if program.form.rows.is_empty() || !program.form.linear {
        return String::new();
    }
    let entry = |rate: &Rate| match rate {
        Rate::State(i) => program
            .form
            .state
            .get(*i)
            .map_or_else(String::new, |s| infix.signal(*s)),
        Rate::Unknown(i) => format!("solved[{i}]"),
    };
    let entries: Vec<String> = program.form.rates.iter().map(entry).collect();
    let (about, solved) = match (program.discrete, program.form.coupled()) {
        (false, true) => ("The time derivative of the state.", "mass.LUsolve(force)"),
        (true, true) => ("The next state.", "mass.LUsolve(force)"),
        (false, false) => ("The time derivative of the state.", "right"),
        (true, false) => ("The next state.", "right"),
    };
    format!(
        "\n\ndef rates():\n    \"\"\"{about}\"\"\"\n    solved = {solved}\n    return {}\n",
        column(&entries)
    )
}

struct Words;

impl Syntax for Words {
    const INFINITY: &'static str = "sp.oo";
    const NAN: &'static str = "sp.nan";

    fn finite(&self, x: f64) -> String {
        // Below 9e15 every whole number is a double, so an integer is exact.
        match x.fract() == 0.0 && x < 9e15 {
            true => format!("{x}"),
            false => format!("{x:?}"),
        }
    }

    fn function(&self, f: Func) -> String {
        format!("sp.{}", f.spelling.sympy)
    }

    fn root(&self, x: &str) -> String {
        format!("sp.sqrt({x})")
    }

    fn power(&self, x: &str, p: &str) -> String {
        format!("sp.Pow({x}, {p})")
    }
}

/// Keywords of Python, names in the emitted code, and functions that `lambdify` calls.
#[rustfmt::skip]
pub(super) const RESERVED: &[&str] = &[
    "False", "None", "True", "and", "as", "assert", "async", "await", "break", "class", "continue", "def", "del", "elif", "else",
    "except", "finally", "for", "from", "global", "if", "import", "in", "is", "lambda", "nonlocal", "not", "or", "pass", "raise",
    "return", "try", "while", "with", "yield",
    "sp", "t", "state", "input", "parameter", "history", "constant", "unknown", "mass", "force", "right", "outputs", "rates", "solved",
    "sin", "cos", "tan", "asin", "acos", "atan", "arcsin", "arccos", "arctan", "sinh", "cosh", "tanh", "exp", "log", "sqrt", "abs",
    "sign", "min", "max", "amin", "amax", "minimum", "maximum", "select", "power", "nan", "inf", "pi", "math", "numpy", "array",
    "SIDC_VERDICT", "SIDC_INPUT_DELAYS", "SIDC_CONSTANTS",
];
