//! A system as straight-line code, independent of any language.
//!
//! In: a [`Discovery`]. Out: the arguments in their order, and a [`Function`] for the rates, the outputs, and the
//! Jacobians of the rates. Targets only write this down.

mod definitions;
mod implicit_differentiation;
mod kind;
mod lowering;
mod schedule;
mod statements;
mod strong_components;

pub(crate) use kind::Kind;
pub(crate) use statements::{Argument, Body, Name, Newton, Solve, Step};

use definitions::Definitions;
use lowering::Scope;

use crate::code::identifiers::{Identifiers, comment_safe, plain};
use crate::unknown_constants;
use sidc_lang::term::{Expr, Func, Node, Signal, SignalNames};
use sidc_system::discovery::{Discovery, Form, Rate};
use sidc_system::switching::Switches;

const NOT_GIVEN: &str =
    "an equation mentions a signal that is neither state, input, parameter nor earlier sample";

/// The functions of a system.
pub(crate) struct Program {
    /// The name of the system, as the user wrote it.
    pub system: Option<String>,
    pub discrete: bool,
    /// True if some input acts later than it is commanded.
    pub is_delayed: bool,
    pub form: Form,
    /// State, inputs, parameters, history, constants; all but the state are left out if empty.
    pub arguments: Vec<Argument>,
    pub functions: Vec<Function>,
    /// Where the equations jump; empty if they never do.
    pub switches: Switches,
    /// The sides of switches, an argument of functions that take them as given.
    sides: Argument,
    /// The unknown constants that occur in the equations.
    pub constants: Vec<Constant>,
    /// Every signal with the user's name.
    pub names: Vec<(Signal, String)>,
}

/// An unknown constant that was found.
pub(crate) struct Constant {
    pub value: f64,
    /// Its name, value, unit and interval, for comments.
    pub about: String,
}

/// A function to write.
pub(crate) struct Function {
    pub kind: Kind,
    pub body: Body,
    /// Rows and columns of the result; one column if it is a vector.
    pub size: (usize, usize),
}

impl Function {
    /// Row, column and node of every nonzero entry of the result.
    pub fn entries(&self) -> Vec<(usize, usize, usize)> {
        let rows = self.body.results.iter().enumerate();
        rows.flat_map(|(i, row)| row.iter().enumerate().map(move |(j, node)| (i, j, *node)))
            .filter(|(.., node)| !self.body.is_zero(*node))
            .collect()
    }
}

impl Program {
    /// # Errors
    /// An equation mentions a signal that is no argument.
    pub fn new(d: &Discovery) -> Result<Program, String> {
        let form = Form::symbolic(d);
        let named = |s: &Signal| (*s, d.name(*s));
        let groups = [
            ("state", "the state", &form.state, true),
            ("input", "the inputs", &form.inputs, false),
            ("parameter", "the parameters", &form.params, false),
            ("history", "earlier samples", &form.history, false),
            (
                CONSTANTS,
                "the constants that were found",
                &form.constants,
                false,
            ),
        ];
        let arguments: Vec<Argument> = groups
            .into_iter()
            .filter(|(_, _, signals, always)| *always || !signals.is_empty())
            .map(|(name, about, signals, _)| Argument {
                name,
                about,
                signals: signals.clone(),
                names: signals.iter().map(|s| d.name(*s)).collect(),
            })
            .collect();
        let known = arguments.iter().flat_map(|a| &a.signals);
        let mut names: Vec<(Signal, String)> = known.chain(&form.unknowns).map(named).collect();
        let (smooth, mut switches) = Switches::of(&form);
        // Equations with kinks but no jumps need no events: their rates are continuous.
        if !switches.jumps.contains(&true) {
            switches = Switches::default();
        }
        let side = |k: usize| format!("side_{}", k + 1);
        names.extend((switches.signals().into_iter().enumerate()).map(|(k, s)| (s, side(k))));
        let mut program = Program {
            system: d.system.clone(),
            discrete: d.discrete,
            is_delayed: form.inputs.iter().any(|s| d.input_delay(s.var) != 0.0),
            constants: form.constants.iter().map(|s| constant(d, *s)).collect(),
            arguments,
            functions: Vec::new(),
            names,
            form,
            sides: Argument {
                name: SIDES,
                about: "the sides of the guards",
                names: (0..switches.len()).map(side).collect(),
                signals: switches.signals(),
            },
            switches,
        };
        program.functions = program
            .all_functions(&smooth)
            .map_err(|_| NOT_GIVEN.to_string())?;
        Ok(program)
    }

