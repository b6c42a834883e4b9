//! Flows across jumps of the states: closed forms, and derivatives against differences.

use super::{agrees_with_differences, moved, system};
use crate::trajectory::integration::{CompiledLaws, IntervalBlock, ShootingIntegrator, Workspace};
use crate::trajectory::model::{Exogenous, ImpulseSource, Record, System, impulse_of};
use sidc_lang::model::Between;
use sidc_lang::term::Term;

/// One interval of 0.1 s of laws with a constant in their jumps; its first column is what the constant does there.
struct Interval {
    system: System,
    /// Of the terms.
    coefficients: Vec<f64>,
    next: Vec<f64>,
}

impl Interval {
    /// `next`: an estimate of the state at the end, which tells in which interval states jump.
    fn new(laws: &str, coefficients: &[f64], next: &[f64]) -> Interval {
        let mut system = system(laws);
        let constant = system.exogenous[0];
        let mut impulses = Vec::new();
        let signal = impulse_of(ImpulseSource::Jump(constant), &mut impulses);
        system.impulses = impulses;
        system.exogenous.push(signal);
        system.columns.insert(0, Term::signal(signal));
        for (l, law) in system.laws.iter_mut().enumerate() {
            law.columns = law.columns.start + usize::from(l > 0)..law.columns.end + 1;
        }
        Interval {
            system,
            coefficients: coefficients.to_vec(),
            next: next.to_vec(),
        }
    }

    fn flow(&self, constant: f64, coefficients: &[f64], states: &[f64]) -> IntervalBlock {
        let n = self.system.states.len();
        let held = |value: f64| Exogenous {
            values: vec![value; 2],
            between: Between::Hold,
        };
        let record = Record {
            time: vec![0.0, 0.1],
            measured: vec![vec![f64::NAN; 2]; n],
            exogenous: vec![held(constant), held(0.0)],
            ..Record::default()
        };
        let coefficients = [&[0.0], coefficients].concat();
        let active: Vec<usize> = (0..coefficients.len()).collect();
        let flow = ShootingIntegrator {
            laws: &CompiledLaws::new(&self.system, &active),
            all: None,
            coefficients: &coefficients,
            spread: &vec![1.0; n],
            accuracy: 1e-11,
        };
        let states = [states, &self.next].concat();
        let (mut work, mut block) = (Workspace::default(), IntervalBlock::default());
        flow.block(&record, &states, 0..1, &mut work, &mut block)
            .unwrap();
        block
    }

    /// T and U are what differences of the end states give, to an error that differences of second order leave.
    fn check(&self, constant: f64, states: &[f64]) -> Vec<f64> {
        let (n, k) = (states.len(), self.coefficients.len() + 1);
        let base = self.flow(constant, &self.coefficients, states);
        for j in 0..n {
            let said = |i: usize| base.transition[i * n + j];
            let flow = |by| self.flow(constant, &self.coefficients, &moved(states, j, by));
            agrees_with_differences(n, &said, &flow, &format!("state {j} of"));
        }
        let said = |i: usize| base.columns[i * k];
        let flow = |by| self.flow(constant + by, &self.coefficients, states);
        agrees_with_differences(n, &said, &flow, "the constant of");
        for j in 1..k {
            let said = |i: usize| base.columns[i * k + j];
            let flow = |by| self.flow(constant, &moved(&self.coefficients, j - 1, by), states);
            agrees_with_differences(n, &said, &flow, &format!("coefficient {j} of"));
        }
        base.end
    }
}

const BALL: &str =
    "system ball\nstate y : order 2\nunknown e in 0.1 .. 1\nddy ~ <1>\nwhen y < 0 : dy -> -e*dy\n";

/// Falls from 0.05 with −1 for τ, leaves the floor with 0.8 of its speed.
#[test]
fn a_ball_bounces() {
    let fall = (f64::sqrt(1.0 + 2.0 * 9.81 * 0.05) - 1.0) / 9.81;
    let (up, rest) = (0.8 * (1.0 + 9.81 * fall), 0.1 - fall);
    let known = [up * rest - 0.5 * 9.81 * rest * rest, up - 9.81 * rest];
    let end = Interval::new(BALL, &[-9.81], &known).check(0.8, &[0.05, -1.0]);
    for (x, known) in end.iter().zip(known) {
        assert!((x - known).abs() < 1e-12, "{end:?}");
    }
}

#[test]
fn a_threshold_is_unknown() {
    let laws = "system cell\nstate v\nunknown top in 0.5 .. 2\ndv ~ <1, v>\nwhen v > top : v -> 0.1*v - 0.3*top\n";
    let cell = Interval::new(laws, &[5.0, -1.0], &[0.0]);
    cell.check(1.0, &[0.9]);
    cell.check(0.8, &[0.6]);
}

#[test]
fn two_bodies_collide() {
    let laws = "system two\nstate x : order 2\nstate z : order 2\nunknown e in 0.1 .. 1\n\
        ddx ~ <1, x>\nddz ~ <z, dz>\n\
        when z < x : dx -> dx + 0.5*(1 + e)*(dz - dx), dz -> dz - 0.5*(1 + e)*(dz - dx)\n";
    let two = Interval::new(laws, &[0.5, -3.0, -2.0, -0.4], &[0.05, -0.9, 0.1, 0.9]);
    two.check(0.7, &[0.0, 1.0, 0.05, -1.0]);
}

/// Which of two intervals a jump beside a sample falls into, the next state tells; the laws lead nearly as far.
#[test]
fn jumps_beside_samples_go_where_the_states_are() {
    // At the floor a thousandth of a second after the end.
    let start = [0.101 + 0.5 * 9.81 * 0.101 * 0.101, -1.0];
    let end = |next: &[f64]| {
        let ball = Interval::new(BALL, &[-9.81], next);
        ball.flow(0.8, &[-9.81], &start).end
    };
    let (before, after) = (end(&[0.002, -2.0]), end(&[-0.002, 1.6]));
    assert!(before[1] < -1.9 && after[1] > 1.5, "{before:?} {after:?}");
    // The ball is as far below the floor as it would have risen since.
    assert!(
        (after[0] + 0.8 * before[0]).abs() < 2e-5,
        "{before:?} {after:?}"
    );
    let late = Interval::new(BALL, &[-9.81], &[0.15, 0.8]);
    let end = late.flow(0.8, &[-9.81], &[-0.002, -2.0]).end;
    assert!(end[1] > 0.5, "{end:?}");
}
