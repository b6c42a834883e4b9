//! JAX: a module of functions of time, state and input that `jit`, `vmap` and `jacfwd` take.
//!
//! Coupled equations are solved at every call. JAX differentiates by itself, so no Jacobians are written.

use crate::caveats::{caveats, python_constants};
use crate::code::autodiff_modules::Autodiff;
use crate::code::identifiers::space_and_name;
use crate::code::printer::{Dialect, commented};
use crate::code::program::{Kind, Program};
use crate::code::python_modules::{constants, dialect, parameters};
use sidc_lang::term::Func;
use sidc_system::discovery::Discovery;

pub(crate) struct Jax;

impl Autodiff for Jax {
    const DIALECT: Dialect = dialect(
        "jax",
        "a JAX module: functions for jit, vmap, grad and diffrax",
        "JAX",
    );
    const MODULE: &'static str = "jnp";
    const NUMBER: &'static str = "jnp.asarray";
    const INFINITY: &'static str = "jnp.inf";
    const NAN: &'static str = "jnp.nan";
    const SOLVE: &'static str = SOLVE;
    const NEWTON: Result<&'static str, &'static str> = Ok(NEWTON);

    fn spelling(f: Func) -> &'static str {
        f.spelling.numpy
    }

    fn header(d: &Discovery, program: &Program) -> String {
        let system = space_and_name(program.system.as_deref());
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

    fn vector(entries: &str) -> String {
        format!("jnp.stack(jnp.broadcast_arrays({entries}))")
    }
}

const SOLVE: &str = "

def _matrix(rows):
    return jnp.stack([jnp.stack(jnp.broadcast_arrays(*map(jnp.asarray, row))) for row in rows])


def _solve(mass, right):
    \"\"\"Solves a small linear system, column by column of the right side; not finite where it is singular.\"\"\"
    return jnp.linalg.solve(_matrix(mass), _matrix(right))
";

/// JAX differentiates a loop of fixed length in forward and in reverse mode.
const NEWTON: &str = "

def _newton(step, size):
    \"\"\"Repeats the solve from zero on, fifty times; NaN if the unknowns do not stay.\"\"\"
    unknown = jax.lax.fori_loop(0, 50, lambda _, unknown: step(unknown)[:, 0], jnp.zeros(size))
    moved = jnp.max(jnp.abs(step(unknown)[:, 0] - unknown))
    tolerance = 64 * jnp.finfo(unknown.dtype).eps * jnp.max(jnp.abs(unknown))
    return jnp.where(moved <= tolerance, unknown, jnp.nan)
";
