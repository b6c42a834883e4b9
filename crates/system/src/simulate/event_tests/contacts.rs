//! Bodies that strike each other and stay together, against closed forms.

use super::jumps::{below, floor, with_resets};
use super::*;

const G: f64 = 9.81;
const SPEED: Signal = Signal::derivative(VarId(1), 1);

/// A ball bounces ever faster, lies on the floor, and is lifted off at 3 s.
#[test]
fn a_ball_comes_to_rest() {
    let ball = bodies(&[number(-G) + Expr::signal(INPUT)]);
    let ball = with_resets(&ball, vec![floor(0.6)]);
    let known = |t: f64| {
        if t >= 3.0 {
            let s = t - 3.0;
            return vec![0.5 * s * s, s];
        }
        let (mut from, mut v) = (f64::sqrt(2.0 / G), 0.6 * f64::sqrt(2.0 * G));
        if t < from {
            return vec![1.0 - 0.5 * G * t * t, -G * t];
        }
        while v > 1e-12 {
            let (s, flight) = (t - from, 2.0 * v / G);
            if s < flight {
                return vec![v * s - 0.5 * G * s * s, v - G * s];
            }
            (from, v) = (from + flight, 0.6 * v);
        }
        vec![0.0, 0.0]
    };
    let time = instants(200, 0.02);
    let input: Vec<f64> = (0..200)
        .map(|k| if k < 150 { 0.0 } else { G + 1.0 })
        .collect();
    agree("ball", &ball, &time, &input, &[1.0, 0.0], &known);
}

/// A body that lies on the floor from the start on, until a force that grows with time exceeds its weight.
#[test]
fn a_body_leaves_the_floor_when_nothing_presses_it_on() {
    let body = bodies(&[Expr::signal(Signal::TIME) - number(1.5)]);
    let body = with_resets(&body, vec![floor(0.3)]);
    let known = |t: f64| {
        let s = f64::max(t - 1.5, 0.0);
        vec![s * s * s / 6.0, 0.5 * s * s]
    };
    let time = instants(60, 0.05);
    agree("body", &body, &time, &[0.0; 60], &[0.0, 0.0], &known);
}

/// One body pushes another after they met without a bounce, until the force turns.
#[test]
fn one_body_pushes_another() {
    let both = (velocity(0) + velocity(1).scale(2.0)).scale(1.0 / 3.0);
    let meet = below(
        position(1),
        position(0),
        vec![
            (SPEED, both.clone()),
            (Signal::derivative(VarId(2), 1), both),
        ],
    );
    // The second has twice the mass of the first.
    let pair = with_resets(&bodies(&[Expr::signal(INPUT), Expr::zero()]), vec![meet]);
    let met = f64::sqrt(2.0);
    let known = |t: f64| {
        if t < met {
            return vec![0.5 * t * t - 1.0, t, 0.0, 0.0];
        }
        let (v, s) = (met / 3.0, f64::min(t, 3.0) - met);
        let (x, v) = (v * s + s * s / 6.0, v + s / 3.0);
        let s = f64::max(t - 3.0, 0.0);
        vec![x + v * s - 0.5 * s * s, v - s, x + v * s, v]
    };
    let time = instants(80, 0.05);
    let input: Vec<f64> = (0..80).map(|k| if k < 60 { 1.0 } else { -1.0 }).collect();
    agree("pair", &pair, &time, &input, &[-1.0, 0.0, 0.0, 0.0], &known);
}

/// A body lies on a support that a force moves: they part where the support falls faster.
#[test]
fn a_support_that_falls_away_loses_its_body() {
    let lands = below(
        position(0),
        position(1),
        vec![(SPEED, velocity(1) - (velocity(0) - velocity(1)).scale(0.5))],
    );
    // The support follows its own law whatever lies on it.
    let pair = bodies(&[number(-1.0), Expr::signal(INPUT)]);
    let pair = with_resets(&pair, vec![lands]);
    let known = |t: f64| {
        if t < 1.0 {
            let (x, v) = (0.25 * t * t, 0.5 * t);
            return vec![x, v, x, v];
        }
        let s = t - 1.0;
        let along = |a: f64| [0.25 + 0.5 * s + 0.5 * a * s * s, 0.5 + a * s];
        [along(-1.0), along(-2.0)].concat()
    };
    let time = instants(40, 0.05);
    let input: Vec<f64> = (0..40).map(|k| if k < 20 { 0.5 } else { -2.0 }).collect();
    agree("support", &pair, &time, &input, &[0.0; 4], &known);
}

/// Two balls fall one upon the other: the lower strikes the floor, then the upper, in one instant.
#[test]
fn impacts_set_off_each_other() {
    let swap = vec![
        (SPEED, velocity(1)),
        (Signal::derivative(VarId(2), 1), velocity(0)),
    ];
    let strike = below(position(1), position(0), swap);
    let balls = with_resets(&bodies(&[number(-G), number(-G)]), vec![floor(1.0), strike]);
    // Balls of the same mass exchange their speeds: the upper rises again to where it was, the lower to where it was.
    let known = |t: f64| {
        let fall = f64::sqrt(2.0 / G);
        let s = match t < fall {
            true => t,
            false => 2.0 * fall - t,
        };
        let (y, v) = (
            1.0 - 0.5 * G * s * s,
            if t < fall {
                -G * t
            } else {
                G * (2.0 * fall - t)
            },
        );
        vec![y, v, y, v]
    };
    let time = instants(40, 0.02);
    agree(
        "balls",
        &balls,
        &time,
        &[0.0; 40],
        &[1.0, 0.0, 1.0, 0.0],
        &known,
    );
}
