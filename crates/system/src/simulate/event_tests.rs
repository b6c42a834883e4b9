//! Runs of laws that switch against closed forms, phase by phase: what is between two events is solved by hand, the events by bisection.

mod contacts;
mod jumps;

use super::compiled::compiled_system::CompiledSystem;
use super::forced_right_side::Guard;
use super::inputs::interpolation::{InputSource, SampledInput};
use super::integrate::continuous_time::{LegSetup, integrate};
use super::run::Method;
use crate::discovery::{Form, Rate};
use sidc_lang::model::Between;
use sidc_lang::term::{Expr, Func, Signal, VarId};
use sidc_progress::Unwatched;

const INPUT: Signal = Signal::new(VarId(90));

fn call(name: &str, args: impl Into<Vec<Expr>>) -> Expr {
    Expr::call(Func::named(name).unwrap(), args.into())
}

fn position(body: usize) -> Expr {
    Expr::signal(Signal::new(VarId(1 + body as u16)))
}

fn velocity(body: usize) -> Expr {
    Expr::signal(Signal::derivative(VarId(1 + body as u16), 1))
}

fn number(value: f64) -> Expr {
    Expr::number(value)
}

/// Bodies with these accelerations.
fn bodies(accelerations: &[Expr]) -> CompiledSystem {
    let mut form = Form {
        linear: true,
        inputs: vec![INPUT],
        ..Form::default()
    };
    for i in 0..accelerations.len() {
        let var = VarId(1 + i as u16);
        form.state
            .extend([Signal::new(var), Signal::derivative(var, 1)]);
        form.unknowns.push(Signal::derivative(var, 2));
        form.rates
            .extend([Rate::State(2 * i + 1), Rate::Unknown(i)]);
    }
    form.rows = (accelerations.iter().zip(&form.unknowns))
        .map(|(right, target)| form.row(right.clone(), *target))
        .collect();
    CompiledSystem::new(form).unwrap()
}

/// One state of first order.
fn first_order(rate: Expr) -> CompiledSystem {
    let mut form = Form {
        linear: true,
        state: vec![Signal::new(VarId(1))],
        unknowns: vec![Signal::derivative(VarId(1), 1)],
        rates: vec![Rate::Unknown(0)],
        ..Form::default()
    };
    form.rows = vec![form.row(rate, form.unknowns[0])];
    CompiledSystem::new(form).unwrap()
}

/// States at the instants, and evaluations. The input is held from instant to instant.
fn run(
    system: &CompiledSystem,
    time: &[f64],
    input: &[f64],
    start: &[f64],
    how: How,
) -> (Vec<Vec<f64>>, u64) {
    let sampled = SampledInput::new(time, input, Between::Hold, 0.0);
    let drives: Vec<InputSource> = match system.form.inputs.is_empty() {
        true => Vec::new(),
        false => vec![InputSource::SampledInput(sampled.unwrap())],
    };
    let n = start.len();
    let mut observer = Unwatched;
    let names = system.form.state.clone();
    let mut guard = Guard::new(vec![1.0; n], vec![1e6; n], names, 5_000_000, &mut observer);
    let guess = vec![0.0; system.form.rows.len()];
    let leg = LegSetup {
        system,
        drives: &drives,
        time,
        sampled: time,
        params: &[],
        guess: &guess,
        method: match how {
            How::Stiff => Method::Stiff,
            _ => Method::Explicit,
        },
        step: match how {
            How::Fixed(h) => Some(h),
            _ => None,
        },
    };
    let path = integrate(&leg, start, &mut guard);
    assert!(path.fault.is_none(), "{:?}", path.fault);
    let rows = (0..path.rows.len()).map(|k| path.rows.row(k).unwrap()[..n].to_vec());
    (rows.collect(), path.evaluations)
}

#[derive(Clone, Copy, Debug)]
enum How {
    Explicit,
    Stiff,
    Fixed(f64),
}

