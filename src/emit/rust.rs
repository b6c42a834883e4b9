//! Rust: functions of time, state and input that compile without dependencies.
//!
//! Coupled equations are solved for the highest derivatives in the emitted code, by a small elimination; where they are not linear
//! in them, by Newton's method.

use super::infix::{Infix, Syntax};
use super::lists::{SHORT, list, solver_call, wanted};
use super::names::{Identifiers, plain, titled};
use super::program::{Function, Name, Newton, Program, Solve, Step};
use super::{Target, chosen};
use crate::discover::Discovery;
use crate::term::{Func, Node};

pub(super) struct Rust;

impl Target for Rust {
    fn name(&self) -> &'static str {
        "rust"
    }

    fn about(&self) -> &'static str {
        "functions of time, state and input, and their Jacobians; no dependencies"
    }

    fn emit(&self, d: &Discovery) -> Result<String, String> {
        let program = Program::new(d)?;
        program.check_calls("Rust", |f| f.spelling.rust)?;
        let names = Identifiers::new(program.names.iter().cloned(), RESERVED.iter().copied());
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
    let mut out = format!("// Written by sidc: the identified system{system} as code.\n");
    for line in program.legend() {
        out.push_str(&format!("// {line}\n"));
    }
    let outputs = program.outputs(d);
    if !outputs.is_empty() {
        out.push_str(&format!("// outputs are {}\n", plain(&outputs.join(", "))));
    }
    out
}

fn function(program: &Program, f: &Function, names: &Identifiers) -> String {
    let infix = Infix::new(&Words, &f.body, names);
    let (rows, columns) = f.size;
    let arguments: String = program
        .arguments
        .iter()
        .map(|a| format!(", {}: &[f64; {}]", a.name, a.signals.len()))
        .collect();
    let result = match f.kind.is_matrix() {
        true => format!("[[f64; {columns}]; {rows}]"),
        false => format!("[f64; {rows}]"),
    };
    let mut out = format!(
        "\n/// {}\n#[allow(unused_variables, non_snake_case, clippy::all)]\npub fn {}(t: f64{arguments}) -> {result} {{\n",
        f.kind.about(program.discrete),
        f.kind.name(program.discrete)
    );
    for read in &f.body.reads {
        out.push_str(&format!(
            "    let {} = {}[{}];\n",
            infix.signal(read.signal),
            read.argument,
            read.place
        ));
    }
    for step in &f.body.steps {
        out.push_str(&statement(&infix, step));
    }
    out.push_str(&results(&infix, f));
    out
}

fn statement(infix: &Infix<Words>, step: &Step) -> String {
    match step {
        Step::Let(name, node) => {
            let value = infix.assigned(*name, *node);
            format!("    let {} = {value};\n", infix.name(*name))
        }
        Step::Solve(s) => solved(infix, s),
        Step::Newton(n) => newton(infix, n),
    }
}

fn solved(infix: &Infix<Words>, s: &Solve) -> String {
    let names = s.signals.iter().map(|row| wanted(infix, row));
    let names: Vec<String> = names.collect();
    format!(
        "    let {} = {};\n",
        list(&names),
        solver_call(solver(&s.mass), infix, (&s.mass, &s.right), "    ")
    )
}

/// Two unknowns are eliminated without loops.
fn solver(mass: &[Vec<usize>]) -> &'static str {
    if mass.len() == 2 { "solve_2" } else { "solve" }
}

fn newton(infix: &Infix<Words>, n: &Newton) -> String {
    let lets: String = n
        .inside
        .iter()
        .map(|node| {
            format!(
                "        let {} = {};\n",
                infix.name(Name::Node(*node)),
                infix.value(*node)
            )
        })
        .collect();
    let step = solver_call(solver(&n.mass), infix, (&n.mass, &n.right), "        ");
    format!(
        "    let {} = newton(|{}| {{\n{lets}        {step}\n    }});\n",
        wanted(infix, &n.asked),
        wanted(infix, &n.moving)
    )
}

fn results(infix: &Infix<Words>, f: &Function) -> String {
    if !f.kind.is_matrix() {
        let entries = infix.flat(&f.body.results);
        return match entries.iter().map(String::len).sum::<usize>() {
            0..SHORT => format!("    {}\n}}\n", list(&entries)),
            _ => format!(
                "    [\n        {},\n    ]\n}}\n",
                entries.join(",\n        ")
            ),
        };
    }
    let (rows, columns) = f.size;
    if f.entries().is_empty() {
        return format!("    [[0.0; {columns}]; {rows}]\n}}\n");
    }
    let mut out = format!("    let mut slope = [[0.0; {columns}]; {rows}];\n");
    for (i, j, node) in f.entries() {
        out.push_str(&format!("    slope[{i}][{j}] = {};\n", infix.text(node)));
    }
    out.push_str("    slope\n}\n");
    out
}

/// The helpers that the code calls.
fn helpers(program: &Program) -> String {
    let newton = program.makes(|s| matches!(s, Step::Newton(_)));
    let all = [
        (program.solves(|n| n == 2), SOLVE_2),
        (program.solves(|n| n != 2), SOLVE),
        (newton, NEWTON),
        (program.computes(|n| matches!(n, Node::Root(_))), ROOT),
        (
            program.calls().iter().any(|f| f.spelling.rust == "sign"),
            SIGN,
        ),
    ];
    chosen(&all)
}

/// The same without loops, three times as fast.
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

/// Gaussian elimination with row exchanges; NaN where the matrix is singular.
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

struct Words;

impl Syntax for Words {
    fn number(&self, x: f64) -> String {
        match x {
            f64::INFINITY => "f64::INFINITY".into(),
            x if x.is_nan() => "f64::NAN".into(),
            x => format!("{x:?}"),
        }
    }

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

/// Words of Rust, constructors that a pattern would match instead of bind, and names that the emitted code uses.
#[rustfmt::skip]
const RESERVED: &[&str] = &[
    "as", "async", "await", "break", "const", "continue", "crate", "dyn", "else", "enum", "extern", "false", "fn", "for", "gen",
    "if", "impl", "in", "let", "loop", "match", "mod", "move", "mut", "pub", "ref", "return", "self", "Self", "static", "struct",
    "super", "trait", "true", "type", "unsafe", "use", "where", "while", "abstract", "become", "box", "do", "final", "macro",
    "override", "priv", "try", "typeof", "unsized", "virtual", "yield", "union", "Some", "None", "Ok", "Err", "f64", "t", "state", "input", "parameter", "history",
    "slope", "solve", "solve_2", "newton", "root", "sign", "derivatives", "next", "jacobian", "jacobian_input", "outputs",
];

#[cfg(test)]
mod tests {
    use super::RESERVED;
    use crate::emit::program::Kind;

    #[test]
    fn every_function_is_reserved() {
        for kind in [
            Kind::Rates,
            Kind::Jacobian,
            Kind::InputJacobian,
            Kind::Outputs,
        ] {
            for discrete in [false, true] {
                assert!(RESERVED.contains(&kind.name(discrete)));
            }
        }
    }
}
