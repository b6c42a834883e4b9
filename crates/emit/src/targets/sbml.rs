//! SBML, level 3 version 2: parameters with rate rules, for the simulators and databases of systems biology.
//!
//! Discrete time is refused, and so are equations that have to be solved together, which few simulators support.

use crate::caveats::{caveats, verdict_summary};
use crate::code::equation_list::check_continuous;
use crate::code::identifiers::{Identifiers, ascii, plain};
use crate::code::infix::BodyNames;
use crate::code::program::{Body, Name, Program, Step};
use crate::target::{Target, Written};
use sidc_lang::term::{Func, Node, Signal};
use sidc_system::discovery::Discovery;

pub(crate) struct Sbml;

impl Target for Sbml {
    fn name(&self) -> &'static str {
        "sbml"
    }

    fn about(&self) -> &'static str {
        "SBML level 3 with rate rules, for COPASI, tellurium and the like"
    }

    fn emit(&self, d: &Discovery) -> Result<Written, String> {
        let program = Program::new(d)?;
        program.refuse_jumps("SBML")?;
        check_continuous("SBML", &program)?;
        let identifiers = program.identifiers(d, RESERVED);
        let body = program.formulas()?;
        let mut document = Document::default();
        document.given(&program, &identifiers);
        let math = Math {
            names: BodyNames::new(&body, &identifiers),
            body: &body,
        };
        math.steps(&mut document)?;
        let mut results = body.results.iter().flatten();
        for (x, node) in program.form.state.iter().zip(results.by_ref()) {
            document.rule("rateRule", identifiers.get(*x), &math.text(*node));
        }
        for ((s, _), node) in program.form.outputs.iter().zip(results) {
            document.computed(identifiers.get(*s), &math.text(*node));
        }
        let id = ascii(program.system.as_deref().unwrap_or("identified"));
        Ok(document.written(d, &id, program.system.as_deref()).into())
    }
}

/// Parameters and rules.
#[derive(Default)]
struct Document {
    parameters: String,
    rules: String,
}

impl Document {
    /// What no formula gives. Inputs and parameters have to be set for a simulation.
    fn given(&mut self, program: &Program, names: &Identifiers) {
        let form = &program.form;
        for s in form.state.iter().chain(&form.inputs).chain(&form.history) {
            self.variable(names.get(*s), " value=\"0\"");
        }
        for s in &form.params {
            self.constant(names.get(*s), f64::NAN);
        }
        for (s, constant) in form.constants.iter().zip(&program.constants) {
            self.constant(names.get(*s), constant.value);
        }
    }

    fn variable(&mut self, id: &str, value: &str) {
        self.parameters.push_str(&format!(
            "      <parameter id=\"{id}\"{value} constant=\"false\"/>\n"
        ));
    }

    fn constant(&mut self, id: &str, value: f64) {
        let value = match value.is_nan() {
            true => String::new(),
            false => format!(" value=\"{value:?}\""),
        };
        self.parameters.push_str(&format!(
            "      <parameter id=\"{id}\"{value} constant=\"true\"/>\n"
        ));
    }

    /// A variable that a formula gives.
    fn computed(&mut self, id: &str, math: &str) {
        self.variable(id, "");
        self.rule("assignmentRule", id, math);
    }

    fn rule(&mut self, kind: &str, id: &str, math: &str) {
        self.rules.push_str(&format!(
            "      <{kind} variable=\"{id}\">\n        <math xmlns=\"http://www.w3.org/1998/Math/MathML\">{math}</math>\n      </{kind}>\n"
        ));
    }

    fn written(&self, d: &Discovery, id: &str, name: Option<&str>) -> String {
        let lines = caveats(d).into_iter().map(|line| escaped(&line));
        let lines: String = lines
            .map(|line| format!("        <p>{line}</p>\n"))
            .collect();
        let name = name.map_or_else(String::new, |n| format!(" name=\"{}\"", escaped(&plain(n))));
        let rules = match self.rules.is_empty() {
            true => String::new(),
            false => format!("    <listOfRules>\n{}    </listOfRules>\n", self.rules),
        };
        format!(
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
             <sbml xmlns=\"http://www.sbml.org/sbml/level3/version2/core\" level=\"3\" version=\"2\">\n\
             \x20 <model id=\"{id}\"{name}>\n    <notes>\n      <body xmlns=\"http://www.w3.org/1999/xhtml\">\n\
             \x20       <p>Written by sidc. SIDC_VERDICT: {}</p>\n{lines}      </body>\n    </notes>\n\
             \x20   <listOfParameters>\n{}    </listOfParameters>\n{rules}  </model>\n</sbml>\n",
            escaped(&verdict_summary(d)),
            self.parameters
        )
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

/// Content MathML of the nodes of a body.
struct Math<'a> {
    names: BodyNames,
    body: &'a Body,
}

impl Math<'_> {
    /// A parameter and a rule for each step.
    ///
    /// # Errors
    /// Equations that are solved together.
    fn steps(&self, document: &mut Document) -> Result<(), String> {
        for step in &self.body.steps {
            let (name, math) = match step {
                Step::Let(name, node) => (self.names.name(*name), self.value(*node)),
                Step::Solve(solve) => match (
                    solve.mass.as_slice(),
                    solve.right.as_slice(),
                    solve.signals.as_slice(),
                ) {
                    ([mass], [right], [signals]) => {
                        match (mass.as_slice(), right.as_slice(), signals.as_slice()) {
                            ([mass], [right], [Some(signal)]) => (
                                self.names.name(Name::Signal(*signal)),
                                apply("divide", &[self.text(*right), self.text(*mass)]),
                            ),
                            _ => return Err(COUPLED_REFUSED.into()),
                        }
                    }
                    _ => return Err(COUPLED_REFUSED.into()),
                },
                Step::Newton(_) => return Err(COUPLED_REFUSED.into()),
            };
            document.computed(&name, &math);
        }
        Ok(())
    }

