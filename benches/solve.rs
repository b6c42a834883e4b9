//! Time of the solvers against rows M and columns N, on the pendulum on a cart without noise.
//!
//! The homotopy prices all columns once per round, with 2MN operations, and takes steps in between, with 4Mw operations each on a working set of w columns.
//! Rounds and steps depend on the terms of the answer and hardly on M and N. Clarabel factorises a sparse system with M dense rows: about M²|W| operations
//! per iteration with a large constant factor, where W has all N columns, or the working set if Φ is not stored. It needs 10 to 20 iterations regardless of M
//! and N.
//!
//! The default solver is timed on all sizes, the others on the small ones. `peers.py` times other packages.

use std::hint::black_box;
use std::time::Duration;

use criterion::{BenchmarkId, Criterion, SamplingMode, criterion_group, criterion_main};
use sidc_progress::Unwatched;
use sidc_solve::{Problem, SOLVERS};

use sidc_testing::pendulum_regression::{Regression, Target, draw, regression};

const NARROW: [usize; 8] = [2, 2, 2, 6, 2, 2, 2, 2];
const WIDE: [usize; 8] = [3; 8];
const SMALL: [(usize, [usize; 8]); 4] = [(50, NARROW), (100, NARROW), (375, NARROW), (100, WIDE)];
const LARGE: [(usize, [usize; 8]); 2] = [(375, WIDE), (1000, WIDE)];

fn solve(c: &mut Criterion) {
    for (rows, caps) in SMALL {
        time(c, SOLVERS.len(), rows, caps);
    }
    for (rows, caps) in LARGE {
        time(c, 1, rows, caps);
    }
}

/// Times the first `solvers` solvers on one regression, ten runs each.
fn time(c: &mut Criterion, solvers: usize, rows: usize, caps: [usize; 8]) {
    let Regression {
        dictionary, target, ..
    } = regression(&draw(rows, 3), Target::Cart, caps);
    let problem = Problem {
        dictionary: &dictionary,
        target: &target,
        tolerance: 0.0,
    };
    let size = format!("{rows}x{}", caps.iter().product::<usize>());
    for solver in SOLVERS.iter().take(solvers) {
        let mut group = c.benchmark_group(solver.name());
        group
            .sample_size(10)
            .sampling_mode(SamplingMode::Flat)
            .warm_up_time(Duration::from_millis(100))
            .measurement_time(Duration::from_secs(2));
        group.bench_function(BenchmarkId::from_parameter(&size), |b| {
            b.iter(|| black_box(solver.solve(&problem, &mut Unwatched)))
        });
        group.finish();
    }
}

criterion_group!(benches, solve);
criterion_main!(benches);
