//! Rust: functions of time, state and input without dependencies.
//!
//! Coupled equations are solved by elimination in the emitted code, by Newton's method where they are not linear in
//! the highest derivatives.

use crate::caveats::{caveats, delays, verdict_summary};
use crate::code::bracket_lists::{LINE_WIDTH, list, unpacked_names};
use crate::code::identifiers::{plain, space_and_name};
use crate::code::infix::Syntax;
use crate::code::parameters::{Parameter, Parameters, numbers};
use crate::code::printer::{
    Dialect, Language, Printer, commented, fill_placeholders, used_helpers,
};
use crate::code::program::{Function, Newton, Program, Step};
use sidc_lang::term::{Func, Node};
use sidc_system::discovery::Discovery;

pub(crate) struct Rust;

impl Language for Rust {
    const DIALECT: Dialect = Dialect {
        target: "rust",
        about: "functions of time, state and input, and their Jacobians; no dependencies",
        language: "Rust",
        indent: "    ",
        declares: "let ",
        end: ";",
        index: (0, "[", "]"),
        close: "}\n",
        helpers_first: false,
        reserved: RESERVED,
    };

    fn spelling(f: Func) -> &'static str {
        f.spelling.rust
    }

    fn header(&self, d: &Discovery, program: &Program) -> String {
        let system = space_and_name(program.system.as_deref());
        let mut out = format!("// Written by sidc: the identified system{system} as code.\n");
        out.push_str(&commented("// ", caveats(d).into_iter()));
        out.push_str("//\n");
        out.push_str(&commented("// ", program.legend()));
        let outputs = program.outputs(d);
        if !outputs.is_empty() {
            out.push_str(&format!("// outputs are {}\n", plain(&outputs.join(", "))));
        }
        out.push_str(&format!(
            "\n/// The verdict on these equations.\n#[allow(dead_code)]\npub const SIDC_VERDICT: &str = \"{}\";\n",
            verdict_summary(d)
        ));
        let delays = delays(d, &program.form.inputs);
        if !delays.is_empty() {
            out.push_str(&format!(
                "\n/// Seconds by which each input acts later.\n#[allow(dead_code)]\npub const SIDC_INPUT_DELAYS: [f64; {}] = {delays:?};\n",
                delays.len()
            ));
        }
        if !program.constants.is_empty() {
            out.push_str("\n/// The constants as they were found:\n");
            out.push_str(&commented("/// - ", program.constant_lines()));
            out.push_str(&format!(
                "#[allow(dead_code)]\npub const SIDC_CONSTANTS: [f64; {}] = [{}];\n",
                program.constants.len(),
                program.constant_values()
            ));
        }
        out + &parameters(d)
    }

    fn opening(&self, program: &Program, f: &Function) -> String {
        let (rows, columns) = f.size;
        let arguments = program.arguments_of(f.kind);
        let arguments = arguments.map(|a| format!(", {}: &[f64; {}]", a.name, a.signals.len()));
        let result = match f.kind.is_matrix() {
            true => format!("[[f64; {columns}]; {rows}]"),
            false => format!("[f64; {rows}]"),
        };
        format!(
            "\n/// {}\n#[allow(unused_variables, non_snake_case, clippy::all)]\npub fn {}(t: f64{}) -> {result} {{\n",
            f.kind.about(program.discrete),
            f.kind.name(program.discrete),
            arguments.collect::<String>()
        )
    }

    /// Systems of two unknowns have a solver of their own.
    fn solver(&self, equations: usize) -> &'static str {
        if equations == 2 { "solve_2" } else { "solve" }
    }

    fn newton(&self, p: &Printer<Self>, n: &Newton) -> String {
        format!(
            "    let {} = newton(|{}| {{\n{}        {}\n    }});\n",
            unpacked_names(&p.infix, &n.used_after),
            unpacked_names(&p.infix, &n.used_inside),
            p.named_inside(n),
            p.solver_call(&n.mass, &n.right, 2)
        )
    }

    fn vector(&self, _: &Printer<Self>, entries: &[String]) -> String {
        match entries.iter().map(String::len).sum::<usize>() {
            0..LINE_WIDTH => format!("    {}\n", list(entries)),
            _ => format!("    [\n        {},\n    ]\n", entries.join(",\n        ")),
        }
    }

    fn matrix(&self, f: &Function) -> (String, String) {
        let (rows, columns) = f.size;
        let (zeros, name) = (format!("[[0.0; {columns}]; {rows}]"), f.kind.matrix_name());
        match f.entries().is_empty() {
            true => (format!("    {zeros}\n"), String::new()),
            false => (
                format!("    let mut {name} = {zeros};\n"),
                format!("    {name}\n"),
            ),
        }
    }

    fn cell(&self, f: &Function, row: usize, column: usize) -> String {
        format!("{}[{row}][{column}]", f.kind.matrix_name())
    }

    fn helpers(&self, program: &Program) -> String {
        let newton = program.makes(|s| matches!(s, Step::Newton(_)));
        let sign = program.calls().iter().any(|f| f.spelling.rust == "sign");
        let other = program.arguments.iter().skip(1);
        let declared = other
            .clone()
            .map(|a| format!(", {}: &[f64; {}]", a.name, a.signals.len()));
        let passed = other.map(|a| format!(", {}", a.name));
        let arguments = (declared.collect::<String>(), passed.collect::<String>());
        let steps = |text| fill_placeholders(program, text, arguments.clone());
        let jumps = !program.switches.is_empty();
        used_helpers(&[
            (program.has_step(), &steps(STEP)),
            (jumps, &steps(STEPS)),
            (program.solves(|n| n == 2), SOLVE_2),
            (program.solves(|n| n != 2), SOLVE),
            (newton, NEWTON),
            (program.computes(|n| matches!(n, Node::Root(_))), ROOT),
            (sign, SIGN),
        ])
    }
}

