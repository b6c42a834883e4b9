//! Advice on the command: solver, rows, memory.

use sidc_testing::program::file;

use super::experiment::{motion, normal, record};
use super::follow::{Case, Scenario};

/// Leaves the choice of the solver to the program.
fn without_solver(case: Case) -> Scenario {
    Scenario::words(case, |case, _| {
        let mut case = case.clone();
        case.options.retain(|o| !o.starts_with("--solver"));
        case
    })
}

pub fn heuristic_solver() -> Scenario {
    let [x] = motion(|_, x: &[f64; 1]| [-0.5 * x[0]], [1.0], 0.05, 100);
    let case = Case::new("state x\ndx ~ poly(x; 3)\n", record(0.05, &[("x", &x)]));
    without_solver(case.option("--solver stlsq"))
}

/// A few more numbers than `stlsq` accepts.
pub fn solver_refused() -> Scenario {
    let u = normal(1000, 1);
    let dx: Vec<f64> = u.iter().map(|u| 2.0 * u).collect();
    let x = normal(1000, 2);
    let table = record(1.0, &[("x", &x), ("u", &u), ("dx", &dx)]);
    let model = "state x\ninput u\ndx ~ powers(u; 90)*powers(x; 91)\n";
    let mut case = Case::new(model, table);
    case.options = ["--solver stlsq", "--samples 1000"]
        .map(String::from)
        .to_vec();
    without_solver(case)
}

/// A term that acts on few rows, with too few rows drawn.
pub fn held_out() -> Scenario {
    let (x, z) = (normal(2000, 1), normal(2000, 2));
    let rate = |(x, z): (&f64, &f64)| 2.0 * x - z + 2.0 * (x - 1.5).max(0.0);
    let dx: Vec<f64> = x.iter().zip(&z).map(rate).collect();
    let table = record(1.0, &[("x", &x), ("z", &z), ("dx", &dx)]);
    let model = "state x, z\ndx ~ <x, z, x^2, max(x - 1.5, 0)>\n";
    Scenario::change(Case::new(model, table).option("--samples 10"))
}

pub fn memory_limit() -> Scenario {
    let [model, data] = ["models/lorenz.sid", "models/data/lorenz.csv"].map(file);
    Scenario::change(Case::new(&model, data).option("--memory-limit 100kB"))
}
