//! Sixty records that cannot, or can hardly, answer the question asked of them, each for a known, planted cause.
//!
//! In: a seed. Out: models, tables and the cause to be named. Uses nothing of the compiler except the names of causes.

use std::fmt::Write;

use sidc_system::discovery::Cause;

use sidc_testing::integrate::grid;
use sidc_testing::plants::response::free;
use sidc_testing::random::Random;

/// A record, its model, and the cause that prevents the answer.
pub struct Case {
    pub name: String,
    pub kind: &'static str,
    /// Causes that count as right.
    pub causes: &'static [Cause],
    pub model: String,
    pub tables: Vec<String>,
    /// The equation that is judged.
    pub target: &'static str,
    /// Its true terms; `None` if its library lacks some.
    pub truth: Option<&'static [&'static str]>,
}

type State = [f64; 4];

/// Noise of the readings, relative to their spread.
const NOISE: [f64; 3] = [0.0, 0.0, 0.01];

/// Makes the case of a cause with this number; the seed draws its constants.
type Make = fn(usize, u64) -> Case;

/// All cases, from seven causes; the seed draws their constants.
pub fn cases(seed: u64) -> Vec<Case> {
    let kinds: [(Make, usize); 7] = [
        (alias, 9),
        (conserved, 9),
        (small_angle, 9),
        (constant_input, 9),
        (few_rows, 8),
        (missing_term, 8),
        (wrong_order, 8),
    ];
    let mut all = Vec::new();
    for (make, count) in kinds {
        all.extend((0..count).map(|number| make(number, seed)));
    }
    all
}

/// A case under construction.
struct Plan {
    kind: &'static str,
    causes: &'static [Cause],
    number: usize,
    target: &'static str,
    truth: Option<&'static [&'static str]>,
    random: Random,
}

impl Plan {
    fn new(kind: &'static str, causes: &'static [Cause], number: usize, seed: u64) -> Plan {
        let start = number as u64 + 1000 * seed;
        let mix = |s: u64, b: u8| s.wrapping_mul(31).wrapping_add(u64::from(b));
        let seed = kind.bytes().fold(start, mix);
        Plan {
            kind,
            causes,
            number,
            target: "dx",
            truth: None,
            random: Random::new(seed),
        }
    }