/// The estimated parameters as constants.
fn parameters(d: &Discovery) -> String {
    let parameters = Parameters::new(d);
    let count = parameters.all.len();
    if count == 0 {
        return String::new();
    }
    let line = |p: &Parameter| {
        let numbers = numbers(&[p.value, p.error], Rust::NAN);
        format!(
            "    // {}\n    (\"{}\", {numbers}, \"{}\"),\n",
            p.about, p.name, p.unit
        )
    };
    let lines = parameters.lines(line);
    let mut out = format!(
        "\n/// Name, value, standard error (0 where the model states the value) and unit of each number that was found.\n#[allow(dead_code, clippy::all)]\n\
         pub const SIDC_PARAMETERS: [(&str, f64, f64, &str); {count}] = [\n{lines}];\n"
    );
    if let Some(rows) = parameters.covariance() {
        let row = |row: &Vec<f64>| format!("    [{}],\n", numbers(row, Rust::NAN));
        let rows: String = rows.iter().map(row).collect();
        out.push_str(&format!(
            "\n/// Their covariances, in the same order.\n#[allow(dead_code, clippy::all)]\npub const SIDC_COVARIANCE: [[f64; {count}]; {count}] = [\n{rows}];\n"
        ));
    }
    out
}

impl Syntax for Rust {
    const INFINITY: &'static str = "f64::INFINITY";
    const NAN: &'static str = "f64::NAN";

    fn function(&self, f: Func) -> String {
        match f.spelling.rust {
            "sign" => "sign".into(),
            method => format!("f64::{method}"),
        }
    }

    fn root(&self, x: &str) -> String {
        format!("root({x})")
    }

    fn power(&self, x: &str, p: &str) -> String {
        format!("f64::powf({x}, {p})")
    }
}

/// Steps from event to event.
const STEPS: &str = include_str!("event_steps/steps.rs.txt");

/// One Runge–Kutta step.
const STEP: &str = "
/// One step of length h by the classical method of Runge and Kutta; what is not the state is held during it.
#[allow(dead_code, clippy::all)]
pub fn step(t: f64, h: f64, state: &[f64; @N@]@ARGS@) -> [f64; @N@] {
    let (mut rate, mut sum) = ([0.0; @N@], [0.0; @N@]);
    for (part, weight) in [(0.0, 1.0), (0.5, 2.0), (0.5, 2.0), (1.0, 1.0)] {
        let point = core::array::from_fn(|i| state[i] + part * h * rate[i]);
        rate = derivatives(t + part * h, &point@PASS@);
        sum = core::array::from_fn(|i| sum[i] + weight * rate[i]);
    }
    core::array::from_fn(|i| state[i] + h / 6.0 * sum[i])
}
";

/// Without loops over rows, three times as fast as `SOLVE`.
const SOLVE_2: &str = "
/// Solves a linear system of two unknowns, column by column of the right side; NaN where it is singular.
#[inline]
#[allow(clippy::all)]
fn solve_2<const K: usize>(a: [[f64; 2]; 2], b: [[f64; K]; 2]) -> [[f64; K]; 2] {
    let swap = a[1][0].abs() > a[0][0].abs();
    let ([first, second], [upper, lower]) = if swap {
        ([a[1], a[0]], [b[1], b[0]])
    } else {
        (a, b)
    };
    let factor = second[0] / first[0];
    let last = second[1] - factor * first[1];
    if first[0] == 0.0 || last == 0.0 {
        return [[f64::NAN; K]; 2];
    }
    let mut solved = [upper, lower];
    for c in 0..K {
        let y = (lower[c] - factor * upper[c]) / last;
        solved[0][c] = (upper[c] - first[1] * y) / first[0];
        solved[1][c] = y;
    }
    solved
}
";

