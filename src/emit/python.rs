//! Python: a module of numpy functions of time, state and input that SciPy's `solve_ivp` takes as they are.
//!
//! Coupled equations are solved for the highest derivatives at every call; where they are not linear in them, by Newton's method.

use super::infix::{Infix, Syntax};
use super::lists::{SHORT, list, solver_call, wanted};
use super::names::{Identifiers, plain, titled};
use super::program::{Function, Kind, Name, Newton, Program, Solve, Step};
use super::{Target, chosen};
use crate::discover::Discovery;
use crate::term::{Func, Node};

pub(super) struct Python;

impl Target for Python {
    fn name(&self) -> &'static str {
        "python"
    }

    fn about(&self) -> &'static str {
        "a numpy module: functions for SciPy's solve_ivp, and their Jacobians"
    }

    fn emit(&self, d: &Discovery) -> Result<String, String> {
        let program = Program::new(d)?;
        program.check_calls("numpy", |f| f.spelling.numpy)?;
        let reserved = RESERVED.iter().copied();
        let names = Identifiers::new(program.names.iter().cloned(), reserved);
        let mut out = header(d, &program);
        for f in &program.functions {
            out.push_str(&function(&program, f, &names));
        }
        out.push_str(&helpers(&program));
        Ok(out)
    }
}

fn header(d: &Discovery, program: &Program) -> String {
    let system = titled(program.system.as_deref());
    let mut out =
        format!("\"\"\"Written by sidc: the identified system{system} as code, for numpy.\n");
    if let (Some(_), false) = (program.get(Kind::Rates), program.discrete) {
        let others: Vec<&str> = program.arguments.iter().skip(1).map(|a| a.name).collect();
        let args = match others.as_slice() {
            [] => String::new(),
            [one] => format!(", args=({one},)"),
            many => format!(", args=({})", many.join(", ")),
        };
        out.push_str(&format!(
            "\n    scipy.integrate.solve_ivp(derivatives, (t0, t1), state{args}, jac=jacobian)\n"
        ));
        if others.contains(&"input") {
            out.push_str("\n`input` is the inputs, or a function of time that gives them.\n");
        }
    }
    out.push_str("\"\"\"\nimport numpy as np\n\n");
    for a in &program.arguments {
        out.push_str(&tuple(a.name, &a.names));
    }
    let outputs = program.outputs(d);
    if !outputs.is_empty() {
        out.push_str(&tuple("output", &outputs));
    }
    out
}

/// `STATE = ("x", "dx")`: the names in their order.
fn tuple(name: &str, all: &[String]) -> String {
    let all: String = all.iter().map(|n| format!("\"{}\", ", plain(n))).collect();
    let all = match all.strip_suffix(", ") {
        Some(several) if several.contains("\", \"") => several,
        Some(_) => all.trim_end(),
        None => "",
    };
    format!("{} = ({all})\n", name.to_uppercase())
}

fn function(program: &Program, f: &Function, names: &Identifiers) -> String {
    let infix = Infix::new(&Words, &f.body, names);
    let arguments: String = program
        .arguments
        .iter()
        .map(|a| format!(", {}", a.name))
        .collect();
    let about = f.kind.about(program.discrete);
    let mut out = format!(
        "\n\n@np.errstate(all=\"ignore\")\ndef {}(t{arguments}):\n    \"\"\"{about}\"\"\"\n",
        f.kind.name(program.discrete)
    );
    for a in &program.arguments {
        if f.body.reads.iter().any(|r| r.argument == a.name) {
            out.push_str(&format!("    {0} = _numbers({0}, t)\n", a.name));
        }
    }
    if f.body.mentions_time() {
        out.push_str("    t = np.float64(t)\n");
    }
    for read in &f.body.reads {
        out.push_str(&format!(
            "    {} = {}[{}]\n",
            infix.signal(read.signal),
            read.argument,
            read.place
        ));
    }
    for step in &f.body.steps {
        out.push_str(&statement(&infix, &f.body, step));
    }
    out.push_str(&results(&infix, f));
    out
}

fn statement(infix: &Infix<Words>, body: &super::program::Body, step: &Step) -> String {
    match step {
        Step::Let(name, node) => {
            let value = match (name, body.nodes().get(*node)) {
                // Python's own numbers refuse a division by zero.
                (Name::Signal(_), Some(Node::Number(_))) => {
                    format!("np.float64({})", infix.text(*node))
                }
                _ => infix.assigned(*name, *node),
            };
            format!("    {} = {value}\n", infix.name(*name))
        }
        Step::Solve(s) => solved(infix, s),
        Step::Newton(n) => newton(infix, n),
    }
}

