//! Python: a module of numpy functions of time, state and input, for SciPy's `solve_ivp`.
//!
//! Coupled equations are solved at every call, by Newton's method where they are not linear in the highest
//! derivatives.

use crate::caveats::{caveats, delays, python_constants};
use crate::code::bracket_lists::LINE_WIDTH;
use crate::code::identifiers::space_and_name;
use crate::code::infix::Syntax;
use crate::code::parameters::{Parameter, Parameters, numbers};
use crate::code::printer::{
    Dialect, Language, Printer, commented, fill_placeholders, used_helpers,
};
use crate::code::program::{Function, Kind, Newton, Program, Step};
use crate::code::python_modules::{constants, definition, dialect, newton};
use sidc_lang::term::Func;
use sidc_system::discovery::Discovery;

pub(crate) struct Python;

impl Language for Python {
    const DIALECT: Dialect = dialect(
        "python",
        "a numpy module: functions for SciPy's solve_ivp, and their Jacobians",
        "numpy",
    );

    fn spelling(f: Func) -> &'static str {
        f.spelling.numpy
    }

    fn header(&self, d: &Discovery, program: &Program) -> String {
        let system = space_and_name(program.system.as_deref());
        let mut out =
            format!("\"\"\"Written by sidc: the identified system{system} as code, for numpy.\n");
        if let (Some(_), false) = (program.get(Kind::Rates), program.discrete) {
            let others: Vec<&str> = program.given().skip(1).map(|a| a.name).collect();
            let args = match others.as_slice() {
                [] => String::new(),
                [one] => format!(", args=({one},)"),
                many => format!(", args=({})", many.join(", ")),
            };
            out.push_str(&format!(
                "\n    scipy.integrate.solve_ivp(derivatives, (t0, t1), state{args}, jac=jacobian)\n"
            ));
            if !program.switches.is_empty() {
                let arguments = program.given().skip(1).map(|a| format!(", {}", a.name));
                let arguments: String = arguments.collect();
                out.push_str(&format!(
                    "\nThe equations jump where a guard is zero. From event to event go\n\n    run(times, state{arguments})  # solve_ivp, stopped at events\n    advance(t, state, h{arguments}, side=None)  # a fixed step\n"
                ));
            }
            if others.contains(&"input") {
                out.push_str("\n`input` is the inputs, or a function of time that gives them.\n");
                if !delays(d, &program.form.inputs).is_empty() {
                    out.push_str("Of a function of time each input is taken at t - SIDC_INPUT_DELAYS; numbers are inputs as they act.\n");
                }
            }
        }
        out.push('\n');
        out.push_str(&commented("", caveats(d).into_iter()));
        out.push_str("\"\"\"\nimport numpy as np\n\n");
        out.push_str(&python_constants(d, &program.form.inputs));
        out + &constants(d, program) + &parameters(d)
    }

    fn opening(&self, program: &Program, f: &Function) -> String {
        let definition = definition(program, f);
        let mut out = format!("\n\n@np.errstate(all=\"ignore\")\n{definition}");
        for a in program.arguments_of(f.kind) {
            if f.body.reads.iter().any(|r| r.argument == a.name) {
                let numbers = if a.name == "input" && program.is_delayed {
                    "_inputs"
                } else {
                    "_numbers"
                };
                out.push_str(&format!("    {0} = {numbers}({0}, t)\n", a.name));
            }
        }
        if f.body.mentions_time() {
            out.push_str("    t = np.float64(t)\n");
        }
        out
    }

    /// Division of Python's own numbers by zero raises an exception; numpy's gives an infinity.
    fn bare_number(&self, number: String) -> String {
        format!("np.float64({number})")
    }

    fn solver(&self, _: usize) -> &'static str {
        "_solve"
    }

    fn newton(&self, p: &Printer<Self>, n: &Newton) -> String {
        newton(p, n)
    }

    fn vector(&self, _: &Printer<Self>, entries: &[String]) -> String {
        let line = entries.join(", ");
        match line.len() < LINE_WIDTH {
            true => format!("    return _rows(state, [{line}])\n"),
            false => format!(
                "    return _rows(state, [\n        {},\n    ])\n",
                entries.join(",\n        ")
            ),
        }
    }

    fn matrix(&self, f: &Function) -> (String, String) {
        let ((rows, columns), name) = (f.size, f.kind.matrix_name());
        (
            format!("    {name} = np.zeros(({rows}, {columns}) + np.shape(state)[1:])\n"),
            format!("    return {name}\n"),
        )
    }

    fn cell(&self, f: &Function, row: usize, column: usize) -> String {
        format!("{}[{row}, {column}]", f.kind.matrix_name())
    }

    fn helpers(&self, program: &Program) -> String {
        let newton = program.makes(|s| matches!(s, Step::Newton(_)));
        let reads = program.functions.iter().any(|f| !f.body.reads.is_empty());
        let vectors = program.functions.iter().any(|f| !f.kind.is_matrix());
        let steps = fill_placeholders(program, STEPS, Default::default());
        used_helpers(&[
            (reads, NUMBERS),
            (vectors, ROWS),
            (reads && program.is_delayed, INPUTS),
            (program.solves(|_| true), SOLVE),
            (newton, NEWTON),
            (!program.switches.is_empty(), &steps),
        ])
    }
}

