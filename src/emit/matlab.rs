//! MATLAB and Octave: a function file for `ode45` and its kin.
//!
//! Coupled equations are solved for the highest derivatives at every call; where they are not linear in them, by Newton's method.
//! Functions that would answer with a complex number answer NaN.

use super::Target;
use super::infix::{Infix, Syntax};
use super::names::{Identifiers, ascii, plain, titled};
use super::program::{Function, Kind, Name, Newton, Program, Solve, Step};
use crate::discover::Discovery;
use crate::term::{Func, Node, Signal};

pub(super) struct Matlab;

impl Target for Matlab {
    fn name(&self) -> &'static str {
        "matlab"
    }

    fn about(&self) -> &'static str {
        "a function file for MATLAB and Octave: rates, their Jacobians, outputs"
    }

    fn emit(&self, d: &Discovery) -> Result<String, String> {
        let program = Program::new(d)?;
        program.check_calls("MATLAB", |f| f.spelling.matlab)?;
        let names = Identifiers::new(program.names.iter().cloned(), RESERVED.iter().copied());
        let mut out = main(d, &program);
        for f in &program.functions {
            out.push_str(&function(&program, f, &names));
        }
        out.push_str(&helpers(&program));
        Ok(out)
    }
}

fn arguments(program: &Program) -> String {
    program
        .arguments
        .iter()
        .map(|a| format!(", {}", a.name))
        .collect()
}

/// What a function returns.
fn result(kind: Kind) -> &'static str {
    match kind {
        Kind::Rates => "rate",
        Kind::Jacobian => "slope",
        Kind::InputJacobian => "slope_input",
        Kind::Outputs => "output",
    }
}

const KINDS: [Kind; 4] = [
    Kind::Rates,
    Kind::Jacobian,
    Kind::InputJacobian,
    Kind::Outputs,
];

/// The function of the file, which calls the others.
fn main(d: &Discovery, program: &Program) -> String {
    let system = titled(program.system.as_deref());
    let own = ascii(program.system.as_deref().unwrap_or("model"));
    let name = Identifiers::new([], RESERVED.iter().copied()).fresh(&own);
    let arguments = arguments(program);
    let results = KINDS.map(result).join(", ");
    let mut out = format!(
        "function [{results}] = {name}(t{arguments})\n% Written by sidc: the identified system{system} as code, for MATLAB and Octave.\n"
    );
    for line in program.legend() {
        out.push_str(&format!("% {line}\n"));
    }
    for kind in KINDS {
        if program.get(kind).is_some() {
            out.push_str(&format!(
                "% {}: {}\n",
                result(kind),
                kind.about(program.discrete).replace('`', "")
            ));
        }
    }
    let outputs = program.outputs(d);
    if !outputs.is_empty() {
        out.push_str(&format!(
            "% The outputs are {}.\n",
            plain(&outputs.join(", "))
        ));
    }
    for (i, kind) in KINDS.into_iter().enumerate() {
        let (result, called) = (result(kind), kind.name(program.discrete));
        let value = match program.get(kind) {
            Some(_) => format!("{called}(t{arguments})"),
            None => "[]".to_string(),
        };
        match i {
            0 => out.push_str(&format!("  {result} = {value};\n")),
            _ => out.push_str(&format!(
                "  if nargout > {i}\n    {result} = {value};\n  end\n"
            )),
        }
    }
    out.push_str("end\n");
    out
}

fn function(program: &Program, f: &Function, names: &Identifiers) -> String {
    let infix = Infix::new(&Words, &f.body, names);
    let mut out = format!(
        "\nfunction {} = {}(t{})\n",
        result(f.kind),
        f.kind.name(program.discrete),
        arguments(program)
    );
    for read in &f.body.reads {
        out.push_str(&format!(
            "  {} = {}({});\n",
            infix.signal(read.signal),
            read.argument,
            read.place + 1
        ));
    }
    for step in &f.body.steps {
        out.push_str(&statement(&infix, step));
    }
    out.push_str(&results(&infix, f));
    out.push_str("end\n");
    out
}

fn statement(infix: &Infix<Words>, step: &Step) -> String {
    match step {
        Step::Let(name, node) => {
            let value = infix.assigned(*name, *node);
            format!("  {} = {value};\n", infix.name(*name))
        }
        Step::Solve(s) => solved(infix, s),
        Step::Newton(n) => newton(infix, n),
    }
}

fn solved(infix: &Infix<Words>, s: &Solve) -> String {
    let mut out = system(infix, &s.mass, &s.right, "  ");
    for (i, row) in s.signals.iter().enumerate() {
        for (j, s) in row.iter().enumerate() {
            if let Some(s) = s {
                out.push_str(&format!(
                    "  {} = solved({}, {});\n",
                    infix.signal(*s),
                    i + 1,
                    j + 1
                ));
            }
        }
    }
    out
}

fn system(infix: &Infix<Words>, mass: &[Vec<usize>], right: &[Vec<usize>], indent: &str) -> String {
    let matrix = |rows: &[Vec<usize>]| {
        let rows: Vec<String> = rows.iter().map(|row| infix.texts(row).join(", ")).collect();
        format!("[{}]", rows.join("; "))
    };
    let next = format!(", ...\n{indent}  ");
    format!(
        "{indent}solved = small_solve({}{next}{});\n",
        matrix(mass),
        matrix(right)
    )
}

