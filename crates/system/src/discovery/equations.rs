//! The equations found, each with its evidence: the data that emitters, simulation and reports work on.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::correlations::Correlations;
use super::hidden_states::HiddenState;
use super::row_origin::RowOrigin;
use super::signal_delays::{SignalDelay, stated};
use super::unknown_values::UnknownValue;
use crate::discovery::{
    Halves, Identifiability, JointEvidence, OmittedTerm, Reason, ReasonCode, RelationChoices,
    RunCoefficient, SparsestProof, TermEvidence, Verification, Witness,
};
use sidc_lang::model::{Model, Reset, VarKind};
use sidc_lang::term::{Language, Signal, SignalNames, Term, VarId};
use sidc_lang::units;
use sidc_lang::units::Unit;

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
    /// Names of runs that the equations were not found from, because they do not follow them.
    pub runs_left: Vec<String>,
    /// Parts of runs that they were not found from, because bodies lie on each other there.
    pub rests: Vec<Rest>,
    /// Other ways to write the relations that the equations span; `None` where none were looked for.
    pub relations: Option<Box<RelationChoices>>,
    /// Declared delays, stated or found, in order of declaration.
    pub delays: Vec<SignalDelay>,
    /// The unknown constants that stand in the equations, in order of declaration.
    pub unknowns: Vec<UnknownValue>,
    /// How the errors of the coefficients are correlated, fit by fit; coefficients of different fits have independent errors.
    pub correlations: Vec<Correlations>,
    /// The components of the state that nothing measures.
    pub hidden: Vec<HiddenState>,
    /// Where states jump, as the model states it; unknown constants stand there by name.
    pub resets: Vec<Reset>,
}

/// A part of a run along which bodies that have struck each other lie on each other.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Rest {
    /// The run, by its name.
    pub run: String,
    /// Its first and its last instant, in units of time.
    pub from: f64,
    pub to: f64,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    pub name: String,
    pub kind: VarKind,
    /// Highest derivative that exists.
    pub order: u8,
    /// The unit, if declared.
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
    /// The solution path from the empty equation on; empty unless requested.
    pub path: Vec<PathKnot>,
}

/// A knot of the solution path of `min ½‖Φa − y‖² + τ‖Da‖₁`, where a term enters or leaves.
#[derive(Clone, Debug, PartialEq)]
pub struct PathKnot {
    /// Its index on the path, from 1. Where indices skip, knots were left out.
    pub number: usize,
    /// τ relative to the first knot.
    pub penalty: f64,
    /// ‖Φa − y‖/‖y‖, rows weighted.
    pub residual: f64,
    /// In the order of printing; coefficients in model units.
    pub terms: Vec<FoundTerm>,
    /// The term that enters here, its coefficient still zero.
    pub enters: Option<Term>,
    /// The term that leaves here.
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
    /// `None` for fixed terms, and where nothing was tested.
    pub evidence: Option<Box<TermEvidence>>,
    /// Its value in each run; empty where all share one. The coefficient is then their mean.
    pub runs: Vec<RunCoefficient>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Status {
    /// Stated by the model.
    Known,
    /// Found, and no evidence is against it.
    Pass,
    /// Found, but with reasons to distrust it.
    Doubt,
}

/// An equation that was searched for and not found.
#[derive(Clone, Debug)]
pub struct Failed {
    pub target: Signal,
    pub reasons: Vec<Reason>,
}

/// The figures behind one equation. Relative figures refer to the root mean square of the target, known part removed,
/// rows weighted by their accuracy.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Evidence {
    /// Rows M that the coefficients were found from.
    pub rows: usize,
    /// Candidate terms N.
    pub candidates: usize,
    /// How the rows were made.
    #[serde(
        rename = "method",
        skip_serializing_if = "RowOrigin::is_samples",
        default
    )]
    pub origin: RowOrigin,
    /// Solver that proposed the support.
    pub solver: String,
    pub iterations: usize,
    /// Root mean square residual, relative.
    pub residual: f64,
    /// Root mean square of the target's estimated error, relative; 0 if it was measured.
    pub target_error: f64,
    /// Terms among which the support was chosen; the solver ruled out the others.
    #[serde(default)]
    pub searched: usize,
    /// The residual on rows not used.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub held_out: Option<HeldOut>,
    pub certificate: Proof,
    /// Over which values of its unknown constants the equation has the least norm.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub certificate_range: Vec<RangeCertificate>,
    /// Figures of the joint estimation with the trajectory, if there was one.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    #[serde(rename = "together")]
    pub joint: Option<JointEvidence>,
    /// Which ways were tried, where the first ended in doubt.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    #[serde(rename = "ways")]
    pub methods: Option<Box<MethodComparison>>,
    /// Whether the equation repeats other equations of its system.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub relation: Option<Rearranged>,
    /// Other supports that fit these data as well.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub ties: Vec<Vec<String>>,
    /// How stability was estimated.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub halves: Option<Halves>,
    /// The term left out that comes nearest to being included.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    #[serde(rename = "nearest")]
    pub omitted: Option<OmittedTerm>,
    /// Which terms the rows can distinguish.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub identifiability: Option<Box<Identifiability>>,
    /// The outcome of verification, if it was requested.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub verification: Option<Box<Verification>>,
    /// The fewest terms that fit, if they were looked for.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub sparsest: Option<Box<SparsestProof>>,
    /// What verification needs; not written.
    #[serde(skip)]
    pub witness: Option<Arc<Witness>>,
}

