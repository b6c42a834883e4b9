//! The rigs of the study: for each a model text, its true equations, and motions drawn from seeds.
//!
//! In: a case's name, a duration, a seed. Out: tables of perfect readings. Adds no noise: sensors.rs disturbs the tables, run.rs judges the equations found.

use sidc_testing::integrate::{grid, integrate};
use sidc_testing::plants::cart_pendulum::{Plant, State};
use sidc_testing::plants::force::{Force, Kind};
use sidc_testing::plants::response::{free, held};
use sidc_testing::random::Random;
use sidc_testing::table::Table;

pub use sidc_testing::plants::cart_pendulum::Law;

/// The meaning of a noise level for a column.
#[derive(Clone, Copy, Debug)]
pub enum Scale {
    /// Level 0.01 is 0.01 times this, in the column's unit.
    Unit(f64),
    /// Level 0.01 is 0.01 standard deviations of the undisturbed column.
    Spread,
}

/// A column that a sensor reads.
pub struct Sensor {
    pub column: &'static str,
    pub scale: Scale,
    /// True for an angle, which a sensor may report modulo 2π.
    pub angle: bool,
}

const fn sensor(column: &'static str, scale: Scale) -> Sensor {
    Sensor {
        column,
        scale,
        angle: false,
    }
}

const fn angle(column: &'static str) -> Sensor {
    Sensor {
        column,
        scale: Scale::Unit(1.0),
        angle: true,
    }
}

/// One trajectory to draw.
pub struct Draw {
    pub rows: usize,
    /// Samples per second.
    pub rate: f64,
    /// Index of the trajectory in the case.
    pub file: usize,
    pub seed: u64,
    /// What drives a cart.
    pub force: Kind,
}

impl Draw {
    fn random(&self) -> Random {
        Random::new(1000 * self.seed + self.file as u64)
    }

    fn times(&self) -> Vec<f64> {
        grid(self.rows, 1.0 / self.rate)
    }

    fn samples(&self, seconds: f64) -> usize {
        ((seconds * self.rate).round() as usize).max(1)
    }
}

/// A rig.
pub struct Case {
    pub name: &'static str,
    pub about: &'static str,
    pub model: &'static str,
    /// Defaults for the duration and rate of a trajectory and the number of trajectories.
    pub seconds: f64,
    pub rate: f64,
    pub files: usize,
    pub sensors: &'static [Sensor],
    /// Columns of commands, which are known without noise.
    pub inputs: &'static [&'static str],
    /// Terms with small coefficients, whose errors are reported separately.
    pub friction: &'static [&'static str],
    /// Spelled as sidc prints them.
    pub truth: fn() -> Vec<Law>,
    pub motion: fn(&Draw) -> Table,
}

const CART_SENSORS: &[Sensor] = &[sensor("y", Scale::Unit(0.3)), angle("theta")];

