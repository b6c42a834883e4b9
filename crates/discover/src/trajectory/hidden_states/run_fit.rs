//! Given laws run from a start, their constants and starts fitted to the readings (output error; Ljung, System Identification, 1999, section 10.2).
//!
//! In: a problem whose laws are all given, ranges of its constants. Out: constants, the best first; courses of hidden states. What is off by the noise is
//! left to the fit of the trajectory.
//!
//! A run follows what wrong constants make of it, so nothing has to be guessed of hidden states but where they start. Long runs have many local minima:
//! constants are fitted to the first part of the records from many starts, by Levenberg's and Marquardt's method, and the best of these to more and more.

use crate::statistics::agree;
use nalgebra::{DMatrix, DVector};

use super::first_values::{SoughtRanges, first_values, holding};
use super::given_course::given_courses;
use super::hidden_laws::hidden_laws;
use super::sensitive_laws::{SensitiveLaws, SensitiveState};
use super::thresholds::OUTPUT_ERROR;
use crate::trajectory::model::{HiddenCourse, Problem};
use sidc_lang::term::{Expr, Signal};
use sidc_progress::Observer;
use sidc_system::least_squares::{Descent, LeastSquares, levenberg_marquardt};

/// Values of the constants with which runs follow the readings best; none alike. Empty where no run ends.
pub(crate) fn constants_by_runs(
    problem: &Problem,
    sought: &SoughtRanges,
    observer: &mut dyn Observer,
) -> Vec<Vec<f64>> {
    let signals: Vec<Signal> = sought.iter().map(|(s, _)| *s).collect();
    let Some(fit) = RunFit::of(problem, &signals) else {
        return Vec::new();
    };
    let mut all: Vec<Fitted> = Vec::new();
    for values in first_values(sought, OUTPUT_ERROR.values, OUTPUT_ERROR.combinations) {
        if !observer.go_on() {
            break;
        }
        let ranges = values.iter().zip(sought);
        let ranges = ranges.map(|(v, (_, ranges))| holding(ranges, *v)).collect();
        all.extend(fit.descend(fit.guessed(values, ranges), OUTPUT_ERROR.parts[0]));
    }
    for (part, kept) in OUTPUT_ERROR.parts.iter().zip(OUTPUT_ERROR.kept).skip(1) {
        best_of(&mut all, kept);
        let further = all.iter();
        let further = further.filter_map(|f| fit.descend(f.unknowns.clone(), *part));
        let further: Vec<Fitted> = further.collect();
        if further.is_empty() || !observer.go_on() {
            break;
        }
        all = further;
    }
    best_of(&mut all, OUTPUT_ERROR.kept[OUTPUT_ERROR.kept.len() - 1]);
    all.into_iter().map(|f| f.unknowns.constants).collect()
}

/// The courses of the hidden states in the run that follows the readings best, at the values that the constants have.
pub(crate) fn hidden_courses_by_runs(problem: &Problem) -> Option<Vec<HiddenCourse>> {
    let fit = RunFit::of(problem, &[])?;
    let mut unknowns = fit.guessed(Vec::new(), Vec::new());
    for part in OUTPUT_ERROR.parts {
        unknowns = fit.descend(unknowns, part)?.unknowns;
    }
    let path = |r: usize| -> Option<Vec<f64>> {
        let run = fit.run(r, problem.records[r].len(), &unknowns)?;
        Some(run.into_iter().flat_map(|state| state.z).collect())
    };
    let paths: Vec<Vec<f64>> = (0..problem.records.len())
        .map(path)
        .collect::<Option<_>>()?;
    let (given, _) = hidden_laws(problem);
    let course = |law| HiddenCourse::along(problem, law, &paths, &|_| 0.0);
    Some(given.into_iter().map(course).collect())
}

/// What is fitted.
#[derive(Clone)]
struct Unknowns {
    constants: Vec<f64>,
    /// Of each constant.
    ranges: Vec<(f64, f64)>,
    /// Of each record.
    starts: Vec<Vec<f64>>,
}