/// A second way, tried because the first ended in doubt or blurs the jumps of a law.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MethodComparison {
    /// The way of `--method` that was tried first, and the doubts of all its equations.
    pub first: String,
    pub first_doubts: Vec<ReasonCode>,
    /// The way that was tried then, and the doubts of all its equations; none where it holds.
    pub second: String,
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub second_doubts: Vec<ReasonCode>,
    /// The way that gave these equations.
    pub given: String,
    /// Why the second was tried.
    #[serde(default)]
    pub why: SecondMethodReason,
}

/// Why a second way to the same equations is tried.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SecondMethodReason {
    /// The measured rates may be bad; the second does without them.
    #[default]
    MeasuredRates,
    /// A law jumps or may jump, or is doubted and bends; the first blurs both.
    Jumps,
    /// The rates were estimated from clean readings, and their errors may hide which terms the law has; the second needs no rates.
    EstimatedRates,
}

/// Two laws of one target, of which one follows from other equations of the system.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Rearranged {
    /// Targets of the equations that are repeated.
    pub of: Vec<String>,
    /// Part of the repeating law's gradient outside the span of theirs: 0 for the same relation.
    #[serde(rename = "apart")]
    pub separation: f64,
    /// The uncertainty of that part, in the same units.
    #[serde(rename = "open")]
    pub uncertainty: f64,
    /// Median condition number of the mass matrix along the data, rows of unit length.
    pub condition: f64,
    /// True if the equation is the independent law and `other` the repeating one; false for the reverse.
    pub independent: bool,
    /// The other law; `None` where no independent law was sought or found.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub other: Option<OtherLaw>,
}

/// A law that was rejected.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct OtherLaw {
    /// Terms with their coefficients.
    pub terms: Vec<(String, f64)>,
    /// Relative residual.
    pub residual: f64,
    /// Its criterion minus that of the equation.
    pub criterion: f64,
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
    /// (‖a‖₁ − dual value) / ‖a‖₁, ‖a‖₁ with the weights of `grading`.
    pub gap: f64,
    /// max |φᵀλ| over all columns, each over its weight; 1 on the support of an optimal answer.
    pub max_correlation: f64,
    /// 1 − max |φᵀλ| off the support.
    pub margin: f64,
    /// Numerical rank of the support's columns, and how many there are.
    pub rank: usize,
    pub support: usize,
    /// Condition number of the support's unit columns.
    pub condition: f64,
    /// No other combination that fits has a smaller ℓ1 norm.
    pub optimal: bool,
    /// No other combination has the same norm.
    pub unique: bool,
    /// True if the printed terms are the support of the ℓ1 answer, not a choice among its proposals.
    pub of_answer: bool,
    /// The weights of the 1-norm; `None` is the plain one on unit columns.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub grading: Option<NormGrading>,
    /// True if all equations tied by constraints were solved together.
    #[serde(skip_serializing_if = "std::ops::Not::not", default)]
    pub constrained: bool,
}

/// What is proved of an equation over the range of an unknown constant: whether other terms that give the same right side on these rows, each
/// at any value in the range, have a smaller ℓ1 norm.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RangeCertificate {
    pub unknown: String,
    /// The range that was searched, in the unit of the constant.
    pub declared: (f64, f64),
    /// Values over which none has a smaller norm, up to rounding; `None` where that is not proved of any.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub holds: Option<(f64, f64)>,
    /// The norm of another combination that gives the right side to 1e-4, over that of the equation, where one was found in the range that was searched.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub smaller: Option<f64>,
    /// The value of the constant in the largest of its terms that has another value; `None` where none has.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub at: Option<f64>,
    /// Other unknown constants of the library, which kept their values.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub kept: Vec<String>,
}

