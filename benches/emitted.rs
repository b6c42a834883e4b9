//! One evaluation of the right-hand side of the coupled pendulum by emitted Rust and C, with their Jacobians.
//!
//! `emitted/pendulum.rs` is the output of `sidc export emitted/pendulum.json --to rust` (a test compares them); the C is emitted here and compiled with `cc
//! -O2`. Prints the time of one call when every call waits for the one before, as in an integration; then Criterion's lines for Rust, where calls overlap.

use std::error::Error;
use std::fs;
use std::hint::black_box;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

use criterion::{Criterion, criterion_group, criterion_main};
use sidc_emit as emit;
use sidc_system::discovery::{Discovery, Form};
use sidc_system::result;

#[allow(dead_code)]
mod pendulum {
    include!("emitted/pendulum.rs");
}

const CALLS: usize = 200_000;
const RUNS: usize = 30;
const STATE: [f64; 4] = [0.1, 0.2, 0.3, 0.4];
const INPUT: [f64; 1] = [0.5];

fn discovery() -> Result<Discovery, Box<dyn Error>> {
    let read = result::read("pendulum.json", include_str!("emitted/pendulum.json"));
    read.map_err(|d| d.message.into())
}

/// Nanoseconds per call, in the fastest of some runs of many calls.
fn fastest(calls: usize, mut call: impl FnMut()) -> f64 {
    let time = |_| {
        let start = Instant::now();
        (0..calls).for_each(|_| call());
        start.elapsed().as_secs_f64() * 1e9 / calls as f64
    };
    (0..RUNS).map(time).fold(f64::INFINITY, f64::min)
}

/// Calls from another file, so that nothing is inlined. The state is changed by the result of the last call.
const LOOP: &str = r#"
#include <stdio.h>
#include <time.h>
void pendulum_on_cart_derivatives(double t, const double *state, const double *input, double *rate);
void pendulum_on_cart_jacobian(double t, const double *state, const double *input, double *slope);
static double now(void) { struct timespec s; clock_gettime(CLOCK_MONOTONIC, &s); return 1e9 * s.tv_sec + s.tv_nsec; }
typedef void function(double, const double *, const double *, double *);
static double fastest(function *f, int which, double *sum) {
    double best = 1e300, out[16];
    for (int run = 0; run < RUNS; run++) {
        double state[4] = {0.1, 0.2, 0.3, 0.4}, input[1] = {0.5};
        const double start = now();
        for (int i = 0; i < CALLS; i++) { f(0.0, state, input, out); state[2] += 1e-9 * out[which]; }
        const double time = (now() - start) / CALLS;
        if (time < best) best = time;
        *sum += state[2];
    }
    return best;
}
int main(void) {
    double sum = 0.0;
    const double rate = fastest(pendulum_on_cart_derivatives, 1, &sum), slope = fastest(pendulum_on_cart_jacobian, 5, &sum);
    printf("%.1f ns, Jacobian %.1f ns\n", rate, slope);
    return sum == 0.0;
}
"#;

fn c(d: &Discovery) -> Result<String, Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let file = |name: &str| folder.path().join(name);
    let code = emit::target("c")
        .ok_or("no target c")?
        .emit(d)?
        .into_bytes();
    fs::write(file("pendulum.c"), code)?;
    fs::write(file("main.c"), LOOP)?;
    let calls = format!("-DCALLS={CALLS}");
    let runs = format!("-DRUNS={RUNS}");
    let args = [
        "-O2",
        &calls,
        &runs,
        "pendulum.c",
        "main.c",
        "-o",
        "timed",
        "-lm",
    ];
    let built = Command::new("cc")
        .args(args)
        .current_dir(folder.path())
        .output()?;
    if !built.status.success() {
        return Err(String::from_utf8_lossy(&built.stderr).into());
    }
    let timed = Command::new(Path::new(&file("timed"))).output()?;
    Ok(String::from_utf8(timed.stdout)?.trim().to_string())
}

fn emitted(criterion: &mut Criterion) {
    let rates = || pendulum::derivatives(0.0, black_box(&STATE), black_box(&INPUT));
    let slopes = || pendulum::jacobian(0.0, black_box(&STATE), black_box(&INPUT));
    let mut state = STATE;
    let rate = fastest(CALLS, || {
        state[2] += 1e-9 * pendulum::derivatives(0.0, black_box(&state), &INPUT)[1];
    });
    let mut state = STATE;
    let slope = fastest(CALLS, || {
        state[2] += 1e-9 * pendulum::jacobian(0.0, black_box(&state), &INPUT)[1][1];
    });
    println!("Rust: {rate:.1} ns, Jacobian {slope:.1} ns");
    match discovery().map(|d| (c(&d), d)) {
        Ok((timed, d)) => {
            println!("C: {}", timed.unwrap_or_else(|why| why.to_string()));
            let form = Form::new(&d);
            let own = fastest(CALLS / 100, || {
                black_box(form.rates_at(0.0, black_box(&STATE), &INPUT, &[], &[]));
            });
            println!("evaluator of sidc: {own:.0} ns");
        }
        Err(why) => println!("C: {why}"),
    }
    let mut group = criterion.benchmark_group("pendulum");
    group.bench_function("derivatives", |b| b.iter(rates));
    group.bench_function("jacobian", |b| b.iter(slopes));
    group.finish();
}

criterion_group!(benches, emitted);
criterion_main!(benches);
