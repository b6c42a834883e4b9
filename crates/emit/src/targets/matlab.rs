//! MATLAB and Octave: a function file for solvers such as `ode45`.
//!
//! Coupled equations are solved at every call, by Newton's method where they are not linear in the highest
//! derivatives. Functions whose value would be complex return NaN.

use crate::caveats::{caveats, delays, verdict_summary};
use crate::code::identifiers::{Identifiers, ascii, plain, space_and_name};
use crate::code::infix::{Infix, Syntax};
use crate::code::parameters::{Parameters, number, numbers};
use crate::code::printer::{Dialect, Language, Printer, commented, fill_placeholders};
use crate::code::program::{Argument, Function, Kind, Newton, Program, Solve};
use sidc_lang::term::{Func, Node};
use sidc_system::discovery::Discovery;

pub(crate) struct Matlab;

impl Language for Matlab {
    const DIALECT: Dialect = Dialect {
        target: "matlab",
        about: "a function file for MATLAB and Octave: rates, their Jacobians, outputs",
        language: "MATLAB",
        indent: "  ",
        declares: "",
        end: ";",
        index: (1, "(", ")"),
        close: "end\n",
        helpers_first: false,
        reserved: RESERVED,
    };

    fn spelling(f: Func) -> &'static str {
        f.spelling.matlab
    }

    fn header(&self, d: &Discovery, program: &Program) -> String {
        main(d, program)
    }

    fn opening(&self, program: &Program, f: &Function) -> String {
        format!(
            "\nfunction {} = {}(t{})\n",
            result(f.kind),
            f.kind.name(program.discrete),
            listed(program.arguments_of(f.kind))
        )
    }

    fn solve(&self, p: &Printer<Self>, s: &Solve) -> String {
        let mut out = system(&p.infix, &s.mass, &s.right, "  ");
        for (i, row) in s.signals.iter().enumerate() {
            for (j, s) in row.iter().enumerate() {
                if let Some(s) = s {
                    let value = format!("solved({}, {})", i + 1, j + 1);
                    out.push_str(&p.declare(1, &p.infix.signal(*s), &value));
                }
            }
        }
        out
    }

    fn newton(&self, p: &Printer<Self>, n: &Newton) -> String {
        let size = n.signals.len();
        format!(
            "  unknown = zeros({size}, 1);\n  settled = false;\n  step = 0;\n  while ~settled && step < 50\n{}{}{}    \
             settled = max(abs(solved - unknown)) <= 1e-12 * max(abs(solved));\n    unknown = solved;\n    step = step + 1;\n  end\n  \
             if ~settled\n    unknown = NaN({size}, 1);\n  end\n{}",
            p.unpack(2, "unknown", &n.used_inside),
            p.named_inside(n),
            system(&p.infix, &n.mass, &n.right, "    "),
            p.unpack(1, "unknown", &n.used_after)
        )
    }

    fn vector(&self, p: &Printer<Self>, entries: &[String]) -> String {
        let value = format!("[{}]", entries.join("; "));
        p.assign(1, result(p.function.kind), &value)
    }

    fn matrix(&self, f: &Function) -> (String, String) {
        let ((rows, columns), name) = (f.size, result(f.kind));
        let zeros = format!("  {name} = zeros({rows}, {columns});\n");
        (zeros, String::new())
    }

    fn cell(&self, f: &Function, row: usize, column: usize) -> String {
        format!("{}({}, {})", result(f.kind), row + 1, column + 1)
    }

    fn helpers(&self, program: &Program) -> String {
        let solves = program.solves(|_| true);
        let powers = program
            .computes(|n| matches!(n, Node::Root(_) | Node::Power(..) | Node::SymbolicPower(..)));
        let mut out = String::new();
        if !program.switches.is_empty() {
            out.push_str(&fill_placeholders(program, STEPS, Default::default()));
        }
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
}

impl Syntax for Matlab {
    const INFINITY: &'static str = "Inf";
    const NAN: &'static str = "NaN";

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

fn arguments(program: &Program) -> String {
    listed(program.arguments.iter())
}

fn listed<'a>(arguments: impl Iterator<Item = &'a Argument>) -> String {
    arguments.map(|a| format!(", {}", a.name)).collect()
}

/// The variable that a function returns.
fn result(kind: Kind) -> &'static str {
    match kind {
        Kind::Rates | Kind::RatesBySide | Kind::GuardRates => "rate",
        Kind::Guards => "guard",
        Kind::Jacobian => "slope",
        Kind::InputJacobian => "slope_input",
        Kind::Outputs => "output",
        Kind::Jumps => "after",
    }
}

const KINDS: [Kind; 4] = [
    Kind::Rates,
    Kind::Jacobian,
    Kind::InputJacobian,
    Kind::Outputs,
];

/// The estimated parameters as fields of the struct.
fn parameters(d: &Discovery) -> String {
    let parameters = Parameters::new(d);
    if parameters.is_empty() {
        return String::new();
    }
    let text = |x: &str| format!("'{}'", x.replace('\'', "''"));
    let mut out = parameters.lines(|p| format!("    %   {} of {}\n", p.name, p.about));
    let mut field = |name: &str, list: String| {
        out.push_str(&format!("    rate.sidc_parameter_{name} = {list};\n"));
    };
    field(
        "names",
        format!("{{{}}}", parameters.list(|p| text(&p.name))),
    );
    field(
        "values",
        format!("[{}]", parameters.list(|p| number(p.value, "NaN"))),
    );
    field(
        "errors",
        format!("[{}]", parameters.list(|p| number(p.error, "NaN"))),
    );
    field(
        "units",
        format!("{{{}}}", parameters.list(|p| text(&p.unit))),
    );
    if let Some(rows) = parameters.covariance() {
        let rows: Vec<String> = rows.iter().map(|row| numbers(row, "NaN")).collect();
        field("covariance", format!("[{}]", rows.join("; ")));
    }
    format!(
        "    % The numbers that were found; errors are standard errors, 0 where the model states the value:\n{out}"
    )
}

