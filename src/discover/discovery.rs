//! What was found: the equations of a system, each with its evidence. All that emitters, simulation and reports may see.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::{Halves, Identifiability, Nearest, Trust, Verification, Witness};
use crate::lang::model::{Model, VarKind};
use crate::term::{Signal, SignalNames, Term, VarId};
use crate::units::{self, Unit};

/// The identified system.
#[derive(Clone, Debug, Default)]
pub struct Discovery {
    pub system: Option<String>,
    /// True if targets are next samples, not derivatives.
    pub discrete: bool,
    /// All declared variables; index 0 is time.
    pub variables: Vec<Variable>,
    pub equations: Vec<Equation>,
    pub failed: Vec<Failed>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    pub name: String,
    pub kind: VarKind,
    /// Highest derivative that exists.
    pub order: u8,
    /// What it is counted in, if declared.
    pub unit: Option<Unit>,
}

/// target = Σ coefficient · term, in model units.
#[derive(Clone, Debug)]
pub struct Equation {
    pub target: Signal,
    pub terms: Vec<FoundTerm>,
    pub status: Status,
    /// Why it is doubted; empty for a pass.
    pub reasons: Vec<Reason>,
    /// `None` for an equation that the model states as known.
    pub evidence: Option<Evidence>,
    /// Answers for larger tolerances, from no term on; empty unless asked for.
    pub path: Vec<PathKnot>,
}

/// The answer of `min ½‖Φa − y‖² + τ‖Da‖₁`, and that of the smallest 1-norm within its own residual, where the terms change.
#[derive(Clone, Debug, PartialEq)]
pub struct PathKnot {
    /// Its place on the path, from 1. Where numbers skip, knots were left out.
    pub number: usize,
    /// τ relative to the largest that leaves any term: 1 at the first knot.
    pub penalty: f64,
    /// ‖Φa − y‖/‖y‖, rows weighted.
    pub residual: f64,
    /// In the order of print; coefficients in model units.
    pub terms: Vec<FoundTerm>,
    /// Comes in here, with a coefficient of zero yet.
    pub enters: Option<Term>,
    /// Leaves here.
    pub leaves: Option<Term>,
    /// Relative duality gap of the penalised form, over all candidates.
    pub gap: f64,
}

#[derive(Clone, Debug, PartialEq)]
pub struct FoundTerm {
    pub term: Term,
    pub coefficient: f64,
    /// True if the model states it, in `known(…)` or with `=`.
    pub fixed: bool,
    /// Standard error from the scatter of the residual; `None` for fixed terms.
    pub standard_error: Option<f64>,
    /// `None` for fixed terms, and where nothing was judged.
    pub trust: Option<Box<Trust>>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Status {
    /// Stated by the model.
    Known,
    /// Found, and nothing speaks against it.
    Pass,
    /// Found, but with reasons to distrust it.
    Doubt,
}

/// One reason for a doubt or a failure.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Reason {
    /// Stable, kebab-case, never renamed.
    pub code: String,
    /// A sentence with its figures.
    pub text: String,
}

impl Reason {
    pub fn new(code: &str, text: impl Into<String>) -> Self {
        Reason {
            code: code.to_string(),
            text: text.into(),
        }
    }
}

/// An equation that was asked for and not found.
#[derive(Clone, Debug)]
pub struct Failed {
    pub target: Signal,
    pub reasons: Vec<Reason>,
}

/// The figures behind one equation. Relative figures are against the root mean square of the target
/// (known part taken off), rows weighted by their accuracy.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Evidence {
    /// Rows M the coefficients were found from.
    pub rows: usize,
    /// Candidate terms N.
    pub candidates: usize,
    /// How the rows were made, if they are not samples.
    #[serde(skip_serializing_if = "String::is_empty", default)]
    pub method: String,
    /// Solver that proposed the support.
    pub solver: String,
    pub iterations: usize,
    /// Root mean square of the residual, relative.
    pub residual: f64,
    /// Root mean square of the target's estimated error, relative; 0 if it was measured.
    pub target_error: f64,
    /// Terms that the choice of the support was made among; the rest was ruled out by the solver.
    #[serde(default)]
    pub searched: usize,
    /// The equation on rows not used.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub held_out: Option<HeldOut>,
    pub certificate: Proof,
    /// What the equations of a system did together, if they were estimated with their trajectory.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub together: Option<Together>,
    /// How the equation stands to others of its system, where it is the one that says, or would say, nothing new.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub relation: Option<Rearranged>,
    /// Other supports that these data cannot tell from the answer.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub ties: Vec<Vec<String>>,
    /// What the stability of its terms was judged by.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub halves: Option<Halves>,
    /// The term that is missing if one is.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub nearest: Option<Nearest>,
    /// What the rows can tell apart.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub identifiability: Option<Box<Identifiability>>,
    /// What a second look at it came to, if that was asked for.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub verification: Option<Box<Verification>>,
    /// What it takes to look once more; not written.
    #[serde(skip)]
    pub witness: Option<Arc<Witness>>,
}

