//! Modelica: a model with the equations as they were found, implicit ones too.
//!
//! Delayed inputs go through `delay`. Discrete time is refused.

use crate::caveats::{caveats, delays, verdict_summary};
use crate::code::equation_list::{check_continuous, equation_list};
use crate::code::identifiers::{Identifiers, plain, space_and_name};
use crate::code::infix::{Infix, Syntax};
use crate::code::printer::commented;
use crate::code::program::Program;
use crate::target::{Target, Written};
use sidc_lang::term::Signal;
use sidc_system::discovery::Discovery;

pub(crate) struct Modelica;

impl Target for Modelica {
    fn name(&self) -> &'static str {
        "modelica"
    }

    fn about(&self) -> &'static str {
        "a Modelica model: the equations as found, delays of inputs"
    }

    fn emit(&self, d: &Discovery) -> Result<Written, String> {
        let program = Program::new(d)?;
        program.refuse_jumps("Modelica")?;
        check_continuous("Modelica", &program)?;
        let mut names = program.identifiers(d, RESERVED);
        let system = names.fresh(program.system.as_deref().unwrap_or("identified"));
        let body = program.sides()?;
        let infix = Infix::new(&Words, &body, &names);
        let all = equation_list(&program, &body, &infix);

        let mut model = Model {
            d,
            program: &program,
            infix: &infix,
            commands: names.clone(),
            out: String::new(),
            equations: String::new(),
        };
        model.constants();
        model.inputs();
        model.variables(&all.rates, &all.laws, &all.outputs);
        if body.mentions_time() {
            model.out.push_str("  Real t = time;\n");
        }
        for (name, _) in &all.named {
            model.out.push_str(&format!("  Real {name};\n"));
        }
        model.equal(&all.named);
        for (state, rate) in &all.rates {
            model
                .equations
                .push_str(&format!("  der({state}) = {rate};\n"));
        }
        model.equal(&all.laws);
        model.equal(&all.outputs);
        let title = space_and_name(program.system.as_deref());
        let head = commented("// ", caveats(d).into_iter());
        Ok(format!(
            "// Written by sidc: the identified system{title} (Modelica).\n//\n{head}model {system}\n{}equation\n{}end {system};\n",
            model.out, model.equations
        )
        .into())
    }
}

struct Model<'a> {
    d: &'a Discovery,
    program: &'a Program,
    infix: &'a Infix<'a, Words>,
    /// Finds free names for the commands of delayed inputs.
    commands: Identifiers,
    /// Declarations.
    out: String,
    equations: String,
}

impl Model<'_> {
    fn constants(&mut self) {
        let verdict = verdict_summary(self.d);
        self.out.push_str(&format!(
            "  constant String SIDC_VERDICT = \"{verdict}\";\n"
        ));
        let form = &self.program.form;
        for (s, constant) in form.constants.iter().zip(&self.program.constants) {
            let (name, unit) = (self.infix.signal(*s), self.unit(*s));
            self.out.push_str(&format!(
                "  parameter Real {name}{unit} = {:?} \"{}\";\n",
                constant.value, constant.about
            ));
        }
        for s in &form.params {
            let (name, unit) = (self.infix.signal(*s), self.unit(*s));
            self.out
                .push_str(&format!("  parameter Real {name}{unit};\n"));
        }
    }

    /// Inputs under their names in the model; a delayed input takes its command under another name.
    fn inputs(&mut self) {
        let form = &self.program.form;
        let delays = delays(self.d, &form.inputs);
        for (i, s) in form.inputs.iter().enumerate() {
            let (name, unit) = (self.infix.signal(*s), self.unit(*s));
            match delays.get(i).copied().filter(|delay| *delay != 0.0) {
                None => self.out.push_str(&format!("  input Real {name}{unit};\n")),
                Some(delay) => {
                    let command = self.commands.fresh(&format!("{name}_command"));
                    self.out.push_str(&format!(
                        "  input Real {command}{unit} \"{name} before its delay\";\n  Real {name}{unit};\n"
                    ));
                    self.equations
                        .push_str(&format!("  {name} = delay({command}, {delay:?});\n"));
                }
            }
        }
    }

    fn variables(
        &mut self,
        rates: &[(String, String)],
        laws: &[(String, String)],
        outputs: &[(String, String)],
    ) {
        let form = &self.program.form;
        for (s, (name, _)) in form.state.iter().zip(rates) {
            let unit = self.unit(*s);
            self.out.push_str(&format!("  Real {name}{unit};\n"));
        }
        for (s, (name, _)) in form.unknowns.iter().zip(laws) {
            let unit = self.unit(*s);
            self.out.push_str(&format!("  Real {name}{unit};\n"));
        }
        for ((s, _), (name, _)) in form.outputs.iter().zip(outputs) {
            let unit = self.unit(*s);
            self.out.push_str(&format!("  output Real {name}{unit};\n"));
        }
    }

    fn equal(&mut self, all: &[(String, String)]) {
        for (left, right) in all {
            self.equations.push_str(&format!("  {left} = {right};\n"));
        }
    }

    /// `(unit="m.s-1")`; a display unit if Modelica cannot read the unit, empty if there is none.
    fn unit(&self, s: Signal) -> String {
        let Some(unit) = self.d.unit(s) else {
            return String::new();
        };
        let unit = unit.to_string().replace('^', "").replace('*', ".");
        let reads = |c: char| c.is_ascii_alphanumeric() || matches!(c, '.' | '-' | '/' | '(' | ')');
        match unit.chars().all(reads) {
            true => format!("(unit=\"{unit}\")"),
            false => format!("(displayUnit=\"{}\")", plain(&unit)),
        }
    }
}

struct Words;

impl Syntax for Words {
    const INFINITY: &'static str = "Modelica.Constants.inf";
    const NAN: &'static str = "(0.0 / 0.0)";

    fn power(&self, x: &str, p: &str) -> String {
        format!("({x}) ^ ({p})")
    }
}

/// Keywords and functions of Modelica (Language Specification 3.6, 2.3.3 and 3.7).
#[rustfmt::skip]
pub(super) const RESERVED: &[&str] = &[
    "algorithm", "and", "annotation", "block", "break", "class", "connect", "connector", "constant", "constrainedby", "der", "discrete",
    "each", "else", "elseif", "elsewhen", "encapsulated", "end", "enumeration", "equation", "expandable", "extends", "external", "false",
    "final", "flow", "for", "function", "if", "import", "impure", "in", "initial", "inner", "input", "loop", "model", "not", "operator",
    "or", "outer", "output", "package", "parameter", "partial", "protected", "public", "pure", "record", "redeclare", "replaceable",
    "return", "stream", "then", "true", "type", "when", "while", "within",
    "abs", "sign", "sqrt", "div", "mod", "rem", "ceil", "floor", "integer", "sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sinh",
    "cosh", "tanh", "exp", "log", "log10", "min", "max", "delay", "cardinality", "homotopy", "sample", "pre", "edge", "change", "reinit",
    "noEvent", "smooth", "terminal", "time", "t", "sum", "product", "size", "fill", "zeros", "ones", "identity", "diagonal", "transpose",
    "cross", "skew", "vector", "matrix", "scalar", "Real", "Integer", "Boolean", "String", "Modelica", "SIDC_VERDICT",
];
