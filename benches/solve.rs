//! Time of both solvers against rows M and columns N, on the pendulum on a cart without noise.
//!
//! One interior-point iteration costs about M²N operations for the normal matrix (its lower triangle), M³/3 for its factor and some twelve passes over the M × N matrix; 10 to 16 iterations hardly depend on
//! either. So time grows with M² for libraries wider than the data and linearly in N. Clarabel factorises a sparse system
//! with M rows full of N entries: also about M²N an iteration, with a factor in front several times larger.

use std::hint::black_box;
use std::ops::ControlFlow;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use sidc::solve::{Problem, SOLVERS};

#[path = "../tests/it/pendulum.rs"]
#[allow(dead_code)]
mod pendulum;

use pendulum::{Target, draw, regression};

const NARROW: [usize; 8] = [2, 2, 2, 6, 2, 2, 2, 2];
const WIDE: [usize; 8] = [3; 8];

fn solve(c: &mut Criterion) {
    for solver in SOLVERS {
        let mut group = c.benchmark_group(solver.name());
        group.sample_size(10);
        for (rows, caps) in [
            (50, NARROW),
            (100, NARROW),
            (375, NARROW),
            (50, WIDE),
            (100, WIDE),
            (375, WIDE),
        ] {
            let cols: usize = caps.iter().product();
            if solver.name() == "clarabel" && rows * cols > 1_000_000 {
                continue;
            }
            let r = regression(&draw(rows, 3), Target::Cart, caps);
            let problem = Problem {
                dictionary: &r.dictionary,
                target: &r.target,
                tolerance: 0.0,
            };
            group.bench_function(BenchmarkId::from_parameter(format!("{rows}x{cols}")), |b| {
                b.iter(|| black_box(solver.solve(&problem, &mut |_| ControlFlow::Continue(()))))
            });
        }
        group.finish();
    }
}

criterion_group!(benches, solve);
criterion_main!(benches);
