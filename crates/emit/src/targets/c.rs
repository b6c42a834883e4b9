//! C99: functions of time, state and input that need nothing but `math.h`.
//!
//! Coupled equations are solved by elimination in the emitted code, by Newton's method where they are not linear in
//! the highest derivatives. Compiles without a warning under `-std=c99 -Wall -Wextra -pedantic`.

use crate::caveats::{caveats, delays, verdict_summary};
use crate::code::identifiers::{plain, titled};
use crate::code::infix::{Infix, Syntax};
use crate::code::printer::{Dialect, Language, Printer, commented, event_steps, used_helpers};
use crate::code::program::{Function, Kind, Newton, Program, Solve, Step};
use sidc_lang::term::{Func, Node};
use sidc_system::discovery::Discovery;

pub(crate) struct C;

impl Language for C {
    const DIALECT: Dialect = Dialect {
        target: "c",
        about: "C99 functions of time, state and input, and their Jacobians; math.h alone",
        language: "C",
        indent: "    ",
        declares: "const double ",
        end: ";",
        index: (0, "[", "]"),
        close: "}\n",
        helpers_first: true,
        reserved: RESERVED,
    };

    fn spelling(f: Func) -> &'static str {
        f.spelling.c
    }

    fn header(&self, d: &Discovery, program: &Program) -> String {
        let system = titled(program.system.as_deref());
        let mut out =
            format!("/* Written by sidc: the identified system{system} as code (C99).\n *\n");
        out.push_str(&commented(" * ", caveats(d).into_iter()));
        out.push_str(" *\n");
        out.push_str(&commented(" * ", program.legend()));
        let outputs = program.outputs(d);
        if !outputs.is_empty() {
            let names = plain(&outputs.join(", "));
            out.push_str(&format!(" * output are the outputs: {names}\n"));
        }
        out.push_str(" *\n");
        for f in &program.functions {
            out.push_str(&format!(" * {};\n", signature(program, f)));
        }
        if !program.switches.is_empty() {
            let other = program.arguments.iter().skip(1);
            let other: String = other
                .map(|a| format!(", const double *{}", a.name))
                .collect();
            out.push_str(&format!(
                " * void sidc_settle(double t, const double *state{other}, double *side);\n * void sidc_advance(double t, double h, double *state{other}, double *side);\n"
            ));
        }
        out.push_str(" */\n#include <math.h>\n\n");
        out.push_str(&format!(
            "#define SIDC_VERDICT \"{}\"\n",
            verdict_summary(d)
        ));
        let delays = delays(d, &program.form.inputs);
        if !delays.is_empty() {
            let delays: Vec<String> = delays.iter().map(|t| format!("{t:?}")).collect();
            out.push_str(&format!(
                "/* Seconds by which each input acts later, as an initialiser of an array. */\n#define SIDC_INPUT_DELAYS {{{}}}\n",
                delays.join(", ")
            ));
        }
        if !program.constants.is_empty() {
            out.push_str("/* The constants as they were found, as an initialiser of an array:\n");
            out.push_str(&commented(" * ", program.constant_lines()));
            out.push_str(&format!(
                " */\n#define SIDC_CONSTANTS {{{}}}\n",
                program.constant_values()
            ));
        }
        out
    }

    fn opening(&self, program: &Program, f: &Function) -> String {
        let about = f.kind.about(program.discrete);
        let (rows, columns) = f.size;
        let layout = match f.kind.is_matrix() {
            true => format!(" slope[{columns}*i + j] is row i of {rows}, column j of {columns}."),
            false => format!(" {} has {rows} entries.", result(f.kind)),
        };
        let mut out = format!("\n/* {about}{layout} */\n{}\n{{\n", signature(program, f));
        if !f.body.mentions_time() {
            out.push_str("    (void)t;\n");
        }
        for a in program.arguments_of(f.kind) {
            if !f.body.reads.iter().any(|r| r.argument == a.name) {
                out.push_str(&format!("    (void){};\n", a.name));
            }
        }
        out
    }

    /// The matrices get a block of their own, so that the next solve can use the same names.
    fn solve(&self, p: &Printer<Self>, s: &Solve) -> String {
        let used = s.signals.concat();
        let names = used.iter().flatten().map(|s| p.infix.signal(*s));
        let names: Vec<String> = names.collect();
        let mut out = format!("    double {};\n    {{\n", names.join(", "));
        out.push_str(&system(&p.infix, &s.mass, &s.right));
        for (place, s) in used.iter().enumerate() {
            if let Some(s) = s {
                out.push_str(&p.assign(2, &p.infix.signal(*s), &p.element("right", place)));
            }
        }
        out.push_str("    }\n");
        out
    }

    fn newton(&self, p: &Printer<Self>, n: &Newton) -> String {
        let size = n.signals.len();
        let zeros = vec!["0.0"; size].join(", ");
        format!(
            "    double unknown[] = {{{zeros}}};\n    int settled = 0;\n    \
             for (int step = 1; step <= 50 && !settled; step++) {{\n{}{}{}        \
             settled = sidc_settled({size}, unknown, right, step == 50);\n    }}\n{}",
            p.unpack(2, "unknown", &n.used_inside),
            p.named_inside(n),
            system(&p.infix, &n.mass, &n.right),
            p.unpack(1, "unknown", &n.used_after)
        )
    }

    fn vector(&self, p: &Printer<Self>, entries: &[String]) -> String {
        let name = result(p.function.kind);
        let entries = entries.iter().enumerate();
        entries
            .map(|(i, entry)| p.assign(1, &p.element(name, i), entry))
            .collect()
    }

    fn matrix(&self, f: &Function) -> (String, String) {
        let (rows, columns) = f.size;
        let zeros = format!(
            "    for (int i = 0; i < {}; i++) {{\n        {}[i] = 0.0;\n    }}\n",
            rows * columns,
            result(f.kind)
        );
        (zeros, String::new())
    }

    fn cell(&self, f: &Function, row: usize, column: usize) -> String {
        let (_, columns) = f.size;
        format!("{}[{}]", result(f.kind), columns * row + column)
    }

    fn last(&self, program: &Program) -> String {
        let other = program.arguments.iter().skip(1);
        let declared = other.clone().map(|a| format!(", const double *{}", a.name));
        let passed = other.map(|a| format!(", {}", a.name));
        event_steps(program, STEPS, (declared.collect(), passed.collect()))
    }

    fn helpers(&self, program: &Program) -> String {
        let newton = program.makes(|s| matches!(s, Step::Newton(_)));
        let sign = program.calls().iter().any(|f| f.spelling.c == "sidc_sign");
        used_helpers(&[
            (program.computes(|n| matches!(n, Node::Root(_))), ROOT),
            (sign, SIGN),
            (program.solves(|n| n == 1), SOLVE_1),
            (program.solves(|n| n == 2), SOLVE_2),
            (program.solves(|n| n > 2), SOLVE),
            (newton, NEWTON),
        ])
    }
}