/// The norm Σ κ^d ‖φ‖ |a|, d the degree of a term, each factor counted by how much it varies.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NormGrading {
    /// κ
    pub base: f64,
    /// A factor whose terms weigh 1e5 times as much; empty if there is none.
    #[serde(rename = "dear", skip_serializing_if = "String::is_empty", default)]
    pub penalized: String,
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
            runs_left: Vec::new(),
            rests: Vec::new(),
            relations: None,
            delays: stated(model),
            unknowns: Vec::new(),
            correlations: Vec::new(),
            hidden: Vec::new(),
            resets: model.resets.clone(),
        }
    }

    /// True if every equation that was searched for passes.
    pub fn passes(&self) -> bool {
        self.failed.is_empty() && self.equations.iter().all(|e| e.status != Status::Doubt)
    }

    /// The unit of a signal, if declared.
    pub fn unit(&self, s: Signal) -> Option<Unit> {
        let of = |id: VarId| self.variable_of(id)?.unit.as_ref();
        units::derivative(of(s.var)?, of(VarId::TIME)?, s.der)
    }

    /// The unit of a term's coefficient, and of its standard error; `None` where some signal has none.
    pub fn coefficient_unit(&self, target: Signal, term: &Term) -> Option<Unit> {
        let term = units::of_term(term, &|s| self.unit(s))?;
        units::coefficient(&self.unit(target)?, &term)
    }

    /// The noise of a signal's sensor, declared or seen by smoothing, in its unit; 0 where none was estimated.
    pub fn sensor_noise(&self, signal: Signal) -> f64 {
        let evidence = self.equations.iter().filter_map(|e| e.evidence.as_ref());
        let together = evidence.filter_map(|e| e.joint.as_ref());
        let name = self.name(signal);
        let mut channels = together.flat_map(|t| &t.channels);
        let channel = channels.find(|c| c.signal == name);
        channel.map_or(0.0, |c| c.noise).clamp(0.0, f64::MAX)
    }

    /// An equation in a sentence: `dx = -1.02*x`.
    pub fn in_short(&self, equation: &Equation, digits: usize) -> String {
        let terms = equation.terms.iter().map(|t| (t.coefficient, &t.term));
        let right = Language(self).sum(terms, digits);
        format!("{} = {right}", self.name(equation.target))
    }

    pub fn variable_of(&self, id: VarId) -> Option<&Variable> {
        self.variables.get(id.0 as usize)
    }
}

impl Equation {
    /// Adds a reason not to trust it.
    pub fn doubt(&mut self, reason: Reason) {
        self.reasons.push(reason);
        self.status = Status::Doubt;
    }

    /// True if the search was ended early.
    pub fn was_stopped(&self) -> bool {
        self.reasons.iter().any(is_stop)
    }
}

impl Discovery {
    /// Doubts every equation that was looked for and for which there is a reason. All are judged before any is doubted.
    pub fn doubt_each(&mut self, reason: impl Fn(&Discovery, &Equation) -> Option<Reason>) {
        let sought = |e: &&Equation| e.status != Status::Known;
        let judge = |e: &Equation| Some(e).filter(sought).and_then(|e| reason(self, e));
        let reasons: Vec<Option<Reason>> = self.equations.iter().map(judge).collect();
        for (equation, reason) in self.equations.iter_mut().zip(reasons) {
            if let Some(reason) = reason {
                equation.doubt(reason);
            }
        }
    }

    /// True if the search of any equation was ended early.
    pub fn was_stopped(&self) -> bool {
        let failed = self.failed.iter().flat_map(|f| &f.reasons);
        failed
            .chain(self.equations.iter().flat_map(|e| &e.reasons))
            .any(is_stop)
    }
}

fn is_stop(reason: &Reason) -> bool {
    matches!(reason.code, ReasonCode::Interrupted | ReasonCode::TimeLimit)
}

impl SignalNames for Discovery {
    fn is_constant(&self, var: VarId) -> bool {
        self.variable_of(var)
            .is_some_and(|v| v.kind == VarKind::Unknown)
    }

    fn variable(&self, var: VarId) -> &str {
        self.variable_of(var).map_or("?", |v| &v.name)
    }
}