    fn of(mut self, target: &'static str, truth: &'static [&'static str]) -> Plan {
        self.target = target;
        self.truth = Some(truth);
        self
    }

    fn case(self, model: &str, tables: Vec<String>) -> Case {
        Case {
            name: format!("{} {}", self.kind, self.number + 1),
            kind: self.kind,
            causes: self.causes,
            model: model.into(),
            tables,
            target: self.target,
            truth: self.truth,
        }
    }
}

/// A table of named columns; the first is time and has no noise.
fn table(columns: &[(&str, Vec<f64>)], noise: f64, random: &mut Random) -> String {
    let names: Vec<&str> = columns.iter().map(|c| c.0).collect();
    let mut text = names.join(",") + "\n";
    let spread = |v: &[f64]| {
        let mean = v.iter().sum::<f64>() / v.len() as f64;
        (v.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / v.len() as f64).sqrt()
    };
    let sigma: Vec<f64> = columns.iter().map(|c| noise * spread(&c.1)).collect();
    for k in 0..columns[0].1.len() {
        for (i, (_, values)) in columns.iter().enumerate() {
            let error = if i == 0 {
                0.0
            } else {
                sigma[i] * random.normal()
            };
            let comma = if i == 0 { "" } else { "," };
            let _ = write!(text, "{comma}{:.12e}", values[k] + error);
        }
        text.push('\n');
    }
    text
}

fn column(states: &[State], i: usize) -> Vec<f64> {
    states.iter().map(|x| x[i]).collect()
}

/// Sines of incommensurate frequencies.
fn wave(t: f64, phase: f64) -> f64 {
    (1.3 * t + phase).sin() + 0.7 * (0.47 * t + 2.0 * phase).sin() + 0.4 * (2.9 * t).cos()
}

/// Terms with equal columns, either always or because an argument keeps its sign.
fn alias(number: usize, seed: u64) -> Case {
    let mut plan = Plan::new("alias", &[Cause::Identity, Cause::OneSign], number, seed);
    let noise = NOISE[number / 5 % 3];
    let times = grid(400, 0.02);
    let (a, b) = (plan.random.uniform(0.5, 1.5), plan.random.uniform(1.5, 3.0));
    let phase = plan.random.uniform(0.0, 3.0);
    let driven = |f: &dyn Fn(f64, f64) -> f64, start: f64| -> Vec<(&'static str, Vec<f64>)> {
        let states = free(
            &|t, x: &State| [f(t, x[0]), 0.0, 0.0, 0.0],
            &times,
            [start, 0.0, 0.0, 0.0],
        );
        let u = times.iter().map(|t| wave(*t, phase)).collect();
        vec![("t", times.clone()), ("x", column(&states, 0)), ("u", u)]
    };
    let (model, truth, data): (&str, &[&str], _) = match number {
        0 | 5 => (
            "state x\ninput u : linear\ndx ~ <1, x, x^2, x*abs(x), x^3, u>\n",
            &["1", "u", "x*abs(x)"],
            driven(&|t, x| b + wave(t, phase) - a * x * x.abs(), 1.0),
        ),
        1 | 6 => {
            let fall = |_: f64, x: &State| [x[1], -9.81 - 0.1 * a * x[1] * x[1].abs(), 0.0, 0.0];
            let states = free(&fall, &times, [30.0, -b, 0.0, 0.0]);
            let data = vec![("t", times.clone()), ("z", column(&states, 0))];
            plan = plan.of("ddz", &["1", "dz*abs(dz)"]);
            let text = table(&data, 0.0, &mut plan.random);
            return plan.case(
                "state z : order 2\nddz ~ <1, dz, dz^2, dz*abs(dz), sign(dz)>\n",
                vec![text],
            );
        }
        2 | 7 => (
            "state x\ninput u : linear\ndx ~ <x, sin(x), cos(x), sin(2*x), sin(x)*cos(x), u>\n",
            &["x", "u", "sin(2*x)"],
            driven(
                &|t, x| 2.0 * wave(t, phase) - a * x + b * (2.0 * x).sin(),
                0.5,
            ),
        ),
        3 => (
            "state x\ninput u : linear\ndx ~ <x, u, exp(x), exp(x)^2, exp(2*x), x^2>\n",
            &["x", "u", "exp(2*x)"],
            driven(
                &|t, x| wave(t, phase) - a * x - 0.3 * b * (2.0 * x).exp(),
                0.1,
            ),
        ),
        4 => (
            "state x\ninput u : linear\ndx ~ <x, u, u*x, sqrt(x^2), abs(x), x^3>\n",
            &["x", "u", "abs(x)"],
            driven(&|t, x| wave(t, phase) - b * x + a * x.abs(), 0.2),
        ),
        _ => (
            "state x\ninput u : linear\ndx ~ <x, u, tanh(x)*cosh(x), sinh(x), x*u, u^2>\n",
            &["u", "sinh(x)"],
            driven(&|t, x| wave(t, phase) - a * x.sinh(), 0.4),
        ),
    };
    plan = plan.of("dx", truth);
    let text = table(&data, noise, &mut plan.random);
    plan.case(model, vec![text])
}

/// Closed systems: a sum of the states is conserved.
fn conserved(number: usize, seed: u64) -> Case {
    let mut plan = Plan::new("conserved sum", &[Cause::Conserved], number, seed);
    let noise = NOISE[number % 3];
    let times = grid(300, 0.1);
    let r = &mut plan.random;
    let (a, b, c) = (
        r.uniform(0.4, 0.9),
        r.uniform(0.1, 0.3),
        r.uniform(0.2, 0.5),
    );
    match number / 3 {
        0 => {
            let f = |_: f64, x: &State| {
                let (s, i) = (x[0] * x[1], x[1]);
                [-a * s, a * s - b * i, b * i, 0.0]
            };
            let states = free(&f, &times, [2.0, 0.02, 0.1, 0.0]);
            let data = three(&times, &states, ["S", "I", "R"]);
            plan = plan.of("dS", &["S*I"]);
            let text = table(&data, noise, &mut plan.random);
            plan.case("state S, I, R\ndS, dI, dR ~ poly(S, I, R; 2)\n", vec![text])
        }
        1 => {
            // 2 A → B → C conserves A + 2 B + 2 C.
            let f = |_: f64, x: &State| {
                let (first, second) = (a * x[0] * x[0], c * x[1]);
                [-2.0 * first, first - second, second, 0.0]
            };
            let states = free(&f, &times, [2.0, 0.1, 0.0, 0.0]);
            let data = three(&times, &states, ["A", "B", "C"]);
            plan = plan.of("dA", &["A^2"]);
            let text = table(&data, noise, &mut plan.random);
            plan.case("state A, B, C\ndA, dB, dC ~ poly(A, B, C; 2)\n", vec![text])
        }
        _ => {
            // Exchange between three compartments with one saturating flow.
            let f = |_: f64, x: &State| {
                let (p, q, s) = (a * x[0] * x[1], c * x[1], b * x[2]);
                [s - p, p - q, q - s, 0.0]
            };
            let states = free(&f, &times, [1.0, 0.8, 0.1, 0.0]);
            let data = three(&times, &states, ["x", "y", "z"]);
            plan = plan.of("dx", &["z", "x*y"]);
            let text = table(&data, noise, &mut plan.random);
            plan.case("state x, y, z\ndx, dy, dz ~ poly(x, y, z; 2)\n", vec![text])
        }
    }
}

fn three(
    times: &[f64],
    states: &[State],
    names: [&'static str; 3],
) -> Vec<(&'static str, Vec<f64>)> {
    let mut data = vec![("t", times.to_vec())];
    data.extend(
        names
            .into_iter()
            .enumerate()
            .map(|(i, n)| (n, column(states, i))),
    );
    data
}

/// Angles and other signals that stay near zero.
fn small_angle(number: usize, seed: u64) -> Case {
    let mut plan = Plan::new("small angle", &[Cause::SmallRange], number, seed);
    let noise = NOISE[number % 3];
    let times = grid(600, 0.02);
    let r = &mut plan.random;
    let (g, c) = (r.uniform(8.0, 12.0), r.uniform(0.1, 0.4));
    let start = r.uniform(0.03, 0.12);
    match number / 3 {
        0 => {
            let f = |_: f64, x: &State| [x[1], -g * x[0].sin() - c * x[1], 0.0, 0.0];
            let states = free(&f, &times, [start, 0.0, 0.0, 0.0]);
            let data = vec![("t", times), ("theta", column(&states, 0))];
            plan = plan.of("ddtheta", &["dtheta", "sin(theta)"]);
            let text = table(&data, noise, &mut plan.random);
            plan.case(
                "state theta : order 2\nddtheta ~ <theta, sin(theta), dtheta, dtheta*cos(theta)>\n",
                vec![text],
            )
        }
        1 => {
            let f = |t: f64, x: &State| {
                let u = 0.2 * wave(t, 1.0);
                [x[1], u * x[0].cos() - g * x[0].sin() - c * x[1], 0.0, 0.0]
            };
            let states = free(&f, &times, [start, 0.0, 0.0, 0.0]);
            let u = times.iter().map(|t| 0.2 * wave(*t, 1.0)).collect();
            let data = vec![("t", times), ("theta", column(&states, 0)), ("u", u)];
            plan = plan.of("ddtheta", &["dtheta", "sin(theta)", "u*cos(theta)"]);
            let text = table(&data, noise, &mut plan.random);
            plan.case(
                "state theta : order 2\ninput u : linear\n\
                 ddtheta ~ <1, theta, sin(theta), dtheta, u, u*cos(theta), theta^2>\n",
                vec![text],
            )
        }
        _ => {
            let f = |t: f64, x: &State| [0.1 * wave(t, 2.0) - c * g * x[0].tanh(), 0.0, 0.0, 0.0];
            let states = free(&f, &times, [start, 0.0, 0.0, 0.0]);
            let u = times.iter().map(|t| 0.1 * wave(*t, 2.0)).collect();
            let data = vec![("t", times), ("x", column(&states, 0)), ("u", u)];
            plan = plan.of("dx", &["u", "tanh(x)"]);
            let text = table(&data, noise, &mut plan.random);
            plan.case(
                "state x\ninput u : linear\ndx ~ <1, x, u, tanh(x), x^2, x*u>\n",
                vec![text],
            )
        }
    }
}

/// Inputs and parameters that are constant.
fn constant_input(number: usize, seed: u64) -> Case {
    let mut plan = Plan::new("constant input", &[Cause::ConstantSignal], number, seed);
    let noise = NOISE[number % 3];
    let times = grid(500, 0.02);
    let r = &mut plan.random;
    let (a, b, level) = (
        r.uniform(0.5, 1.5),
        r.uniform(0.5, 1.5),
        r.uniform(0.8, 2.5),
    );
    let still = vec![level; times.len()];
    match number / 3 {
        0 => {
            let f = |_: f64, x: &State| [x[1], b * level - 4.0 * a * x[0] - 0.3 * x[1], 0.0, 0.0];
            let states = free(&f, &times, [1.0, 0.0, 0.0, 0.0]);
            let data = vec![("t", times), ("x", column(&states, 0)), ("F", still)];
            plan = plan.of("ddx", &["x", "dx", "F"]);
            let text = table(&data, noise, &mut plan.random);
            plan.case(
                "state x : order 2\ninput F : hold\nddx ~ <1, x, dx, F, x^3, x^2>\n",
                vec![text],
            )
        }
        1 => {
            let f = |_: f64, x: &State| {
                [
                    a * x[1] - 0.5 * level * x[0],
                    -b * x[0] * level - 0.2 * x[1],
                    0.0,
                    0.0,
                ]
            };
            let states = free(&f, &times, [1.0, 0.5, 0.0, 0.0]);
            let data = vec![
                ("t", times),
                ("x", column(&states, 0)),
                ("y", column(&states, 1)),
                ("q", still),
            ];
            plan = plan.of("dx", &["y", "x*q"]);
            let text = table(&data, noise, &mut plan.random);
            plan.case(
                "state x, y\ninput q : hold\nlet lib = <x, y, q, x*q, y*q, x*y>\ndx, dy ~ lib\n",
                vec![text],
            )
        }
        _ => {
            let f = |t: f64, x: &State| [wave(t, b) - a * x[0] / level, 0.0, 0.0, 0.0];
            let states = free(&f, &times, [1.0, 0.0, 0.0, 0.0]);
            let u = times.iter().map(|t| wave(*t, b)).collect();
            let data = vec![
                ("t", times),
                ("x", column(&states, 0)),
                ("u", u),
                ("R", still),
            ];
            plan = plan.of("dx", &["u", "x/R"]);
            let text = table(&data, noise, &mut plan.random);
            plan.case(
                "state x\ninput u : linear\nparam R\ndx ~ <1, x, u, x/R, u/R, x^2>\n",
                vec![text],
            )
        }
    }
}

/// Fewer rows than needed.
fn few_rows(number: usize, seed: u64) -> Case {
    let mut plan = Plan::new("too few rows", &[Cause::TooFewRows], number, seed);
    let r = &mut plan.random;
    let rows = r.whole(9, 15);
    let start = [
        r.uniform(-8.0, 8.0),
        r.uniform(-8.0, 8.0),
        r.uniform(15.0, 30.0),
        0.0,
    ];
    let lorenz = |_: f64, x: &State| {
        [
            10.0 * (x[1] - x[0]),
            28.0 * x[0] - x[1] - x[0] * x[2],
            x[0] * x[1] - 8.0 / 3.0 * x[2],
            0.0,
        ]
    };
    let step = if number.is_multiple_of(2) { 0.17 } else { 0.05 };
    let times = grid(rows, step);
    let states = free(&lorenz, &times, start);
    let rates: Vec<State> = states.iter().map(|x| lorenz(0.0, x)).collect();
    let mut data = three(&times, &states, ["x", "y", "z"]);
    for (i, name) in ["dx", "dy", "dz"].into_iter().enumerate() {
        data.push((name, column(&rates, i)));
    }
    // The rates have noise, so that any exact fit is a wrong one.
    let noise = [0.0, 0.02, 0.05, 0.1][number % 4];
    plan = plan.of("dy", &["x", "y", "x*z"]);
    let text = table(&data, noise, &mut plan.random);
    plan.case("state x, y, z\ndy ~ poly(x, y, z; 4)\n", vec![text])
}

/// A library that lacks one of the terms.
fn missing_term(number: usize, seed: u64) -> Case {
    let mut plan = Plan::new("missing term", &[Cause::MissingTerm], number, seed);
    let noise = if number % 4 == 3 { 0.01 } else { 0.0 };
    let r = &mut plan.random;
    let (a, b) = (r.uniform(0.8, 1.4), r.uniform(0.8, 1.4));
    match number % 4 {
        0 => {
            let f = |_: f64, x: &State| {
                [
                    10.0 * (x[1] - x[0]),
                    28.0 * a * x[0] - x[1] - x[0] * x[2],
                    x[0] * x[1] - 8.0 / 3.0 * x[2],
                    0.0,
                ]
            };
            let times = grid(800, 0.01);
            let states = free(&f, &times, [-3.0, 4.0, 20.0, 0.0]);
            plan.target = "dy";
            let text = table(
                &three(&times, &states, ["x", "y", "z"]),
                noise,
                &mut plan.random,
            );
            plan.case("state x, y, z\ndy ~ <1, x, y, z, x^2, y^2>\n", vec![text])
        }
        1 => {
            let f = |_: f64, x: &State| [x[1], -x[0] + a * (1.0 - x[0] * x[0]) * x[1], 0.0, 0.0];
            let times = grid(800, 0.02);
            let states = free(&f, &times, [1.0, 0.5, 0.0, 0.0]);
            plan.target = "ddx";
            let data = [("t", times), ("x", column(&states, 0))];
            let text = table(&data, noise, &mut plan.random);
            plan.case(
                "state x : order 2\nddx ~ <1, x, dx, x^2, x^3>\n",
                vec![text],
            )
        }
        2 => {
            // An input that the author of the model forgot.
            let f = |t: f64, x: &State| [2.0 * wave(t, b) - a * x[0], 0.0, 0.0, 0.0];
            let times = grid(600, 0.02);
            let states = free(&f, &times, [0.0; 4]);
            let other: Vec<f64> = times.iter().map(|t| wave(*t, b)).collect();
            let second = free(
                &|t, _: &State| [wave(t, b + 1.0), 0.0, 0.0, 0.0],
                &times,
                [0.0; 4],
            );
            let data = [
                ("t", times),
                ("x", column(&states, 0)),
                ("y", column(&second, 0)),
                ("u", other),
            ];
            let text = table(&data, noise, &mut plan.random);
            plan.case(
                "state x, y\ninput u : linear\ndx ~ poly(x, y; 2)\ndy ~ <u, y>\n",
                vec![text],
            )
        }
        _ => {
            let f = |t: f64, x: &State| {
                let push = wave(t, b);
                [
                    x[1],
                    push - 3.0 * a * x[0].sin() - 2.0 * b * x[1] * x[1].abs(),
                    0.0,
                    0.0,
                ]
            };
            let times = grid(800, 0.02);
            let states = free(&f, &times, [1.5, 0.0, 0.0, 0.0]);
            let u = times.iter().map(|t| wave(*t, b)).collect();
            plan.target = "ddtheta";
            let data = [("t", times), ("theta", column(&states, 0)), ("u", u)];
            let text = table(&data, noise, &mut plan.random);
            plan.case(
                "state theta : order 2\ninput u : linear\nddtheta ~ <theta, sin(theta), cos(theta), u>\n",
                vec![text],
            )
        }
    }
}

/// A variable whose law has another order than declared.
fn wrong_order(number: usize, seed: u64) -> Case {
    let mut plan = Plan::new("wrong order", &[Cause::WrongOrder], number, seed);
    let noise = if number % 4 == 3 { 0.01 } else { 0.0 };
    let r = &mut plan.random;
    let (a, b, phase) = (
        r.uniform(2.0, 5.0),
        r.uniform(0.2, 0.6),
        r.uniform(0.0, 2.0),
    );
    let times = grid(800, 0.02);
    let u: Vec<f64> = times.iter().map(|t| wave(*t, phase)).collect();
    if number < 4 {
        let f = |t: f64, x: &State| {
            let drive = if number.is_multiple_of(2) {
                wave(t, phase)
            } else {
                0.0
            };
            [
                x[1],
                drive - a * x[0] - b * x[1] - 0.5 * x[0].powi(3),
                0.0,
                0.0,
            ]
        };
        let states = free(&f, &times, [1.0, 0.0, 0.0, 0.0]);
        let mut data = vec![("t", times), ("x", column(&states, 0))];
        let model = if number.is_multiple_of(2) {
            data.push(("u", u));
            "state x\ninput u : linear\ndx ~ poly(x; 3) + <u, u*x>\n"
        } else {
            "state x\ndx ~ poly(x; 3)\n"
        };
        let text = table(&data, noise, &mut plan.random);
        return plan.case(model, vec![text]);
    }
    plan.target = "ddx";
    let cubic = if number.is_multiple_of(2) { 0.4 } else { 0.0 };
    let f = |t: f64, x: &State| {
        [
            wave(t, phase) - a * x[0] - cubic * x[0].powi(3),
            0.0,
            0.0,
            0.0,
        ]
    };
    let states = free(&f, &times, [1.0, 0.0, 0.0, 0.0]);
    let data = vec![("t", times), ("x", column(&states, 0)), ("u", u)];
    let text = table(&data, noise, &mut plan.random);
    plan.case(
        "state x : order 2\ninput u : linear\nddx ~ <1, x, dx, u, x^3, x*dx, u*x>\n",
        vec![text],
    )
}