    fn all_functions(&mut self, smooth: &Form) -> Result<Vec<Function>, Signal> {
        let form = self.form.clone();
        let mut all = Vec::new();
        if !form.rows.is_empty() {
            let rates = form
                .rates
                .iter()
                .map(|r| vec![rate_signal(&form, *r)])
                .collect();
            all.push(self.function(Kind::Rates, Definitions::new(&form), rates)?);
            let (definitions, derivatives) =
                implicit_differentiation::rate_derivatives(&form, &form.state);
            all.push(self.function(Kind::Jacobian, definitions, derivatives)?);
            if !form.inputs.is_empty() {
                let (definitions, derivatives) =
                    implicit_differentiation::rate_derivatives(&form, &form.inputs);
                all.push(self.function(Kind::InputJacobian, definitions, derivatives)?);
            }
        }
        if !form.outputs.is_empty() {
            let values = form.outputs.iter().map(|(_, e)| vec![e.clone()]).collect();
            all.push(self.function(Kind::Outputs, Definitions::new(&form), values)?);
        }
        if !self.switches.is_empty() {
            all.extend(self.functions_by_side(smooth)?);
        }
        Ok(all)
    }

    /// The functions that steps from event to event need.
    fn functions_by_side(&self, smooth: &Form) -> Result<Vec<Function>, Signal> {
        let guards = self.switches.guards.iter();
        let rates = smooth.rates.iter().map(|r| rate_signal(smooth, *r));
        let rates: Vec<Expr> = rates.collect();
        let moves = |guard: &Expr| {
            let along = smooth.state.iter().zip(&rates);
            let along = along.map(|(x, rate)| guard.derivative(*x) * rate.clone());
            vec![along.chain([guard.derivative(Signal::TIME)]).sum()]
        };
        let moving = guards.clone().map(moves).collect();
        let column = |e: &Expr| vec![e.clone()];
        let none = Definitions::default;
        let mut all = vec![
            self.function(Kind::Guards, none(), guards.map(column).collect())?,
            self.function(
                Kind::RatesBySide,
                Definitions::new(smooth),
                rates.iter().map(column).collect(),
            )?,
            self.function(Kind::GuardRates, Definitions::new(smooth), moving)?,
        ];
        let resets = self.switches.resets.iter();
        let after = resets.map(|reset| {
            let value = |x: &Signal| {
                let own = reset.jumps.iter().find(|(signal, _)| signal == x);
                own.map_or(Expr::signal(*x), |(_, value)| value.clone())
            };
            smooth.state.iter().map(value).collect()
        });
        let after: Vec<Vec<Expr>> = after.collect();
        if !after.is_empty() {
            all.push(self.function(Kind::Jumps, none(), after)?);
        }
        Ok(all)
    }

    /// Whether states jump.
    pub fn has_jumps(&self) -> bool {
        !self.switches.resets.is_empty()
    }

    /// For each guard that is the speed of a contact, the guard of its gap.
    pub fn gaps(&self) -> impl Iterator<Item = Option<usize>> {
        let contacts = &self.switches.contacts;
        let gap = |k| contacts.iter().find(|c| c.speed == k).map(|c| c.gap);
        (0..self.switches.len()).map(gap)
    }

    /// # Errors
    /// States jump, which the language has no word for.
    pub fn refuse_jumps(&self, language: &str) -> Result<(), String> {
        match self.has_jumps() {
            true => Err(format!(
                "the export to {language} lets no states jump: take `python`, `rust`, `c`, `matlab` or `fmi`"
            )),
            false => Ok(()),
        }
    }

    /// The arguments of a function.
    pub fn arguments_of(&self, kind: Kind) -> impl Iterator<Item = &Argument> {
        let sides = kind.takes_sides().then_some(&self.sides);
        self.arguments.iter().chain(sides)
    }

    fn function(
        &self,
        kind: Kind,
        definitions: Definitions,
        results: Vec<Vec<Expr>>,
    ) -> Result<Function, Signal> {
        let size = (results.len(), results.first().map_or(0, Vec::len));
        let arguments: Vec<&Argument> = self.arguments_of(kind).collect();
        let body = self.scope(&arguments).lower(definitions, results)?;
        Ok(Function { kind, body, size })
    }

    /// The terms of the system with the unknowns given. Rows of results: for each equation its row of the mass matrix,
    /// its force and its right side; then each output.
    ///
    /// # Errors
    /// An equation mentions a signal that is no argument.
    pub fn sides(&self) -> Result<Body, String> {
        let row = |r: &sidc_system::discovery::Row| {
            let mut all = r.mass.clone();
            all.extend([r.force.clone(), r.right.clone()]);
            all
        };
        let outputs = self.form.outputs.iter().map(|(_, e)| vec![e.clone()]);
        let rows = self.form.rows.iter().map(row).chain(outputs).collect();
        let arguments: Vec<&Argument> = self.arguments.iter().collect();
        let body = self.scope(&arguments).lower(Definitions::default(), rows);
        body.map_err(|_| NOT_GIVEN.to_string())
    }

    /// The rates of the state, then the outputs, with the subexpressions that they share: a row for each.
    ///
    /// # Errors
    /// An equation mentions a signal that is no argument.
    pub fn formulas(&self) -> Result<Body, String> {
        let form = &self.form;
        let rates = form.rates.iter().map(|r| vec![rate_signal(form, *r)]);
        let outputs = form.outputs.iter().map(|(_, e)| vec![e.clone()]);
        let rows = rates.chain(outputs).collect();
        let arguments: Vec<&Argument> = self.arguments.iter().collect();
        let body = self.scope(&arguments).lower(Definitions::new(form), rows);
        body.map_err(|_| NOT_GIVEN.to_string())
    }

