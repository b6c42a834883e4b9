//! Why a simulation ended before its record.

use sidc_lang::term::{Signal, SignalNames};

/// What went wrong, where, and in which equation.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    pub kind: FaultKind,
    /// Seconds; in discrete time the number of the sample.
    pub time: f64,
    /// Targets of the equations concerned.
    pub equations: Vec<Signal>,
    /// State, inputs and parameters there, each with its value.
    pub at: Vec<(Signal, f64)>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FaultKind {
    /// The equation of this target has no finite value.
    NotFinite(Signal),
    /// The mass matrix is singular: the equations do not determine the unknowns.
    Singular,
    /// Newton's method does not converge; the equation of this target moves most in its last step.
    NoSolution(Signal),
    /// A signal exceeded the bound that its data suggest.
    Diverged { signal: Signal, bound: f64 },
    /// The step size fell below the resolution of time.
    StepTooSmall,
    /// States jump again and again while no time passes.
    JumpsAccumulate,
    /// The budget of evaluations is spent.
    TooMuchWork,
    /// The user or a time limit ended the run.
    Stopped,
}

impl FaultKind {
    /// The code in diagnostics.
    pub fn code(self) -> &'static str {
        match self {
            FaultKind::NotFinite(_) => "not-finite",
            FaultKind::Singular => "singular-mass",
            FaultKind::NoSolution(_) => "no-solution",
            FaultKind::Diverged { .. } => "blow-up",
            FaultKind::StepTooSmall => "step-too-small",
            FaultKind::JumpsAccumulate => "jumps-accumulate",
            FaultKind::TooMuchWork => "too-much-work",
            FaultKind::Stopped => "run-stopped",
        }
    }
}

impl Fault {
    /// A sentence on what happened, without the time.
    pub fn text(&self, names: &impl SignalNames) -> String {
        let named: Vec<String> = self.equations.iter().map(|s| names.name(*s)).collect();
        let equations = match named.as_slice() {
            [] => "the equations".into(),
            [one] => format!("the equation of {one}"),
            many => format!("the equations of {}", many.join(" and ")),
        };
        match self.kind {
            FaultKind::NotFinite(_) => format!("{equations} has no finite value"),
            FaultKind::Singular => format!(
                "the mass matrix is singular: {equations} say the same there, and no longer determine their unknowns"
            ),
            FaultKind::NoSolution(_) => {
                format!("Newton's method finds nothing that fulfils {equations}")
            }
            FaultKind::Diverged { signal, bound } => format!(
                "{} runs away (beyond ±{bound:.2e}), moved by {equations}",
                names.name(signal),
            ),
            FaultKind::StepTooSmall => {
                format!("no step is small enough to follow {equations}: a singularity")
            }
            FaultKind::JumpsAccumulate => {
                "states jump again and again while no time passes (`when`)".into()
            }
            FaultKind::TooMuchWork => "its steps had become too many and too small".into(),
            FaultKind::Stopped => "stopped by hand or by the time limit".into(),
        }
    }
}
