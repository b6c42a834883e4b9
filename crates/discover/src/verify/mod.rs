//! An equation and its proof checked once more, by other code and in 106 bits.
//!
//! In: an equation with its [`Witness`], its library, the samples. Out: a [`Verification`]: figures that no rounding can have flattered, what does
//! not hold, and what was not checked. Every term is evaluated afresh from the signals, which count as exact, and every sum made
//! anew. It shares no code with solvers, certificates and dictionaries, and never changes an equation.

mod columns;
mod double;
mod functions;
mod normal;
mod path;
mod proof;
mod rows;
mod value;
mod words;

use sidc_data::{Dataset, Samples};
use sidc_lang::library::Library;
use sidc_lang::term::Term;
use sidc_progress::Observer;
use sidc_system::discovery::{Discovery, Equation, Evidence, Verification, Witness};

use normal::Normal;
use path::Path;
use rows::{Asked, Rows, Sums};

/// Part of a coefficient by which it may miss the least-squares one.
const NEAR: f64 = 1e-6;
/// Rounding of a fit in f64, relative, where columns are far from depending on each other.
const FITTED: f64 = 1e-13;
/// Difference of the stated residual, relative, and to the size of what cancels in it.
const STATED: (f64, f64) = (1e-3, 1e-13);
/// Digits beyond which two coefficients are the same number.
const MOST_DIGITS: f64 = 17.0;

/// What is to be checked.
#[derive(Clone, Copy)]
pub struct Case<'a> {
    /// Names of signals.
    pub names: &'a Discovery,
    pub equation: &'a Equation,
    pub library: &'a Library,
    /// The samples that the witness counts rows of.
    pub samples: &'a Samples,
    /// Readings, for an equation that was estimated with its trajectory.
    pub dataset: &'a Dataset,
}

/// Products of numbers of 106 bits that checking an equation takes.
pub fn work(case: &Case) -> u128 {
    let witness = case.equation.evidence.as_ref();
    let witness = witness.and_then(|e| e.witness.as_ref());
    let proved = witness.filter(|w| !w.dual.is_empty());
    proved.map_or(0, |w| columns::work(case.library, w.rows.len()))
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
/// // A coefficient that is off in its fifth digit is told.
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
        out.open.push(words::no_rows(evidence));
        out.holds = true;
        return Some(out);
    };
    if let (Some(together), Some(samples)) = (&evidence.together, &witness.path) {
        let path = Path {
            names: case.names,
            equation: case.equation,
            evidence,
            together,
            samples,
            dataset: case.dataset,
        };
        path.check(&mut out, observer)?;
        out.holds = out.fails.is_empty();
        return Some(out);
    }
    let Some(rows) = Rows::new(case.samples, &witness.rows, &witness.weights) else {
        out.fails.push(words::rows_missing());
        return Some(out);
    };
    out.rows = rows.len();
    let check = Check {
        case,
        evidence,
        witness,
        rows,
    };
    check.stated(&mut out);
    let sums = check.fit(&mut out, observer)?;
    check.proof(&sums, &mut out, observer)?;
    out.holds = out.fails.is_empty();
    Some(out)
}

/// False also for what is not a number: such a figure shows nothing.
fn within(figure: f64, limit: f64) -> bool {
    figure <= limit
}

/// One equation with what it is checked against.
struct Check<'a> {
    case: &'a Case<'a>,
    evidence: &'a Evidence,
    witness: &'a Witness,
    rows: Rows<'a>,
}

impl<'a> Check<'a> {
    /// Terms of one kind, with their coefficients.
    fn terms(&self, fixed: bool) -> Vec<(&'a Term, f64)> {
        let terms = self.case.equation.terms.iter();
        let kind = terms.filter(|t| t.fixed == fixed);
        kind.map(|t| (&t.term, t.coefficient)).collect()
    }

    /// What the evidence states of the library.
    fn stated(&self, out: &mut Verification) {
        let (has, stated) = (self.case.library.len(), self.evidence.candidates);
        if has != stated {
            out.fails.push(words::candidates(has, stated));
        }
        if self.rows.len() != self.evidence.rows {
            let text = words::rows(self.rows.len(), self.evidence.rows);
            out.fails.push(text);
        }
        for (term, _) in self.terms(false) {
            if self.case.library.contains(term).is_none() {
                out.fails.push(words::no_candidate(self.case.names, term));
            }
        }
    }

    /// What the equation leaves, and whether its coefficients are the least-squares ones.
    fn fit(&self, out: &mut Verification, observer: &mut dyn Observer) -> Option<Sums> {
        let (known, found) = (self.terms(true), self.terms(false));
        let asked = Asked {
            target: self.case.equation.target,
            known: &known,
            found: &found,
            dual: &self.witness.dual,
            gram: true,
        };
        let sums = self.rows.sums(&asked, observer)?;
        let size = sums.target.value.hi;
        let shares: Vec<f64> = (found.iter().zip(&sums.norms))
            .map(|((_, a), n)| a.abs() * n.size())
            .collect();
        let largest = shares.iter().copied().fold(size, f64::max);
        if !sums.left.error.is_finite() {
            out.fails.push(words::no_value(self.case.names, &found));
            return Some(sums);
        }
        let (left, stated) = (sums.left.value.hi / size, self.evidence.residual);
        out.residual = Some(left);
        let rounding = STATED.1 * largest / size + sums.left.error / size;
        if !within((left - stated).abs(), STATED.0 * left + rounding) {
            out.fails.push(words::residual(left, stated));
        }
        if self.evidence.certificate.constrained {
            out.open.push(words::constrained());
        } else if !found.is_empty() {
            let normal = normal::solve(&sums.gram, &sums.slopes);
            self.least_squares(&normal, &sums, largest, out);
        }
        Some(sums)
    }

    fn least_squares(&self, normal: &Normal, sums: &Sums, largest: f64, out: &mut Verification) {
        let found = self.terms(false);
        if normal.rank < found.len() {
            let text = words::dependent(normal.rank, found.len());
            match self.evidence.certificate.rank < found.len() {
                true => out.open.push(text),
                false => out.fails.push(text),
            }
            return;
        }
        // What a fit in f64 can be off by: the condition, and its square where much is left over (Golub & Van Loan, section 5.3).
        let condition = normal.condition;
        let left = sums.left.value.hi / sums.target.value.hi;
        let fitted = FITTED * condition * (1.0 + condition * left) * largest;
        let mut digits = MOST_DIGITS;
        for (((term, a), step), norm) in found.iter().zip(&normal.step).zip(&sums.norms) {
            let relative = (step / a).abs();
            digits = digits.min(-relative.log10());
            if step.abs() > NEAR * a.abs() + fitted / norm.size() {
                let name = words::name(self.case.names, term);
                out.fails.push(words::coefficient(&name, *a, a + step));
            }
        }
        out.digits = Some(digits.max(0.0)).filter(|d| d.is_finite());
    }
}