/// Gaussian elimination with partial pivoting; NaN where the matrix is singular.
const SOLVE: &str = "
/// Solves a small linear system, column by column of the right side; NaN where it is singular.
#[inline]
#[allow(clippy::all)]
fn solve<const N: usize, const K: usize>(mut a: [[f64; N]; N], mut b: [[f64; K]; N]) -> [[f64; K]; N] {
    for k in 0..N {
        let mut pivot = k;
        for i in k + 1..N {
            if a[i][k].abs() > a[pivot][k].abs() {
                pivot = i;
            }
        }
        a.swap(k, pivot);
        b.swap(k, pivot);
        if a[k][k] == 0.0 {
            return [[f64::NAN; K]; N];
        }
        for i in k + 1..N {
            let factor = a[i][k] / a[k][k];
            for j in k + 1..N {
                a[i][j] -= factor * a[k][j];
            }
            for c in 0..K {
                b[i][c] -= factor * b[k][c];
            }
        }
    }
    for k in (0..N).rev() {
        for c in 0..K {
            for j in k + 1..N {
                b[k][c] -= a[k][j] * b[j][c];
            }
            b[k][c] /= a[k][k];
        }
    }
    b
}
";

const NEWTON: &str = "
/// Repeats the solve from zero on until the unknowns stay; NaN if they never do.
#[allow(clippy::all)]
fn newton<const N: usize>(step: impl Fn([f64; N]) -> [[f64; 1]; N]) -> [f64; N] {
    let mut unknown = [0.0; N];
    for _ in 0..50 {
        let next = step(unknown).map(|[x]| x);
        let mut moved = 0.0;
        let mut size = 0.0;
        for i in 0..N {
            moved = f64::max(moved, f64::abs(next[i] - unknown[i]));
            size = f64::max(size, f64::abs(next[i]));
        }
        unknown = next;
        if moved <= 1e-12 * size {
            return unknown;
        }
    }
    [f64::NAN; N]
}
";

const ROOT: &str = "
/// The square root; that of -0.0 is 0.0.
#[inline]
fn root(x: f64) -> f64 {
    if x == f64::NEG_INFINITY { f64::INFINITY } else { (x + 0.0).sqrt() }
}
";

const SIGN: &str = "
/// -1, 0 or 1.
#[inline]
fn sign(x: f64) -> f64 {
    if x == 0.0 { x } else { x.signum() }
}
";

/// Keywords of Rust, constructors that a pattern would match instead of bind, and names in the emitted code.
#[rustfmt::skip]
const RESERVED: &[&str] = &[
    "as", "async", "await", "break", "const", "continue", "crate", "dyn", "else", "enum", "extern", "false", "fn", "for", "gen",
    "if", "impl", "in", "let", "loop", "match", "mod", "move", "mut", "pub", "ref", "return", "self", "Self", "static", "struct",
    "super", "trait", "true", "type", "unsafe", "use", "where", "while", "abstract", "become", "box", "do", "final", "macro",
    "override", "priv", "try", "typeof", "unsized", "virtual", "yield", "union", "Some", "None", "Ok", "Err", "f64", "t", "state", "input", "parameter", "history", "constant",
    "slope", "solve", "solve_2", "newton", "root", "sign", "derivatives", "next", "jacobian", "jacobian_input", "outputs",
    "side", "after", "guards", "rates_by_side", "guard_rates", "jumps", "settle", "advance", "eliminate", "open", "Held", "Vec",
    "JUMPS", "GAPS", "WAITS",
    "SIDC_VERDICT", "SIDC_INPUT_DELAYS", "SIDC_CONSTANTS",
];

#[cfg(test)]
mod tests {
    use super::RESERVED;
    use crate::code::program::Kind;

    #[test]
    fn every_function_is_reserved() {
        for kind in [
            Kind::Rates,
            Kind::Jacobian,
            Kind::InputJacobian,
            Kind::Outputs,
            Kind::Guards,
            Kind::RatesBySide,
            Kind::GuardRates,
            Kind::Jumps,
        ] {
            for discrete in [false, true] {
                assert!(RESERVED.contains(&kind.name(discrete)));
            }
        }
    }
}