pub const CASES: &[Case] = &[
    Case {
        name: "cart_pendulum",
        about: "pendulum on a cart from y, theta, F; 192 terms in each equation",
        model: "system cart_pendulum
state y, theta : order 2
input F : hold
ddy, ddtheta ~ powers(y, dy, ddy, ddtheta, sin theta, cos theta, F; 1) * powers(dtheta; 2)
",
        seconds: 40.0,
        rate: 100.0,
        files: 1,
        sensors: CART_SENSORS,
        inputs: &["F"],
        friction: &["dy", "dtheta"],
        truth: || Plant::default().laws().to_vec(),
        motion: cart_pendulum,
    },
    Case {
        name: "cart_pendulum_poly",
        about: "the same; 213 terms in each equation: cubic in all states, times 1, sin, cos, the mass matrix, the force",
        model: "system cart_pendulum
state y, theta : order 2
input F : hold
let trig = <1, sin theta, cos theta>
let motion = poly(y, dy, theta, dtheta; 3) * trig + F * trig
ddy     ~ motion + ddtheta * poly(y, dy, theta, dtheta; 3) * trig
ddtheta ~ motion + ddy * poly(y, dy, theta, dtheta; 3) * trig
",
        seconds: 40.0,
        rate: 100.0,
        files: 1,
        sensors: CART_SENSORS,
        inputs: &["F"],
        friction: &["dy", "dtheta"],
        truth: || Plant::default().laws().to_vec(),
        motion: cart_pendulum,
    },
    Case {
        name: "michaelis_menten",
        about: "a rational rate from concentrations alone; five short runs",
        model: "system michaelis_menten
state x
dx ~ poly(x; 3) + dx * <x, x^2>
",
        seconds: 4.0,
        rate: 25.0,
        files: 5,
        sensors: &[sensor("x", Scale::Spread)],
        inputs: &[],
        friction: &[],
        truth: || {
            let (inflow, fastest, half) = REACTION;
            let [a, b, c] = [inflow, (inflow - fastest) / half, -1.0 / half];
            vec![("dx", vec![("1", a), ("x", b), ("x*dx", c)])]
        },
        motion: michaelis_menten,
    },
    Case {
        name: "double_pendulum",
        about: "two rods from their angles alone, swinging freely; implicit, 45 terms in each equation",
        model: "system double_pendulum
state th1, th2 : order 2
let swing = poly(dth1, dth2; 2) * <1, sin th1, cos th1, sin th2, cos th2, sin(th1 - th2), cos(th1 - th2)>
let joint = <1, sin(th1 - th2), cos(th1 - th2)>
ddth1 ~ swing + ddth2 * joint
ddth2 ~ swing + ddth1 * joint
",
        seconds: 20.0,
        rate: 100.0,
        files: 2,
        sensors: &[angle("th1"), angle("th2")],
        inputs: &[],
        friction: &["dth1", "dth2"],
        truth: double_pendulum_laws,
        motion: double_pendulum,
    },
    Case {
        name: "duffing",
        about: "Duffing's oscillator from its position, a held drive; 35 terms",
        model: "system duffing
state x : order 2
input u : hold
ddx ~ poly(x, dx, u; 4)
",
        seconds: 40.0,
        rate: 50.0,
        files: 1,
        sensors: &[sensor("x", Scale::Spread)],
        inputs: &["u"],
        friction: &["dx"],
        truth: || {
            let terms = vec![("u", 1.0), ("x", 1.0), ("dx", -0.2), ("x^3", -1.0)];
            vec![("ddx", terms)]
        },
        motion: duffing,
    },
    Case {
        name: "lorenz",
        about: "Lorenz' convection from its three states; 20 terms in each equation",
        model: "system lorenz
state x, y, z
dx, dy, dz ~ poly(x, y, z; 3)
",
        seconds: 10.0,
        rate: 100.0,
        files: 1,
        sensors: &[
            sensor("x", Scale::Spread),
            sensor("y", Scale::Spread),
            sensor("z", Scale::Spread),
        ],
        inputs: &[],
        friction: &[],
        truth: || {
            vec![
                ("dx", vec![("x", -10.0), ("y", 10.0)]),
                ("dy", vec![("x", 28.0), ("y", -1.0), ("x*z", -1.0)]),
                ("dz", vec![("z", -8.0 / 3.0), ("x*y", 1.0)]),
            ]
        },
        motion: lorenz,
    },
    Case {
        name: "lotka_volterra",
        about: "hares and lynxes; 10 terms in each equation",
        model: "system lotka_volterra
state x, y
dx, dy ~ poly(x, y; 3)
",
        seconds: 30.0,
        rate: 20.0,
        files: 1,
        sensors: &[sensor("x", Scale::Spread), sensor("y", Scale::Spread)],
        inputs: &[],
        friction: &[],
        truth: || {
            vec![
                ("dx", vec![("x", 0.9), ("x*y", -0.4)]),
                ("dy", vec![("y", -0.7), ("x*y", 0.3)]),
            ]
        },
        motion: lotka_volterra,
    },
    Case {
        name: "neuron",
        about: "FitzHugh-Nagumo's neuron, two states and a held current; 20 terms in each equation",
        model: "system neuron
state v, w
input u : hold
dv, dw ~ poly(v, w, u; 3)
",
        seconds: 80.0,
        rate: 20.0,
        files: 1,
        sensors: &[sensor("v", Scale::Spread), sensor("w", Scale::Spread)],
        inputs: &["u"],
        friction: &[],
        truth: || {
            let fast = vec![("v", 1.0), ("w", -1.0), ("u", 1.0), ("v^3", -1.0 / 3.0)];
            let slow = vec![("1", 0.056), ("v", 0.08), ("w", -0.064)];
            vec![("dv", fast), ("dw", slow)]
        },
        motion: neuron,
    },
];

