//! The same problems, solved by the compiler in the norms that `sidc identify` tries.
//!
//! In: a case and a plan, of which gradings and steps are ignored. Out: for each problem the answer with fewest terms, in the order of the trials. A law that
//! does not compile is an error.

use std::time::Instant;

use sidc::pipeline::Program;
use sidc_progress::Unwatched;
use sidc_testing::plants::coupled::{Factor, Point};

use super::library::POWER;
use super::run::{Case, Plan, RegressionCase, problems};
use super::trial::{Outcome, judged};

/// # Errors
/// The compiler's diagnostics of a model.
pub fn identified(case: &Case, plan: &Plan) -> Result<Vec<Outcome>, String> {
    problems(case, plan, asked).into_iter().collect()
}

fn asked(posed: &RegressionCase) -> Result<Outcome, String> {
    let start = Instant::now();
    let (system, law) = (posed.system, posed.law);
    let target = system.name(Factor::Acceleration(law.coordinate));
    let atoms: Vec<String> = posed
        .library
        .atoms
        .iter()
        .map(|a| system.name(*a))
        .collect();
    let library = format!("powers({}; {POWER})", atoms.join(", "));
    let model = format!("{}{target} ~ {library}\n", system.declared());
    let program = Program::compile("coupled.sid", &model)?;

    let (names, values): (Vec<String>, Vec<Vec<f64>>) = signals(posed).into_iter().unzip();
    let columns: Vec<(&str, &[f64])> = names
        .iter()
        .map(|n| &n[..])
        .zip(values.iter().map(|v| &v[..]))
        .collect();
    let time: Vec<f64> = posed.rows.iter().map(|(t, _)| *t).collect();
    let samples = program.samples(&time, &columns)?;
    let regression = program.regression(&target, &samples)?;

    let library = program.library(&target).ok_or("no library")?;
    let found = regression.proposals(library, 0.0, &mut Unwatched);
    let first = found.first().ok_or("no norm")?;
    let names: Vec<String> = law.terms.iter().map(|(m, _)| system.term(m)).collect();
    let names: Vec<&str> = names.iter().map(|n| &n[..]).collect();
    let slots = program.slots(&target, &names);
    let truth = slots
        .into_iter()
        .zip(&law.terms)
        .map(|(slot, (_, c))| Some((slot?, *c)));
    Ok(judged(
        &regression.problem(0.0),
        &first.solution,
        truth.collect(),
        start,
    ))
}

/// Every signal of the system, by name.
fn signals(posed: &RegressionCase) -> Vec<(String, Vec<f64>)> {
    let system = posed.system;
    let coordinates = 0..system.coordinates();
    let of = |i| {
        [
            Factor::Position(i),
            Factor::Speed(i),
            Factor::Acceleration(i),
        ]
    };
    let factors = coordinates
        .flat_map(of)
        .chain((0..system.inputs()).map(Factor::Input));
    let value = |factor: Factor| move |(_, p): &&(f64, Point)| factor.value(p);
    factors
        .map(|f| (system.name(f), posed.rows.iter().map(value(f)).collect()))
        .collect()
}
