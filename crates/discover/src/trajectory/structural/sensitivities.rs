//! Sensitivities of readings along a random run.
//!
//! In: a problem, its unknown constants, random numbers. Out: the relative changes of what is read with every parameter and every start, or nothing where
//! the run meets a point at which the laws say nothing of some parameter.

use nalgebra::DMatrix;

use super::thresholds::STRUCTURAL;
use crate::random::SplitMix;
use crate::trajectory::model::Problem;
use sidc_lang::model::UnknownConstant;
use sidc_lang::term::{Expr, Signal, Term};
use sidc_system::switching::Switches;

/// Readings × (constants, coefficients, starts).
pub(super) type Sensitivities = DMatrix<f64>;

/// The laws with their derivatives.
pub(super) struct SensitiveSystem<'a> {
    problem: &'a Problem,
    constants: &'a [UnknownConstant],
    /// States that are read.
    read: Vec<usize>,
    laws: Vec<SensitiveLaw>,
}

/// z'ᵢ = known + Σ coefficient · column.
struct SensitiveLaw {
    state: usize,
    known: SensitiveTerm,
    /// With the number of their column.
    columns: Vec<(usize, SensitiveTerm)>,
}

/// An expression and its derivatives, those that are not zero.
struct SensitiveTerm {
    value: Expr,
    by_state: Vec<(usize, Expr)>,
    by_constant: Vec<(usize, Expr)>,
}

/// Where laws are evaluated.
struct Point<'a> {
    system: &'a SensitiveSystem<'a>,
    t: f64,
    z: &'a [f64],
    exogenous: &'a [f64],
    constants: &'a [f64],
}

/// Values of all parameters.
struct Values {
    constants: Vec<f64>,
    coefficients: Vec<f64>,
}

impl<'a> SensitiveSystem<'a> {
    /// `None` where sensitivities are no answer: laws that switch, contain rates, differ between runs or are constrained, or many candidates.
    pub fn of(problem: &'a Problem, constants: &'a [UnknownConstant]) -> Option<Self> {
        let system = &problem.system;
        let free = system.constraints.is_empty() && problem.run_columns.is_empty();
        let few = system.columns.len() <= STRUCTURAL.columns;
        let shared = constants.iter().all(|c| !c.per_run);
        let explicit =
            |t: &Term| !Switches::are_in(t) && system.laws.iter().all(|l| !t.mentions(l.target));
        let known = system.laws.iter().flat_map(|l| l.known.terms());
        let mut all = system.columns.iter().chain(known.map(|(_, t)| t));
        if constants.is_empty() || !(free && few && shared) || !all.all(explicit) {
            return None;
        }
        let sensitive = |value: Expr| {
            let by = |s: Signal| Some(value.derivative(s)).filter(|d| d.as_number() != Some(0.0));
            let states = system.states.iter().enumerate();
            let unknowns = constants.iter().enumerate();
            SensitiveTerm {
                by_state: states.filter_map(|(i, s)| Some((i, by(*s)?))).collect(),
                by_constant: unknowns
                    .filter_map(|(k, c)| Some((k, by(Signal::new(c.var))?)))
                    .collect(),
                value,
            }
        };
        let laws = system.laws.iter().map(|law| SensitiveLaw {
            state: law.state,
            known: sensitive(law.known.clone()),
            columns: (law.columns.clone())
                .map(|j| (j, sensitive(Expr::from((1.0, system.columns[j].clone())))))
                .collect(),
        });
        Some(SensitiveSystem {
            problem,
            constants,
            read: problem.read_states().collect(),
            laws: laws.collect(),
        })
    }

    /// One run from a random start.
    pub fn run(&self, numbers: &mut SplitMix) -> Option<Sensitivities> {
        let n = self.problem.system.states.len();
        let mut exogenous = self.exogenous(numbers)?;
        let mut z = self.start(numbers)?;
        let values = self.values(&z, &exogenous, numbers)?;
        let width = self.constants.len() + values.coefficients.len() + n;
        let mut s = DMatrix::zeros(n, width);
        for i in 0..n {
            // Relative changes, of the start as of all else.
            s[(i, width - n + i)] = z[i];
        }
        let step = self.step(&z, &exogenous, &values)?;
        let mut rows: Vec<f64> = Vec::new();
        let mut t = 0.0;
        for k in 0..STRUCTURAL.steps {
            if k > 0 && k % STRUCTURAL.held == 0 {
                exogenous = self.exogenous(numbers)?;
            }
            for i in &self.read {
                let size = 1.0 / self.size(*i);
                rows.extend(s.row(*i).iter().map(|x| x * size));
            }
            (z, s) = self.advance((t, step), (&z, &s), &exogenous, &values)?;
            t += step;
        }
        Some(DMatrix::from_row_slice(rows.len() / width, width, &rows))
    }

    /// The spread of a state; 1 where nothing is known of it.
    fn size(&self, state: usize) -> f64 {
        let spread = self.problem.spread[state];
        if spread > 0.0 { spread } else { 1.0 }
    }