/// The main function, which calls the others.
fn main(d: &Discovery, program: &Program) -> String {
    let system = space_and_name(program.system.as_deref());
    let own = ascii(program.system.as_deref().unwrap_or("model"));
    let name = Identifiers::new([], RESERVED.iter().copied()).fresh(&own);
    let arguments = arguments(program);
    let results = KINDS.map(result).join(", ");
    let has_events = !program.switches.is_empty();
    let taken = match has_events {
        true => "varargin".to_string(),
        false => format!("t{arguments}"),
    };
    let mut out = format!(
        "function [{results}] = {name}({taken})\n% Written by sidc: the identified system{system} as code, for MATLAB and Octave.\n"
    );
    out.push_str(&commented("% ", caveats(d).into_iter()));
    out.push_str("% Without arguments, rate is a struct with the verdict, the delays of the inputs in seconds, and the numbers that were found.\n%\n");
    out.push_str(&commented("% ", program.legend()));
    if !program.constants.is_empty() {
        out.push_str("% Without them constant is:\n");
        out.push_str(&commented("%   ", program.constant_lines()));
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
    if has_events {
        let other = listed(program.arguments.iter().skip(1));
        out.push_str(&format!(
            "% The equations jump where a guard is zero. From event to event go\n%   [state, side] = {name}('advance', t, state, h, side{other}), a fixed step, and\n%   [times, states] = {name}('run', times, state{other}), ode45 stopped at events.\n"
        ));
    }
    let outputs = program.outputs(d);
    if !outputs.is_empty() {
        out.push_str(&format!(
            "% The outputs are {}.\n",
            plain(&outputs.join(", "))
        ));
    }
    let delays: Vec<String> = (delays(d, &program.form.inputs).iter())
        .map(|t| format!("{t:?}"))
        .collect();
    let values = program.constant_values();
    let constants = match program.constants.is_empty() {
        true => String::new(),
        false => format!(", 'sidc_constants', [{values}]"),
    };
    out.push_str(&format!(
        "  if nargin == 0\n    rate = struct('sidc_verdict', '{}', 'sidc_input_delays', [{}]{constants});\n{}    return\n  end\n",
        verdict_summary(d),
        delays.join(", "),
        parameters(d)
    ));
    if has_events {
        out.push_str(&unpacked(program));
    } else if !program.constants.is_empty() {
        let given = 1 + program.given().count();
        out.push_str(&format!(
            "  if nargin <= {given}\n    constant = [{values}];\n  end\n"
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

/// Unpacks the arguments of the main function, the first of which may name a function that steps from event to event.
fn unpacked(program: &Program) -> String {
    let mut out = String::from(
        "  if ischar(varargin{1})\n    [rate, slope] = feval(str2func(varargin{1}), varargin{2:end});\n    return\n  end\n  t = varargin{1};\n",
    );
    let values = program.constant_values();
    for (i, a) in program.arguments.iter().enumerate() {
        let value = format!("  {} = varargin{{{}}};\n", a.name, i + 2);
        out.push_str(&match a.name == "constant" {
            false => value,
            true => format!(
                "  if nargin < {}\n    constant = [{values}];\n  else\n  {value}  end\n",
                i + 2
            ),
        });
    }
    out
}

fn system(
    infix: &Infix<Matlab>,
    mass: &[Vec<usize>],
    right: &[Vec<usize>],
    indent: &str,
) -> String {
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

/// Steps from event to event.
const STEPS: &str = include_str!("event_steps/steps.m");

/// Prefix of functions that guard against complex values.
const REAL: &str = "real_";

/// Gaussian elimination with partial pivoting; NaN where the matrix is singular, without a warning.
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

/// Keywords of MATLAB and Octave, functions, and names in the emitted code.
#[rustfmt::skip]
pub(super) const RESERVED: &[&str] = &[
    "break", "case", "catch", "classdef", "continue", "else", "elseif", "end", "for", "function", "global", "if", "otherwise", "parfor",
    "persistent", "return", "spmd", "switch", "try", "while", "arguments", "properties", "methods", "events", "enumeration", "import",
    "do", "until", "unwind_protect", "unwind_protect_cleanup", "end_try_catch", "end_unwind_protect", "endclassdef",
    "endenumeration", "endevents", "endfor", "endfunction", "endif", "endmethods", "endparfor", "endproperties", "endswitch", "endwhile",
    "endspmd", "endarguments", "static", "nargin", "nargout", "varargin", "varargout", "ans", "isargout", "nthargout", "inputname",
    "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "exp", "log", "sqrt", "abs", "sign", "min", "max", "zeros",
    "NaN", "Inf", "size", "isreal", "real_asin", "real_acos", "real_log", "real_sqrt", "real_power", "small_solve",
    "t", "state", "input", "parameter", "history", "constant", "rate", "slope", "slope_input", "output", "solved", "unknown", "settled", "step",
    "derivatives", "next", "jacobian", "jacobian_input", "outputs", "side", "guard", "guards", "rates_by_side", "guard_rates",
    "after", "jumps", "passed", "opened", "beyond", "reaches", "jump_tables", "jumps_at", "floors", "touching", "advance", "run", "stops", "first_sides", "contacts", "following", "decide", "held_sides", "least_sides", "margins", "classical",
];
