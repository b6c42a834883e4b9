//! `sidc linearize R.json --at theta=0`: the linear system near a point, and what it does.

use std::path::PathBuf;

use super::{Failure, inputs, output, point, status};
use sidc_emit as emit;
use sidc_lang::model::VarKind;
use sidc_lang::source::Sources;
use sidc_lang::term::{Signal, SignalNames, VarId};
use sidc_system::algebra;
use sidc_system::algebra::{Linear, NoLinear, Point};
use sidc_system::discovery::{Discovery, Form};
use sidc_system::result;

/// A and B near a point, eigenvalues, stability, controllability
#[derive(clap::Args)]
#[command(after_help = super::examples::LINEARIZE)]
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
    let text = inputs::result(&args.result)?;
    let name = inputs::short_name(&args.result);
    let d = result::read(&name, &text)
        .map_err(|d| Failure::new(inputs::render(&[d], &Sources::default())))?;
    let form = Form::new(&d);
    if form.state.is_empty() {
        return Err(Failure::new(
            "error[no-dynamics]: the result has no equation of a state: there is nothing to linearise",
        ));
    }
    let mut point = Point::default();
    let mut named = set_point(&mut point, &d, &form, &args.at)?;
    named.extend(set_params(&mut point, &d, &form, &args.params)?);
    let actuators: Vec<Signal> = (d.variables.iter().enumerate())
        .filter(|(_, v)| v.kind == VarKind::Input)
        .map(|(i, _)| Signal::new(VarId(i as u16)))
        .collect();
    let near = algebra::near(&form, &point, &actuators).map_err(|why| refusal(&d, &form, why))?;
    let warnings = emit::kink_warnings(&d, &near);
    for w in &warnings {
        eprintln!("warning[{}]: {}", w.code, w.text);
    }
    let text = match args.json {
        true => result::linearization(&d, &near, &point, &named, &warnings)
            .map_err(|e| Failure::new(format!("error[internal]: {e}; please report this")))?,
        false => emit::linearization(&d, &near, &point, &named),
    };
    output::print(&text)?;
    Ok(status::PASS)
}

/// Sets what `--at` says; returns which signals those are.
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
    let pairs = point::pairs("--at", texts)?;
    let found = point::resolve(("--at", "unknown-point"), &pairs, &names, &explain)?;
    let mut named = Vec::new();
    for (place, value) in found {
        if let Some(s) = signals.get(place) {
            at.0.insert(*s, value);
            named.push(*s);
        }
    }
    Ok(named)
}

/// Every parameter that the equations mention needs a value; others may have one. Returns the former.
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
    let pairs = point::pairs("--param", texts)?;
    for (place, value) in point::resolve(("--param", "unknown-param"), &pairs, &names, &|_| None)? {
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

/// Why there is no linear system, with the equations that are the reason.
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
