//! Which checks an equation gets.
//!
//! In: a case. Out: its [`Verification`]. An equation from rows is compared with least squares and its certificate; an equation that was
//! estimated with its trajectory is compared with that.

use super::equation_check::{Case, EquationCheck};
use super::messages;
use super::pricing;
use super::trajectory_check::TrajectoryCheck;
use super::weighted_sums::WeightedRows;
use sidc_progress::Observer;
use sidc_system::discovery::Verification;

/// Products in 106 bits that checking an equation takes.
pub fn work(case: &Case) -> u128 {
    let witness = case.equation.evidence.as_ref();
    let witness = witness.and_then(|e| e.witness.as_ref());
    let proved = witness.filter(|w| !w.dual.is_empty());
    proved.map_or(0, |w| pricing::work(case.library, w.rows.len()))
}

/// Checks an equation; `None` where the observer ended it, or nothing was found.
///
/// ```
/// use sidc_data::Dataset;
/// use sidc_discover::{Options, discover};
/// use sidc_progress::Unwatched;
/// use sidc::pipeline::Program;
/// use sidc_discover::verify::{Case, verify};
///
/// let program = Program::compile("decay.sid", "state x\ndx ~ powers(x; 3)\n")?;
/// let x: Vec<f64> = (0..40).map(|k| 2.0 * (-0.1 * f64::from(k)).exp()).collect();
/// let dx: Vec<f64> = x.iter().map(|x| -x).collect();
/// let time: Vec<f64> = (0..40).map(|k| 0.1 * f64::from(k)).collect();
/// let samples = program.samples(&time, &[("x", &x), ("dx", &dx)])?;
/// let data = (&Dataset::default(), &samples);
/// let found = discover(&program.model, &program.libraries, data, &Options::default(), &mut Unwatched);
/// let found = found.map_err(|_| "a term has no value")?;
///
/// let case = Case {
///     names: &found,
///     equation: &found.equations[0],
///     library: program.library("dx").ok_or("no library")?,
///     samples: &samples,
///     dataset: &Dataset::default(),
/// };
/// let verified = verify(&case, &mut Unwatched).ok_or("stopped")?;
/// assert!(verified.holds && verified.digits.is_some_and(|d| d > 10.0));
///
/// // A coefficient with a wrong fifth digit is found.
/// let mut wrong = found.equations[0].clone();
/// wrong.terms[0].coefficient *= 1.00001;
/// let verified = verify(&Case { equation: &wrong, ..case }, &mut Unwatched).ok_or("stopped")?;
/// assert!(!verified.holds && verified.fails.iter().any(|f| f.contains("least squares")));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn verify(case: &Case, observer: &mut dyn Observer) -> Option<Verification> {
    let evidence = case.equation.evidence.as_ref()?;
    let mut out = Verification {
        rows: evidence.rows,
        ..Verification::default()
    };
    let Some(witness) = evidence.witness.as_deref() else {
        out.open.push(messages::no_rows(evidence));
        out.holds = true;
        return Some(out);
    };
    if let (Some(together), Some(samples)) = (&evidence.joint, &witness.path) {
        let check = TrajectoryCheck {
            case,
            evidence,
            together,
            samples,
        };
        check.run(&mut out, observer)?;
        out.holds = out.fails.is_empty();
        return Some(out);
    }
    let Some(rows) = WeightedRows::new(case.samples, &witness.rows, &witness.weights) else {
        out.fails.push(messages::rows_missing());
        return Some(out);
    };
    out.rows = rows.len();
    let check = EquationCheck {
        case,
        evidence,
        witness,
        rows,
    };
    check.statements(&mut out);
    let sums = check.fit(&mut out, observer)?;
    check.certificate(&sums, &mut out, observer)?;
    out.holds = out.fails.is_empty();
    Some(out)
}
