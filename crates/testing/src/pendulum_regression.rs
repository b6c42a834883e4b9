//! A pendulum on a cart under a held random force, with the tensor power library: the experiment of the thesis as a regression.

use sidc_solve::dictionary::Dense;

const CART: f64 = 0.5;
const BOB: f64 = 0.275;
const ROD: f64 = 0.5;
const PIVOT_FRICTION: f64 = 0.01;
const TRACK_FRICTION: f64 = 0.05;
const GRAVITY: f64 = 9.8;

/// One sample: y, ẏ, ÿ, θ, θ̇, θ̈, F.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    pub y: f64,
    pub dy: f64,
    pub ddy: f64,
    pub angle: f64,
    pub dangle: f64,
    pub ddangle: f64,
    pub force: f64,
}

/// Small generator with a fixed stream on every platform (xorshift64*).
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Random {
        Random(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    /// Uniform in [0, 1).
    pub fn uniform(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Standard normal (Box–Muller).
    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.uniform()).cos()
    }

    /// `count` different numbers below `range`.
    pub fn choose(&mut self, count: usize, range: usize) -> Vec<usize> {
        let mut all: Vec<usize> = (0..range).collect();
        for i in 0..count {
            let j = i + (self.uniform() * (range - i) as f64) as usize;
            all.swap(i, j);
        }
        all.truncate(count);
        all
    }
}

/// (ÿ, θ̈) from (ẏ, θ, θ̇, F).
fn accelerations(dy: f64, angle: f64, dangle: f64, force: f64) -> (f64, f64) {
    let (s, c) = angle.sin_cos();
    let a = [
        [CART + BOB, BOB * ROD * c],
        [BOB * ROD * c, BOB * ROD * ROD],
    ];
    let b = [
        force - TRACK_FRICTION * dy + BOB * ROD * dangle * dangle * s,
        -PIVOT_FRICTION * dangle - BOB * GRAVITY * ROD * s,
    ];
    let det = a[0][0] * a[1][1] - a[0][1] * a[1][0];
    (
        (b[0] * a[1][1] - b[1] * a[0][1]) / det,
        (a[0][0] * b[1] - a[1][0] * b[0]) / det,
    )
}

/// 100 Hz samples from rest; the force is a random level held for a random time.
pub fn simulate(count: usize, seed: u64) -> Vec<Sample> {
    let mut random = Random::new(seed);
    let (mut state, mut force, mut hold) = ([0.0_f64; 4], 0.0, 0);
    let rate = |s: [f64; 4], force: f64| {
        let (ddy, ddangle) = accelerations(s[1], s[2], s[3], force);
        [s[1], ddy, s[3], ddangle]
    };
    let step = |s: [f64; 4], k: [f64; 4], h: f64| std::array::from_fn(|i| s[i] + h * k[i]);
    let mut samples = Vec::with_capacity(count);
    for _ in 0..count {
        if hold == 0 {
            hold = 10 + (random.uniform() * 50.0) as usize;
            force = 16.0 * random.uniform() - 8.0;
        }
        hold -= 1;
        let (ddy, ddangle) = accelerations(state[1], state[2], state[3], force);
        let [y, dy, angle, dangle] = state;
        samples.push(Sample {
            y,
            dy,
            ddy,
            angle,
            dangle,
            ddangle,
            force,
        });
        for _ in 0..4 {
            let h = 0.0025;
            let k1 = rate(state, force);
            let k2 = rate(step(state, k1, h / 2.0), force);
            let k3 = rate(step(state, k2, h / 2.0), force);
            let k4 = rate(step(state, k3, h), force);
            for i in 0..4 {
                state[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
            }
        }
    }
    samples
}

/// Which of the two equations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target {
    Cart,
    Pendulum,
}

/// One regression: Φ, the target and the true terms by column.
pub struct Regression {
    pub dictionary: Dense,
    pub target: Vec<f64>,
    pub truth: Vec<(usize, f64)>,
}

/// All products of the eight atoms with exponents below `caps`; the first atom varies slowest.
pub fn regression(samples: &[Sample], target: Target, caps: [usize; 8]) -> Regression {
    let atoms: Vec<[f64; 8]> = samples
        .iter()
        .map(|s| {
            let other = if target == Target::Cart {
                s.ddangle
            } else {
                s.ddy
            };
            [
                s.y,
                s.dy,
                s.angle,
                s.dangle,
                other,
                s.angle.sin(),
                s.angle.cos(),
                s.force,
            ]
        })
        .collect();
    let cols: usize = caps.iter().product();
    let mut values = Vec::with_capacity(cols * samples.len());
    for j in 0..cols {
        let powers = exponents(j, caps);
        values.extend(atoms.iter().map(|a| -> f64 {
            a.iter()
                .zip(powers)
                .map(|(x, e)| x.powi(e as i32))
                .product()
        }));
    }
    let at = |powers: [usize; 8]| {
        (0..cols)
            .find(|&j| exponents(j, caps) == powers)
            .unwrap_or(0)
    };
    let (mass, inertia) = (CART + BOB, BOB * ROD * ROD);
    let truth = match target {
        Target::Cart => vec![
            (at([0, 0, 0, 0, 0, 0, 0, 1]), 1.0 / mass),
            (at([0, 1, 0, 0, 0, 0, 0, 0]), -TRACK_FRICTION / mass),
            (at([0, 0, 0, 0, 1, 0, 1, 0]), -BOB * ROD / mass),
            (at([0, 0, 0, 2, 0, 1, 0, 0]), BOB * ROD / mass),
        ],
        Target::Pendulum => vec![
            (at([0, 0, 0, 1, 0, 0, 0, 0]), -PIVOT_FRICTION / inertia),
            (at([0, 0, 0, 0, 0, 1, 0, 0]), -GRAVITY / ROD),
            (at([0, 0, 0, 0, 1, 0, 1, 0]), -1.0 / ROD),
        ],
    };
    Regression {
        dictionary: Dense::new(samples.len(), values),
        target: samples
            .iter()
            .map(|s| {
                if target == Target::Cart {
                    s.ddy
                } else {
                    s.ddangle
                }
            })
            .collect(),
        truth,
    }
}

fn exponents(mut j: usize, caps: [usize; 8]) -> [usize; 8] {
    let mut powers = [0; 8];
    for (power, cap) in powers.iter_mut().zip(caps).rev() {
        *power = j % cap;
        j /= cap;
    }
    powers
}

/// `rows` random samples of 15 s of motion.
pub fn draw(rows: usize, seed: u64) -> Vec<Sample> {
    let all = simulate(1500, seed);
    Random::new(seed + 1000)
        .choose(rows, all.len())
        .into_iter()
        .map(|i| all[i])
        .collect()
}
