//! The declarations of the emitted functions, as a comment or a header file.
//!
//! In: a program. Out: text in which every name begins with `sidc_` or `SIDC_`; [`with_prefix`] replaces that prefix by the name of the
//! system.

use crate::caveats::{caveats, delays, verdict_summary};
use crate::code::identifiers::{ascii, plain, space_and_name};
use crate::code::parameters::{Parameters, number, numbers};
use crate::code::printer::commented;
use crate::code::program::{Function, Kind, Program};
use crate::target::{Target, Written};
use sidc_system::discovery::Discovery;

/// The type of numbers.
pub(super) const fn real(single: bool) -> &'static str {
    if single { "float" } else { "double" }
}

/// A header file with the declarations of what [`super::C`] defines.
pub(crate) struct Header<const SINGLE: bool>;

impl<const SINGLE: bool> Target for Header<SINGLE> {
    fn name(&self) -> &'static str {
        if SINGLE { "c-float-header" } else { "c-header" }
    }

    fn about(&self) -> &'static str {
        match SINGLE {
            false => "the header file of `c`",
            true => "the header file of `c-float`",
        }
    }

    fn emit(&self, d: &Discovery) -> Result<Written, String> {
        let program = Program::new(d)?;
        let mut out = head(d, &program, ": declarations of its code");
        out.push_str(" */\n#ifndef SIDC_H\n#define SIDC_H\n\n");
        out.push_str(&macros(d, &program, SINGLE));
        out.push_str("\n#ifdef __cplusplus\nextern \"C\" {\n#endif\n");
        for f in &program.functions {
            let declared = signature(&program, f, real(SINGLE));
            out.push_str(&format!("\n/* {} */\n{declared};\n", about(&program, f)));
        }
        for (declared, about) in steps(&program, real(SINGLE)) {
            out.push_str(&format!("\n/* {about} */\n{declared};\n"));
        }
        out.push_str("\n#ifdef __cplusplus\n}\n#endif\n\n#endif\n");
        Ok(with_prefix(&program, out).into())
    }
}

/// The beginning of the first comment: what this is, the verdict, what the arguments hold.
pub(super) fn head(d: &Discovery, program: &Program, what: &str) -> String {
    let system = space_and_name(program.system.as_deref());
    let mut out = format!("/* Written by sidc: the identified system{system}{what} (C99).\n *\n");
    out.push_str(&commented(" * ", caveats(d).into_iter()));
    out.push_str(" *\n");
    out.push_str(&commented(" * ", program.legend()));
    let outputs = program.outputs(d);
    if !outputs.is_empty() {
        let names = plain(&outputs.join(", "));
        out.push_str(&format!(" * output are the outputs: {names}\n"));
    }
    out
}

/// Macros: the verdict, and initialisers of arrays for delays, constants and parameters.
pub(super) fn macros(d: &Discovery, program: &Program, single: bool) -> String {
    let suffix = if single { "f" } else { "" };
    let verdict = verdict_summary(d);
    let mut out = format!("#define SIDC_VERDICT \"{verdict}\"\n");
    let delays = delays(d, &program.form.inputs);
    if !delays.is_empty() {
        let delays: Vec<String> = delays.iter().map(|t| format!("{t:?}{suffix}")).collect();
        out.push_str(&format!(
            "/* Seconds by which each input acts later, as an initialiser of an array. */\n#define SIDC_INPUT_DELAYS {{{}}}\n",
            delays.join(", ")
        ));
    }
    if !program.constants.is_empty() {
        out.push_str("/* The constants as they were found, as an initialiser of an array:\n");
        out.push_str(&commented(" * ", program.constant_lines()));
        let values = program
            .constant_values()
            .replace(", ", &format!("{suffix}, "));
        out.push_str(&format!(
            " */\n#define SIDC_CONSTANTS {{{values}{suffix}}}\n"
        ));
    }
    if !single {
        out.push_str(&parameters(d));
    }
    out
}

