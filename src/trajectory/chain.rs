//! The first linearisation: laws evaluated along smooth curves, states answering to their chains alone.
//!
//! In: a record and the curve through it. Out: a link for every interval, over all columns. This is the weak form with every test
//! function at once: what the laws add up to between samples is compared with what was read, each with its own noise.

use super::problem::Problem;
use super::record::Record;
use super::smooth::Curve;
use super::sweep::Link;

/// Hands the links of a record to `take`, with the number of the sample they start at; `None` at the last sample. `None` is also what
/// comes out if `take` says no.
pub(super) fn links(
    problem: &Problem,
    record: &Record,
    curve: &Curve,
    take: &mut dyn FnMut(usize, Option<Link>) -> bool,
) -> Option<()> {
    let system = &problem.system;
    let (n, m, p) = (
        system.states.len(),
        system.laws.len(),
        problem.all.outputs(),
    );
    let last = record.len() - 1;
    let mut columns = vec![0.0; n * p];
    let mut transition = vec![0.0; n * n];
    let mut defect = vec![0.0; n];
    let mut scratch = Scratch::default();
    for k in 0..last {
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
                // State d of the chain gathers the law through (h − s)^r / r!, r = order − 1 − d.
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
        let link = Link {
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

/// Values of all columns and known parts at the start, the middle and the end of an interval, along the curve.
fn evaluate(
    problem: &Problem,
    record: &Record,
    curve: &Curve,
    (k, h): (usize, f64),
    scratch: &mut Scratch,
) {
    let system = &problem.system;
    let (n, m, p) = (
        system.states.len(),
        system.laws.len(),
        problem.all.outputs(),
    );
    let inputs = system.inputs().len();
    let mut points = vec![0.0; inputs * 3];
    let (here, next) = (curve.at(k, n), curve.at(k + 1, n));
    let (rate0, rate1) = (curve.rate_at(k, m), curve.rate_at(k + 1, m));
    let mut slopes = [vec![0.0; n], vec![0.0; n]];
    for i in 0..n {
        let follows = system.follows(i);
        let law = system.laws.iter().position(|l| l.state == i);
        for (slopes, (states, rates)) in slopes.iter_mut().zip([(here, rate0), (next, rate1)]) {
            slopes[i] = match (follows, law) {
                (Some(j), _) => states[j],
                (None, Some(l)) => rates[l],
                (None, None) => 0.0,
            };
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
            points[(n + m + x) * 3 + b] = record.outside_at(x, k, *part);
        }
    }
    let Scratch { raw, work, values } = scratch;
    raw.resize(p * 3, 0.0);
    problem.all.eval(&points, 3, raw, work);
    let names = system.inputs();
    let value = |s: crate::term::Signal, b: usize| {
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