    /// Identifiers of all signals, including outputs.
    pub fn identifiers(&self, d: &Discovery, reserved: &[&'static str]) -> Identifiers {
        let outputs = self.form.outputs.iter().map(|(s, _)| (*s, d.name(*s)));
        let signals = self.names.iter().cloned().chain(outputs);
        Identifiers::new(signals, reserved.iter().copied())
    }

    fn scope<'a>(&'a self, arguments: &'a [&'a Argument]) -> Scope<'a> {
        Scope {
            arguments,
            names: &self.names,
            constants: &self.form.constants,
        }
    }

    /// A line for each argument, for comments.
    pub fn legend(&self) -> impl Iterator<Item = String> {
        let filled = self.arguments.iter().filter(|a| !a.signals.is_empty());
        filled.map(|a| format!("{} is {}: {}", a.name, a.about, plain(&a.names.join(", "))))
    }

    /// The arguments without default values.
    pub fn given(&self) -> impl Iterator<Item = &Argument> {
        self.arguments.iter().filter(|a| a.name != CONSTANTS)
    }

    /// A line for each constant, for comments.
    pub fn constant_lines(&self) -> impl Iterator<Item = String> {
        self.constants.iter().map(|c| c.about.clone())
    }

    /// The values of the constants, `a, b`, with all their digits.
    pub fn constant_values(&self) -> String {
        let all = self.constants.iter().map(|c| format!("{:?}", c.value));
        all.collect::<Vec<String>>().join(", ")
    }

    /// The values of the constants as a tuple of Python, each with its comment; empty without constants.
    pub fn python_constants(&self) -> String {
        let line = |c: &Constant| format!("    {:?},  # {}\n", c.value, c.about);
        let lines: String = self.constants.iter().map(line).collect();
        match lines.is_empty() {
            true => lines,
            false => format!("SIDC_CONSTANTS = (\n{lines})\n"),
        }
    }

    /// Names of the outputs.
    pub fn outputs(&self, d: &Discovery) -> Vec<String> {
        self.form.outputs.iter().map(|(s, _)| d.name(*s)).collect()
    }

    /// The function of that kind, if there is one.
    pub fn get(&self, kind: Kind) -> Option<&Function> {
        self.functions.iter().find(|f| f.kind == kind)
    }

    /// True if the rates can be integrated without events; in discrete time `next` is the step.
    pub fn has_step(&self) -> bool {
        !self.discrete && self.switches.is_empty() && self.get(Kind::Rates).is_some()
    }

    /// True if some function contains such a node.
    pub fn computes(&self, is: impl Fn(&Node) -> bool) -> bool {
        self.functions
            .iter()
            .any(|f| f.body.nodes().iter().any(&is))
    }

    /// True if some function contains such a step.
    pub fn makes(&self, is: impl Fn(&Step) -> bool) -> bool {
        self.functions.iter().any(|f| f.body.steps.iter().any(&is))
    }

    /// True if some linear system of such a size is solved.
    pub fn solves(&self, is: impl Fn(usize) -> bool) -> bool {
        self.makes(|step| match step {
            Step::Solve(s) => is(s.mass.len()),
            Step::Newton(n) => is(n.mass.len()),
            Step::Let(..) => false,
        })
    }

    /// Every function of the model language that is called, sorted and without repetition.
    pub fn calls(&self) -> Vec<Func> {
        let nodes = self.functions.iter().flat_map(|f| f.body.nodes());
        let mut all: Vec<Func> = nodes
            .filter_map(|n| match n {
                Node::Call(f, _) => Some(*f),
                _ => None,
            })
            .collect();
        all.sort();
        all.dedup();
        all
    }

    /// # Errors
    /// The language lacks a function of the model language that the system calls.
    pub fn check_calls(
        &self,
        language: &str,
        spelling: impl Fn(Func) -> &'static str,
    ) -> Result<(), String> {
        match self.calls().into_iter().find(|f| spelling(*f).is_empty()) {
            Some(f) => Err(format!("{language} has no function for `{}`", f.name)),
            None => Ok(()),
        }
    }
}

/// The name of the argument that holds the sides of guards.
pub(crate) const SIDES: &str = "side";
/// The name of the argument that holds the constants.
const CONSTANTS: &str = "constant";

fn constant(d: &Discovery, signal: Signal) -> Constant {
    let name = d.name(signal);
    let told = unknown_constants::told(d, &name).unwrap_or_default();
    Constant {
        value: d.unknown_value(signal).unwrap_or(f64::NAN),
        about: format!("{} = {}", plain(&name), comment_safe(&told)),
    }
}

fn rate_signal(form: &Form, rate: Rate) -> Expr {
    let signal = match rate {
        Rate::State(i) => form.state.get(i),
        Rate::Unknown(i) => form.unknowns.get(i),
    };
    signal.map_or_else(Expr::zero, |s| Expr::signal(*s))
}