/// The estimated parameters as initialisers of arrays.
fn parameters(d: &Discovery) -> String {
    let parameters = Parameters::new(d);
    if parameters.is_empty() {
        return String::new();
    }
    let mut out = String::from(
        "/* The numbers that were found, as initialisers of arrays; errors are standard errors, 0 where the model states the value:\n",
    );
    out.push_str(&parameters.lines(|p| format!(" * {} of {}\n", p.name, p.about)));
    out.push_str(" */\n");
    let text = |x: &str| format!("\"{x}\"");
    let mut define = |name: &str, list: String| {
        out.push_str(&format!("#define SIDC_{name} {{{list}}}\n"));
    };
    define("PARAMETER_NAMES", parameters.list(|p| text(&p.name)));
    define(
        "PARAMETER_VALUES",
        parameters.list(|p| number(p.value, "NAN")),
    );
    define(
        "PARAMETER_ERRORS",
        parameters.list(|p| number(p.error, "NAN")),
    );
    define("PARAMETER_UNITS", parameters.list(|p| text(&p.unit)));
    if let Some(rows) = parameters.covariance() {
        define("PARAMETER_COVARIANCE", numbers(&rows.concat(), "NAN"));
    }
    let count = parameters.all.len();
    out.push_str(&format!("#define SIDC_PARAMETERS {count}\n"));
    out
}

/// What a function computes, and how its result is laid out.
pub(super) fn about(program: &Program, f: &Function) -> String {
    let about = f.kind.about(program.discrete);
    let (rows, columns) = f.size;
    match f.kind.is_matrix() {
        true => {
            let name = result(f.kind);
            format!("{about} {name}[{columns}*i + j] is row i of {rows}, column j of {columns}.")
        }
        false => format!("{about} {} has {rows} entries.", result(f.kind)),
    }
}

pub(super) fn signature(program: &Program, f: &Function, real: &str) -> String {
    let arguments = program.arguments_of(f.kind);
    let arguments: String = arguments
        .map(|a| format!(", const {real} *{}", a.name))
        .collect();
    format!(
        "void sidc_{}({real} t{arguments}, {real} *{})",
        f.kind.name(program.discrete),
        result(f.kind)
    )
}

/// The array that a function writes.
pub(super) fn result(kind: Kind) -> &'static str {
    match kind {
        Kind::Rates | Kind::RatesBySide | Kind::GuardRates => "rate",
        Kind::Guards => "guard",
        Kind::Jacobian | Kind::InputJacobian | Kind::Jumps => kind.matrix_name(),
        Kind::Outputs => "output",
    }
}

/// The declarations of the functions that advance the state by a step, each with a description.
pub(super) fn steps(program: &Program, real: &str) -> Vec<(String, &'static str)> {
    let other = program.arguments.iter().skip(1);
    let other: String = other
        .map(|a| format!(", const {real} *{}", a.name))
        .collect();
    if program.has_step() {
        let step = format!("void sidc_step({real} t, {real} h, {real} *state{other})");
        return vec![(
            step,
            "One step of length h; what is not the state is held during it.",
        )];
    }
    if program.switches.is_empty() {
        return Vec::new();
    }
    vec![
        (
            format!("void sidc_settle({real} t, const {real} *state{other}, {real} *side)"),
            "The sides of the guards to begin with.",
        ),
        (
            format!("void sidc_advance({real} t, {real} h, {real} *state{other}, {real} *side)"),
            "One step of length h, cut at the events within it.",
        ),
    ]
}

/// Makes names begin with that of the system, so that the code of several systems can be linked together.
pub(crate) fn with_prefix(program: &Program, text: String) -> String {
    let Some(system) = &program.system else {
        return text;
    };
    let prefix = ascii(system);
    let renamed = text.replace("sidc_", &format!("{prefix}_"));
    renamed.replace("SIDC_", &format!("{}_", prefix.to_uppercase()))
}