    /// One reading of each state that is read; a number near one or its spread for the others.
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
    fn values(&self, z: &[f64], exogenous: &[f64], numbers: &mut SplitMix) -> Option<Values> {
        let constants: Vec<f64> = (self.constants.iter())
            .map(|c| {
                let (from, to) = c.ranges()[0];
                let part = 0.3 + 0.4 * numbers.unit();
                match from * to > 0.0 {
                    true => from * (to / from).powf(part),
                    false => from + part * (to - from),
                }
            })
            .collect();
        let mut coefficients = vec![0.0; self.problem.system.columns.len()];
        let at = self.point(0.0, z, exogenous, &constants);
        let rate = STRUCTURAL.rates / self.problem.length().max(f64::MIN_POSITIVE);
        for law in &self.laws {
            for (j, column) in &law.columns {
                let size = told(at.eval(&column.value))?.abs();
                let way = if numbers.unit() < 0.5 { -1.0 } else { 1.0 };
                coefficients[*j] =
                    way * (0.5 + numbers.unit()) * rate * self.size(law.state) / size;
            }
        }
        Some(Values {
            constants,
            coefficients,
        })
    }

    fn point<'b>(
        &'b self,
        t: f64,
        z: &'b [f64],
        exogenous: &'b [f64],
        constants: &'b [f64],
    ) -> Point<'b> {
        Point {
            system: self,
            t,
            z,
            exogenous,
            constants,
        }
    }

    /// A small part of the fastest time constant at the start. `None` where a derivative vanishes there, so that it tells nothing.
    fn step(&self, z: &[f64], exogenous: &[f64], values: &Values) -> Option<f64> {
        let at = self.point(0.0, z, exogenous, &values.constants);
        let mut fastest = STRUCTURAL.rates / self.problem.length().max(f64::MIN_POSITIVE);
        for law in &self.laws {
            let known = std::iter::once((1.0, &law.known));
            let columns = law.columns.iter();
            let columns = columns.map(|(j, c)| (values.coefficients[*j], c));
            for (weight, term) in known.chain(columns) {
                for (_, d) in term.by_state.iter().chain(&term.by_constant) {
                    told(at.eval(d))?;
                }
                for (_, d) in &term.by_state {
                    fastest = (weight * at.eval(d)).abs().max(fastest);
                }
            }
        }
        Some(STRUCTURAL.step / fastest)
    }

    /// A step by the classical method of Runge and Kutta. The sensitivities are exactly those of the discrete run, so symmetries hold to rounding.
    fn advance(
        &self,
        (t, h): (f64, f64),
        (z, s): (&[f64], &DMatrix<f64>),
        exogenous: &[f64],
        values: &Values,
    ) -> Option<(Vec<f64>, DMatrix<f64>)> {
        let (mut end, mut end_s) = (z.to_vec(), s.clone());
        let (mut rate, mut rate_s) = (vec![0.0; z.len()], DMatrix::zeros(s.nrows(), s.ncols()));
        for (part, weight) in [(0.0, 1.0), (0.5, 2.0), (0.5, 2.0), (1.0, 1.0)] {
            let at: Vec<f64> = z.iter().zip(&rate).map(|(z, r)| z + part * h * r).collect();
            let at_s = s + &rate_s * (part * h);
            let point = self.point(t + part * h, &at, exogenous, &values.constants);
            (rate, rate_s) = self.rates(&point, &at_s, &values.coefficients);
            let by = weight * h / 6.0;
            end.iter_mut().zip(&rate).for_each(|(z, r)| *z += by * r);
            end_s += &rate_s * by;
        }
        let finite = end.iter().chain(end_s.iter()).all(|x| x.is_finite());
        finite.then_some((end, end_s))
    }

    fn rates(
        &self,
        at: &Point,
        s: &DMatrix<f64>,
        coefficients: &[f64],
    ) -> (Vec<f64>, DMatrix<f64>) {
        let n = at.z.len();
        let mut rate = vec![0.0; n];
        let mut rate_s = DMatrix::zeros(n, s.ncols());
        for (i, value) in rate.iter_mut().enumerate() {
            if let Some(next) = self.problem.system.derivative_state(i) {
                *value = at.z[next];
                rate_s.row_mut(i).copy_from(&s.row(next));
            }
        }
        let constants = at.constants;
        for law in &self.laws {
            let i = law.state;
            let mut add = |weight: f64, term: &SensitiveTerm| {
                rate[i] += weight * at.eval(&term.value);
                for (k, d) in &term.by_state {
                    let slope = weight * at.eval(d);
                    let moved = s.row(*k) * slope;
                    let mut row = rate_s.row_mut(i);
                    row += moved;
                }
                for (k, d) in &term.by_constant {
                    rate_s[(i, *k)] += weight * at.eval(d) * constants[*k];
                }
            };
            add(1.0, &law.known);
            for (j, column) in &law.columns {
                add(coefficients[*j], column);
            }
            for (j, column) in &law.columns {
                rate_s[(i, constants.len() + j)] += coefficients[*j] * at.eval(&column.value);
            }
        }
        (rate, rate_s)
    }
}

impl Point<'_> {
    fn eval(&self, e: &Expr) -> f64 {
        let system = &self.system.problem.system;
        let unknowns = self.system.constants;
        e.eval(&|signal: Signal| {
            if signal == Signal::TIME {
                return self.t;
            }
            if let Some(k) = unknowns.iter().position(|u| Signal::new(u.var) == signal) {
                return self.constants[k];
            }
            if let Some(i) = system.state_index(signal) {
                return self.z[i];
            }
            let place = system.exogenous.iter().position(|s| *s == signal);
            place.map_or(f64::NAN, |e| self.exogenous[e])
        })
    }
}

/// A value that says something: finite, and not lost to underflow.
fn told(x: f64) -> Option<f64> {
    (x.is_finite() && x.abs() > STRUCTURAL.underflow).then_some(x)
}
