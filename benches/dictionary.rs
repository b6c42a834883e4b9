//! Compares Φ with the limits of the machine: filling it with plain writing, pricing products with their multiplications.
//!
//! `fill` compares like with like: Φ and the plain buffers are fresh memory whose pages are first touched when written, so both include the time in which the
//! system provides pages. `touched` is memory written before. With `MALLOC_MMAP_THRESHOLD_=8589934592 MALLOC_TRIM_THRESHOLD_=8589934592` the allocator gives
//! Φ touched memory too.
//!
//! Pricing N columns on M rows takes M·N multiplications and additions. Criterion shows elements per second; flop/s are twice that.

use std::hint::black_box;
use std::thread;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use sidc_data::{Column, Origin, Samples};
use sidc_discover::dictionary::compile;
use sidc_lang::library::{Block, Library};
use sidc_lang::term::{Expr, Func, Signal, Term, VarId};

const ROWS: usize = 100_000;
const COLS: usize = 1000;

/// Signals of order one.
fn samples(rows: usize, signals: u16) -> Samples {
    let mut random = sidc_testing::pendulum_regression::Random::new(7);
    let column = |i| Column {
        signal: Signal::new(VarId(i)),
        values: (0..rows).map(|_| 2.0 * random.uniform() - 1.0).collect(),
        origin: Origin::Measured { noise: None },
    };
    Samples {
        trajectory: vec![0; rows],
        time: (0..rows).map(|i| i as f64).collect(),
        columns: (1..=signals).map(column).collect(),
    }
}

fn signal(i: u16) -> Expr {
    Expr::signal(Signal::new(VarId(i)))
}

/// All products of the powers 0, 1, 2 of some atoms.
fn powers(atoms: &[Expr]) -> Vec<Term> {
    atoms.iter().fold(vec![Term::one()], |terms, atom| {
        let raise = |t: &Term| [0.0, 1.0, 2.0].map(|p| t.mul(&atom.clone().pow(p).into_term().1));
        terms.iter().flat_map(raise).collect()
    })
}

/// Signals with a sine and a cosine among them.
fn atoms() -> Vec<Expr> {
    let call = |name| Func::named(name).map(|f| Expr::call(f, vec![signal(1)]));
    let mut atoms: Vec<Expr> = (2..=5).map(signal).collect();
    atoms.extend(["sin", "cos"].into_iter().filter_map(call));
    atoms.extend((6..=9).map(signal));
    atoms
}

/// Writes one number to every place, on all cores.
fn write(buffer: &mut [f64], value: f64) {
    let cores = thread::available_parallelism().map_or(1, usize::from);
    let share = buffer.len().div_ceil(cores);
    thread::scope(|scope| {
        for part in buffer.chunks_mut(share) {
            scope.spawn(move || part.fill(black_box(value)));
        }
    });
}

fn fill(c: &mut Criterion) {
    let mut group = c.benchmark_group("fill");
    group.sample_size(10);
    group.throughput(Throughput::Bytes(8 * (ROWS * COLS) as u64));
    group.bench_function("plain, fresh", |b| {
        b.iter(|| {
            let mut buffer = vec![0.0; ROWS * COLS];
            write(&mut buffer, 1.5);
            black_box(buffer);
        });
    });
    let mut buffer = vec![1.0; ROWS * COLS];
    group.bench_function("plain, touched", |b| {
        b.iter(|| write(black_box(&mut buffer), 1.5));
    });
    drop(buffer);
    let (samples, weights) = (samples(ROWS, 9), vec![0.5; ROWS]);
    let mut terms = powers(&atoms()[..7]);
    terms.truncate(COLS);
    let library = Library::listed(terms);
    group.bench_function("dictionary", |b| {
        b.iter(|| compile(&library, &samples, Some(&weights)).map(|phi| black_box(phi.cols())));
    });
    group.finish();
}

/// 3^n terms as products of two halves.
fn products(n: usize) -> Library {
    let signals: Vec<Expr> = (1..=n as u16).map(signal).collect();
    let (left, right) = signals.split_at(n / 2);
    let (left, right) = (powers(left), powers(right));
    Library::products(vec![Block { left, right }], Vec::new())
}

fn price(c: &mut Criterion) {
    for (n, rows) in [
        (8, 200),
        (10, 200),
        (12, 200),
        (13, 200),
        (14, 300),
        (15, 300),
    ] {
        let (library, samples) = (products(n), samples(rows, n as u16));
        let Ok(phi) = compile(&library, &samples, None) else {
            continue;
        };
        let lambda: Vec<f64> = (0..rows).map(|i| (i as f64).sin()).collect();
        let name = |what| BenchmarkId::new(what, format!("{rows}x{}", phi.cols()));
        let mut group = c.benchmark_group("products");
        group.sample_size(10);
        group.throughput(Throughput::Elements((rows * phi.cols()) as u64));
        group.bench_function(name("price"), |b| {
            b.iter(|| black_box(phi.price(&lambda, 100, 1.0)));
        });
        group.bench_function(name("compile"), |b| {
            b.iter(|| compile(&library, &samples, None).map(|phi| black_box(phi.cols())));
        });
        group.finish();
    }
}

criterion_group!(benches, fill, price);
criterion_main!(benches);
