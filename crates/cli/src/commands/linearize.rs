//! `sidc linearize R.json --at theta=0`: the linear system near a point, and its properties.

use std::path::PathBuf;

use crate::exit_status;
use crate::failure::Failure;
use crate::inputs::texts;
use crate::option_values::operating_point::PointOption;
use crate::outputs::{doubts, stdout};
use sidc_emit as emit;
use sidc_lang::model::VarKind;
use sidc_lang::number::significant;
use sidc_lang::term::{Signal, SignalNames, VarId};
use sidc_system::algebra;
use sidc_system::algebra::{DelayState, Linear, NoLinear, Point};
use sidc_system::discovery::{Discovery, Form, Notice};
use sidc_system::result;

const EXAMPLES: &str = "Examples:
  sidc linearize R.json --at theta=pi                 A and B near upright
  sidc linearize R.json --at theta=pi/6,F=2 --json    the same as a document";

/// A and B near a point, eigenvalues, stability, controllability
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Result of `sidc identify … -o R.json`
    result: PathBuf,
    /// The point: states and inputs by name, arithmetic with pi allowed; what is not named is 0
    #[arg(long, value_name = "theta=pi,dtheta=0")]
    at: Vec<String>,
    /// Values of parameters that the equations mention
    #[arg(long = "param", value_name = "m=0.3")]
    params: Vec<String>,
    /// Print a JSON document instead of text
    #[arg(long)]
    json: bool,
}

pub fn run(args: &Args) -> Result<u8, Failure> {
    let found = texts::result(&args.result)?.discovery;
    // The equations with states in place of delays.
    let (d, delays) = algebra::delays_as_states(&found);
    let form = Form::new(&d);
    if form.state.is_empty() {
        return Err(Failure::new(
            "error[no-dynamics]: the result has no equation of a state: there is nothing to linearise",
        ));
    }
    let mut point = Point::default();
    let mut named = set_point(&mut point, &d, &form, &args.at)?;
    named.extend(set_params(&mut point, &d, &form, &args.params)?);
    for delay in &delays {
        let input = point.value(delay.input);
        point.0.insert(delay.state, delay.at_rest(input));
        if input != 0.0 {
            named.push(delay.state);
        }
    }
    let actuators: Vec<Signal> = (d.variables.iter().enumerate())
        .filter(|(_, v)| v.kind == VarKind::Input)
        .map(|(i, _)| Signal::new(VarId(i as u16)))
        .collect();
    let near = algebra::near(&form, &point, &actuators).map_err(|why| refusal(&d, &form, why))?;
    let mut warnings = emit::kink_warnings(&d, &near);
    warnings.extend(doubts::doubted(&found));
    warnings.extend(delays.iter().map(|delay| approximated(&d, delay)));
    for w in &warnings {
        eprintln!("warning[{}]: {}", w.code, w.text);
    }
    let text = match args.json {
        true => result::linearization(&d, &near, &point, &named, &warnings)
            .map_err(Failure::internal)?,
        false => emit::linearization(&d, &near, &point, &named),
    };
    stdout::print(&text)?;
    Ok(exit_status::PASS)
}

/// A notice that a delay was replaced by states.
fn approximated(d: &Discovery, delay: &DelayState) -> Notice {
    let text = format!(
        "{} acts {} {} late: A and B hold that as a second-order Padé approximant with the states {} and {}",
        d.name(delay.input),
        significant(delay.seconds, 6),
        d.time_unit(),
        d.name(delay.state),
        d.name(Signal::derivative(delay.state.var, 1)),
    );
    Notice::new("delay-approximated", text)
}

/// Sets the values of `--at` in the point. Returns the signals that were set.
fn set_point(
    at: &mut Point,
    d: &Discovery,
    form: &Form,
    texts: &[String],
) -> Result<Vec<Signal>, Failure> {
    let frame = Linear::without_matrices(form);
    let mut signals = [frame.states, frame.inputs].concat();
    if form.rows.iter().any(|r| r.right.mentions(Signal::TIME)) {
        signals.push(Signal::TIME);
    }
    let names: Vec<String> = signals.iter().map(|s| d.name(*s)).collect();
    let explain = |name: &str| {
        let is = |s: &&Signal| d.name(**s) == name;
        if form.params.iter().any(|s| is(&s)) {
            return Some(format!("this is a parameter; write --param {name}=…"));
        }
        if form.unknowns.iter().any(|s| is(&s)) {
            return Some("this is what the equations give; name states and inputs".into());
        }
        let declared = d.variables.iter().any(|v| v.name == name);
        declared.then(|| "no equation mentions it; leave it away".into())
    };
    let option = PointOption {
        name: "--at",
        unknown: "unknown-point",
        known: &names,
        explain: &explain,
    };
    let mut named = Vec::new();
    for (place, value) in option.read(texts)? {
        if let Some(s) = signals.get(place) {
            at.0.insert(*s, value);
            named.push(*s);
        }
    }
    Ok(named)
}

/// Sets the values of `--param` in the point. Returns the parameters that the equations mention, all of which need a value.
fn set_params(
    at: &mut Point,
    d: &Discovery,
    form: &Form,
    texts: &[String],
) -> Result<Vec<Signal>, Failure> {
    let declared = d.variables.iter().enumerate();
    let declared = declared.filter(|(_, v)| v.kind == VarKind::Param);
    let signals: Vec<Signal> = declared
        .map(|(i, _)| Signal::new(VarId(i as u16)))
        .collect();
    let names: Vec<String> = signals.iter().map(|s| d.name(*s)).collect();
    let option = PointOption {
        name: "--param",
        unknown: "unknown-param",
        known: &names,
        explain: &|_| None,
    };
    for (place, value) in option.read(texts)? {
        if let Some(s) = signals.get(place) {
            at.0.insert(*s, value);
        }
    }
    match form.params.iter().find(|s| !at.0.contains_key(s)) {
        None => Ok(form.params.clone()),
        Some(s) => Err(Failure::new(format!(
            "error[missing-param]: the equations hold the parameter {0}, which has no value\n  = help: --param {0}=1",
            d.name(*s)
        ))),
    }
}

/// Why there is no linear system, with the equations responsible.
fn refusal(d: &Discovery, form: &Form, why: NoLinear) -> Failure {
    let lines = emit::equations(d);
    let of = |target: Signal| -> String {
        let found = d
            .equations
            .iter()
            .zip(&lines)
            .find(|(e, _)| e.target == target);
        found.map_or_else(String::new, |(_, line)| line.clone())
    };
    let tied: String = form.unknowns.iter().map(|q| of(*q)).collect();
    Failure::new(match why {
        NoLinear::Singular => format!(
            "error[singular-mass]: at this point the equations cannot be solved for their highest derivatives: det M = 0\n{tied}  = help: take another point; at this one the equations say the same thing twice\n"
        ),
        NoLinear::NoSolution => format!(
            "error[no-solution]: at this point no solution of the equations was found by Newton's method from zero\n{tied}  = help: take another point\n"
        ),
        NoLinear::NoValue(target) => format!(
            "error[no-value]: {} has no finite value at this point\n{}  = help: take a point inside the domain of every function\n",
            d.name(target),
            of(target)
        ),
        NoLinear::NoSlope(target, by) => format!(
            "error[no-slope]: {} has no finite derivative by {} at this point\n{}  = help: take a point beside it\n",
            d.name(target),
            d.name(by),
            of(target)
        ),
    })
}