const ALL: [(How, f64); 3] = [
    (How::Explicit, 1e-10),
    (How::Stiff, 1e-8),
    (How::Fixed(1e-4), 1e-8),
];

fn instants(count: usize, step: f64) -> Vec<f64> {
    (0..count).map(|k| k as f64 * step).collect()
}

/// Every row within the tolerance of what is known.
fn agree(
    name: &str,
    system: &CompiledSystem,
    time: &[f64],
    input: &[f64],
    start: &[f64],
    known: &dyn Fn(f64) -> Vec<f64>,
) {
    for (how, tolerance) in ALL {
        let (rows, calls) = run(system, time, input, start, how);
        assert_eq!(rows.len(), time.len(), "{name} {how:?}");
        for (t, row) in time.iter().zip(&rows) {
            for (x, truth) in row.iter().zip(known(*t)) {
                let off = (x - truth).abs();
                assert!(off <= tolerance, "{name} {how:?} at {t}: {x} {truth}");
            }
        }
        if !matches!(how, How::Fixed(_)) {
            assert!(calls < 2_000 * time.len() as u64, "{name} {how:?}: {calls}");
        }
    }
}

fn bisected(f: &dyn Fn(f64) -> f64, mut a: f64, mut b: f64) -> f64 {
    let sign = f(a) > 0.0;
    for _ in 0..200 {
        let m = 0.5 * (a + b);
        if (f(m) > 0.0) == sign {
            a = m;
        } else {
            b = m;
        }
    }
    0.5 * (a + b)
}

/// ẍ = −x − μ sign ẋ: half cosines about ±μ, until |x| ≤ μ where it stops.
#[test]
fn an_oscillator_with_dry_friction_stops() {
    let mu = 0.4;
    let friction = call("sign", [velocity(0)]).scale(-mu);
    let system = bodies(&[position(0).scale(-1.0) + friction]);
    let known = |t: f64| {
        let (mut x, mut begun) = (5.3f64, 0.0);
        while x.abs() > mu {
            let centre = mu * x.signum();
            if t < begun + std::f64::consts::PI {
                let phase = t - begun;
                return vec![
                    centre + (x - centre) * phase.cos(),
                    -(x - centre) * phase.sin(),
                ];
            }
            x = 2.0 * centre - x;
            begun += std::f64::consts::PI;
        }
        vec![x, 0.0]
    };
    let time = instants(90, 0.37);
    agree(
        "oscillator",
        &system,
        &time,
        &vec![0.0; 90],
        &[5.3, 0.0],
        &known,
    );
}

/// ẍ = −x − F sign(ẋ − V) + s (ẋ − V): sticks to the belt until the spring holds F, then slides along a growing oscillation.
#[test]
fn a_mass_on_a_belt_sticks_and_slips() {
    let (force, rise, belt) = (1.0, 0.15, 0.3);
    let slip = velocity(0) - number(belt);
    let friction = call("sign", [slip.clone()]).scale(-force) + slip.scale(rise);
    let system = bodies(&[position(0).scale(-1.0) + friction]);
    // Sliding behind the belt: ẍ = −x + s ẋ + F − s V.
    let centre = force - rise * belt;
    let rate = (1.0f64 - 0.25 * rise * rise).sqrt();
    let sliding = move |x0: f64, v0: f64, t: f64| {
        let a = x0 - centre;
        let b = (v0 - 0.5 * rise * a) / rate;
        let (sin, cos, grow) = ((rate * t).sin(), (rate * t).cos(), (0.5 * rise * t).exp());
        let x = centre + grow * (a * cos + b * sin);
        let v = grow * (0.5 * rise * (a * cos + b * sin) + rate * (b * cos - a * sin));
        (x, v)
    };
    let known = |t: f64| {
        let (mut x, mut begun) = (0.0, 0.0);
        loop {
            // It sticks from x until the spring holds F.
            let lets_go = begun + (force - x) / belt;
            if t <= lets_go {
                return vec![x + belt * (t - begun), belt];
            }
            let caught = |d: f64| sliding(force, belt, d).1 - belt;
            let slides = bisected(&caught, 2.0, 6.6);
            if t <= lets_go + slides {
                let (x, v) = sliding(force, belt, t - lets_go);
                return vec![x, v];
            }
            x = sliding(force, belt, slides).0;
            begun = lets_go + slides;
        }
    };
    let time = instants(120, 0.31);
    agree(
        "belt",
        &system,
        &time,
        &vec![0.0; 120],
        &[0.0, belt],
        &known,
    );
}