fn table(names: &[&'static str]) -> Table {
    let mut table = Table::new(names);
    table.digits = None;
    table
}

/// A table of `t` and the columns that `pick` takes from each state.
fn tabulate<const N: usize, const K: usize>(
    names: &[&'static str],
    times: &[f64],
    states: Vec<[f64; N]>,
    pick: impl Fn(&[f64; N]) -> [f64; K],
    input: Option<&[f64]>,
) -> Table {
    let mut table = table(names);
    for (k, (t, state)) in times.iter().zip(&states).enumerate() {
        let mut row = vec![*t];
        row.extend(pick(state));
        row.extend(input.and_then(|u| u.get(k)));
        table.push(&row);
    }
    table
}

/// The experiment starts near upright; with open-loop forces the start is arbitrary.
fn cart_pendulum(draw: &Draw) -> Table {
    let plant = Plant::default();
    let mut random = draw.random();
    let theta = match draw.force {
        Kind::Experiment => std::f64::consts::PI + random.uniform(-0.2, 0.2),
        _ => random.uniform(-2.0, 2.0),
    };
    let mut force = Force::draw(draw.force, draw.rows, draw.rate, &mut random);
    let mut x: State = [0.0, 0.0, theta, 0.0];
    let mut table = table(&["t", "y", "theta", "F"]);
    for (k, t) in draw.times().into_iter().enumerate() {
        let f = force.at(k, &plant, &x);
        table.push(&[t, x[0], x[2], f]);
        x = integrate(
            &|_, x: &State| plant.derivative(x, f),
            0.0,
            1.0 / draw.rate,
            x,
        );
    }
    table
}

/// Inflow, maximum rate, concentration at half that rate.
const REACTION: (f64, f64, f64) = (0.6, 1.5, 0.3);

fn michaelis_menten(draw: &Draw) -> Table {
    let (inflow, fastest, half) = REACTION;
    let f = |_: f64, &[x]: &[f64; 1]| [inflow - fastest * x / (half + x)];
    let starts = [0.05, 0.4, 1.0, 3.0, 6.0];
    let start = starts[draw.file % starts.len()] * draw.random().uniform(0.8, 1.2);
    let times = draw.times();
    let states = free(&f, &times, [start]);
    tabulate(&["t", "x"], &times, states, |x| *x, None)
}

/// Masses (kg), lengths (m), frictions (N m s) of the two rods; gravity.
const RODS: ([f64; 2], [f64; 2], [f64; 2], f64) = ([0.3, 0.2], [0.5, 0.4], [0.004, 0.002], 9.8);

fn double_pendulum_laws() -> Vec<Law> {
    let ([m1, m2], [l1, l2], [c1, c2], g) = RODS;
    let share = m2 / (m1 + m2);
    vec![
        (
            "ddth1",
            vec![
                ("dth1", -c1 / ((m1 + m2) * l1 * l1)),
                ("sin(th1)", -g / l1),
                ("ddth2*cos(th1 - th2)", -share * l2 / l1),
                ("dth2^2*sin(th1 - th2)", -share * l2 / l1),
            ],
        ),
        (
            "ddth2",
            vec![
                ("dth2", -c2 / (m2 * l2 * l2)),
                ("sin(th2)", -g / l2),
                ("ddth1*cos(th1 - th2)", -l1 / l2),
                ("dth1^2*sin(th1 - th2)", l1 / l2),
            ],
        ),
    ]
}

fn double_pendulum(draw: &Draw) -> Table {
    let ([m1, m2], [l1, l2], [c1, c2], g) = RODS;
    let f = |_: f64, &[t1, t2, d1, d2]: &[f64; 4]| {
        let (sin, cos) = (t1 - t2).sin_cos();
        let joint = m2 * l1 * l2;
        let mass = [(m1 + m2) * l1 * l1, joint * cos, m2 * l2 * l2];
        let right = [
            -c1 * d1 - (m1 + m2) * g * l1 * t1.sin() - joint * d2 * d2 * sin,
            -c2 * d2 - m2 * g * l2 * t2.sin() + joint * d1 * d1 * sin,
        ];
        let det = mass[0] * mass[2] - mass[1] * mass[1];
        let a1 = (right[0] * mass[2] - mass[1] * right[1]) / det;
        let a2 = (mass[0] * right[1] - mass[1] * right[0]) / det;
        [d1, d2, a1, a2]
    };
    let mut random = draw.random();
    let mut start = || {
        let side = if random.unit() < 0.5 { -1.0 } else { 1.0 };
        side * random.uniform(0.8, 2.2)
    };
    let x0 = [start(), start(), 0.0, 0.0];
    let times = draw.times();
    let states = free(&f, &times, x0);
    tabulate(&["t", "th1", "th2"], &times, states, |x| [x[0], x[1]], None)
}

fn duffing(draw: &Draw) -> Table {
    let f = |&[x, v]: &[f64; 2], u: f64| [v, u - 0.2 * v + x - x * x * x];
    let mut random = draw.random();
    let hold = (draw.samples(0.2), draw.samples(1.5));
    let input = random.square(draw.rows, hold, 1.5);
    let x0 = [random.uniform(-1.5, 1.5), 0.0];
    let times = draw.times();
    let states = held(&f, &times, x0, &input);
    tabulate(&["t", "x", "u"], &times, states, |x| [x[0]], Some(&input))
}

fn lorenz(draw: &Draw) -> Table {
    let f =
        |_: f64, &[x, y, z]: &[f64; 3]| [10.0 * (y - x), x * (28.0 - z) - y, x * y - 8.0 / 3.0 * z];
    let mut random = draw.random();
    let far = [random.uniform(-8.0, 8.0), random.uniform(-8.0, 8.0), 25.0];
    // After three seconds the state is on the attractor.
    let arrival = free(&f, &grid(301, 0.01), far);
    let x0 = arrival.last().copied().unwrap_or(far);
    let times = draw.times();
    let states = free(&f, &times, x0);
    tabulate(&["t", "x", "y", "z"], &times, states, |x| *x, None)
}

fn lotka_volterra(draw: &Draw) -> Table {
    let f = |_: f64, &[x, y]: &[f64; 2]| [0.9 * x - 0.4 * x * y, -0.7 * y + 0.3 * x * y];
    let mut random = draw.random();
    let x0 = [random.uniform(0.8, 1.6), random.uniform(0.8, 1.6)];
    let times = draw.times();
    let states = free(&f, &times, x0);
    tabulate(&["t", "x", "y"], &times, states, |x| *x, None)
}

fn neuron(draw: &Draw) -> Table {
    let f =
        |&[v, w]: &[f64; 2], u: f64| [v - v * v * v / 3.0 - w + u, 0.08 * v + 0.056 - 0.064 * w];
    let mut random = draw.random();
    let hold = (draw.samples(1.0), draw.samples(6.0));
    let input = random.square(draw.rows, hold, 1.0);
    let x0 = [random.uniform(-1.0, 1.0), random.uniform(-0.5, 0.5)];
    let times = draw.times();
    let states = held(&f, &times, x0, &input);
    tabulate(&["t", "v", "w", "u"], &times, states, |x| *x, Some(&input))
}
