//! Reference values for emitted code: our evaluator at random points, and derivatives by the implicit function theorem.

use nalgebra::{DMatrix, DVector};
use sidc_lang::term::{Expr, Signal};
use sidc_system::discovery::{Discovery, Form, Rate};

use super::random::Random;

/// A system, the points to evaluate it at, and the answers.
pub struct Case {
    pub discovery: Discovery,
    pub form: Form,
    pub points: Vec<Point>,
}

pub struct Point {
    pub t: f64,
    /// State, inputs, parameters, history, constants.
    pub groups: [Vec<f64>; 5],
    /// Highest derivatives, or next samples.
    pub unknown: Vec<f64>,
    /// NaN for unknowns without a value.
    pub rates: Vec<f64>,
    /// Derivatives by the state, row by row, then those by the inputs.
    pub slopes: [Vec<f64>; 2],
    pub outputs: Vec<f64>,
}

impl Case {
    /// `count` points within ±1.5; parameters, which are masses and lengths, from 1 to 2.5.
    pub fn new(discovery: Discovery, count: usize, seed: u64) -> Case {
        let form = Form::new(&discovery);
        let mut random = Random::new(seed);
        let mentioned = Form::symbolic(&discovery).constants;
        let value = |s: &Signal| discovery.unknown_value(*s).unwrap();
        let constants: Vec<f64> = mentioned.iter().map(value).collect();
        let points = (0..count).map(|_| Point::new(&form, &constants, &mut random));
        let points = points.collect();
        Case {
            discovery,
            form,
            points,
        }
    }

    /// The arguments of the system at a point.
    pub fn arguments<'a>(&self, point: &'a Point) -> Vec<&'a Vec<f64>> {
        let all = point.groups.iter().enumerate();
        all.filter(|(i, g)| *i == 0 || !g.is_empty())
            .map(|(_, g)| g)
            .collect()
    }

    /// The same arguments, at every second point without the constants, which then have their default values.
    pub fn without_defaults<'a>(&self, point: &'a Point, place: usize) -> Vec<&'a Vec<f64>> {
        let mut all = self.arguments(point);
        if place % 2 == 1 && !point.groups[4].is_empty() {
            all.pop();
        }
        all
    }

    /// Mass matrix, force, right sides, rates if they are a formula, and outputs, as passed to SymPy.
    pub fn sides(&self, point: &Point) -> Vec<Vec<f64>> {
        let form = &self.form;
        let names = [
            &form.state,
            &form.inputs,
            &form.params,
            &form.history,
            &form.constants,
            &form.unknowns,
        ];
        let values = point.groups.iter().chain([&point.unknown]);
        let known: Vec<(Signal, f64)> = names
            .into_iter()
            .zip(values)
            .flat_map(|(names, values)| names.iter().copied().zip(values.iter().copied()))
            .collect();
        let at = |s: Signal| match s == Signal::TIME {
            true => point.t,
            false => known
                .iter()
                .find(|(k, _)| *k == s)
                .map_or(f64::NAN, |(_, v)| *v),
        };
        let rows = &form.rows;
        let mass = rows.iter().flat_map(|r| r.mass.iter().map(|e| e.eval(&at)));
        let mut all = vec![
            mass.collect(),
            rows.iter().map(|r| r.force.eval(&at)).collect(),
            rows.iter().map(|r| r.right.eval(&at)).collect(),
        ];
        if form.linear {
            all.push(point.rates.clone());
        }
        if !form.outputs.is_empty() {
            all.push(point.outputs.clone());
        }
        all
    }

    /// The functions in emitted code, in the order of [`Point::expected`].
    pub fn functions(&self) -> Vec<&'static str> {
        let rates = if self.discovery.discrete {
            "next"
        } else {
            "derivatives"
        };
        let dynamic = !self.form.rows.is_empty();
        let all = [
            (dynamic, rates),
            (dynamic, "jacobian"),
            (dynamic && !self.form.inputs.is_empty(), "jacobian_input"),
            (!self.form.outputs.is_empty(), "outputs"),
        ];
        all.iter()
            .filter(|(has, _)| *has)
            .map(|(_, f)| *f)
            .collect()
    }

    pub fn expected<'a>(&self, point: &'a Point, function: &str) -> &'a [f64] {
        match function {
            "jacobian" => &point.slopes[0],
            "jacobian_input" => &point.slopes[1],
            "outputs" => &point.outputs,
            _ => &point.rates,
        }
    }
}

