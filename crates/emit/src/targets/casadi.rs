//! CasADi: functions of its symbols or numbers, and `casadi.Function`s of them for optimal control and estimation.
//!
//! Coupled equations are solved in symbols. Jacobians are CasADi's to take, so none are written.

use crate::caveats::{caveats, python_constants};
use crate::code::identifiers::titled;
use crate::code::infix::Syntax;
use crate::code::printer::{Dialect, Language, Printer, commented, used_helpers};
use crate::code::program::{Function, Kind, Newton, Program};
use crate::code::python_modules::{RESERVED, constants, parameters};
use crate::target::Target;
use sidc_lang::term::Func;
use sidc_system::discovery::Discovery;

pub(crate) struct Casadi;

/// The language behind the target, which refuses what symbols cannot say.
struct Symbols;

impl Target for Casadi {
    fn name(&self) -> &'static str {
        Symbols.name()
    }

    fn about(&self) -> &'static str {
        Symbols.about()
    }

    fn emit(&self, d: &Discovery) -> Result<String, String> {
        match Program::new(d)?.form.linear {
            true => Symbols.emit(d),
            false => Err("CasADi's symbols have no form for equations that are not linear in the highest derivatives; --to python solves them by Newton's method".into()),
        }
    }
}

impl Language for Symbols {
    const DIALECT: Dialect = Dialect {
        target: "casadi",
        about: "a CasADi module: functions of symbols, for optimal control",
        language: "CasADi",
        indent: "    ",
        declares: "",
        end: "",
        index: (0, "[", "]"),
        close: "",
        helpers_first: false,
        reserved: RESERVED,
    };

    fn spelling(f: Func) -> &'static str {
        match f.name {
            "sign" => "sign",
            _ => f.spelling.c,
        }
    }

    fn writes(&self, kind: Kind) -> bool {
        matches!(kind, Kind::Rates | Kind::Outputs)
    }

    fn header(&self, d: &Discovery, program: &Program) -> String {
        let system = titled(program.system.as_deref());
        let mut out = format!(
            "\"\"\"Written by sidc: the identified system{system} as code, for CasADi.\n\nThe functions take symbols (SX or MX) and numbers.\n\n"
        );
        out.push_str(&commented("", caveats(d).into_iter()));
        out.push_str("\"\"\"\nimport casadi as ca\n\n");
        out.push_str(&python_constants(d, &program.form.inputs));
        out + &constants(d, program)
    }

    fn opening(&self, program: &Program, f: &Function) -> String {
        format!(
            "\n\ndef {}({}):\n    \"\"\"{}\"\"\"\n",
            f.kind.name(program.discrete),
            parameters(program, f),
            f.kind.about(program.discrete)
        )
    }

    /// Division of Python's own numbers by zero raises an exception; a matrix's gives an infinity.
    fn bare_number(&self, number: String) -> String {
        format!("ca.DM({number})")
    }

    fn solver(&self, _: usize) -> &'static str {
        "_solve"
    }

    /// Refused before.
    fn newton(&self, _: &Printer<Self>, _: &Newton) -> String {
        String::new()
    }

    fn vector(&self, _: &Printer<Self>, entries: &[String]) -> String {
        format!("    return ca.vertcat({})\n", entries.join(", "))
    }

    fn matrix(&self, _: &Function) -> (String, String) {
        (String::new(), String::new())
    }

    fn cell(&self, _: &Function, _: usize, _: usize) -> String {
        String::new()
    }

    fn helpers(&self, program: &Program) -> String {
        used_helpers(&[(program.solves(|_| true), SOLVE)])
    }

    fn last(&self, program: &Program) -> String {
        let written = program.functions.iter().filter(|f| self.writes(f.kind));
        written.map(|f| function(program, f)).collect()
    }
}

/// The `casadi.Function` of a function, with named arguments.
fn function(program: &Program, f: &Function) -> String {
    let name = f.kind.name(program.discrete);
    let arguments: Vec<(&str, usize)> = std::iter::once(("t", 1))
        .chain(program.arguments.iter().map(|a| (a.name, a.names.len())))
        .collect();
    let symbols = arguments
        .iter()
        .map(|(name, size)| format!("ca.SX.sym(\"{name}\", {size})"));
    let names = arguments.iter().map(|(name, _)| format!("\"{name}\""));
    format!(
        "\n\ndef {name}_function():\n    \"\"\"`{name}` as a casadi.Function.\"\"\"\n    symbols = [{}]\n    \
         return ca.Function(\"{name}\", symbols, [{name}(*symbols)], [{}], [\"result\"])\n",
        symbols.collect::<Vec<_>>().join(", "),
        names.collect::<Vec<_>>().join(", ")
    )
}

impl Syntax for Symbols {
    const INFINITY: &'static str = "ca.inf";
    const NAN: &'static str = "ca.nan";

    fn function(&self, f: Func) -> String {
        format!("ca.{}", Symbols::spelling(f))
    }

    fn root(&self, x: &str) -> String {
        format!("ca.sqrt({x})")
    }

    fn power(&self, x: &str, p: &str) -> String {
        format!("ca.power({x}, {p})")
    }
}

const SOLVE: &str = "

def _solve(mass, right):
    \"\"\"Solves a small linear system, column by column of the right side.\"\"\"
    def matrix(rows):
        return ca.vertcat(*[ca.horzcat(*row) for row in rows])

    solved = ca.solve(matrix(mass), matrix(right))
    return [[solved[i, k] for k in range(solved.shape[1])] for i in range(solved.shape[0])]
";