fn newton(infix: &Infix<Words>, n: &Newton) -> String {
    let size = n.signals.len();
    let entries = |all: &[Option<Signal>], indent: &str| -> String {
        let named = all
            .iter()
            .enumerate()
            .filter_map(|(i, s)| Some((i + 1, (*s)?)));
        named
            .map(|(i, s)| format!("{indent}{} = unknown({i});\n", infix.signal(s)))
            .collect()
    };
    let lets: String = n
        .inside
        .iter()
        .map(|node| {
            format!(
                "    {} = {};\n",
                infix.name(Name::Node(*node)),
                infix.value(*node)
            )
        })
        .collect();
    format!(
        "  unknown = zeros({size}, 1);\n  settled = false;\n  step = 0;\n  while ~settled && step < 50\n{}{lets}{}    \
         settled = max(abs(solved - unknown)) <= 1e-12 * max(abs(solved));\n    unknown = solved;\n    step = step + 1;\n  end\n  \
         if ~settled\n    unknown = NaN({size}, 1);\n  end\n{}",
        entries(&n.moving, "    "),
        system(infix, &n.mass, &n.right, "    "),
        entries(&n.asked, "  ")
    )
}

fn results(infix: &Infix<Words>, f: &Function) -> String {
    let name = result(f.kind);
    if !f.kind.is_matrix() {
        let entries = infix.flat(&f.body.results);
        return format!("  {name} = [{}];\n", entries.join("; "));
    }
    let (rows, columns) = f.size;
    let mut out = format!("  {name} = zeros({rows}, {columns});\n");
    for (i, j, node) in f.entries() {
        out.push_str(&format!(
            "  {name}({}, {}) = {};\n",
            i + 1,
            j + 1,
            infix.text(node)
        ));
    }
    out
}

/// The helpers that the code calls.
fn helpers(program: &Program) -> String {
    let solves = program.solves(|_| true);
    let powers = program.computes(|n| matches!(n, Node::Root(_) | Node::Power(..)));
    let mut out = String::new();
    if solves {
        out.push_str(SOLVE);
    }
    if powers {
        out.push_str(POWER);
    }
    for f in program.calls() {
        if let Some(built_in) = f.spelling.matlab.strip_prefix(REAL) {
            out.push_str(&format!(
                "\nfunction y = {}(x)\n  y = {built_in}(x);\n  if ~isreal(y)\n    y = NaN;\n  end\nend\n",
                f.spelling.matlab
            ));
        }
    }
    out
}

/// In front of functions that may answer with a complex number.
const REAL: &str = "real_";

/// Gaussian elimination with row exchanges; NaN where the matrix is singular, without a warning.
const SOLVE: &str = "
function b = small_solve(a, b)
% Solves a small linear system, column by column of the right side; NaN where it is singular.
  n = size(a, 1);
  for k = 1:n
    [~, pivot] = max(abs(a(k:n, k)));
    pivot = pivot + k - 1;
    a([k, pivot], :) = a([pivot, k], :);
    b([k, pivot], :) = b([pivot, k], :);
    if a(k, k) == 0
      b = NaN(size(b));
      return
    end
    for i = k + 1:n
      factor = a(i, k) / a(k, k);
      a(i, :) = a(i, :) - factor * a(k, :);
      b(i, :) = b(i, :) - factor * b(k, :);
    end
  end
  for k = n:-1:1
    b(k, :) = (b(k, :) - a(k, k + 1:n) * b(k + 1:n, :)) / a(k, k);
  end
end
";

const POWER: &str = "
function y = real_power(x, p)
% x^p for p that is not whole; NaN where it is not real.
  if x == -Inf
    x = Inf;
  end
  y = x^p;
  if ~isreal(y)
    y = NaN;
  end
end
";

struct Words;

impl Syntax for Words {
    fn number(&self, x: f64) -> String {
        match x {
            f64::INFINITY => "Inf".into(),
            x if x.is_nan() => "NaN".into(),
            x => format!("{x:?}"),
        }
    }

    fn function(&self, f: Func) -> String {
        f.spelling.matlab.into()
    }

    fn root(&self, x: &str) -> String {
        format!("real_power({x}, 0.5)")
    }

    fn power(&self, x: &str, p: &str) -> String {
        format!("real_power({x}, {p})")
    }
}

/// Words of MATLAB and Octave, and names that the emitted code uses.
#[rustfmt::skip]
const RESERVED: &[&str] = &[
    "break", "case", "catch", "classdef", "continue", "else", "elseif", "end", "for", "function", "global", "if", "otherwise", "parfor",
    "persistent", "return", "spmd", "switch", "try", "while", "arguments", "properties", "methods", "events", "enumeration", "import",
    "do", "until", "unwind_protect", "unwind_protect_cleanup", "end_try_catch", "end_unwind_protect", "endclassdef",
    "endenumeration", "endevents", "endfor", "endfunction", "endif", "endmethods", "endparfor", "endproperties", "endswitch", "endwhile",
    "endspmd", "endarguments", "static", "nargin", "nargout", "varargin", "varargout", "ans", "isargout", "nthargout", "inputname",
    "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "exp", "log", "sqrt", "abs", "sign", "min", "max", "zeros",
    "NaN", "Inf", "size", "isreal", "real_asin", "real_acos", "real_log", "real_sqrt", "real_power", "small_solve",
    "t", "state", "input", "parameter", "history", "rate", "slope", "slope_input", "output", "solved", "unknown", "settled", "step",
    "derivatives", "next", "jacobian", "jacobian_input", "outputs",
];

#[cfg(test)]
mod tests {
    use super::RESERVED;
    use crate::term::FUNCTIONS;

    #[test]
    fn every_function_is_reserved() {
        for f in FUNCTIONS {
            assert!(
                RESERVED.contains(&f.spelling.matlab),
                "{}",
                f.spelling.matlab
            );
        }
    }
}
