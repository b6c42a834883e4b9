//! Integral matching: the first linearisation, for which nothing has to be fitted.
//!
//! In: records and smoothed trajectories. Out: a quadratic form of all columns, or a sketch of it. The laws are evaluated along the
//! smoothed trajectories and integrated from sample to sample (Simpson's rule); these integrals are compared with the readings, each with
//! its own noise. This is the weak form with all test functions at once. Chooses no terms.

use std::ops::Range;

use crate::trajectory::integration::INTERVALS_AT_ONCE;
use crate::trajectory::least_squares::{
    CountSketch, InformationFilter, NormalEquations, ProcessEquation, RowSink, SketchedProblem,
};
use crate::trajectory::model::{Problem, Record, SmoothedTrajectory};
use sidc_progress::Observer;
use sidc_solve::QuadraticForm;

/// Calls `take` with each of some samples and the process equation that starts there (`None` at the last of them). Returns `None` once `take`
/// says no.
pub(crate) fn for_each_interval(
    problem: &Problem,
    record: &Record,
    (curve, samples): (&SmoothedTrajectory, Range<usize>),
    take: &mut dyn FnMut(usize, Option<ProcessEquation>) -> bool,
) -> Option<()> {
    let system = &problem.system;
    let (n, m, p) = (
        system.states.len(),
        system.laws.len(),
        problem.all.outputs(),
    );
    let last = samples.end - 1;
    let mut columns = vec![0.0; n * p];
    let mut transition = vec![0.0; n * n];
    let mut defect = vec![0.0; n];
    let mut scratch = Scratch::default();
    for k in samples.start..last {
        let h = record.time[k + 1] - record.time[k];
        let nodes = [(0.0, 1.0), (0.5, 4.0), (1.0, 1.0)];
        evaluate(problem, record, curve, (k, h), &mut scratch);
        let values = &scratch.values;
        columns.fill(0.0);
        transition.fill(0.0);
        for i in 0..n {
            transition[i * n + i] = 1.0;
        }
        for (l, law) in system.laws.iter().enumerate() {
            let order = usize::from(law.target.der);
            let first = law.state + 1 - order;
            for d in 0..order {
                let i = first + d;
                // Derivative d of the variable gains ∫ law (h − s)^r / r! ds, r = order − 1 − d (Taylor's theorem).
                let r = order - 1 - d;
                for (e, factor) in (1..=r).map(|e| (e, power(h, e))) {
                    transition[i * n + i + e] = factor;
                }
                for (node, (part, weight)) in nodes.iter().enumerate() {
                    let gain = weight * h / 6.0 * power((1.0 - part) * h, r);
                    let row = &values[node * (p + m)..(node + 1) * (p + m)];
                    for j in law.columns.clone() {
                        columns[i * p + j] += gain * row[j];
                    }
                    if node == 0 {
                        defect[i] = 0.0;
                    }
                    defect[i] += gain * row[p + l];
                }
            }
        }
        let (here, next) = (curve.at(k, n), curve.at(k + 1, n));
        for i in 0..n {
            let moved: f64 = (0..n).map(|j| transition[i * n + j] * here[j]).sum();
            defect[i] += moved - next[i];
        }
        let link = ProcessEquation {
            transition: &transition,
            columns: &columns,
            defect: &defect,
        };
        if !take(k, Some(link)) {
            return None;
        }
    }
    take(last, None).then_some(())
}

/// x^e / e!
fn power(x: f64, e: usize) -> f64 {
    (1..=e).fold(1.0, |y, k| y * x / k as f64)
}