impl Syntax for C {
    const INFINITY: &'static str = "INFINITY";
    const NAN: &'static str = "NAN";

    fn function(&self, f: Func) -> String {
        f.spelling.c.into()
    }

    fn root(&self, x: &str) -> String {
        format!("sidc_root({x})")
    }

    fn power(&self, x: &str, p: &str) -> String {
        format!("pow({x}, {p})")
    }
}

fn signature(program: &Program, f: &Function) -> String {
    let arguments = program.arguments_of(f.kind);
    let arguments: String = arguments
        .map(|a| format!(", const double *{}", a.name))
        .collect();
    format!(
        "void sidc_{}(double t{arguments}, double *{})",
        f.kind.name(program.discrete),
        result(f.kind)
    )
}

/// The array that a function writes.
fn result(kind: Kind) -> &'static str {
    match kind {
        Kind::Rates | Kind::RatesBySide | Kind::GuardRates => "rate",
        Kind::Guards => "guard",
        Kind::Jacobian | Kind::InputJacobian => "slope",
        Kind::Outputs => "output",
    }
}

fn system(infix: &Infix<C>, mass: &[Vec<usize>], right: &[Vec<usize>]) -> String {
    let columns = right.first().map_or(0, Vec::len);
    let matrix = |name: &str, rows: &[Vec<usize>]| {
        let rows: Vec<String> = rows
            .iter()
            .map(|row| format!("            {}", infix.texts(row).join(", ")))
            .collect();
        format!(
            "        double {name}[] = {{\n{}\n        }};\n",
            rows.join(",\n")
        )
    };
    format!(
        "{}{}        {}{columns}, mass, right);\n",
        matrix("mass", mass),
        matrix("right", right),
        solver(mass.len())
    )
}

