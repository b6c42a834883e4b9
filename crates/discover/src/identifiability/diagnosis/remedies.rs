//! What to do about doubts, from what was found about the data.
//!
//! In: an equation or a failure with its reasons, findings. Out: the same reasons with remedies. Adds no reason.

use super::findings::UNEXPLAINED;
use sidc_system::discovery::{Cause, Equation, Finding, Reason, ReasonCode, Remedy};

/// Gives every reason that has no remedy of its own the advice of the finding that explains it.
pub fn advise(equation: &mut Equation) {
    let evidence = equation.evidence.as_ref();
    let Some(told) = evidence.and_then(|e| e.identifiability.as_deref()) else {
        return;
    };
    for reason in &mut equation.reasons {
        if reason.remedy.is_none() {
            let mut of_it = told.findings.iter().filter(|f| f.matters);
            reason.remedy = of_it.find(|f| explains(f, reason)).map(remedy);
        }
    }
}

/// The advice of a finding as a remedy.
pub fn remedy(finding: &Finding) -> Remedy {
    Remedy {
        text: finding.advice.clone(),
        because: match finding.cause {
            // The text of the doubt already gives this figure.
            Cause::WeakTerm => String::new(),
            _ => finding.text.clone(),
        },
        change: finding.change.clone(),
    }
}

/// Doubts that arise where any target could be fitted.
const CROWDED: [ReasonCode; 2] = [ReasonCode::NotSparse, ReasonCode::ExhaustedLibrary];

/// Doubts whose cause may be the sensors or the solver as well as the library.
const MEASURED: [ReasonCode; 3] = [
    ReasonCode::ColouredResiduals,
    ReasonCode::InconsistentRows,
    ReasonCode::SolverInaccurate,
];

/// Whether the finding is the cause of the reason, so that its advice applies.
fn explains(finding: &Finding, reason: &Reason) -> bool {
    match &reason.code {
        _ if finding.advice.is_empty() => false,
        ReasonCode::UncertainCoefficient => {
            finding.cause == Cause::WeakTerm && subject(&finding.text) == subject(&reason.text)
        }
        ReasonCode::Tie | ReasonCode::DependentSupport => {
            finding.cause != Cause::WeakTerm && finding.cause != Cause::MissingTerm
        }
        code if UNEXPLAINED.contains(code) => match finding.cause {
            // More rows do not improve the fit, but rule out sets of terms that fit by chance.
            Cause::TooFewRows => CROWDED.contains(code),
            // A finding that no simple term is missing gives no change to make; the usual advice for these
            // doubts says more.
            Cause::MissingTerm => finding.change.is_some() || !MEASURED.contains(code),
            Cause::WrongOrder => true,
            _ => false,
        },
        _ => false,
    }
}

/// `the coefficient of x^2` of `the coefficient of x^2 is known to 30 %`.
fn subject(text: &str) -> &str {
    text.split(" is known").next().unwrap_or(text)
}