    /// The name of a node, or else its value.
    fn text(&self, node: usize) -> String {
        match self.names.node(node) {
            None => self.value(node),
            Some(name) => format!("<ci>{name}</ci>"),
        }
    }

    fn texts(&self, nodes: &[usize]) -> Vec<String> {
        nodes.iter().map(|n| self.text(*n)).collect()
    }

    fn signal(&self, s: Signal) -> String {
        if s == Signal::TIME {
            return "<csymbol encoding=\"text\" definitionURL=\"http://www.sbml.org/sbml/symbols/time\">t</csymbol>".into();
        }
        format!("<ci>{}</ci>", self.names.signal(s))
    }

    fn value(&self, node: usize) -> String {
        match self.body.nodes().get(node) {
            None => String::new(),
            Some(Node::Input(row)) => self.signal(self.body.input(*row)),
            Some(Node::Number(bits)) => number(f64::from_bits(*bits)),
            Some(Node::Product(a, b)) => apply("times", &self.texts(&[*a, *b])),
            Some(Node::Reciprocal(a)) => apply("divide", &[number(1.0), self.text(*a)]),
            Some(Node::Root(a)) => apply("root", &[self.text(*a)]),
            Some(Node::Power(a, p)) => apply("power", &[self.text(*a), number(f64::from_bits(*p))]),
            Some(Node::SymbolicPower(a, p)) => apply("power", &self.texts(&[*a, *p])),
            Some(Node::Call(f, arguments)) => call(*f, &self.texts(arguments)),
            Some(Node::Sum(start, parts)) => {
                let start = f64::from_bits(*start);
                let first = (start != 0.0).then(|| number(start));
                let rest = parts
                    .iter()
                    .map(|(weight, node)| match f64::from_bits(*weight) {
                        1.0 => self.text(*node),
                        weight => apply("times", &[number(weight), self.text(*node)]),
                    });
                apply("plus", &first.into_iter().chain(rest).collect::<Vec<_>>())
            }
        }
    }
}

const COUPLED_REFUSED: &str = "SBML has rates that are formulas, and these equations are solved together; --to modelica writes them as they were found";

fn apply(operator: &str, arguments: &[String]) -> String {
    format!("<apply><{operator}/>{}</apply>", arguments.concat())
}

fn number(x: f64) -> String {
    let text = format!("{x:?}");
    match text.split_once('e') {
        _ if x.is_nan() => "<notanumber/>".into(),
        _ if x == f64::INFINITY => "<infinity/>".into(),
        _ if x == f64::NEG_INFINITY => apply("minus", &["<infinity/>".into()]),
        Some((digits, power)) => format!("<cn type=\"e-notation\">{digits}<sep/>{power}</cn>"),
        None => format!("<cn>{text}</cn>"),
    }
}

fn call(f: Func, arguments: &[String]) -> String {
    match (f.name, arguments) {
        ("asin" | "acos" | "atan", _) => apply(&f.name.replacen('a', "arc", 1), arguments),
        ("log", _) => apply("ln", arguments),
        ("sqrt", _) => apply("root", arguments),
        ("sign", [x]) => {
            let piece = |value: &str, relation: &str| {
                let holds = apply(relation, &[x.clone(), number(0.0)]);
                format!("<piece><cn>{value}</cn>{holds}</piece>")
            };
            let (above, below) = (piece("1", "gt"), piece("-1", "lt"));
            format!("<piecewise>{above}{below}<otherwise><cn>0</cn></otherwise></piecewise>")
        }
        (name, _) => apply(name, arguments),
    }
}

/// Words that the formula parsers of simulators take for something else.
#[rustfmt::skip]
pub(super) const RESERVED: &[&str] = &[
    "time", "t", "pi", "avogadro", "delay", "rateOf", "true", "false", "infinity", "notanumber", "exponentiale",
    "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "exp", "log", "ln", "sqrt", "abs", "sign", "min", "max",
];