/// A block under a force in steps: rests while it is below the friction, slides evenly accelerated, comes to rest again.
#[test]
fn a_block_rests_until_the_force_exceeds_its_friction() {
    let system = bodies(&[Expr::signal(INPUT) + call("sign", [velocity(0)]).scale(-1.0)]);
    let forces = [0.9, 1.5, 0.2, 0.2, -0.99, -1.25, 0.0, 0.0, 1.0, 0.3];
    let known = |t: f64| {
        let (mut x, mut v) = (0.0, 0.0f64);
        for (k, u) in forces.iter().enumerate() {
            let mut left = (t - k as f64).clamp(0.0, 1.0);
            if k + 1 == forces.len() {
                left = (t - k as f64).max(0.0);
            }
            if v != 0.0 {
                let a = u - v.signum();
                let stops = if a * v < 0.0 { -v / a } else { f64::INFINITY };
                let d = stops.min(left);
                x += v * d + 0.5 * a * d * d;
                v = if d == stops { 0.0 } else { v + a * d };
                left -= d;
            }
            if v == 0.0 && u.abs() > 1.0 && left > 0.0 {
                let a = u - u.signum();
                x += 0.5 * a * left * left;
                v = a * left;
            }
        }
        vec![x, v]
    };
    let time = instants(10, 1.0);
    agree("block", &system, &time, &forces, &[0.0, 0.0], &known);
}

/// ẏ̇ = −g − step(−y)(k y + c ẏ): parabolas, and damped sines while the ball touches the floor.
#[test]
fn a_ball_bounces_on_a_springy_floor() {
    let (g, k, c) = (9.81, 4000.0f64, 6.0);
    let floor = call("step", [position(0).scale(-1.0)]);
    let force = position(0).scale(k) + velocity(0).scale(c);
    let system = bodies(&[number(-g) + (floor * force).scale(-1.0)]);
    let rate = (k - 0.25 * c * c).sqrt();
    let pressed = move |v0: f64, t: f64| {
        let (sin, cos, fall) = ((rate * t).sin(), (rate * t).cos(), (-0.5 * c * t).exp());
        let (a, centre) = (g / k, -g / k);
        let b = (v0 + 0.5 * c * a) / rate;
        let y = centre + fall * (a * cos + b * sin);
        let v = fall * (-0.5 * c * (a * cos + b * sin) + rate * (b * cos - a * sin));
        (y, v)
    };
    let known = |t: f64| {
        let (mut y, mut v, mut begun) = (1.0f64, 0.0f64, 0.0);
        loop {
            let falls = (v + (v * v + 2.0 * g * y).sqrt()) / g;
            if t <= begun + falls {
                let d = t - begun;
                return vec![y + v * d - 0.5 * g * d * d, v - g * d];
            }
            begun += falls;
            let hits = v - g * falls;
            let half = std::f64::consts::PI / rate;
            let leaves = bisected(&|d| pressed(hits, d).0, 0.5 * half, 1.5 * half);
            if t <= begun + leaves {
                let (y, v) = pressed(hits, t - begun);
                return vec![y, v];
            }
            begun += leaves;
            (y, v) = (0.0, pressed(hits, leaves).1);
        }
    };
    // Each contact takes a twentieth of a second, less than from row to row.
    let time = instants(40, 0.11);
    agree("ball", &system, &time, &vec![0.0; 40], &[1.0, 0.0], &known);
}

