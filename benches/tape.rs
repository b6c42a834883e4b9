//! The tape compared with `Expr::eval`: every monomial of three signals up to degree 3 and its gradient, at 2,000 points.
//!
//! Prints the time per value for both and their ratio, then Criterion's lines; an element is one output at one point.

use std::hint::black_box;
use std::time::Instant;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use sidc_lang::term::{Expr, Func, Signal, Tape, VarId};

const POINTS: usize = 2000;
const INPUTS: [Signal; 3] = [
    Signal::new(VarId(0)),
    Signal::new(VarId(1)),
    Signal::new(VarId(2)),
];

/// The 20 monomials of `poly(x0, x1, x2; 3)` and their 60 derivatives.
fn library() -> Vec<Expr> {
    let mut all = vec![Expr::number(1.0)];
    for s in INPUTS {
        let powers = |e: &Expr| [0.0, 1.0, 2.0, 3.0].map(|p| e.clone() * Expr::signal(s).pow(p));
        all = all.iter().flat_map(powers).collect();
    }
    all.retain(|e| e.terms().all(|(_, t)| t.degree() <= 3.0));
    with_gradients(all)
}

/// Three equations with every monomial, and their 9 derivatives.
fn dense() -> Vec<Expr> {
    let all = library();
    let equation = |k: usize| {
        let weighted = all[..20].iter().enumerate();
        weighted
            .map(|(i, e)| e.clone().scale(((7 * i + k) as f64).sin()))
            .sum()
    };
    with_gradients((0..3).map(equation).collect())
}

/// Two equations of a pendulum on a cart, with sines and a quotient.
fn pendulum() -> Vec<Expr> {
    let [x, y, z] = INPUTS.map(Expr::signal);
    let call =
        |name: &str| Func::named(name).map_or_else(Expr::zero, |f| Expr::call(f, vec![x.clone()]));
    let (sin, cos) = (call("sin"), call("cos"));
    let inertia = Expr::number(3.0) - cos.clone().pow(2.0);
    let force = z.scale(1.5) + sin.clone() * y.clone().pow(2.0) - sin.clone() * cos.clone();
    let turning = sin.scale(19.6) - y.pow(2.0) * cos;
    with_gradients(vec![force / inertia.clone(), turning / inertia])
}

fn with_gradients(mut all: Vec<Expr>) -> Vec<Expr> {
    let by = |s: Signal| all.iter().map(move |e| e.derivative(s)).collect::<Vec<_>>();
    let slopes = INPUTS.map(by).concat();
    all.extend(slopes);
    all
}

fn plain(all: &[Expr], inputs: &[f64], out: &mut [f64]) {
    for (e, row) in all.iter().zip(out.chunks_mut(POINTS)) {
        for (i, value) in row.iter_mut().enumerate() {
            *value = e.eval(&|s: Signal| inputs[usize::from(s.var.0) * POINTS + i]);
        }
    }
}

/// Nanoseconds of the fastest of some runs.
fn fastest(runs: usize, mut run: impl FnMut()) -> f64 {
    let time = |_| {
        let start = Instant::now();
        run();
        start.elapsed().as_secs_f64() * 1e9
    };
    (0..runs).map(time).fold(f64::INFINITY, f64::min)
}

fn tape(c: &mut Criterion) {
    let inputs: Vec<f64> = (0..3 * POINTS).map(|i| (i as f64 * 0.37).sin()).collect();
    let sets = [
        ("library", library()),
        ("dense", dense()),
        ("pendulum", pendulum()),
    ];
    for (name, all) in sets {
        let Ok(tape) = Tape::new(&all, &INPUTS) else {
            continue;
        };
        let (mut out, mut work) = (vec![0.0; all.len() * POINTS], Vec::new());
        let fast = fastest(50, || {
            tape.eval(black_box(&inputs), POINTS, &mut out, &mut work)
        });
        let slow = fastest(5, || plain(black_box(&all), &inputs, &mut out));
        let values = (all.len() * POINTS) as f64;
        println!(
            "{name}: {} outputs; tape {:.2} ns, eval {:.1} ns per output and point; ratio {:.0}",
            all.len(),
            fast / values,
            slow / values,
            slow / fast
        );
        let mut group = c.benchmark_group(name);
        group.sample_size(20);
        group.throughput(Throughput::Elements(values as u64));
        group.bench_function("tape", |b| {
            b.iter(|| tape.eval(black_box(&inputs), POINTS, &mut out, &mut work));
        });
        group.bench_function("eval", |b| {
            b.iter(|| plain(black_box(&all), &inputs, &mut out));
        });
        group.finish();
    }
}

criterion_group!(benches, tape);
criterion_main!(benches);