impl Point {
    fn new(form: &Form, constants: &[f64], random: &mut Random) -> Point {
        let groups = [&form.state, &form.inputs, &form.params, &form.history];
        let mut groups = groups.map(|g| {
            g.iter()
                .map(|_| random.between(-1.5, 1.5))
                .collect::<Vec<f64>>()
        });
        groups[2].iter_mut().for_each(|p| *p = 1.0 + p.abs());
        let t = random.between(-1.5, 1.5);
        let [x, u, p, h] = &groups;
        let n = form.unknowns.len();
        let signals = [&form.state, &form.inputs, &form.params, &form.history];
        let at = |s: Signal| {
            let found = signals.iter().zip(&groups).find_map(|(names, values)| {
                let i = names.iter().position(|n| *n == s)?;
                Some(values[i])
            });
            if s == Signal::TIME {
                t
            } else {
                found.unwrap_or(f64::NAN)
            }
        };
        let q = form.solve(&at, &vec![0.0; n]).unwrap_or(vec![f64::NAN; n]);
        let with_q = |s: Signal| match form.unknowns.iter().position(|u| *u == s) {
            Some(i) => q[i],
            None => at(s),
        };
        let unsolved = || form.rates.iter().map(|r| rate(r, x, &q)).collect();
        let mut rates = form.rates_at(t, x, u, p, h).unwrap_or_else(unsolved);
        if !form.coupled() {
            // A linear solve spreads a NaN over all unknowns; explicit equations do not.
            let own: Vec<f64> = form.rows.iter().map(|r| r.right.eval(&at)).collect();
            rates = form.rates.iter().map(|r| rate(r, x, &own)).collect();
        }
        Point {
            t,
            rates,
            slopes: [&form.state, &form.inputs].map(|by| slopes(form, by, &with_q)),
            outputs: form.outputs.iter().map(|(_, e)| e.eval(&with_q)).collect(),
            groups: {
                let [x, u, p, h] = groups;
                [x, u, p, h, constants.to_vec()]
            },
            unknown: q,
        }
    }
}

fn rate(r: &Rate, x: &[f64], q: &[f64]) -> f64 {
    match r {
        Rate::State(i) => x[*i],
        Rate::Unknown(i) => q[*i],
    }
}

/// ∂(rates)/∂`by` from M · ∂q/∂s = ∂right/∂s, solved as one dense system, row by row.
fn slopes(form: &Form, by: &[Signal], with_q: &impl Fn(Signal) -> f64) -> Vec<f64> {
    let n = form.rows.len();
    let mass = form.mass(with_q);
    let columns: Vec<DVector<f64>> = by
        .iter()
        .map(|s| {
            let slope = |r: &sidc_system::discovery::Row| -> Expr { r.right.derivative(*s) };
            let right = form.rows.iter().map(|r| slope(r).eval(with_q));
            let right = DVector::from_iterator(n, right);
            let solved = mass.clone().lu().solve(&right);
            solved.unwrap_or_else(|| DVector::from_element(n, f64::NAN))
        })
        .collect();
    let unknown = DMatrix::from_fn(n, by.len(), |i, j| columns[j][i]);
    let mut out = Vec::new();
    for r in &form.rates {
        for (j, s) in by.iter().enumerate() {
            out.push(match r {
                Rate::State(i) => f64::from(u8::from(form.state[*i] == *s)),
                Rate::Unknown(i) => unknown[(*i, j)],
            });
        }
    }
    out
}

/// Compares what a language printed: one line per case, point and function, with entries separated by blanks.
///
/// If one of our values is not finite, some of theirs must not be either; for explicit equations exactly the same ones.
pub fn compare(language: &str, cases: &[Case], printed: &str) {
    let mut lines = printed.lines();
    for (k, case) in cases.iter().enumerate() {
        for (i, point) in case.points.iter().enumerate() {
            for function in case.functions() {
                let place = || format!("{language}, system {k}, point {i}, {function}");
                let line = lines
                    .next()
                    .unwrap_or_else(|| panic!("{}: nothing", place()));
                let got: Vec<f64> = line.split_whitespace().map(number).collect();
                let expected = case.expected(point, function);
                assert_eq!(got.len(), expected.len(), "{}: {line}", place());
                check(&got, expected, !case.form.coupled(), &place);
            }
        }
    }
    assert_eq!(lines.next(), None, "{language}: more lines than calls");
}

pub fn check(got: &[f64], expected: &[f64], explicit: bool, place: &impl Fn() -> String) {
    let slopes = place().contains("jacobian");
    if !expected.iter().all(|x| x.is_finite()) {
        let like = |(a, b): (&f64, &f64)| a == b || (a.is_nan() && b.is_nan()) || near(*a, *b);
        let fine = match explicit && !slopes {
            true => got.iter().zip(expected).all(like),
            false => slopes || got.iter().any(|x| !x.is_finite()),
        };
        assert!(fine, "{}: {got:?} is not {expected:?}", place());
        return;
    }
    check_to(1e-12, got, expected, place);
}

/// Compares finite numbers up to a tolerance relative to their size or to one.
pub fn check_to(part: f64, got: &[f64], expected: &[f64], place: &impl Fn() -> String) {
    for (a, b) in got.iter().zip(expected) {
        let near = (a - b).abs() <= part * (1.0 + b.abs());
        assert!(near, "{}: {a:e} is not {b:e}", place());
    }
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-12 * (1.0 + b.abs())
}

/// Numbers as C, Python and Octave print them.
pub fn number(text: &str) -> f64 {
    match text.trim_start_matches('-') {
        "nan" | "NaN" | "NA" => f64::NAN,
        "inf" | "Inf" if text.starts_with('-') => f64::NEG_INFINITY,
        "inf" | "Inf" => f64::INFINITY,
        _ => text
            .parse()
            .unwrap_or_else(|_| panic!("{text} is no number")),
    }
}