/// ẋ = −x/2 + 2 step(1 − x) rises to the threshold and slides along it; a dead zone has two bends.
#[test]
fn a_relay_slides_and_a_dead_zone_bends() {
    let x = || Expr::signal(Signal::new(VarId(1)));
    let relay = call("step", [number(1.0) - x()]).scale(2.0);
    let system = first_order(x().scale(-0.5) + relay);
    let known = |t: f64| vec![(4.0 - 3.8 * (-0.5 * t).exp()).min(1.0)];
    agree("relay", &system, &instants(40, 0.05), &[], &[0.2], &known);
    // ẋ = −max(x − 1, 0) − 1: exponential down to 1, then straight.
    let zone = call("max", [x() - number(1.0), number(0.0)]);
    let system = first_order(zone.scale(-1.0) - number(1.0));
    let known = |t: f64| {
        let down = 3.0f64.ln();
        vec![if t < down {
            3.0 * (-t).exp()
        } else {
            1.0 - (t - down)
        }]
    };
    agree(
        "dead zone",
        &system,
        &instants(40, 0.07),
        &[],
        &[3.0],
        &known,
    );
}

/// An event may be within rounding of a row, from either side.
#[test]
fn events_fall_on_rows() {
    let beyond = call("max", [position(0) - number(0.5), number(0.0)]);
    let system = bodies(&[beyond.scale(-64.0)]);
    for first in 20..50 {
        let time: Vec<f64> = (first..68).map(|k| 0.02 * f64::from(k)).collect();
        for off in -8..=8 {
            let start = [time[0] - 0.5 + f64::from(off) * f64::EPSILON / 8.0, 1.0];
            let (rows, _) = run(
                &system,
                &time,
                &vec![0.0; time.len()],
                &start,
                How::Explicit,
            );
            for (t, row) in time.iter().zip(&rows) {
                let past = t - 1.0;
                let known = 0.5
                    + if past < 0.0 {
                        past
                    } else {
                        (8.0 * past).sin() / 8.0
                    };
                assert!((row[0] - known).abs() < 1e-10, "{first} {off} at {t}");
            }
        }
    }
}

/// Three bodies in a chain, each on dry ground, their accelerations coupled by a mass matrix: at rest the friction forces balance the rest
/// within their bounds, two integrators agree, and nothing moves in the end.
#[test]
fn coupled_contacts_stick_one_by_one() {
    let rate = |i: usize| Expr::signal(Signal::derivative(VarId(1 + i as u16), 2));
    let spring = |i: usize, j: usize| (position(j) - position(i)).scale(3.0);
    let dry = |i: usize, mu: f64| call("sign", [velocity(i)]).scale(-mu);
    // A lever between two bodies couples their inertia.
    let laws = [
        spring(0, 1) - position(0) + dry(0, 0.5) + rate(1).scale(0.2),
        spring(1, 0) + spring(1, 2) + dry(1, 0.3) + rate(0).scale(0.2),
        spring(2, 1) + dry(2, 0.4) + call("sign", [velocity(2) - velocity(1)]).scale(-0.1),
    ];
    let system = bodies(&laws);
    let start = [2.0, 0.0, -1.0, 0.5, 1.5, 0.0];
    let time = instants(240, 0.25);
    let zeros = vec![0.0; 240];
    let (explicit, _) = run(&system, &time, &zeros, &start, How::Explicit);
    let (stiff, _) = run(&system, &time, &zeros, &start, How::Stiff);
    for (a, b) in explicit.iter().zip(&stiff) {
        for (x, y) in a.iter().zip(b) {
            assert!((x - y).abs() < 1e-7, "{a:?} {b:?}");
        }
    }
    let last = explicit.last().unwrap();
    assert!([1, 3, 5].iter().all(|i| last[*i].abs() < 1e-12), "{last:?}");
    // Not all came to rest at once.
    let rests = |i: usize| explicit.iter().position(|row| row[i].abs() < 1e-12);
    assert!(rests(1) != rests(3) || rests(3) != rests(5));
}
