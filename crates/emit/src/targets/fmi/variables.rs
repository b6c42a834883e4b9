//! The variables of an FMU, in the order of their value references.
//!
//! In: a discovery and its program. Out: a list of variables with their attributes in XML. The order is that of `fmi3.c`: time, states,
//! rates, inputs, parameters, outputs, guards.

use crate::caveats::delays;
use crate::code::identifiers::{comment_safe, plain};
use crate::code::program::Program;
use sidc_lang::number::significant;
use sidc_lang::term::{Signal, SignalNames};
use sidc_system::discovery::{Discovery, Rate};

/// Significant digits of a delay in a name.
const DELAY_DIGITS: usize = 6;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    Time,
    State,
    /// The rate of the state with this value reference.
    Rate(usize),
    Input,
    Parameter,
    Output,
    Guard,
}

pub(super) struct Variable {
    pub role: Role,
    pub name: String,
    pub about: String,
    pub unit: Option<String>,
    /// For states, inputs and parameters.
    pub start: f64,
    /// The value references that an output depends on directly; `None` if it may depend on all.
    pub follows: Option<Vec<usize>>,
}

pub(super) struct Variables {
    /// A variable's index is its value reference.
    pub all: Vec<Variable>,
}

impl Variables {
    pub fn new(d: &Discovery, program: &Program) -> Variables {
        let mut variables = Variables {
            all: vec![variable(d, Role::Time, Signal::TIME)],
        };
        variables.states(d, program);
        variables.inputs(d, program);
        variables.parameters(d, program);
        variables.outputs(d, program);
        for k in 1..=program.switches.len() {
            variables.all.push(Variable {
                role: Role::Guard,
                name: format!("guard({k})"),
                about: "above zero until the next event".into(),
                unit: None,
                start: 0.0,
                follows: None,
            });
        }
        variables
    }

    /// The variables of a role with their value references, in order.
    pub fn of(&self, role: impl Fn(Role) -> bool) -> impl Iterator<Item = (usize, &Variable)> {
        let all = self.all.iter().enumerate();
        all.filter(move |(_, v)| role(v.role))
    }

    pub fn count(&self, role: Role) -> usize {
        self.of(|r| r == role).count()
    }

    /// The start values of the variables of a role.
    pub fn starts(&self, role: Role) -> Vec<f64> {
        self.of(|r| r == role).map(|(_, v)| v.start).collect()
    }

    fn states(&mut self, d: &Discovery, program: &Program) {
        let form = &program.form;
        for s in &form.state {
            let name = d.name(*s);
            let hidden = d.hidden.iter().find(|h| h.name == name);
            self.all.push(Variable {
                start: hidden.map_or(0.0, |h| h.mean),
                follows: Some(vec![self.all.len()]),
                ..variable(d, Role::State, *s)
            });
        }
        for (place, (s, rate)) in form.state.iter().zip(&form.rates).enumerate() {
            let signal = match rate {
                Rate::State(i) => form.state.get(*i),
                Rate::Unknown(i) => form.unknowns.get(*i),
            };
            let is = signal.map_or_else(String::new, |s| plain(&d.name(*s)));
            let unit = signal.and_then(|s| d.unit(*s));
            self.all.push(Variable {
                role: Role::Rate(place + 1),
                name: format!("der({})", d.name(*s)),
                about: is,
                unit: unit.map(|u| u.to_string()),
                start: 0.0,
                follows: None,
            });
        }
    }

    /// The name of a delayed input says which value it takes.
    fn inputs(&mut self, d: &Discovery, program: &Program) {
        let inputs = &program.form.inputs;
        let delays = delays(d, inputs);
        for (i, s) in inputs.iter().enumerate() {
            let mut input = variable(d, Role::Input, *s);
            if let Some(delay) = delays.get(i).copied().filter(|delay| *delay != 0.0) {
                let delay = significant(delay, DELAY_DIGITS);
                input.about = format!(
                    "{} as it acts: the command of {delay} {} ago",
                    plain(&input.name),
                    d.time_unit()
                );
                input.name = format!("delay({}, {delay})", input.name);
            }
            self.all.push(input);
        }
    }

    /// Parameters from a column of the data have no value of their own.
    fn parameters(&mut self, d: &Discovery, program: &Program) {
        let form = &program.form;
        for s in &form.params {
            self.all.push(Variable {
                start: f64::NAN,
                about: "has no value of its own: set it before the simulation begins".into(),
                ..variable(d, Role::Parameter, *s)
            });
        }
        for (s, constant) in form.constants.iter().zip(&program.constants) {
            self.all.push(Variable {
                start: constant.value,
                about: comment_safe(&constant.about),
                ..variable(d, Role::Parameter, *s)
            });
        }
    }

    fn outputs(&mut self, d: &Discovery, program: &Program) {
        for (s, value) in &program.form.outputs {
            let mut follows = Vec::new();
            let mut computed = false;
            value.for_each_signal(&mut |used| {
                computed |= program.form.unknowns.contains(&used);
                follows.extend(reference(program, used));
            });
            follows.sort_unstable();
            follows.dedup();
            self.all.push(Variable {
                follows: (!computed).then_some(follows),
                ..variable(d, Role::Output, *s)
            });
        }
    }
}

/// The value reference of time, a state or an input; `None` for what is constant during a simulation or computed.
fn reference(program: &Program, s: Signal) -> Option<usize> {
    let form = &program.form;
    let place = |all: &[Signal]| all.iter().position(|x| *x == s);
    let first_input = 1 + 2 * form.state.len();
    let input = || Some(first_input + place(&form.inputs)?);
    match s == Signal::TIME {
        true => Some(0),
        false => place(&form.state).map(|i| 1 + i).or_else(input),
    }
}

fn variable(d: &Discovery, role: Role, s: Signal) -> Variable {
    Variable {
        role,
        name: d.name(s),
        about: String::new(),
        unit: d.unit(s).map(|u| u.to_string()),
        start: 0.0,
        follows: None,
    }
}
