//! Attacks with random systems of two states: laws of two to four terms, from monomials up to degree 3, sines and cosines.
//!
//! In: a seed, a level of noise, whether a term is left out of its library. Out: a case of two runs, in which both states move and stay
//! bounded, and every term matters.

use super::{Case, Law, runge_kutta_step};
use crate::integrate::{grid, integrate};
use crate::pendulum_regression::Random;
use crate::table::Table;

const RUNS: usize = 2;
const ROWS: usize = 201;
const STEP: f64 = 0.02;
/// Integration steps between two rows when a draw is tried.
const SUBSTEPS: usize = 4;
/// Largest state of a run that counts as bounded.
const BOUND: f64 = 8.0;
/// Least spread of a state.
const MOVES: f64 = 0.3;
/// Least spread of a term, relative to that of its rate.
const MATTERS: f64 = 0.15;

type State = [f64; 2];

/// A candidate term.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Candidate {
    Monomial(i32, i32),
    Sin(usize),
    Cos(usize),
}

impl Candidate {
    fn all() -> Vec<Candidate> {
        let powers = (0..=3).flat_map(|i| (0..=3 - i).map(move |j| (i, j)));
        let monomials = powers.filter(|(i, j)| i + j > 0);
        let monomials = monomials.map(|(i, j)| Candidate::Monomial(i, j));
        let calls = (0..2).flat_map(|s| [Candidate::Sin(s), Candidate::Cos(s)]);
        monomials.chain(calls).collect()
    }

    fn value(self, z: &State) -> f64 {
        match self {
            Candidate::Monomial(i, j) => z[0].powi(i) * z[1].powi(j),
            Candidate::Sin(s) => z[s].sin(),
            Candidate::Cos(s) => z[s].cos(),
        }
    }

    fn name(self) -> String {
        let power = |name: &str, n: i32| match n {
            0 => None,
            1 => Some(name.to_string()),
            n => Some(format!("{name}^{n}")),
        };
        match self {
            Candidate::Monomial(i, j) => {
                let parts = [power("x", i), power("y", j)];
                parts.into_iter().flatten().collect::<Vec<_>>().join("*")
            }
            Candidate::Sin(s) => format!("sin({})", ["x", "y"][s]),
            Candidate::Cos(s) => format!("cos({})", ["x", "y"][s]),
        }
    }
}

/// The terms of one rate with their coefficients.
type Terms = Vec<(f64, Candidate)>;

fn rate(laws: &[Terms; 2], z: &State) -> State {
    let sum = |law: &Terms| law.iter().map(|(a, t)| a * t.value(z)).sum();
    [sum(&laws[0]), sum(&laws[1])]
}

pub(super) fn case(seed: u64, noise: f64, omit: bool) -> Case {
    let mut random = Random::new(5000 + seed);
    let (laws, starts) = loop {
        let laws = [draw(&mut random), draw(&mut random)];
        let start = |random: &mut Random| [0, 1].map(|_| 3.0 * random.uniform() - 1.5);
        let starts: [State; RUNS] = [start(&mut random), start(&mut random)];
        if is_informative(&laws, &starts) {
            break (laws, starts);
        }
    };
    let mut runs: Vec<Vec<State>> = starts.iter().map(|s| along(&laws, *s)).collect();
    disturb(&mut runs, noise, &mut random);
    let place = (seed % 2) as usize;
    let of = (random.uniform() * laws[place].len() as f64) as usize;
    let left_out = omit.then(|| laws[place][of].1.name());
    let library = "poly(x, y; 3) + <sin(x), cos(x), sin(y), cos(y)>";
    let mut model = String::from("state x, y\n");
    for (i, target) in ["dx", "dy"].into_iter().enumerate() {
        let without = left_out.as_ref().filter(|_| i == place);
        let without = without.map_or_else(String::new, |t| format!(" - <{t}>"));
        model.push_str(&format!("{target} ~ {library}{without}\n"));
    }
    let law = |(i, target): (usize, &'static str)| Law {
        target,
        terms: laws[i].iter().map(|(_, t)| t.name()).collect(),
        offered: !(omit && i == place),
    };
    let table = |run: &Vec<State>| {
        let rows = grid(ROWS, STEP).into_iter().zip(run);
        Table {
            rows: rows.map(|(t, z)| vec![t, z[0], z[1]]).collect(),
            digits: None,
            ..Table::new(&["t", "x", "y"])
        }
    };
    Case {
        model,
        runs: runs.iter().map(table).collect(),
        laws: ["dx", "dy"].into_iter().enumerate().map(law).collect(),
    }
}

/// Two to four terms of 0.3 to 2.5, of either sign.
fn draw(random: &mut Random) -> Terms {
    let all = Candidate::all();
    let count = 2 + (3.0 * random.uniform()) as usize;
    let mut chosen = random.choose(count, all.len());
    chosen.sort_unstable();
    let one = |random: &mut Random, place: usize| {
        let size = 0.3 + 2.2 * random.uniform();
        let sign = if random.uniform() < 0.5 { -1.0 } else { 1.0 };
        ((1000.0 * sign * size).round() / 1000.0, all[place])
    };
    chosen.into_iter().map(|p| one(random, p)).collect()
}

/// Whether the runs stay bounded, both states move, and every term matters.
fn is_informative(laws: &[Terms; 2], starts: &[State]) -> bool {
    let mut all = Vec::new();
    for start in starts {
        let mut z = *start;
        for _ in 0..ROWS * SUBSTEPS {
            z = runge_kutta_step(&|_, z| rate(laws, z), 0.0, STEP / SUBSTEPS as f64, &z);
            if z.iter().any(|x| !x.is_finite() || x.abs() > BOUND) {
                return false;
            }
            all.push(z);
        }
    }
    let states = (0..2).all(|s| spread(all.iter().map(|z| z[s])) > MOVES);
    states
        && (0..2).all(|i| {
            let whole = spread(all.iter().map(|z| rate(laws, z)[i]));
            let part = |(a, t): &(f64, Candidate)| spread(all.iter().map(|z| a * t.value(z)));
            laws[i].iter().all(|term| part(term) > MATTERS * whole)
        })
}

/// All rows of a run, to the accuracy of the integrator.
fn along(laws: &[Terms; 2], start: State) -> Vec<State> {
    let mut z = start;
    let step = |t: &f64| {
        let here = z;
        z = integrate(&|_, z: &State| rate(laws, z), *t, t + STEP, z);
        here
    };
    grid(ROWS, STEP).iter().map(step).collect()
}

/// Adds noise to both states, relative to their spreads over all runs.
fn disturb(runs: &mut [Vec<State>], noise: f64, random: &mut Random) {
    let sigma = [0, 1].map(|s| noise * spread(runs.iter().flatten().map(|z| z[s])));
    for z in runs.iter_mut().flatten() {
        for (x, sigma) in z.iter_mut().zip(sigma) {
            *x += sigma * random.normal();
        }
    }
}

/// Standard deviation.
fn spread(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let count = values.clone().count() as f64;
    let mean = values.clone().sum::<f64>() / count;
    let square = values.map(|x| (x - mean).powi(2)).sum::<f64>() / count;
    square.sqrt()
}