/// The beginning of a call. One and two unknowns have solvers without loops.
fn solver(n: usize) -> String {
    match n {
        1 | 2 => format!("sidc_solve_{n}("),
        n => format!("sidc_solve({n}, "),
    }
}

/// Steps from event to event.
const STEPS: &str = include_str!("event_steps/steps.c");

const SOLVE_1: &str = "
/* Solves a times x = b (1 x columns) in place of b; NaN where a is zero. */
static inline void sidc_solve_1(int columns, const double *a, double *b)
{
    for (int j = 0; j < columns; j++) {
        b[j] = a[0] == 0.0 ? NAN : b[j] / a[0];
    }
}
";

const SOLVE_2: &str = "
/* Solves a (2 x 2) times x = b (2 x columns) in place of b; NaN where a is singular. */
static inline void sidc_solve_2(int columns, const double *a, double *b)
{
    const int first = fabs(a[2]) > fabs(a[0]), second = 1 - first;
    const double pivot = a[2 * first], above = a[2 * first + 1];
    const double factor = a[2 * second] / pivot;
    const double last = a[2 * second + 1] - factor * above;
    for (int j = 0; j < columns; j++) {
        const double upper = b[columns * first + j];
        const double y = (b[columns * second + j] - factor * upper) / last;
        const double x = (upper - above * y) / pivot;
        b[j] = pivot == 0.0 || last == 0.0 ? NAN : x;
        b[columns + j] = pivot == 0.0 || last == 0.0 ? NAN : y;
    }
}
";

/// Gaussian elimination with partial pivoting; NaN where the matrix is singular.
const SOLVE: &str = "
/* Solves a (n x n) times x = b (n x columns) in place of b; NaN where a is singular. */
static inline void sidc_solve(int n, int columns, double *a, double *b)
{
    for (int k = 0; k < n; k++) {
        int pivot = k;
        for (int i = k + 1; i < n; i++) {
            if (fabs(a[i * n + k]) > fabs(a[pivot * n + k])) {
                pivot = i;
            }
        }
        if (pivot != k) {
            for (int j = k; j < n; j++) {
                const double kept = a[k * n + j];
                a[k * n + j] = a[pivot * n + j];
                a[pivot * n + j] = kept;
            }
            for (int j = 0; j < columns; j++) {
                const double kept = b[k * columns + j];
                b[k * columns + j] = b[pivot * columns + j];
                b[pivot * columns + j] = kept;
            }
        }
        if (a[k * n + k] == 0.0) {
            for (int i = 0; i < n * columns; i++) {
                b[i] = NAN;
            }
            return;
        }
        for (int i = k + 1; i < n; i++) {
            const double factor = a[i * n + k] / a[k * n + k];
            for (int j = k + 1; j < n; j++) {
                a[i * n + j] -= factor * a[k * n + j];
            }
            for (int j = 0; j < columns; j++) {
                b[i * columns + j] -= factor * b[k * columns + j];
            }
        }
    }
    for (int k = n - 1; k >= 0; k--) {
        for (int j = 0; j < columns; j++) {
            for (int i = k + 1; i < n; i++) {
                b[k * columns + j] -= a[k * n + i] * b[i * columns + j];
            }
            b[k * columns + j] /= a[k * n + k];
        }
    }
}
";

