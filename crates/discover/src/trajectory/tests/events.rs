//! Flows across events: closed forms, and derivatives against differences.

use super::{agrees_with_differences, close, moved, system};
use crate::trajectory::integration::{CompiledLaws, IntervalBlock, ShootingIntegrator, Workspace};
use crate::trajectory::model::{Exogenous, Record, System};
use sidc_lang::model::Between;

/// One interval of 0.1 s of laws with all their columns active.
struct Interval {
    system: System,
    coefficients: Vec<f64>,
    /// Exogenous signals at the start and at the end.
    inputs: Vec<[f64; 2]>,
}

impl Interval {
    /// `laws`: the text of a model, whose terms have these coefficients in the order in which they are written.
    fn new(laws: &str, coefficients: &[f64], inputs: &[[f64; 2]]) -> Interval {
        let system = system(laws);
        assert_eq!(system.columns.len(), coefficients.len());
        assert_eq!(system.exogenous.len(), inputs.len());
        Interval {
            system,
            coefficients: coefficients.to_vec(),
            inputs: inputs.to_vec(),
        }
    }

    fn flow(&self, coefficients: &[f64], states: &[f64]) -> IntervalBlock {
        let n = self.system.states.len();
        let exogenous = |values: &[f64; 2]| Exogenous {
            values: values.to_vec(),
            between: Between::Linear,
        };
        let record = Record {
            time: vec![0.0, 0.1],
            measured: vec![vec![f64::NAN; 2]; n],
            exogenous: self.inputs.iter().map(exogenous).collect(),
            ..Record::default()
        };
        let active: Vec<usize> = (0..coefficients.len()).collect();
        let flow = ShootingIntegrator {
            laws: &CompiledLaws::new(&self.system, &active),
            all: None,
            coefficients,
            spread: &vec![1.0; n],
            accuracy: 1e-11,
        };
        let states = [states, &vec![0.0; n]].concat();
        let (mut work, mut block) = (Workspace::default(), IntervalBlock::default());
        flow.block(&record, &states, 0..1, &mut work, &mut block)
            .unwrap();
        block
    }

    /// T and U are what differences of the end states give.
    fn check(&self, states: &[f64]) -> Vec<f64> {
        let (n, k) = (states.len(), self.coefficients.len());
        let base = self.flow(&self.coefficients, states);
        for j in 0..n {
            let said = |i: usize| base.transition[i * n + j];
            let flow = |by| self.flow(&self.coefficients, &moved(states, j, by));
            agrees_with_differences(n, &said, &flow, &format!("state {j} of"));
        }
        for j in 0..k {
            let said = |i: usize| base.columns[i * k + j];
            let flow = |by| self.flow(&moved(&self.coefficients, j, by), states);
            agrees_with_differences(n, &said, &flow, &format!("coefficient {j} of"));
        }
        base.end
    }
}

const BODY: &str = "system body\nstate x : order 2\ninput F\nddx ~ <F, sign(dx)>\n";

#[test]
fn a_body_comes_to_rest_and_stays() {
    // 0.04 at a deceleration of 1 - 0.4: at rest after 0.04/0.6 s.
    let body = Interval::new(BODY, &[1.0, -1.0], &[[0.4, 0.4]]);
    let end = body.check(&[0.3, 0.04]);
    assert!((end[0] - 0.3 - 0.04 * 0.04 / 1.2).abs() < 1e-14, "{end:?}");
    assert!(end[1].abs() < 1e-14, "{end:?}");
}

#[test]
fn a_body_turns() {
    // -1 - 2 until it rests after 0.01 s, then -2 + 1 for 0.09 s.
    let body = Interval::new(BODY, &[1.0, -1.0], &[[-2.0, -2.0]]);
    let end = body.check(&[0.3, 0.03]);
    let moved = 0.03 * 0.03 / 6.0 - 0.09 * 0.09 / 2.0;
    assert!((end[0] - 0.3 - moved).abs() < 1e-14, "{end:?}");
    assert!((end[1] + 0.09).abs() < 1e-14, "{end:?}");
}

#[test]
fn a_body_is_let_go_when_the_force_has_grown() {
    // The force passes the friction of 1 after half of the time: 20 t beyond it, so 10 t² and 10/3 t³.
    let body = Interval::new(BODY, &[1.0, -1.0], &[[0.0, 2.0]]);
    for start in [0.0, 1e-4, -1e-4] {
        let end = body.check(&[0.3, start]);
        assert!((end[1] - 10.0 * 0.05 * 0.05).abs() < 1e-12, "{end:?}");
    }
}

#[test]
fn friction_that_depends_on_speed_and_place() {
    let laws = "system body\nstate x : order 2\ninput F\n\
        ddx ~ <x, dx, F, sign(dx), sign(dx)*exp(-abs(dx)/0.1), x^2*sign(dx), step(x - 0.301)>\n";
    let a = [-5.0, -0.5, 1.0, -1.0, -0.6, -0.3, -0.8];
    let body = Interval::new(laws, &a, &[[1.0, -4.0]]);
    for speed in [0.06, 0.02, -0.03, -0.2] {
        body.check(&[0.3, speed]);
    }
}

