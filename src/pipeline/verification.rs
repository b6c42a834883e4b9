//! Checks equations again after they were found.
//!
//! In: a program, the samples, the [`Discovery`]. Out: in each equation's evidence whether it holds, and a doubt if it does not. Never changes a term or a
//! coefficient.

use super::measure::Measured;
use super::program::Program;
use sidc_discover::unverified;
use sidc_discover::verify;
use sidc_discover::verify::Case;
use sidc_progress::{EquationObserver, Observer, Stage, Stop};
use sidc_system::discovery::{Discovery, Equation, Reason, ReasonCode, Status, Verification};

/// Checks every equation that was found, with independent code and other arithmetic. If `observer` ends the work, the remaining equations get a doubt that
/// says so.
pub fn verify(
    program: &Program,
    measured: &Measured,
    discovery: &mut Discovery,
    observer: &mut dyn Observer,
) {
    let mut observer = EquationObserver::new(observer);
    for at in 0..discovery.equations.len() {
        let Some((place, case)) = case(program, measured, discovery, at) else {
            continue;
        };
        observer.set_equation(place);
        let checked = match observer.at(Stage::Verifying(0, case.library.slots())) {
            Some(_) => None,
            None => verify::verify(&case, &mut observer),
        };
        let checked = observer.stop().map_or(Ok(checked), Err);
        if let Some(equation) = discovery.equations.get_mut(at) {
            attach(equation, checked);
        }
    }
}

/// The number of 106-bit products that checking all equations takes.
pub fn verification_work(program: &Program, measured: &Measured, discovery: &Discovery) -> u128 {
    let all = 0..discovery.equations.len();
    let cases = all.filter_map(|at| case(program, measured, discovery, at));
    cases.map(|(_, case)| verify::work(&case)).sum()
}

/// An equation that was searched for, with its index in the model.
fn case<'a>(
    program: &'a Program,
    measured: &'a Measured,
    discovery: &'a Discovery,
    at: usize,
) -> Option<(usize, Case<'a>)> {
    let equation = discovery.equations.get(at)?;
    let (place, library) = measured.searched(program).sought(equation.target)?;
    let case = Case {
        names: discovery,
        equation,
        library,
        samples: &measured.samples,
        dataset: &measured.dataset,
    };
    Some((place, case))
}

fn attach(equation: &mut Equation, checked: Result<Option<Verification>, Stop>) {
    let reason = match &checked {
        Err(stop) => Some(unverified(*stop)),
        Ok(Some(v)) if !v.holds => Some(Reason::new(ReasonCode::NotVerified, v.fails.join("; "))),
        Ok(_) => None,
    };
    if let Some(reason) = reason {
        // An earlier stop may have added the same reason already.
        if equation.reasons.iter().all(|r| r.code != reason.code) {
            equation.reasons.push(reason);
        }
        equation.status = Status::Doubt;
    }
    if let (Some(evidence), Ok(Some(verified))) = (&mut equation.evidence, checked) {
        evidence.verification = Some(Box::new(verified));
    }
}