struct Fitted {
    /// Mean square, of the spreads.
    square: f64,
    unknowns: Unknowns,
}

struct RunFit<'a> {
    problem: &'a Problem,
    constants: &'a [Signal],
    laws: SensitiveLaws<'a>,
    read: Vec<usize>,
}

/// Least squares at some unknowns.
struct Linearized {
    square: f64,
    normal: DMatrix<f64>,
    right: DVector<f64>,
}

impl<'a> RunFit<'a> {
    fn of(problem: &'a Problem, constants: &'a [Signal]) -> Option<RunFit<'a>> {
        let laws: Vec<Expr> = problem
            .system
            .laws
            .iter()
            .map(|l| l.known.clone())
            .collect();
        Some(RunFit {
            problem,
            constants,
            laws: SensitiveLaws::new(&problem.system, &laws, constants)?,
            read: problem.read_states().collect(),
        })
    }

    /// Starts at the first smoothed readings; hidden states where their laws put them at rest.
    fn guessed(&self, constants: Vec<f64>, ranges: Vec<(f64, f64)>) -> Unknowns {
        let named = self.constants.iter().zip(&constants);
        let named = named.map(|(s, value)| (*s, None, *value));
        let at = self.problem.with_constant_values(named);
        let n = self.problem.states();
        let (given, _) = hidden_laws(&at);
        let courses = given_courses(&at, &given).unwrap_or_default();
        let at = at.with_hidden_courses(&courses, &[]);
        Unknowns {
            constants,
            ranges,
            starts: at.smoothed.iter().map(|c| c.at(0, n).to_vec()).collect(),
        }
    }

    /// States and sensitivities at the first samples of a record; `None` where the run does not end.
    fn run(&self, record: usize, samples: usize, at: &Unknowns) -> Option<Vec<SensitiveState>> {
        let data = &self.problem.records[record];
        let mut state = self.laws.start(&at.starts[record], &|_| 1.0);
        let mut run = vec![state.clone()];
        for k in 0..samples - 1 {
            let h = data.time[k + 1] - data.time[k];
            let here = |place: usize| data.exogenous_at(place, k, 0.0);
            let out = self.laws.outputs(&state.z, &here, &at.constants);
            let steps = (h * self.laws.fastest(&out) / OUTPUT_ERROR.step).ceil();
            if steps.is_nan() || steps > OUTPUT_ERROR.steps as f64 {
                return None;
            }
            let steps = steps.max(1.0);
            for step in 0..steps as usize {
                let exogenous = |place: usize, part: f64| {
                    data.exogenous_at(place, k, (step as f64 + part) / steps)
                };
                state = self
                    .laws
                    .step(&state, h / steps, &exogenous, &at.constants)?;
            }
            run.push(state.clone());
        }
        Some(run)
    }

    /// The least square reached from some unknowns, on this part of every record.
    fn descend(&self, from: Unknowns, part: f64) -> Option<Fitted> {
        let mut partial = PartialFit { whole: self, part };
        let descent = Descent {
            steps: OUTPUT_ERROR.iterations,
            converged: OUTPUT_ERROR.converged,
            still: 0.0,
        };
        let found = levenberg_marquardt(&mut partial, from, descent)?;
        Some(Fitted {
            square: found.fit.square,
            unknowns: found.point,
        })
    }

    fn linearize(&self, at: &Unknowns, part: f64) -> Option<Linearized> {
        let (n, p) = (self.problem.states(), self.constants.len());
        let size = p + n * self.problem.records.len();
        let mut normal = DMatrix::zeros(size, size);
        let mut right = DVector::zeros(size);
        let (mut square, mut count) = (0.0, 0_usize);
        for (r, record) in self.problem.records.iter().enumerate() {
            let least = OUTPUT_ERROR.samples * (p + n);
            let most = (OUTPUT_ERROR.most_samples / self.problem.records.len()).max(least);
            let samples = (part * record.len().min(most) as f64) as usize;
            let samples = samples.max(least).min(record.len());
            let run = self.run(r, samples, at)?;
            // The place of a column of the run's sensitivities among all unknowns.
            let place = |j: usize| if j < p { j } else { p + r * n + (j - p) };
            let width = self.laws.width();
            for (k, state) in run.iter().enumerate() {
                for i in &self.read {
                    let reading = record.measured[*i][k];
                    if !reading.is_finite() {
                        continue;
                    }
                    let weight = 1.0 / self.problem.spread[*i].max(f64::MIN_POSITIVE);
                    let off = weight * (reading - state.z[*i]);
                    square += off * off;
                    count += 1;
                    let row = &state.s[i * width..(i + 1) * width];
                    for (a, x) in row.iter().enumerate() {
                        let x = x * weight * at.scale(a);
                        right[place(a)] += x * off;
                        for (b, y) in row[..=a].iter().enumerate() {
                            normal[(place(a), place(b))] += x * y * weight * at.scale(b);
                        }
                    }
                }
            }
        }
        normal.fill_upper_triangle_with_lower_triangle();
        let square = square / count.max(1) as f64;
        square.is_finite().then_some(Linearized {
            square,
            normal,
            right,
        })
    }

    fn moved(&self, at: &Unknowns, step: &DVector<f64>) -> Unknowns {
        let (n, p) = (self.problem.states(), self.constants.len());
        let moved = |(k, value): (usize, &f64)| {
            let (from, to) = at.ranges[k];
            let by = step[k].clamp(-1.0, 1.0);
            let moved = match from * to > 0.0 {
                true => value * by.exp(),
                false => value + by * at.scale(k),
            };
            moved.clamp(from, to)
        };
        let starts = at.starts.iter().enumerate().map(|(r, start)| {
            let own = start.iter().enumerate();
            own.map(|(i, x)| x + step[p + r * n + i]).collect()
        });
        Unknowns {
            constants: at.constants.iter().enumerate().map(moved).collect(),
            ranges: at.ranges.clone(),
            starts: starts.collect(),
        }
    }
}