/// Two laws of one target: one that repeats other equations of the system, and one that does not.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Rearranged {
    /// Targets of the equations that are repeated.
    pub of: Vec<String>,
    /// Part of the repeating law's slopes that theirs do not give: 0 for the same relation.
    pub apart: f64,
    /// What the laws leave open, in the same units.
    pub open: f64,
    /// Median condition number of their mass matrix along the data, rows of unit length.
    pub condition: f64,
    /// True if the equation is the law of its own, and `other` the one that repeats; else the other way round.
    pub independent: bool,
    /// The law that is not the equation; none where no law of its own was sought or found.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub other: Option<OtherLaw>,
}

/// A law that was not taken.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct OtherLaw {
    /// Terms with their coefficients.
    pub terms: Vec<(String, f64)>,
    /// Relative residual.
    pub residual: f64,
    /// Its criterion over that of the equation.
    pub criterion: f64,
}

/// Figures of a system estimated with its trajectory, as far as they concern one variable.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Together {
    /// Every measured derivative of the variable.
    pub channels: Vec<ChannelFit>,
    /// The term that is missed least, and what the criterion loses with it.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub weakest: Option<(String, f64)>,
    /// Inputs that were moved in time.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub delays: Vec<InputDelay>,
    /// What a term has to earn.
    pub price: f64,
    /// Sets of terms that were fitted.
    pub tried: usize,
    /// The criterion of each tie over the answer's, in the order of `ties`.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub ties: Vec<f64>,
}

/// An input that acts at another time than its record says.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct InputDelay {
    pub input: String,
    /// Positive if later.
    pub seconds: f64,
    pub samples: f64,
}

/// What the trajectory leaves of one channel's readings.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ChannelFit {
    pub signal: String,
    /// Root mean square of the residuals, in the signal's units, and relative to its spread.
    pub left: f64,
    pub relative: f64,
    /// The sensor's noise, declared or seen by smoothing. A spline of one stiffness that cannot follow what jumps of an input do
    /// sees more than there is.
    pub noise: f64,
    /// Whether the noise was declared.
    #[serde(skip_serializing_if = "std::ops::Not::not", default)]
    pub declared: bool,
    /// Autocorrelation of the residuals over the first lags, and what chance allows it to be.
    pub memory: f64,
    pub chance: f64,
    /// What it is in each file, by name, where sensors differ from file to file.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub files: Vec<(String, f64)>,
    /// Readings that were given no weight.
    #[serde(skip_serializing_if = "is_zero", default)]
    pub left_out: usize,
}

fn is_zero(count: &usize) -> bool {
    *count == 0
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct HeldOut {
    pub rows: usize,
    pub residual: f64,
}

/// What the dual point proves about the ℓ1 problem that proposed the support.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Proof {
    /// ε of ‖Φa − y‖₂ ≤ ε, relative to ‖y‖; 0 is basis pursuit with equality.
    pub tolerance: f64,
    /// (‖a‖₁ − dual value) / ‖a‖₁ on unit columns.
    pub gap: f64,
    /// max |φᵀλ| over all unit columns; 1 on the support of an optimal answer.
    pub max_correlation: f64,
    /// 1 − max |φᵀλ| off the support.
    pub margin: f64,
    /// Numerical rank of the support's columns, and how many there are.
    pub rank: usize,
    pub support: usize,
    /// Condition number of the support's unit columns.
    pub condition: f64,
    /// No combination of candidates that fits has a smaller ℓ1 norm.
    pub optimal: bool,
    /// No other combination has the same one.
    pub unique: bool,
    /// True if the printed terms are the ℓ1 answer's own support, not a choice among its proposals.
    pub of_answer: bool,
    /// True if the problem was that of all equations tied by constraints, under these.
    #[serde(skip_serializing_if = "std::ops::Not::not", default)]
    pub constrained: bool,
}

impl Discovery {
    /// A discovery without equations, for the variables of a model.
    pub fn of(model: &Model) -> Self {
        Discovery {
            system: model.system.clone(),
            discrete: model.discrete,
            variables: model
                .vars
                .iter()
                .map(|v| Variable {
                    name: v.name.clone(),
                    kind: v.kind,
                    order: v.order,
                    unit: v.unit.clone(),
                })
                .collect(),
            equations: Vec::new(),
            failed: Vec::new(),
        }
    }

    /// True if every equation that was asked for passes.
    pub fn passes(&self) -> bool {
        self.failed.is_empty() && self.equations.iter().all(|e| e.status != Status::Doubt)
    }

    /// What a signal is counted in, if that was said.
    pub fn unit(&self, s: Signal) -> Option<Unit> {
        let of = |id: VarId| self.variable_of(id)?.unit.as_ref();
        units::derivative(of(s.var)?, of(VarId::TIME)?, s.der)
    }

    /// The unit of a term's coefficient, and of its standard error; `None` where some signal has none.
    pub fn coefficient_unit(&self, target: Signal, term: &Term) -> Option<Unit> {
        let term = units::of_term(term, &|s| self.unit(s))?;
        units::coefficient(&self.unit(target)?, &term)
    }

    pub fn variable_of(&self, id: VarId) -> Option<&Variable> {
        self.variables.get(id.0 as usize)
    }
}

impl SignalNames for Discovery {
    fn variable(&self, var: VarId) -> &str {
        self.variable_of(var).map_or("?", |v| &v.name)
    }
}