fn solved(infix: &Infix<Words>, s: &Solve) -> String {
    let names = s.signals.iter().map(|row| wanted(infix, row));
    let names: Vec<String> = names.collect();
    format!(
        "    {} = {}\n",
        list(&names),
        solver_call("_solve", infix, (&s.mass, &s.right), "    ")
    )
}

fn newton(infix: &Infix<Words>, n: &Newton) -> String {
    let lets: String = n
        .inside
        .iter()
        .map(|node| {
            format!(
                "        {} = {}\n",
                infix.name(Name::Node(*node)),
                infix.value(*node)
            )
        })
        .collect();
    let step = solver_call("_solve", infix, (&n.mass, &n.right), "        ");
    format!(
        "\n    def step(unknown):\n        {} = unknown\n{lets}        return {step}\n\n    {} = _newton(step, {})\n",
        wanted(infix, &n.moving),
        wanted(infix, &n.asked),
        n.signals.len()
    )
}

fn results(infix: &Infix<Words>, f: &Function) -> String {
    if !f.kind.is_matrix() {
        let entries = infix.flat(&f.body.results);
        let line = entries.join(", ");
        return match line.len() < SHORT {
            true => format!("    return np.array([{line}])\n"),
            false => format!(
                "    return np.array([\n        {},\n    ])\n",
                entries.join(",\n        ")
            ),
        };
    }
    let (rows, columns) = f.size;
    let mut out = format!("    slope = np.zeros(({rows}, {columns}))\n");
    for (i, j, node) in f.entries() {
        out.push_str(&format!("    slope[{i}, {j}] = {}\n", infix.text(node)));
    }
    out.push_str("    return slope\n");
    out
}

/// The helpers that the code calls.
fn helpers(program: &Program) -> String {
    let newton = program.makes(|s| matches!(s, Step::Newton(_)));
    let solve = program.solves(|_| true);
    let reads = program.functions.iter().any(|f| !f.body.reads.is_empty());
    let all = [(reads, NUMBERS), (solve, SOLVE), (newton, NEWTON)];
    chosen(&all)
}

const NUMBERS: &str = "

def _numbers(values, t):
    \"\"\"Numbers, or those that a function of time gives.\"\"\"
    return np.asarray(values(t) if callable(values) else values, dtype=float).reshape(-1)
";

const SOLVE: &str = "

def _solve(mass, right):
    \"\"\"Solves a small linear system, column by column of the right side; NaN where it is singular.\"\"\"
    try:
        return np.linalg.solve(np.array(mass), np.array(right))
    except np.linalg.LinAlgError:
        return np.full(np.shape(right), np.nan)
";

const NEWTON: &str = "

def _newton(step, size):
    \"\"\"Repeats the solve from zero on until the unknowns stay; NaN if they never do.\"\"\"
    unknown = np.zeros(size)
    for _ in range(50):
        after = step(unknown)[:, 0]
        moved, unknown = np.max(np.abs(after - unknown)), after
        if moved <= 1e-12 * np.max(np.abs(after)):
            return unknown
    return np.full(size, np.nan)
";

struct Words;

impl Syntax for Words {
    fn number(&self, x: f64) -> String {
        match x {
            f64::INFINITY => "np.inf".into(),
            x if x.is_nan() => "np.nan".into(),
            x => format!("{x:?}"),
        }
    }

    fn function(&self, f: Func) -> String {
        format!("np.{}", f.spelling.numpy)
    }

    fn root(&self, x: &str) -> String {
        format!("np.power({x}, 0.5)")
    }

    fn power(&self, x: &str, p: &str) -> String {
        format!("np.power({x}, {p})")
    }
}

/// Words of Python, and names that the emitted code uses.
#[rustfmt::skip]
const RESERVED: &[&str] = &[
    "False", "None", "True", "and", "as", "assert", "async", "await", "break", "class", "continue", "def", "del", "elif", "else",
    "except", "finally", "for", "from", "global", "if", "import", "in", "is", "lambda", "nonlocal", "not", "or", "pass", "raise",
    "return", "try", "while", "with", "yield",
    "np", "t", "state", "input", "parameter", "history", "slope", "step", "unknown", "derivatives", "next", "jacobian", "jacobian_input",
    "outputs",
];
