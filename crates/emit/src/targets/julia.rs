//! Julia: a ModelingToolkit system with the equations as they were found.
//!
//! Discrete time is refused.

use crate::caveats::{caveats, delays, verdict_summary};
use crate::code::equation_list::{check_continuous, equation_list};
use crate::code::identifiers::space_and_name;
use crate::code::infix::{Infix, Syntax};
use crate::code::printer::commented;
use crate::code::program::Program;
use crate::target::{Target, Written};
use sidc_lang::term::Signal;
use sidc_system::discovery::Discovery;

pub(crate) struct Julia;

impl Target for Julia {
    fn name(&self) -> &'static str {
        "julia"
    }

    fn about(&self) -> &'static str {
        "a ModelingToolkit system in Julia: the equations as found"
    }

    fn emit(&self, d: &Discovery) -> Result<Written, String> {
        let program = Program::new(d)?;
        program.refuse_jumps("Julia")?;
        check_continuous("ModelingToolkit", &program)?;
        let mut names = program.identifiers(d, RESERVED);
        let system = names.fresh(program.system.as_deref().unwrap_or("identified"));
        let body = program.sides()?;
        let infix = Infix::new(&Words, &body, &names);
        let all = equation_list(&program, &body, &infix);
        let equal = |(left, right): &(String, String)| format!("    ({left} ~ {right}),\n");
        let rate = |(left, right): &(String, String)| format!("    (D({left}) ~ {right}),\n");
        let let_ = |(name, value): &(String, String)| format!("{name} = {value}\n");
        let mut out = header(d, &program);
        out.push_str(&declarations(&program, &infix));
        out.extend(all.named.iter().map(let_));
        out.push_str("\nequations = [\n");
        out.extend(all.rates.iter().map(rate));
        out.extend(all.laws.iter().chain(&all.outputs).map(equal));
        out.push_str(&format!("]\n@named {system} = ODESystem(equations, t)\n"));
        Ok(out.into())
    }
}

fn header(d: &Discovery, program: &Program) -> String {
    let title = space_and_name(program.system.as_deref());
    let mut out =
        format!("# Written by sidc: the identified system{title}, for ModelingToolkit.\n#\n");
    out.push_str(&commented("# ", caveats(d).into_iter()));
    out.push_str(
        "using ModelingToolkit\nusing ModelingToolkit: t_nounits as t, D_nounits as D\n\n",
    );
    out.push_str(&format!(
        "const SIDC_VERDICT = \"{}\"\n",
        verdict_summary(d)
    ));
    let delays = delays(d, &program.form.inputs);
    if !delays.is_empty() {
        out.push_str(&format!("const SIDC_INPUT_DELAYS = {delays:?}\n"));
    }
    out
}

/// A line for each parameter and for each variable.
fn declarations(program: &Program, infix: &Infix<Words>) -> String {
    let form = &program.form;
    let mut out = String::new();
    for (s, constant) in form.constants.iter().zip(&program.constants) {
        let name = infix.signal(*s);
        out.push_str(&format!(
            "@parameters {name} = {:?}  # {}\n",
            constant.value, constant.about
        ));
    }
    for s in &form.params {
        out.push_str(&format!("@parameters {}\n", infix.signal(*s)));
    }
    for s in &form.inputs {
        let name = infix.signal(*s);
        out.push_str(&format!("@variables {name}(t) [input = true]\n"));
    }
    let outputs: Vec<Signal> = form.outputs.iter().map(|(s, _)| *s).collect();
    for s in form.state.iter().chain(&form.unknowns).chain(&outputs) {
        out.push_str(&format!("@variables {}(t)\n", infix.signal(*s)));
    }
    out
}

struct Words;

impl Syntax for Words {
    const INFINITY: &'static str = "Inf";
    const NAN: &'static str = "NaN";

    fn power(&self, x: &str, p: &str) -> String {
        format!("({x})^({p})")
    }
}

/// Keywords of Julia, and names in the emitted code.
#[rustfmt::skip]
pub(super) const RESERVED: &[&str] = &[
    "baremodule", "begin", "break", "catch", "const", "continue", "do", "else", "elseif", "end", "export", "false", "finally", "for",
    "function", "global", "if", "import", "in", "isa", "let", "local", "macro", "module", "mutable", "public", "quote", "return", "struct",
    "true", "try", "type", "using", "where", "while", "abstract", "primitive", "im", "pi", "e", "Inf", "NaN",
    "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "exp", "log", "sqrt", "abs", "sign", "min", "max",
    "t", "D", "equations", "ModelingToolkit", "ODESystem", "SIDC_VERDICT", "SIDC_INPUT_DELAYS",
];
