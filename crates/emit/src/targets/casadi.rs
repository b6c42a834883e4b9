//! CasADi: functions of its symbols or numbers, and `casadi.Function`s of them for optimal control and estimation.
//!
//! Coupled equations are solved in symbols. CasADi differentiates by itself, so no Jacobians are written.

use crate::caveats::{caveats, python_constants};
use crate::code::autodiff_modules::Autodiff;
use crate::code::identifiers::space_and_name;
use crate::code::printer::{Dialect, commented};
use crate::code::program::{Function, Program};
use crate::code::python_modules::{constants, dialect};
use sidc_lang::term::Func;
use sidc_system::discovery::Discovery;

pub(crate) struct Casadi;

impl Autodiff for Casadi {
    const DIALECT: Dialect = dialect(
        "casadi",
        "a CasADi module: functions of symbols, for optimal control",
        "CasADi",
    );
    const MODULE: &'static str = "ca";
    const NUMBER: &'static str = "ca.DM";
    const INFINITY: &'static str = "ca.inf";
    const NAN: &'static str = "ca.nan";
    const SOLVE: &'static str = SOLVE;
    const NEWTON: Result<&'static str, &'static str> = Err(
        "CasADi's symbols have no form for equations that are not linear in the highest derivatives; --to python solves them by Newton's method",
    );

    fn spelling(f: Func) -> &'static str {
        match f.name {
            "sign" => "sign",
            _ => f.spelling.c,
        }
    }

    fn header(d: &Discovery, program: &Program) -> String {
        let system = space_and_name(program.system.as_deref());
        let mut out = format!(
            "\"\"\"Written by sidc: the identified system{system} as code, for CasADi.\n\nThe functions take symbols (SX or MX) and numbers.\n\n"
        );
        out.push_str(&commented("", caveats(d).into_iter()));
        out.push_str("\"\"\"\nimport casadi as ca\n\n");
        out.push_str(&python_constants(d, &program.form.inputs));
        out + &constants(d, program)
    }

    fn vector(entries: &str) -> String {
        format!("ca.vertcat({entries})")
    }

    /// The `casadi.Function` of a function, with named arguments.
    fn last(program: &Program, f: &Function) -> String {
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
}

const SOLVE: &str = "

def _solve(mass, right):
    \"\"\"Solves a small linear system, column by column of the right side.\"\"\"
    def matrix(rows):
        return ca.vertcat(*[ca.horzcat(*row) for row in rows])

    solved = ca.solve(matrix(mass), matrix(right))
    return [[solved[i, k] for k in range(solved.shape[1])] for i in range(solved.shape[0])]
";
