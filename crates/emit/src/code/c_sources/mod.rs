//! C99: functions of time, state and input that need nothing but `math.h`, in double or single precision.
//!
//! Coupled equations are solved by elimination in the emitted code, by Newton's method where they are not linear in
//! the highest derivatives. Compiles without a warning under `-std=c99 -Wall -Wextra -pedantic`.

mod declarations;
mod helpers;
mod reserved;

use crate::code::infix::{Infix, Syntax};
use crate::code::printer::{Dialect, Language, Printer, fill_placeholders, used_helpers};
use crate::code::program::{Function, Newton, Program, Solve, Step};
pub(crate) use declarations::Header;
pub(crate) use declarations::with_prefix;
use declarations::{about, head, macros, real, result, signature, steps};
use helpers::{NEWTON, ROOT, SIGN, SOLVE, SOLVE_1, SOLVE_2, STEP, STEPS, in_single};
use reserved::RESERVED;
use sidc_lang::term::{Func, Node};
use sidc_system::discovery::Discovery;

pub(crate) struct C<const SINGLE: bool>;

impl<const SINGLE: bool> Language for C<SINGLE> {
    const DIALECT: Dialect = Dialect {
        target: if SINGLE { "c-float" } else { "c" },
        about: if SINGLE {
            "the same in single precision, for controllers"
        } else {
            "C99 functions of time, state and input, their Jacobians, a step; math.h alone"
        },
        language: "C",
        indent: "    ",
        declares: if SINGLE {
            "const float "
        } else {
            "const double "
        },
        end: ";",
        index: (0, "[", "]"),
        close: "}\n",
        helpers_first: true,
        reserved: RESERVED,
    };

    fn spelling(f: Func) -> &'static str {
        f.spelling.c
    }

    fn check(&self, program: &Program) -> Result<(), String> {
        if !SINGLE {
            return Ok(());
        }
        if !program.switches.is_empty() {
            return Err("the steps from event to event of equations that jump need double precision: take `c`".into());
        }
        let far = |x: f64| x.is_finite() && x != 0.0 && !(x as f32).is_normal();
        match program.computes(|n| matches!(n, Node::Number(bits) if far(f64::from_bits(*bits)))) {
            true => Err("a number of the equations is beyond the range of single precision: measure in other units, or take `c`".into()),
            false => Ok(()),
        }
    }

    fn header(&self, d: &Discovery, program: &Program) -> String {
        let mut out = head(d, program, " as code");
        out.push_str(" *\n");
        let functions = program.functions.iter();
        let functions = functions.map(|f| signature(program, f, real(SINGLE)));
        let steps = steps(program, real(SINGLE))
            .into_iter()
            .map(|(step, _)| step);
        for declared in functions.chain(steps) {
            out.push_str(&format!(" * {declared};\n"));
        }
        out.push_str(" */\n#include <math.h>\n\n");
        out + &macros(d, program, SINGLE)
    }

    fn opening(&self, program: &Program, f: &Function) -> String {
        let (about, declared) = (about(program, f), signature(program, f, real(SINGLE)));
        let mut out = format!("\n/* {about} */\n{declared}\n{{\n");
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
        let mut out = format!("    {} {};\n    {{\n", real(SINGLE), names.join(", "));
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
        let zeros = vec![self.finite(0.0); size].join(", ");
        let real = real(SINGLE);
        format!(
            "    {real} unknown[] = {{{zeros}}};\n    int settled = 0;\n    \
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
            "    for (int i = 0; i < {}; i++) {{\n        {}[i] = {};\n    }}\n",
            rows * columns,
            result(f.kind),
            self.finite(0.0)
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
        let arguments = (declared.collect(), passed.collect());
        in_precision(
            SINGLE,
            match program.has_step() {
                true => fill_placeholders(program, STEP, arguments),
                false if program.switches.is_empty() => String::new(),
                false => fill_placeholders(program, STEPS, arguments),
            },
        )
    }

    fn helpers(&self, program: &Program) -> String {
        let newton = program.makes(|s| matches!(s, Step::Newton(_)));
        let sign = program.calls().iter().any(|f| f.spelling.c == "sidc_sign");
        in_precision(
            SINGLE,
            used_helpers(&[
                (program.computes(|n| matches!(n, Node::Root(_))), ROOT),
                (sign, SIGN),
                (program.solves(|n| n == 1), SOLVE_1),
                (program.solves(|n| n == 2), SOLVE_2),
                (program.solves(|n| n > 2), SOLVE),
                (newton, NEWTON),
            ]),
        )
    }

    fn finished(&self, program: &Program, text: String) -> String {
        with_prefix(program, text)
    }
}

fn in_precision(single: bool, text: String) -> String {
    if single { in_single(&text) } else { text }
}

impl<const SINGLE: bool> Syntax for C<SINGLE> {
    const INFINITY: &'static str = "INFINITY";
    const NAN: &'static str = "NAN";

    fn finite(&self, x: f64) -> String {
        match SINGLE {
            true => format!("{:?}f", x as f32),
            false => format!("{x:?}"),
        }
    }

    fn function(&self, f: Func) -> String {
        match SINGLE && !f.spelling.c.starts_with("sidc_") {
            true => format!("{}f", f.spelling.c),
            false => f.spelling.c.into(),
        }
    }

    fn root(&self, x: &str) -> String {
        format!("sidc_root({x})")
    }

    fn power(&self, x: &str, p: &str) -> String {
        let pow = if SINGLE { "powf" } else { "pow" };
        format!("{pow}({x}, {p})")
    }
}

fn system<const SINGLE: bool>(
    infix: &Infix<C<SINGLE>>,
    mass: &[Vec<usize>],
    right: &[Vec<usize>],
) -> String {
    let columns = right.first().map_or(0, Vec::len);
    let matrix = |name: &str, rows: &[Vec<usize>]| {
        let rows: Vec<String> = rows
            .iter()
            .map(|row| format!("            {}", infix.texts(row).join(", ")))
            .collect();
        format!(
            "        {} {name}[] = {{\n{}\n        }};\n",
            real(SINGLE),
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

/// The beginning of the call. Systems of one and of two unknowns have solvers of their own.
fn solver(n: usize) -> String {
    match n {
        1 | 2 => format!("sidc_solve_{n}("),
        n => format!("sidc_solve({n}, "),
    }
}
