//! What Python modules have in common, whatever library they compute with.
//!
//! In: a program. Out: its constants as tuples, its functions up to their first statement, Newton loops, reserved words.

use crate::code::bracket_lists::unpacked_names;
use crate::code::identifiers::plain;
use crate::code::printer::{Dialect, Language, Printer};
use crate::code::program::{Function, Newton, Program, SIDES};
use sidc_system::discovery::Discovery;

/// How the statements of Python look.
pub(crate) const fn dialect(
    target: &'static str,
    about: &'static str,
    language: &'static str,
) -> Dialect {
    Dialect {
        target,
        about,
        language,
        indent: "    ",
        declares: "",
        end: "",
        index: (0, "[", "]"),
        close: "",
        helpers_first: false,
        reserved: RESERVED,
    }
}

/// Keywords of Python, and names in the emitted code.
#[rustfmt::skip]
const RESERVED: &[&str] = &[
    "False", "None", "True", "and", "as", "assert", "async", "await", "break", "class", "continue", "def", "del", "elif", "else",
    "except", "finally", "for", "from", "global", "if", "import", "in", "is", "lambda", "nonlocal", "not", "or", "pass", "raise",
    "return", "try", "while", "with", "yield",
    "np", "jax", "jnp", "ca", "function",
    "t", "state", "input", "parameter", "history", "constant", "slope", "step", "unknown", "derivatives", "next", "jacobian", "jacobian_input",
    "outputs", "side", "after", "guards", "rates_by_side", "guard_rates", "jumps", "advance", "run", "settle", "SIDC_VERDICT", "SIDC_INPUT_DELAYS", "SIDC_CONSTANTS",
    "SIDC_PARAMETERS", "SIDC_COVARIANCE",
];

/// The constants that were found, and the names of the entries of each argument: `STATE = ("x", "dx")`.
pub(crate) fn constants(d: &Discovery, program: &Program) -> String {
    let mut out = program.python_constants();
    for a in &program.arguments {
        out.push_str(&tuple(a.name, &a.names));
    }
    let outputs = program.outputs(d);
    if !outputs.is_empty() {
        out.push_str(&tuple("output", &outputs));
    }
    out
}

fn tuple(name: &str, all: &[String]) -> String {
    let all: String = all.iter().map(|n| format!("\"{}\", ", plain(n))).collect();
    let all = match all.strip_suffix(", ") {
        Some(several) if several.contains("\", \"") => several,
        Some(_) => all.trim_end(),
        None => "",
    };
    format!("{} = ({all})\n", name.to_uppercase())
}

/// `t, state, input` as a function takes them; constants default to the values found.
pub(crate) fn parameters(program: &Program, f: &Function) -> String {
    let sides = program.arguments_of(f.kind).filter(|a| a.name == SIDES);
    let given = program
        .given()
        .chain(sides)
        .map(|a| format!(", {}", a.name));
    let constants = Some(", constant=SIDC_CONSTANTS".to_string());
    let all = given.chain(constants.filter(|_| !program.constants.is_empty()));
    format!("t{}", all.collect::<String>())
}

/// `def derivatives(t, state):` and its docstring.
pub(crate) fn definition(program: &Program, f: &Function) -> String {
    format!(
        "def {}({}):\n    \"\"\"{}\"\"\"\n",
        f.kind.name(program.discrete),
        parameters(program, f),
        f.kind.about(program.discrete)
    )
}

/// A call of the helper `_newton` with the function that it iterates.
pub(crate) fn newton<L: Language>(p: &Printer<L>, n: &Newton) -> String {
    format!(
        "\n    def step(unknown):\n        {} = unknown\n{}        return {}\n\n    {} = _newton(step, {})\n",
        unpacked_names(&p.infix, &n.used_inside),
        p.named_inside(n),
        p.solver_call(&n.mass, &n.right, 2),
        unpacked_names(&p.infix, &n.used_after),
        n.signals.len()
    )
}