/// A fit to this part of every record.
struct PartialFit<'a> {
    whole: &'a RunFit<'a>,
    part: f64,
}

impl LeastSquares for PartialFit<'_> {
    type Point = Unknowns;
    type Fit = Linearized;

    fn fit(&mut self, at: &Unknowns) -> Option<Linearized> {
        self.whole.linearize(at, self.part)
    }

    fn value(&self, fit: &Linearized) -> f64 {
        fit.square
    }

    fn normal_equations(
        &mut self,
        _: &Unknowns,
        fit: &Linearized,
    ) -> Option<(DMatrix<f64>, DVector<f64>)> {
        Some((fit.normal.clone(), fit.right.clone()))
    }

    fn moved(&self, at: &Unknowns, step: &DVector<f64>) -> Unknowns {
        self.whole.moved(at, step)
    }
}

impl Unknowns {
    /// What a step of one moves an unknown by: a constant by a factor e, unless it may be zero.
    fn scale(&self, unknown: usize) -> f64 {
        let Some(value) = self.constants.get(unknown) else {
            return 1.0;
        };
        let (from, to) = self.ranges[unknown];
        match from * to > 0.0 {
            true => *value,
            false => value.abs().max(0.01 * (to - from)),
        }
    }
}

/// Keeps the best, none with constants like a better one's.
fn best_of(all: &mut Vec<Fitted>, most: usize) {
    all.sort_by(|a, b| a.square.total_cmp(&b.square));
    let mut kept: Vec<Fitted> = Vec::new();
    for fitted in all.drain(..) {
        let constants = &fitted.unknowns.constants;
        let alike = |o: &Fitted| agree(&o.unknowns.constants, constants, OUTPUT_ERROR.same);
        if kept.len() < most && !kept.iter().any(alike) {
            kept.push(fitted);
        }
    }
    *all = kept;
}
