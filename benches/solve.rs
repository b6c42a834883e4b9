//! Time of the solvers against rows M and columns N, on the pendulum on a cart without noise.
//!
//! One interior-point iteration costs about M²N operations for the normal matrix (its lower triangle), M³/3 for its factor and some twelve passes over the M × N matrix; 10 to 16 iterations hardly depend on
//! either. So time grows with M² for libraries wider than the data and linearly in N. Clarabel factorises a sparse system
//! with M rows full of N entries: also about M²N an iteration, with a factor in front several times larger.
//!
//! The default solver is timed on all sizes, the others on the small ones. Peers are in `peers.py`.

use std::hint::black_box;
use std::ops::ControlFlow;
use std::time::Duration;

use criterion::{BenchmarkId, Criterion, SamplingMode, criterion_group, criterion_main};
use sidc::solve::{Problem, SOLVERS};

#[path = "../tests/it/pendulum.rs"]
#[allow(dead_code)]
mod pendulum;

use pendulum::{Regression, Target, draw, regression};

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

/// The first so many solvers on one regression, ten runs each.
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
            b.iter(|| black_box(solver.solve(&problem, &mut |_| ControlFlow::Continue(()))))
        });
        group.finish();
    }
}

criterion_group!(benches, solve);
criterion_main!(benches);
