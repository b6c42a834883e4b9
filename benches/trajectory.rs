//! The joint estimate of trajectory and laws: a whole search, against the numbers of samples and of candidate terms.
//!
//! Lorenz with 1 % noise, three laws: `poly(x, y, z; 2)` has 30 columns, `poly(x, y, z; 5)` has 168. An element is one sample. Records of more than 10,000
//! samples are first searched in segments, so the time per sample falls there towards that of the last fits.

use std::hint::black_box;
use std::time::Duration;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use sidc::pipeline;
use sidc_data as data;
use sidc_data::Limits;
use sidc_discover::trajectory;
use sidc_lang::source::Sources;
use sidc_progress::Unwatched;

const STEP: f64 = 0.01;
const NOISE: f64 = 0.08;

/// Readings of x, y and z as CSV; the noise is a sum of uniform numbers from a fixed seed.
fn readings(samples: usize) -> String {
    let mut seed = 1u64;
    let mut uniform = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (seed >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    };
    let flow = |s: [f64; 3]| {
        let [x, y, z] = s;
        [10.0 * (y - x), x * (28.0 - z) - y, x * y - 8.0 / 3.0 * z]
    };
    let after = |s: [f64; 3], rate: [f64; 3], h: f64| [0, 1, 2].map(|i| s[i] + h * rate[i]);
    let mut state = [1.0, 1.0, 20.0];
    let mut text = String::from("t,x,y,z\n");
    for k in 0..samples {
        let [x, y, z] = state.map(|x| x + NOISE * (0..12).map(|_| uniform()).sum::<f64>());
        text += &format!("{},{x},{y},{z}\n", k as f64 * STEP);
        let k1 = flow(state);
        let k2 = flow(after(state, k1, STEP / 2.0));
        let k3 = flow(after(state, k2, STEP / 2.0));
        let k4 = flow(after(state, k3, STEP));
        let mean = [0, 1, 2].map(|i| (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]) / 6.0);
        state = after(state, mean, STEP);
    }
    text
}

fn problem(degree: usize, samples: usize) -> Option<trajectory::Problem> {
    let model = format!("system lorenz\nstate x, y, z\ndx, dy, dz ~ poly(x, y, z; {degree})\n");
    let mut sources = Sources::default();
    let file = sources.add("lorenz.sid", model);
    let program = pipeline::compile(file, &sources, pipeline::MEMORY).0?;
    let text = readings(samples);
    let table = data::read(
        "lorenz.csv",
        text.as_bytes(),
        &Limits::default(),
        &mut sources,
    )
    .ok()?;
    let (dataset, _) = data::bind(&program.model, &[table], &[], &mut sources);
    let pools = vec![None; program.libraries.len()];
    let system = trajectory::System::new(&program.model, &program.libraries, &pools).ok()?;
    trajectory::Problem::new(system, &dataset, &|_| None, false).ok()
}

fn searches(c: &mut Criterion) {
    let mut group = c.benchmark_group("search");
    group
        .sample_size(10)
        .warm_up_time(Duration::from_millis(1))
        .measurement_time(Duration::from_secs(5));
    for (degree, samples) in [(2, 2_000), (2, 8_000), (2, 32_000), (5, 2_000)] {
        let Some(problem) = problem(degree, samples) else {
            continue;
        };
        let terms = problem.system.columns.len();
        group.throughput(Throughput::Elements(samples as u64));
        let name = BenchmarkId::from_parameter(format!("{samples}x{terms}"));
        group.bench_function(name, |b| {
            b.iter(|| trajectory::search(black_box(&problem), &[], &mut Unwatched));
        });
    }
    group.finish();
}

criterion_group!(benches, searches);
criterion_main!(benches);
