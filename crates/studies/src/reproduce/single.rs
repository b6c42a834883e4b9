//! Systems whose laws are not coupled: graded norms must do no harm there.

use super::Effort;
use super::Fault;
use super::record::Record;
use super::setup::{Setup, draw};
use super::success::{Norms, curves_in, told};
use super::tidy::Tidy;
use super::work;
use sidc_testing::integrate::grid;
use sidc_testing::plants::cart_pendulum::Law;
use sidc_testing::plants::response::held;
use sidc_testing::random::Random;

const ROWS: usize = 600;
const STEP: f64 = 0.02;

type State = [f64; 3];

struct System {
    name: &'static str,
    model: &'static str,
    laws: fn() -> Vec<Law>,
    rates: fn(&State, f64) -> State,
    /// Signals from a state, its rates and the input.
    signals: fn(&State, &State, f64) -> Vec<(&'static str, f64)>,
}

const OSCILLATOR: fn(&State, &State, f64) -> Vec<(&'static str, f64)> =
    |s, r, u| vec![("x", s[0]), ("dx", s[1]), ("ddx", r[1]), ("F", u)];

const SYSTEMS: [System; 4] = [
    System {
        name: "Lorenz",
        model: "state x, y, z\ndx ~ powers(x, y, z, sin x, cos y; 2)\ndy ~ powers(x, y, z, sin x, cos y; 2)\ndz ~ powers(x, y, z, sin x, cos y; 2)\n",
        laws: || {
            vec![
                ("dx", vec![("x", -10.0), ("y", 10.0)]),
                ("dy", vec![("x", 28.0), ("y", -1.0), ("x*z", -1.0)]),
                ("dz", vec![("x*y", 1.0), ("z", -8.0 / 3.0)]),
            ]
        },
        rates: |[x, y, z], _| [10.0 * (y - x), x * (28.0 - z) - y, x * y - 8.0 / 3.0 * z],
        signals: |s, r, _| {
            let names = ["x", "y", "z", "dx", "dy", "dz"];
            names.into_iter().zip(s.iter().chain(r).copied()).collect()
        },
    },
    System {
        name: "Duffing",
        model: "state x : order 2\ninput F : hold\nddx ~ powers(x, dx, F, sin x, cos x; 3)\n",
        laws: || {
            let terms = vec![("x", -1.0), ("dx", -0.3), ("x^3", -5.0), ("F", 1.0)];
            vec![("ddx", terms)]
        },
        rates: |[x, v, _], u| [*v, -x - 0.3 * v - 5.0 * x * x * x + u, 0.0],
        signals: OSCILLATOR,
    },
    System {
        name: "Van der Pol",
        model: "state x : order 2\ninput F : hold\nddx ~ powers(x, dx, F, sin x, cos x; 3)\n",
        laws: || {
            vec![(
                "ddx",
                vec![("x", -1.0), ("dx", 2.0), ("x^2*dx", -2.0), ("F", 1.0)],
            )]
        },
        rates: |[x, v, _], u| [*v, -x + 2.0 * (1.0 - x * x) * v + u, 0.0],
        signals: OSCILLATOR,
    },
    System {
        name: "pendulum, small swings",
        model: "state x : order 2\ninput F : hold\nddx ~ powers(x, dx, F, sin x, cos x; 3)\n",
        laws: || {
            vec![(
                "ddx",
                vec![("sin(x)", -9.81), ("dx", -0.2), ("F*cos(x)", -1.0)],
            )]
        },
        rates: |[x, v, _], u| [*v, -9.81 * x.sin() - 0.2 * v - 0.5 * u * x.cos(), 0.0],
        signals: |s, r, u| vec![("x", s[0]), ("dx", s[1]), ("ddx", r[1]), ("F", 0.5 * u)],
    },
];

fn record(system: &System, seed: u64) -> Record {
    let mut random = Random::new(8000 + seed);
    let start = [(); 3].map(|()| random.uniform(-0.3, 0.3));
    let times = grid(ROWS, STEP);
    let input = random.square(ROWS, (5, 40), 4.0);
    let states = held(&system.rates, &times, start, &input);
    let rows: Vec<Vec<(&'static str, f64)>> = states
        .iter()
        .zip(&input)
        .map(|(s, u)| (system.signals)(s, &(system.rates)(s, *u), *u))
        .collect();
    let names = rows.first().map_or(&[][..], |r| r);
    let column = |i: usize| rows.iter().map(|r| r[i].1).collect();
    Record {
        time: times,
        columns: (0..names.len()).map(|i| (names[i].0, column(i))).collect(),
    }
}

/// The fewest samples for every law, plain and graded, as Markdown.
pub fn table(effort: Effort) -> Result<String, Fault> {
    let seeds: Vec<u64> = (0..effort.of(60, 3)).collect();
    let rows: Vec<usize> = effort.of((4..=30).chain([35, 40, 50]).collect(), vec![20]);
    let mut table = Tidy::new(&["system", "target", "terms", "plain", "graded"]);
    for system in &SYSTEMS {
        let setup = Setup::new(system.model, (system.laws)())?;
        let records = work::all(system.name, &seeds, |seed| Ok(record(system, *seed)))?;
        let [plain, graded] =
            Norms::BOTH.map(|norms| curves_in(system.name, &setup, &records, (&rows, norms), draw));
        for (p, g) in plain?.iter().zip(graded?) {
            table.push([
                system.name.into(),
                format!("`{}`", p.target),
                p.terms.to_string(),
                told(p.needed(), &rows),
                told(g.needed(), &rows),
            ]);
        }
    }
    Ok(table.markdown())
}