const NEWTON: &str = "
/* Takes the next unknowns and tells if they stay; after the last step, NaN if they do not. */
static int sidc_settled(int n, double *unknown, const double *next, int last)
{
    double moved = 0.0, size = 0.0;
    for (int i = 0; i < n; i++) {
        moved = fmax(moved, fabs(next[i] - unknown[i]));
        size = fmax(size, fabs(next[i]));
        unknown[i] = next[i];
    }
    const int settled = moved <= 1e-12 * size;
    for (int i = 0; i < n && last && !settled; i++) {
        unknown[i] = NAN;
    }
    return settled;
}
";

const ROOT: &str = "
/* The square root; that of -0.0 is 0.0. */
static inline double sidc_root(double x)
{
    return x == -INFINITY ? INFINITY : sqrt(x + 0.0);
}
";

const SIGN: &str = "
/* -1, 0 or 1. */
static inline double sidc_sign(double x)
{
    return x > 0.0 ? 1.0 : x < 0.0 ? -1.0 : x;
}
";

/// Keywords of C and C++, functions and macros of `math.h` and of compilers, and names in the emitted code.
#[rustfmt::skip]
const RESERVED: &[&str] = &[
    "auto", "break", "case", "char", "const", "continue", "default", "do", "double", "else", "enum", "extern", "float", "for", "goto",
    "if", "inline", "int", "long", "register", "restrict", "return", "short", "signed", "sizeof", "static", "struct", "switch",
    "typedef", "union", "unsigned", "void", "volatile", "while", "asm", "typeof", "bool", "true", "false", "nullptr", "alignas",
    "alignof", "constexpr", "static_assert", "thread_local", "and", "and_eq", "bitand", "bitor", "catch", "class", "compl", "concept",
    "delete", "dynamic_cast", "explicit", "export", "friend", "mutable", "namespace", "new", "noexcept", "not", "not_eq", "operator",
    "or", "or_eq", "private", "protected", "public", "template", "this", "throw", "try", "typeid", "typename", "using", "virtual",
    "wchar_t", "xor", "xor_eq",
    "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "exp", "log", "sqrt", "fabs", "fmin", "fmax", "pow",
    "INFINITY", "NAN", "HUGE", "HUGE_VAL", "HUGE_VALF", "HUGE_VALL", "FP_NAN", "FP_INFINITE", "FP_ZERO", "FP_SUBNORMAL", "FP_NORMAL",
    "FP_ILOGB0", "FP_ILOGBNAN", "FP_FAST_FMA", "MATH_ERRNO", "MATH_ERREXCEPT", "math_errhandling", "MAXFLOAT", "SNAN", "DOMAIN",
    "SING", "OVERFLOW", "UNDERFLOW", "TLOSS", "PLOSS", "X_TLOSS", "M_E", "M_LOG2E", "M_LOG10E", "M_LN2", "M_LN10", "M_PI", "M_PI_2",
    "M_PI_4", "M_1_PI", "M_2_PI", "M_2_SQRTPI", "M_SQRT2", "M_SQRT1_2", "linux", "unix", "i386", "near", "far", "NULL", "signgam",
    "t", "state", "input", "parameter", "history", "constant", "rate", "slope", "output", "mass", "right", "unknown", "settled", "step",
    "i", "sidc_solve", "sidc_solve_1", "sidc_solve_2", "sidc_settled", "sidc_root", "sidc_sign", "sidc_derivatives", "sidc_next", "sidc_jacobian",
    "sidc_jacobian_input", "sidc_outputs", "sidc_guards", "sidc_rates_by_side", "sidc_guard_rates", "sidc_settle", "sidc_advance",
    "side", "guard", "sidc_states", "sidc_switches", "SIDC_VERDICT", "SIDC_INPUT_DELAYS",
    "SIDC_CONSTANTS",
];

#[cfg(test)]
mod tests {
    use super::RESERVED;
    use sidc_lang::term::FUNCTIONS;

    #[test]
    fn every_function_is_reserved() {
        for f in FUNCTIONS {
            assert!(RESERVED.contains(&f.spelling.c), "{}", f.spelling.c);
        }
    }
}