#[test]
fn contacts_through_a_mass_matrix_and_on_each_other() {
    let laws = "system two\nstate x : order 2\nstate q : order 2\ninput F\n\
        ddx ~ <F, sign(dx), dq^2*sin(q), ddq*cos(q)>\nddq ~ <sin(q), sign(dq - dx), ddx*cos(q)>\n";
    let a = [1.0, -0.7, 0.3, -0.2, -4.0, -0.5, -0.4];
    for force in [[0.9, -1.5], [0.2, -0.3]] {
        let two = Interval::new(laws, &a, &[force]);
        for states in [
            [0.1, 0.03, 0.2, 0.01],
            [0.1, 0.01, 0.02, 0.03],
            [0.1, -0.02, -0.1, -0.04],
        ] {
            two.check(&states);
        }
    }
    let end = Interval::new(laws, &a, &[[0.2, -0.3]]).check(&[0.1, 0.0, 0.02, 0.0]);
    assert!(end[1].abs() + end[3].abs() < 1e-14, "{end:?}");
}

#[test]
fn a_belt_whose_speed_changes() {
    let laws = "system belt\nstate x : order 2\ninput v\nddx ~ <x, sign(dx - v)>\n";
    let belt = Interval::new(laws, &[-3.0, -1.0], &[[0.02, 0.06]]);
    for speed in [0.02, 0.1, -0.05] {
        let end = belt.check(&[0.1, speed]);
        if speed == 0.02 {
            assert!((end[1] - 0.06).abs() < 1e-12, "{end:?}");
        }
    }
}

#[test]
fn laws_that_bend() {
    // Free for 0.02 s, then 0.08 s in a spring: 0.05 sin and 0.5 cos of 10 τ.
    let laws = "system play\nstate x : order 2\nddx ~ <max(x - 0.3, 0)>\n";
    let end = Interval::new(laws, &[-100.0], &[]).check(&[0.29, 0.5]);
    let (sin, cos) = 0.8_f64.sin_cos();
    assert!((end[0] - 0.3 - 0.05 * sin).abs() < 1e-10, "{end:?}");
    assert!((end[1] - 0.5 * cos).abs() < 1e-10, "{end:?}");
}

/// A law that no step is short enough for ends all the same, with what one in any direction can do in 0.1 s.
#[test]
fn laws_too_fast_to_follow_end() {
    let laws = "system fast\nstate x : order 2\nddx ~ <max(x - 0.3, 0), sin(1e25*x)>\n";
    let a = [1.0, -100.0]; // sin sorts before max
    let end = Interval::new(laws, &a, &[]).flow(&a, &[0.29, 0.5]).end;
    let known = 0.3 + 0.05 * 0.8_f64.sin();
    assert!((end[0] - known).abs() < 0.5 * 0.1 * 0.1, "{end:?}");
}

/// Intervals side by side give what each gives alone, whether all contacts hold, one is let go, or none is.
#[test]
fn what_slides_together_goes_as_alone() {
    let body = "system body\nstate x : order 2\ninput v\nddx ~ <x, x^3, sign(dx - v)>\n";
    let two = "system two\nstate x : order 2\nstate q : order 2\ninput v\n\
        ddx ~ <x, sign(dx - v), ddq*cos(q)>\nddq ~ <sin(q), sign(dq - dx), ddx*cos(q)>\n";
    let belt: Vec<f64> = (0..13).map(|k| 0.1 + 0.02 * f64::from(k % 3)).collect();
    for (laws, coefficients) in [
        (body, &[-30.0, 4.0, -1.0][..]),
        (two, &[-9.0, -0.7, -0.2, -4.0, -0.5, -0.4]),
    ] {
        let system = system(laws);
        let n = system.states.len();
        let record = Record {
            time: (0..belt.len()).map(|k| 0.02 * k as f64).collect(),
            measured: vec![vec![f64::NAN; belt.len()]; n],
            exogenous: vec![Exogenous {
                values: belt.clone(),
                between: Between::Linear,
            }],
            ..Record::default()
        };
        // Ever further out, on the belt but for every fifth sample.
        let state = |k: usize| {
            let slip = if k % 5 == 4 { 0.05 } else { 0.0 };
            let speed = belt[k] + slip;
            [0.004 * k as f64, speed, 0.1, speed][..n].to_vec()
        };
        let states: Vec<f64> = (0..belt.len()).flat_map(state).collect();
        let active: Vec<usize> = (0..coefficients.len()).collect();
        let integrator = ShootingIntegrator {
            laws: &CompiledLaws::new(&system, &active),
            all: None,
            coefficients,
            spread: &vec![1.0; n],
            accuracy: 1e-11,
        };
        let block = |intervals| {
            let (mut work, mut out) = (Workspace::default(), IntervalBlock::default());
            let done = integrator.block(&record, &states, intervals, &mut work, &mut out);
            done.unwrap();
            out
        };
        let together = block(0..belt.len() - 1);
        let mut alone = IntervalBlock::default();
        (0..belt.len() - 1).for_each(|k| alone.append(&block(k..k + 1)));
        for (a, b) in [
            (&together.end, &alone.end),
            (&together.transition, &alone.transition),
            (&together.columns, &alone.columns),
        ] {
            assert_eq!(a.len(), b.len());
            let all = a.iter().zip(b).enumerate();
            all.for_each(|(i, (a, b))| assert!(close(*a, *b, 1e-11), "{i}: {a} for {b}"));
        }
    }
}
