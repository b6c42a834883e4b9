//! Records of small systems that more than one test needs, as text.
//!
//! In: sizes of noise, numbers of samples. Out: CSV. Every number follows from its seed.

use std::fmt::Write;

use crate::pendulum_regression::Random;

/// y' = 1.6 y − 0.7 y₋₁ + 0.1 u, with process noise and sensor noise.
pub fn difference_equation(process: f64, sensor: f64) -> String {
    let mut random = Random::new(3);
    let (mut y, mut before, mut u) = (0.0, 0.0, 0.0);
    let mut text = String::from("y,u\n");
    for k in 0..1500 {
        if k % 15 == 0 {
            u = random.normal();
        }
        let _ = writeln!(text, "{:.9},{u:.9}", y + sensor * random.normal());
        let next = 1.6 * y - 0.7 * before + 0.1 * u + process * random.normal();
        (y, before) = (next, y);
    }
    text
}

/// Heights of a ball that is dropped from 2 m and loses a fifth of its speed at every impact.
pub fn bounces(rows: usize, step: f64) -> Vec<f64> {
    let (mut start, mut height, mut speed) = (0.0, 2.0f64, 0.0f64);
    let mut fall = |time: f64| loop {
        let s = time - start;
        let y = height + speed * s - 9.81 / 2.0 * s * s;
        if y >= 0.0 || speed.abs() < 1e-3 && height == 0.0 {
            return y;
        }
        let flight = (speed + (speed * speed + 2.0 * 9.81 * height).sqrt()) / 9.81;
        speed = 0.8 * (9.81 * flight - speed);
        (start, height) = (start + flight, 0.0);
    };
    (0..rows).map(|k| fall(k as f64 * step)).collect()
}

/// The same twelve states three times, with rates dx = 2 x − z that differ by a thousandth.
pub fn contradicting_rows() -> String {
    let row = |i: usize| {
        let (x, z) = (
            (i % 12) as f64 / 4.0 - 1.0,
            ((i % 12) * (i % 12) % 7) as f64 / 5.0,
        );
        let rate = 2.0 * x - z + 1e-3 * (i / 12) as f64;
        format!("{i},{x},{z},{rate}\n")
    };
    let rows: String = (0..36).map(row).collect();
    format!("t,x,z,dx\n{rows}")
}

/// Time between the samples of [`joined`].
const JOINED_STEP: f64 = 0.01;

/// Two bodies joined by inertia and springs, the first of which is pushed: ddx + m ddy = u − k₁ x − k₁₂ y − 0.2 dx, ddy + m ddx = −k₂ y −
/// k₁₂ x − 0.1 dy. Everything is measured.
pub fn joined(m: f64, [k1, k2, k12]: [f64; 3], seed: u64) -> String {
    let mut random = Random::new(seed);
    let mut z = [0.0f64; 4];
    let (mut u, mut text) = (0.0, "t,x,y,dx,dy,ddx,ddy,u\n".to_string());
    let rates = |z: &[f64; 4], u: f64| {
        let [x, y, dx, dy] = *z;
        let f = u - k1 * x - k12 * y - 0.2 * dx;
        let g = -k2 * y - k12 * x - 0.1 * dy;
        let det = 1.0 - m * m;
        [(f - m * g) / det, (g - m * f) / det]
    };
    for row in 0..500 {
        if row % 20 == 0 {
            u = 4.0 * random.uniform() - 2.0;
        }
        let [ddx, ddy] = rates(&z, u);
        let [x, y, dx, dy] = z;
        let t = JOINED_STEP * f64::from(row);
        let _ = writeln!(text, "{t},{x},{y},{dx},{dy},{ddx},{ddy},{u}");
        // Runge–Kutta, because Euler's rates are half a step late and would contradict the positions.
        let slope = |z: &[f64; 4]| {
            let [ddx, ddy] = rates(z, u);
            [z[2], z[3], ddx, ddy]
        };
        let ahead = |z: &[f64; 4], k: &[f64; 4], h: f64| {
            let mut out = *z;
            out.iter_mut().zip(k).for_each(|(z, k)| *z += h * k);
            out
        };
        for _ in 0..2 {
            let h = 0.5 * JOINED_STEP;
            let a = slope(&z);
            let b = slope(&ahead(&z, &a, 0.5 * h));
            let c = slope(&ahead(&z, &b, 0.5 * h));
            let d = slope(&ahead(&z, &c, h));
            for i in 0..4 {
                z[i] += h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]);
            }
        }
    }
    text
}