impl Syntax for Python {
    const INFINITY: &'static str = "np.inf";
    const NAN: &'static str = "np.nan";

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

/// The estimated parameters as tuples.
fn parameters(d: &Discovery) -> String {
    let parameters = Parameters::new(d);
    if parameters.is_empty() {
        return String::new();
    }
    let line = |p: &Parameter| {
        let numbers = numbers(&[p.value, p.error], Python::NAN);
        format!(
            "    (\"{}\", {numbers}, \"{}\"),  # {}\n",
            p.name, p.unit, p.about
        )
    };
    let lines = parameters.lines(line);
    let mut out = format!(
        "# Name, value, standard error (0 where the model states the value) and unit of each number that was found.\nSIDC_PARAMETERS = (\n{lines})\n"
    );
    if let Some(rows) = parameters.covariance() {
        let row = |row: &Vec<f64>| format!("    [{}],\n", numbers(row, Python::NAN));
        let rows: String = rows.iter().map(row).collect();
        out.push_str(&format!(
            "# Their covariances, in the same order.\nSIDC_COVARIANCE = np.array([\n{rows}])\n"
        ));
    }
    out
}

/// Steps from event to event.
const STEPS: &str = include_str!("event_steps/steps.py");

const NUMBERS: &str = "

def _numbers(values, t):
    \"\"\"Numbers, or those that a function of time gives; a column for each column of the state.\"\"\"
    return np.atleast_1d(np.asarray(values(t) if callable(values) else values, dtype=float))
";

const ROWS: &str = "

def _rows(state, entries):
    \"\"\"One row an entry, with the columns of the state.\"\"\"
    rows = np.empty((len(entries),) + np.shape(state)[1:])
    for i, entry in enumerate(entries):
        rows[i] = entry
    return rows
";

const INPUTS: &str = "

def _inputs(values, t):
    \"\"\"The inputs as they act at t: those of a function of time each after its delay.\"\"\"
    if not callable(values):
        return _numbers(values, t)
    return np.array([_numbers(values, t - delay)[i] for i, delay in enumerate(SIDC_INPUT_DELAYS)])
";

const SOLVE: &str = "

def _solve(mass, right):
    \"\"\"Solves a small linear system, column by column of the right side; NaN where it is singular. Entries have columns if the state has.\"\"\"
    mass, right = _matrix(mass), _matrix(right)
    if mass.ndim == right.ndim == 2:
        try:
            return np.linalg.solve(mass, right)
        except np.linalg.LinAlgError:
            return np.full(right.shape, np.nan)
    mass, right = (np.moveaxis(m, (0, 1), (-2, -1)) for m in (mass, right))
    try:
        solved = np.linalg.solve(mass, right)
    except np.linalg.LinAlgError:
        solved = _solve_each(mass, right)
    return np.moveaxis(solved, (-2, -1), (0, 1))


def _matrix(rows):
    try:
        return np.array(rows, dtype=float)
    except ValueError:  # Some entries have columns, and some are the same for all.
        shape = np.broadcast_shapes(*(np.shape(entry) for row in rows for entry in row))
        return np.array([[np.broadcast_to(entry, shape) for entry in row] for row in rows])


def _solve_each(mass, right):
    stack = np.broadcast_shapes(mass.shape[:-2], right.shape[:-2])
    mass = np.broadcast_to(mass, stack + mass.shape[-2:])
    right = np.broadcast_to(right, stack + right.shape[-2:])
    solved = np.full(right.shape, np.nan)
    for at in np.ndindex(*stack):
        try:
            solved[at] = np.linalg.solve(mass[at], right[at])
        except np.linalg.LinAlgError:
            pass
    return solved
";

const NEWTON: &str = "

def _newton(step, size):
    \"\"\"Repeats the solve from zero on until the unknowns stay; NaN if they never do.\"\"\"
    unknown, settled = np.zeros(size), False
    for _ in range(50):
        after = step(unknown)[:, 0]
        unknown = np.broadcast_to(unknown.reshape(unknown.shape + (1,) * (after.ndim - unknown.ndim)), after.shape)
        moved = np.max(np.abs(after - unknown), axis=0)
        unknown = np.where(settled, unknown, after)
        settled = settled | (moved <= 1e-12 * np.max(np.abs(after), axis=0))
        if np.all(settled):
            return unknown
    return np.where(settled, unknown, np.nan)
";
