//! Ten systems of ODEBench (d'Ascoli et al., ICLR 2024; github.com/sdascoli/odeformer, MIT): laws, constants and both starts.
//!
//! In: nothing. Out: a case for each system, its states read 501 or 1,000 times in ten seconds. They have one to four states, and include weak terms, a limit
//! cycle with two speeds, chaos and a conserved sum.

use super::case::{Case, Law, Motion, Sensor, deviation};
use sidc_testing::plants::response::free;
use sidc_testing::table::Table;

/// States that a system does not have stay zero.
type State = [f64; 4];

struct System {
    name: &'static str,
    states: usize,
    library: &'static str,
    laws: Vec<Law>,
    rates: fn(&State) -> State,
    starts: [State; 2],
    rows: usize,
}

const SECONDS: f64 = 10.0;
const NAMES: [&str; 5] = ["t", "x0", "x1", "x2", "x3"];
const CUBIC: &str = "poly(STATES; 3)";
/// The benchmark's functions for systems of one and of two states.
const TRIG_1: &str = "poly(x0; 2) + <sin(x0), cos(x0), sin(x0)*cos(x0), sin(x0)^2, x0*sin(x0), x0*cos(x0), exp(x0), exp(-x0)>";
const TRIG_2: &str = "poly(x0, x1; 2) + <sin(x0), sin(x1), cos(x0), cos(x1)> + <1, x0, x1, cos(x0), cos(x1)> * <sin(x0), sin(x1)> \
    + <x0, x1> * <cos(x0), cos(x1)> + <sin(x0)^2, sin(x0)*sin(x1), sin(x1)^2, cos(x0)*cos(x1)>";

pub fn cases() -> Vec<Case> {
    systems().into_iter().map(case).collect()
}

fn case(system: System) -> Case {
    let (rates, n) = (system.rates, system.states);
    let states = NAMES[1..=n].join(", ");
    let derivatives: Vec<String> = NAMES[1..=n].iter().map(|x| format!("d{x}")).collect();
    let library = system.library.replace("STATES", &states);
    let times: Vec<f64> = (0..system.rows)
        .map(|k| k as f64 * SECONDS / (system.rows - 1) as f64)
        .collect();
    let motion = |start: State| {
        let mut table = Table::new(&NAMES[..=n]);
        for (t, x) in times
            .iter()
            .zip(free(&|_, x: &State| rates(x), &times, start))
        {
            let mut row = vec![*t];
            row.extend(&x[..n]);
            table.push(&row);
        }
        table
    };
    let tables: Vec<Table> = system.starts.into_iter().map(motion).collect();
    Case {
        name: system.name,
        model: format!("state {states}\n{} ~ {library}\n", derivatives.join(", ")),
        laws: system.laws,
        sensors: (1..=n)
            .map(|i| Sensor::white(NAMES[i], deviation(&tables, i)))
            .collect(),
        motion: Motion::Fixed(tables),
    }
}

fn systems() -> Vec<System> {
    let mut all = plain();
    all.push(lotka_volterra("ode27_lotka_volterra", 1000));
    all.extend(planar());
    all.extend(spatial());
    all
}

/// One of the systems, read only 31 times: few readings for each coefficient.
pub fn short() -> Case {
    case(lotka_volterra("ode27_short", 31))
}

/// Systems with one state.
fn plain() -> Vec<System> {
    vec![
        System {
            name: "ode05_falling",
            states: 1,
            library: CUBIC,
            laws: vec![("dx0", vec![("1", 9.81), ("x0^2", -0.0021175)])],
            rates: |x| [9.81 - 0.0021175 * x[0] * x[0], 0.0, 0.0, 0.0],
            starts: [[0.5, 0.0, 0.0, 0.0], [73.0, 0.0, 0.0, 0.0]],
            rows: 501,
        },
        System {
            name: "ode21_epidemic",
            states: 1,
            library: TRIG_1,
            laws: vec![("dx0", vec![("1", 1.2), ("x0", -0.2), ("exp(-x0)", -1.0)])],
            rates: |x| [1.2 - 0.2 * x[0] - (-x[0]).exp(), 0.0, 0.0, 0.0],
            starts: [[0.0; 4], [0.8, 0.0, 0.0, 0.0]],
            rows: 501,
        },
    ]
}

/// Hares and lynxes, read `rows` times.
fn lotka_volterra(name: &'static str, rows: usize) -> System {
    System {
        name,
        states: 2,
        library: CUBIC,
        laws: vec![
            ("dx0", vec![("x0", 1.84), ("x0*x1", -1.45)]),
            ("dx1", vec![("x1", -3.0), ("x0*x1", 1.62)]),
        ],
        rates: |x| {
            [
                x[0] * (1.84 - 1.45 * x[1]),
                -x[1] * (3.0 - 1.62 * x[0]),
                0.0,
                0.0,
            ]
        },
        starts: [[8.3, 3.4, 0.0, 0.0], [0.4, 0.65, 0.0, 0.0]],
        rows,
    }
}

