//! Sensitivities of readings along a random run.
//!
//! In: a problem, its unknown constants, random numbers. Out: the relative changes of what is read with every parameter and every start, or nothing where
//! the run meets a point at which the laws say nothing of some parameter.

use nalgebra::DMatrix;

use super::thresholds::STRUCTURAL;
use crate::random::SplitMix;
use crate::trajectory::hidden_states::{SensitiveLaws, between};
use crate::trajectory::model::{Problem, indicator};
use sidc_lang::model::UnknownConstant;
use sidc_lang::term::{Expr, Signal, Term};
use sidc_system::switching::Switches;

/// Readings × (constants, coefficients, starts).
pub(super) type Sensitivities = DMatrix<f64>;

/// The laws, their constants and coefficients as parameters.
pub(super) struct SensitiveSystem<'a> {
    problem: &'a Problem,
    constants: &'a [UnknownConstant],
    /// States that are read.
    read: Vec<usize>,
    laws: SensitiveLaws<'a>,
}

impl<'a> SensitiveSystem<'a> {
    /// `None` where sensitivities are no answer: laws that switch, contain rates, differ between runs or are constrained, or many candidates.
    pub fn of(problem: &'a Problem, constants: &'a [UnknownConstant]) -> Option<Self> {
        let system = &problem.system;
        let free = system.constraints.is_empty() && problem.run_columns.is_empty();
        let few = system.columns.len() <= STRUCTURAL.columns;
        let shared = constants.iter().all(|c| !c.per_run);
        let known = system.laws.iter().flat_map(|l| l.known.terms());
        let mut all = system.columns.iter().chain(known.map(|(_, t)| t));
        let switches = all.any(Switches::are_in) || !system.resets.is_empty();
        if constants.is_empty() || !(free && few && shared) || switches {
            return None;
        }
        // Signals that no model declares; no column here belongs to a run.
        let coefficient = indicator;
        let term = |j: usize| Term::signal(coefficient(j)).mul(&system.columns[j]);
        let laws = system.laws.iter().map(|law| {
            let columns = law.columns.clone();
            columns.fold(law.known.clone(), |sum, j| sum + Expr::from((1.0, term(j))))
        });
        let laws: Vec<Expr> = laws.collect();
        let parameters = constants.iter().map(|c| Signal::new(c.var));
        let parameters = parameters.chain((0..system.columns.len()).map(coefficient));
        let parameters: Vec<Signal> = parameters.collect();
        Some(SensitiveSystem {
            problem,
            constants,
            read: problem.read_states().collect(),
            laws: SensitiveLaws::new(system, &laws, &parameters)?,
        })
    }

    /// One run from a random start.
    pub fn run(&self, numbers: &mut SplitMix) -> Option<Sensitivities> {
        let mut exogenous = self.exogenous(numbers)?;
        let z = self.start(numbers)?;
        let parameters = self.parameters(&z, &exogenous, numbers)?;
        let step = self.step(&z, &exogenous, &parameters)?;
        let width = self.laws.width();
        // Relative changes, of the start as of all else.
        let mut state = self.laws.start(&z, &|i| z[i]);
        let mut rows: Vec<f64> = Vec::new();
        for k in 0..STRUCTURAL.steps {
            if k > 0 && k % STRUCTURAL.held == 0 {
                exogenous = self.exogenous(numbers)?;
            }
            for i in &self.read {
                let size = 1.0 / self.size(*i);
                let row = state.s[i * width..(i + 1) * width].iter().enumerate();
                rows.extend(row.map(|(j, x)| x * size * parameters.get(j).unwrap_or(&1.0)));
            }
            state = self
                .laws
                .step(&state, step, &|place, _| exogenous[place], &parameters)?;
        }
        Some(DMatrix::from_row_slice(rows.len() / width, width, &rows))
    }

    /// The spread of a state; 1 where nothing is known of it.
    fn size(&self, state: usize) -> f64 {
        let spread = self.problem.spread[state];
        if spread > 0.0 { spread } else { 1.0 }
    }

    /// One reading of each state that is read; a number near its spread for the others.
    fn start(&self, numbers: &mut SplitMix) -> Option<Vec<f64>> {
        let states = 0..self.problem.system.states.len();
        let start = states.map(|i| {
            let near = self.size(i) * (0.5 + numbers.unit());
            let read: Vec<f64> = (self.problem.records.iter())
                .flat_map(|r| r.measured[i].iter().copied())
                .filter(|x| x.is_finite() && *x != 0.0)
                .collect();
            match read.len() {
                0 => near,
                count => read[numbers.below(count)],
            }
        });
        let start: Vec<f64> = start.collect();
        start.iter().all(|x| x.is_finite()).then_some(start)
    }

    /// Inputs of a random sample, each changed by up to a half; zero is a value like any other, but tells nothing of its factors.
    fn exogenous(&self, numbers: &mut SplitMix) -> Option<Vec<f64>> {
        let record = self.problem.records.first()?;
        let value = |values: &Vec<f64>, numbers: &mut SplitMix| {
            let own = values.get(numbers.below(values.len())).copied();
            let own = own.filter(|x| x.is_finite() && *x != 0.0).unwrap_or(1.0);
            own * (0.5 + numbers.unit())
        };
        let all = record.exogenous.iter();
        Some(all.map(|e| value(&e.values, numbers)).collect())
    }

    /// Values of the constants within their ranges; coefficients with which every term moves its state by about its spread in a part of the record.
    fn parameters(&self, z: &[f64], exogenous: &[f64], numbers: &mut SplitMix) -> Option<Vec<f64>> {
        let mut parameters: Vec<f64> = (self.constants.iter())
            .map(|c| between(c.ranges()[0], 0.3 + 0.4 * numbers.unit()))
            .collect();
        let first = parameters.len();
        parameters.resize(self.laws.parameters, 1.0);
        let out = self.laws.outputs(z, &|place| exogenous[place], &parameters);
        let columns = self.laws.parameter_slopes(&out);
        for ((law, parameter), column) in columns.filter(|((_, k), _)| *k >= first) {
            let way = if numbers.unit() < 0.5 { -1.0 } else { 1.0 };
            let size = self.size(self.problem.system.laws[law].state) * self.slowest();
            parameters[parameter] = way * (0.5 + numbers.unit()) * size / told(column)?.abs();
        }
        Some(parameters)
    }

    /// How fast laws are at least, 1/s.
    fn slowest(&self) -> f64 {
        STRUCTURAL.rates / self.problem.length().max(f64::MIN_POSITIVE)
    }

    /// A small part of the fastest time constant at the start. `None` where a derivative vanishes there, so that it tells nothing.
    fn step(&self, z: &[f64], exogenous: &[f64], parameters: &[f64]) -> Option<f64> {
        let out = self.laws.outputs(z, &|place| exogenous[place], parameters);
        for slope in &out[self.problem.system.laws.len()..] {
            told(*slope)?;
        }
        Some(STRUCTURAL.step / self.laws.fastest(&out).max(self.slowest()))
    }
}

/// A value that says something: finite, and not lost to underflow.
fn told(x: f64) -> Option<f64> {
    (x.is_finite() && x.abs() > STRUCTURAL.underflow).then_some(x)
}
