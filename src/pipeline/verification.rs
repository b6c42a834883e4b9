//! Equations checked once more, after they were found.
//!
//! In: a program, the samples, the [`Discovery`]. Out: a verification with each equation's evidence, and a doubt where something does not hold.
//! Never changes a term or a coefficient.

use super::{Measured, Program};
use crate::discover::{
    Discovery, Equation, Reason, Stage, Status, Step, Stop, Verification, Watch,
};
use crate::library::Library;
use crate::verify::{self, Case};

/// Checks every equation that was found, by other code and in other arithmetic. Where `watch` ends the work, equations that
/// were not come to are doubted for it.
pub fn verify(program: &Program, measured: &Measured, discovery: &mut Discovery, watch: Watch) {
    let mut stopped = None;
    for at in 0..discovery.equations.len() {
        let Some((place, library)) = sought(program, discovery, at) else {
            continue;
        };
        let checked = match stopped {
            Some(stop) => Err(stop),
            None => one(discovery, at, (library, measured), &mut |columns| {
                let stage = Stage::Verifying(columns, library.slots());
                let step = Step {
                    equation: place,
                    stage,
                };
                watch(step).break_value()
            }),
        };
        stopped = checked.as_ref().err().copied();
        if let Some(equation) = discovery.equations.get_mut(at) {
            attach(equation, checked);
        }
    }
}

/// Products in 106 bits that checking all equations takes.
pub fn verification_work(program: &Program, measured: &Measured, discovery: &Discovery) -> u128 {
    let all = 0..discovery.equations.len();
    let case = |at: usize| {
        let (_, library) = sought(program, discovery, at)?;
        Some(verify::work(&Case {
            names: discovery,
            equation: discovery.equations.get(at)?,
            library,
            samples: &measured.samples,
            dataset: &measured.dataset,
        }))
    };
    all.filter_map(case).sum()
}

/// The place in the model and the library of an equation that was sought.
fn sought<'a>(
    program: &'a Program,
    discovery: &Discovery,
    at: usize,
) -> Option<(usize, &'a Library)> {
    let target = discovery.equations.get(at)?.target;
    let all = program.model.equations.iter();
    let place = all.clone().position(|e| e.target == target)?;
    Some((place, program.libraries.get(place)?.as_ref()?))
}

fn one(
    discovery: &Discovery,
    at: usize,
    (library, measured): (&Library, &Measured),
    watch: &mut dyn FnMut(usize) -> Option<Stop>,
) -> Result<Option<Verification>, Stop> {
    let Some(equation) = discovery.equations.get(at) else {
        return Ok(None);
    };
    let case = Case {
        names: discovery,
        equation,
        library,
        samples: &measured.samples,
        dataset: &measured.dataset,
    };
    let mut stop = watch(0);
    if let Some(stop) = stop {
        return Err(stop);
    }
    let verified = verify::verify(&case, &mut |columns| {
        stop = watch(columns);
        stop.is_none()
    });
    match stop {
        Some(stop) => Err(stop),
        None => Ok(verified),
    }
}

fn attach(equation: &mut Equation, checked: Result<Option<Verification>, Stop>) {
    let reason = match &checked {
        Err(stop) => Some(stop.unverified()),
        Ok(Some(v)) if !v.holds => Some(Reason::new("not-verified", v.fails.join("; "))),
        Ok(_) => None,
    };
    if let Some(reason) = reason {
        // Who was stopped before is not told twice.
        if equation.reasons.iter().all(|r| r.code != reason.code) {
            equation.reasons.push(reason);
        }
        equation.status = Status::Doubt;
    }
    if let (Some(evidence), Ok(Some(verified))) = (&mut equation.evidence, checked) {
        evidence.verification = Some(Box::new(verified));
    }
}