/// Systems with two states.
fn planar() -> Vec<System> {
    let planar = |name, library, laws, rates, starts: [[f64; 2]; 2], rows| System {
        name,
        states: 2,
        library,
        laws,
        rates,
        starts: starts.map(|[a, b]| [a, b, 0.0, 0.0]),
        rows,
    };
    vec![
        planar(
            "ode32_double_well",
            CUBIC,
            vec![
                ("dx0", vec![("x1", 1.0)]),
                ("dx1", vec![("x0", 1.0), ("x1", -0.18), ("x0^3", -1.0)]),
            ],
            |x| [x[1], x[0] - x[0].powi(3) - 0.18 * x[1], 0.0, 0.0],
            [[-1.8, -1.8], [5.8, 0.0]],
            1000,
        ),
        planar(
            "ode36_pendulum",
            TRIG_2,
            vec![
                ("dx0", vec![("x1", 1.0)]),
                (
                    "dx1",
                    vec![("x1", -1.0), ("sin(x0)", -1.0), ("x1*cos(x0)", -0.07)],
                ),
            ],
            |x| {
                [
                    x[1],
                    -0.07 * x[1] * x[0].cos() - x[1] - x[0].sin(),
                    0.0,
                    0.0,
                ]
            },
            [[0.45, 0.9], [1.34, -0.8]],
            501,
        ),
        planar(
            "ode37_van_der_pol",
            CUBIC,
            vec![
                ("dx0", vec![("x1", 1.0)]),
                ("dx1", vec![("x0", -1.0), ("x1", 0.43), ("x0^2*x1", -0.43)]),
            ],
            |x| [x[1], -x[0] - 0.43 * x[1] * (x[0] * x[0] - 1.0), 0.0, 0.0],
            [[2.2, 0.0], [0.1, 3.2]],
            501,
        ),
        planar(
            "ode49_brusselator",
            CUBIC,
            vec![
                ("dx0", vec![("1", 1.0), ("x0", -4.03), ("x0^2*x1", 3.1)]),
                ("dx1", vec![("x0", 3.03), ("x0^2*x1", -3.1)]),
            ],
            |x| {
                let fast = 3.1 * x[0] * x[0] * x[1];
                [1.0 - 4.03 * x[0] + fast, 3.03 * x[0] - fast, 0.0, 0.0]
            },
            [[0.7, -1.4], [2.1, 1.3]],
            501,
        ),
    ]
}

/// Systems with three or four states.
fn spatial() -> Vec<System> {
    vec![
        System {
            name: "ode52_laser",
            states: 3,
            library: CUBIC,
            laws: vec![
                ("dx0", vec![("x0", -0.1), ("x1", 0.1)]),
                ("dx1", vec![("x1", -0.21), ("x0*x2", 0.21)]),
                ("dx2", vec![("1", 1.394), ("x2", -0.34), ("x0*x1", -1.054)]),
            ],
            rates: |x| {
                [
                    0.1 * (x[1] - x[0]),
                    0.21 * (x[0] * x[2] - x[1]),
                    1.394 - 1.054 * x[0] * x[1] - 0.34 * x[2],
                    0.0,
                ]
            },
            starts: [[1.3, 1.1, 0.89, 0.0], [0.89, 1.3, 1.1, 0.0]],
            rows: 501,
        },
        System {
            name: "ode56_lorenz",
            states: 3,
            library: CUBIC,
            laws: vec![
                ("dx0", vec![("x0", -10.0), ("x1", 10.0)]),
                ("dx1", vec![("x0", 28.0), ("x1", -1.0), ("x0*x2", -1.0)]),
                ("dx2", vec![("x2", -8.0 / 3.0), ("x0*x1", 1.0)]),
            ],
            rates: |x| {
                [
                    10.0 * (x[1] - x[0]),
                    x[0] * (28.0 - x[2]) - x[1],
                    x[0] * x[1] - 8.0 / 3.0 * x[2],
                    0.0,
                ]
            },
            starts: [[2.3, 8.1, 12.4, 0.0], [10.0, 20.0, 30.0, 0.0]],
            rows: 1000,
        },
        System {
            name: "ode63_seir",
            states: 4,
            library: CUBIC,
            laws: vec![
                ("dx0", vec![("x0*x2", -0.28)]),
                ("dx1", vec![("x1", -0.47), ("x0*x2", 0.28)]),
                ("dx2", vec![("x1", 0.47), ("x2", -0.3)]),
                ("dx3", vec![("x2", 0.3)]),
            ],
            rates: |x| {
                let new = 0.28 * x[0] * x[2];
                [
                    -new,
                    new - 0.47 * x[1],
                    0.47 * x[1] - 0.3 * x[2],
                    0.3 * x[2],
                ]
            },
            starts: [[0.6, 0.3, 0.09, 0.01], [0.4, 0.3, 0.25, 0.05]],
            rows: 501,
        },
    ]
}
