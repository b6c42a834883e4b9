//! Attacks on the verdict: random systems with data for which a wrong law may pass, or a right one may be doubted.
//!
//! In: a kind of attack, a seed, a level of noise. Out: a model, tables, and the true laws. Every number of a case follows from its seed.

mod pendulum;
mod random_system;

use crate::table::Table;

/// How a case tries to mislead the verdict.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Attack {
    /// Nothing: the law is in the library.
    Honest,
    /// The sine of the law is not in the library.
    MissingTerm,
    /// The library contains expressions that equal the target.
    Copy,
    /// A second sensor measures the rate.
    SecondSensor,
    /// The input is one sine, and only the steady motion is recorded.
    SteadySine,
    /// A small free swing, and powers in place of the sine.
    Series,
    /// The solver that made the data took few steps.
    CoarseSolver,
    /// Two states, random laws of two to four terms each.
    RandomSystem,
    /// The same, and a term of one law is not in its library.
    OmittedTerm,
}

impl Attack {
    pub const ALL: [Attack; 9] = [
        Attack::Honest,
        Attack::MissingTerm,
        Attack::Copy,
        Attack::SecondSensor,
        Attack::SteadySine,
        Attack::Series,
        Attack::CoarseSolver,
        Attack::RandomSystem,
        Attack::OmittedTerm,
    ];

    /// Whether the library of the pendulum contains the law, even if the data of a steady motion do not determine it.
    fn has_law(self) -> bool {
        let without = [Attack::MissingTerm, Attack::SecondSensor, Attack::Series];
        !without.contains(&self)
    }
}

/// One case.
pub struct Case {
    pub model: String,
    /// Written with all digits, so that exact data stay exact.
    pub runs: Vec<Table>,
    /// One for each equation that is judged.
    pub laws: Vec<Law>,
}

/// The true law of a target.
pub struct Law {
    pub target: &'static str,
    /// In the order in which the program prints them.
    pub terms: Vec<String>,
    /// Whether its library contains all of them.
    pub offered: bool,
}

/// A case; `noise` is relative to the spread of each column.
pub fn case(attack: Attack, seed: u64, noise: f64) -> Case {
    match attack {
        Attack::RandomSystem => random_system::case(seed, noise, false),
        Attack::OmittedTerm => random_system::case(seed, noise, true),
        _ => pendulum::case(attack, seed, noise),
    }
}

impl Case {
    /// The columns of every run by name, time first.
    pub fn columns(&self) -> Vec<Vec<(&'static str, Vec<f64>)>> {
        let of = |table: &Table| {
            let names = table.names.iter().enumerate();
            let column = |i: usize| table.rows.iter().map(|r| r[i]).collect();
            names.map(|(i, name)| (*name, column(i))).collect()
        };
        self.runs.iter().map(of).collect()
    }
}

/// One step of the classical Runge-Kutta method: fast, with a visible error.
fn runge_kutta_step(
    rate: &impl Fn(f64, &[f64; 2]) -> [f64; 2],
    t: f64,
    h: f64,
    z: &[f64; 2],
) -> [f64; 2] {
    let moved = |k: &[f64; 2], by: f64| [z[0] + by * k[0], z[1] + by * k[1]];
    let a = rate(t, z);
    let b = rate(t + 0.5 * h, &moved(&a, 0.5 * h));
    let c = rate(t + 0.5 * h, &moved(&b, 0.5 * h));
    let d = rate(t + h, &moved(&c, h));
    let mean = |i: usize| (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]) / 6.0;
    moved(&[mean(0), mean(1)], h)
}
