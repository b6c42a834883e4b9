//! JAX: a module of functions of time, state and input that `jit`, `vmap` and `jacfwd` take.
//!
//! Coupled equations are solved at every call. Jacobians are JAX's to take, so none are written.

use crate::caveats::{caveats, python_constants};
use crate::code::bracket_lists::unpacked_names;
use crate::code::identifiers::titled;
use crate::code::infix::Syntax;
use crate::code::printer::{Dialect, Language, Printer, commented, used_helpers};
use crate::code::program::{Function, Kind, Newton, Program, Step};
use crate::code::python_modules::{RESERVED, constants, parameters};
use sidc_lang::term::Func;
use sidc_system::discovery::Discovery;

pub(crate) struct Jax;

impl Language for Jax {
    const DIALECT: Dialect = Dialect {
        target: "jax",
        about: "a JAX module: functions for jit, vmap, grad and diffrax",
        language: "JAX",
        indent: "    ",
        declares: "",
        end: "",
        index: (0, "[", "]"),
        close: "",
        helpers_first: false,
        reserved: RESERVED,
    };

    fn spelling(f: Func) -> &'static str {
        f.spelling.numpy
    }

    fn writes(&self, kind: Kind) -> bool {
        matches!(kind, Kind::Rates | Kind::Outputs)
    }

    fn header(&self, d: &Discovery, program: &Program) -> String {
        let system = titled(program.system.as_deref());
        let mut out =
            format!("\"\"\"Written by sidc: the identified system{system} as code, for JAX.\n");
        if let Some(rates) = program.get(Kind::Rates) {
            let name = rates.kind.name(program.discrete);
            out.push_str(&format!(
                "\n    jax.jacfwd({name}, 1)({})  # by the state\n",
                parameters(program, rates)
            ));
        }
        out.push_str("\nNumbers are 32 bits wide unless jax.config.update(\"jax_enable_x64\", True) was called.\n\n");
        out.push_str(&commented("", caveats(d).into_iter()));
        out.push_str("\"\"\"\nimport jax\nimport jax.numpy as jnp\n\n");
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

    /// Division of Python's own numbers by zero raises an exception; an array's gives an infinity.
    fn bare_number(&self, number: String) -> String {
        format!("jnp.asarray({number})")
    }

    fn solver(&self, _: usize) -> &'static str {
        "_solve"
    }

    fn newton(&self, p: &Printer<Self>, n: &Newton) -> String {
        format!(
            "\n    def step(unknown):\n        {} = unknown\n{}        return {}\n\n    {} = _newton(step, {})\n",
            unpacked_names(&p.infix, &n.used_inside),
            p.named_inside(n),
            p.solver_call(&n.mass, &n.right, 2),
            unpacked_names(&p.infix, &n.used_after),
            n.signals.len()
        )
    }

    fn vector(&self, _: &Printer<Self>, entries: &[String]) -> String {
        format!(
            "    return jnp.stack(jnp.broadcast_arrays({}))\n",
            entries.join(", ")
        )
    }

    fn matrix(&self, _: &Function) -> (String, String) {
        (String::new(), String::new())
    }

    fn cell(&self, _: &Function, _: usize, _: usize) -> String {
        String::new()
    }

    fn helpers(&self, program: &Program) -> String {
        let newton = program.makes(|s| matches!(s, Step::Newton(_)));
        used_helpers(&[(program.solves(|_| true), SOLVE), (newton, NEWTON)])
    }
}

impl Syntax for Jax {
    const INFINITY: &'static str = "jnp.inf";
    const NAN: &'static str = "jnp.nan";

    fn function(&self, f: Func) -> String {
        format!("jnp.{}", f.spelling.numpy)
    }

    fn root(&self, x: &str) -> String {
        format!("jnp.sqrt({x})")
    }

    fn power(&self, x: &str, p: &str) -> String {
        format!("jnp.power({x}, {p})")
    }
}

const SOLVE: &str = "

def _matrix(rows):
    return jnp.stack([jnp.stack(jnp.broadcast_arrays(*map(jnp.asarray, row))) for row in rows])


def _solve(mass, right):
    \"\"\"Solves a small linear system, column by column of the right side; not finite where it is singular.\"\"\"
    return jnp.linalg.solve(_matrix(mass), _matrix(right))
";

/// A loop of fixed length has derivatives in both directions.
const NEWTON: &str = "

def _newton(step, size):
    \"\"\"Repeats the solve from zero on, fifty times; NaN if the unknowns do not stay.\"\"\"
    unknown = jax.lax.fori_loop(0, 50, lambda _, unknown: step(unknown)[:, 0], jnp.zeros(size))
    moved = jnp.max(jnp.abs(step(unknown)[:, 0] - unknown))
    tolerance = 64 * jnp.finfo(unknown.dtype).eps * jnp.max(jnp.abs(unknown))
    return jnp.where(moved <= tolerance, unknown, jnp.nan)
";