/// Values of all columns and known parts at the start, the middle and the end of an interval.
fn evaluate(
    problem: &Problem,
    record: &Record,
    curve: &SmoothedTrajectory,
    (k, h): (usize, f64),
    scratch: &mut Scratch,
) {
    let system = &problem.system;
    let (n, m, p) = (
        system.states.len(),
        system.laws.len(),
        problem.all.outputs(),
    );
    let inputs = system.evaluation_signals().len();
    let mut points = vec![0.0; inputs * 3];
    let (here, next) = (curve.at(k, n), curve.at(k + 1, n));
    let (rate0, rate1) = (curve.rate_at(k, m), curve.rate_at(k + 1, m));
    let mut slopes = [vec![0.0; n], vec![0.0; n]];
    for i in 0..n {
        for (slopes, (states, rates)) in slopes.iter_mut().zip([(here, rate0), (next, rate1)]) {
            slopes[i] = system.rate_of(i, states, rates);
        }
        points[i * 3] = here[i];
        points[i * 3 + 1] = 0.5 * (here[i] + next[i]) + h / 8.0 * (slopes[0][i] - slopes[1][i]);
        points[i * 3 + 2] = next[i];
    }
    for l in 0..m {
        points[(n + l) * 3] = rate0[l];
        points[(n + l) * 3 + 1] = 0.5 * (rate0[l] + rate1[l]);
        points[(n + l) * 3 + 2] = rate1[l];
    }
    for x in 0..inputs - n - m {
        for (b, part) in [0.0, 0.5, 1.0].iter().enumerate() {
            points[(n + m + x) * 3 + b] = record.exogenous_at(x, k, *part);
        }
    }
    let Scratch { raw, work, values } = scratch;
    raw.resize(p * 3, 0.0);
    problem.all.eval(&points, 3, raw, work);
    let names = system.evaluation_signals();
    let value = |s: sidc_lang::term::Signal, b: usize| {
        let at = names.iter().position(|t| *t == s).unwrap_or(0);
        points[at * 3 + b]
    };
    values.clear();
    for b in 0..3 {
        values.extend((0..p).map(|j| raw[j * 3 + b]));
        values.extend(system.laws.iter().map(|l| l.known.eval(&|s| value(s, b))));
    }
}

/// Buffers that intervals share.
#[derive(Default)]
struct Scratch {
    raw: Vec<f64>,
    work: Vec<f64>,
    /// At the start, the middle and the end: all columns, then every law's known part.
    values: Vec<f64>,
}

impl Problem {
    /// The quadratic form of all columns about the smoothed trajectories. States answer to their own derivatives only, not to the
    /// laws; `slack` is the noise of a step in units of the sensors'. `None` if cancelled.
    pub(crate) fn integral_matching_form(
        &self,
        sigma: &[f64],
        slack: f64,
        observer: &mut dyn Observer,
    ) -> Option<QuadraticForm> {
        let mut normal_equations = NormalEquations::new(self.all.outputs());
        self.integral_matching_rows((sigma, slack), &mut normal_equations, observer)?;
        Some(QuadraticForm::new(
            &normal_equations.shifted(&[]),
            self.all.outputs(),
        ))
    }

    fn integral_matching_rows(
        &self,
        (sigma, slack): (&[f64], f64),
        sink: &mut impl RowSink,
        observer: &mut dyn Observer,
    ) -> Option<()> {
        for (r, (record, curve)) in self.records.iter().zip(&self.smoothed).enumerate() {
            let sigma = &sigma[self.sensors.of(r)];
            let stiffness: Vec<f64> = sigma.iter().map(|s| 1.0 / (slack * s)).collect();
            // No integral crosses a jump.
            for flight in curve.flights(record.len()) {
                let mut filter = InformationFilter::new(&stiffness, sink, None);
                for_each_interval(self, record, (curve, flight), &mut |k, link| {
                    // The noise of a step swamps what lasts of a sensor's error.
                    let fresh = (r, k);
                    filter.measurement_update(&self.readings_at(fresh, &curve.states, sigma, k));
                    if let Some(link) = link {
                        filter.time_update(&link, &[]);
                    }
                    k % INTERVALS_AT_ONCE > 0 || observer.go_on()
                })?;
                filter.end();
            }
        }
        Some(())
    }

    /// The same as a sketch of `rows` whitened rows, for libraries too large for a quadratic form. `None` if cancelled.
    pub fn sketch(
        &self,
        slack: f64,
        rows: usize,
        observer: &mut dyn Observer,
    ) -> Option<SketchedProblem> {
        let mut sketch = CountSketch::new(self.all.outputs(), rows);
        self.integral_matching_rows((&self.noise, slack), &mut sketch, observer)?;
        Some(sketch.end())
    }
}
