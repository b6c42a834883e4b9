//! States that jump, against closed forms.

use super::*;
use sidc_lang::model::{Condition, Reset};

pub(super) fn below(left: Expr, right: Expr, jumps: Vec<(Signal, Expr)>) -> Reset {
    Reset {
        condition: Condition {
            left,
            is_above: false,
            right,
        },
        jumps,
    }
}

pub(super) fn with_resets(system: &CompiledSystem, resets: Vec<Reset>) -> CompiledSystem {
    let form = Form {
        resets,
        ..system.form.clone()
    };
    CompiledSystem::new(form).unwrap()
}

/// A rigid floor, which the first body leaves with this part of its speed.
pub(super) fn floor(restitution: f64) -> Reset {
    let speed = Signal::derivative(VarId(1), 1);
    let leaves = velocity(0).scale(-restitution);
    below(position(0), number(0.0), vec![(speed, leaves)])
}

/// A ball that leaves a rigid floor with 0.8 of its speed.
#[test]
fn a_ball_bounces() {
    const G: f64 = 9.81;
    let ball = with_resets(&bodies(&[number(-G)]), vec![floor(0.8)]);
    let known = |t: f64| {
        let (mut from, mut y, mut v) = (0.0, 1.0, 0.5);
        loop {
            let flight = (v + f64::sqrt(v * v + 2.0 * G * y)) / G;
            if t < from + flight {
                let s = t - from;
                return vec![y + v * s - 0.5 * G * s * s, v - G * s];
            }
            (from, y, v) = (from + flight, 0.0, -0.8 * (v - G * flight));
        }
    };
    let time = instants(150, 0.02);
    agree("ball", &ball, &time, &[0.0; 150], &[1.0, 0.5], &known);
}

/// A cell that charges towards its input and is discharged at 1; where the input takes the threshold below the charge, at once.
#[test]
fn a_cell_fires() {
    let (x, threshold) = (position(0), Expr::signal(INPUT));
    let fire = below(
        threshold,
        x.clone(),
        vec![(Signal::new(VarId(1)), number(-0.5))],
    );
    let mut cell = first_order(number(2.0) - x);
    cell.form.inputs = vec![INPUT];
    let cell = with_resets(&cell, vec![fire]);
    let time = instants(40, 0.1);
    let input: Vec<f64> = (0..40).map(|k| if k == 22 { 0.2 } else { 1.0 }).collect();
    let known = |t: f64| {
        let (mut from, mut charge) = (0.0, 0.0);
        loop {
            let fires = from + f64::ln((2.0 - charge) / (2.0 - 1.0));
            let at = |s: f64| 2.0 - (2.0 - charge) * f64::exp(from - s);
            let forced = from < 2.2 && fires > 2.2 && at(2.2) > 0.2;
            let until = if forced { 2.2 } else { fires };
            if t < until {
                return vec![at(t)];
            }
            (from, charge) = (until, -0.5);
        }
    };
    agree("cell", &cell, &time, &input, &[0.0], &known);
}

/// Jumps without end in no time are named, where no contact closes: here those of a speed below zero are no multiple of it.
#[test]
fn jumps_that_accumulate_end_the_run() {
    let speed = Signal::derivative(VarId(1), 1);
    let stop = below(
        position(0),
        number(0.0),
        vec![(speed, velocity(0).pow(2.0).scale(0.01))],
    );
    let ball = with_resets(&bodies(&[number(-9.81)]), vec![stop]);
    let time = instants(50, 0.02);
    let mut observer = Unwatched;
    let names = ball.form.state.clone();
    let mut guard = Guard::new(vec![1.0; 2], vec![1e6; 2], names, 1_000_000, &mut observer);
    let leg = LegSetup {
        system: &ball,
        drives: &[InputSource::SampledInput(
            SampledInput::new(&time, &[0.0; 50], Between::Hold, 0.0).unwrap(),
        )],
        time: &time,
        sampled: &time,
        params: &[],
        guess: &[0.0],
        method: Method::Explicit,
        step: None,
    };
    let path = integrate(&leg, &[0.1, 0.0], &mut guard);
    let fault = path.fault.unwrap();
    assert_eq!(fault.kind.code(), "jumps-accumulate");
    assert!(fault.time < 0.15, "{fault:?}");
}

/// A relay whose threshold an input takes below the state: it switches at once, and goes on from there.
#[test]
fn a_relay_switches_when_its_threshold_falls() {
    // x' = q − x with q that jumps from 2 to 0 above the threshold, and back below 0.5.
    let (x, q) = (Signal::new(VarId(1)), Signal::new(VarId(2)));
    let mut form = Form {
        linear: true,
        state: vec![x, q],
        inputs: vec![INPUT],
        unknowns: vec![
            Signal::derivative(VarId(1), 1),
            Signal::derivative(VarId(2), 1),
        ],
        rates: vec![Rate::Unknown(0), Rate::Unknown(1)],
        ..Form::default()
    };
    let rates = [Expr::signal(q) - Expr::signal(x), Expr::zero()];
    form.rows = (rates.into_iter().zip(&form.unknowns))
        .map(|(rate, target)| form.row(rate, *target))
        .collect();
    let relay = with_resets(
        &CompiledSystem::new(form).unwrap(),
        vec![
            below(Expr::signal(INPUT), Expr::signal(x), vec![(q, number(0.0))]),
            below(Expr::signal(x), number(0.5), vec![(q, number(2.0))]),
        ],
    );
    let known = |t: f64| {
        let on = 2.0 - 1.4 * f64::exp(-t);
        let off = (2.0 - 1.4 * f64::exp(-0.4)) * f64::exp(0.4 - t);
        let again = 0.4 + f64::ln((2.0 - 1.4 * f64::exp(-0.4)) / 0.5);
        match t {
            t if t < 0.4 => vec![on, 2.0],
            t if t < again => vec![off, 0.0],
            t => vec![2.0 - 1.5 * f64::exp(again - t), 2.0],
        }
    };
    let time = instants(16, 0.1);
    let input: Vec<f64> = (0..16).map(|k| if k == 4 { 0.8 } else { 1.5 }).collect();
    agree("relay", &relay, &time, &input, &[0.6, 2.0], &known);
}
