//! The cost of simulation: a million fixed steps, and ten seconds with error control.

#![allow(clippy::unwrap_used)]

use criterion::{Criterion, criterion_group, criterion_main};

use sidc_data as data;
use sidc_data::Limits;
use sidc_lang::source::Sources;
use sidc_progress::Unwatched;
use sidc_system::result;
use sidc_system::simulate;
use sidc_system::simulate::{Options, Run, Source};

/// The pendulum on a cart as `identify` writes it.
const RESULT: &str = r#"{"sidc_result": 1,
    "variables": [{"name": "y", "kind": "state", "order": 2}, {"name": "theta", "kind": "state", "order": 2},
        {"name": "F", "kind": "input", "order": 0}],
    "equations": [
        {"target": "ddy", "status": "pass", "terms": [{"term": "F", "coefficient": 1.2903225806451613},
            {"term": "dy", "coefficient": -0.06451612903225806}, {"term": "ddtheta*cos(theta)", "coefficient": -0.1774193548387097},
            {"term": "dtheta^2*sin(theta)", "coefficient": 0.1774193548387097}]},
        {"target": "ddtheta", "status": "pass", "terms": [{"term": "dtheta", "coefficient": -0.14545454545454545},
            {"term": "sin(theta)", "coefficient": -19.6}, {"term": "ddy*cos(theta)", "coefficient": -2.0}]}],
    "settings": {"reading": {"between": {"F": "hold"}}}}"#;

/// Ten seconds at 100 Hz under a force that jumps at every sample.
fn record() -> String {
    let mut text = String::from("t,y,dy,theta,dtheta,F\n");
    for k in 0..1001 {
        let force = 4.0 * f64::from(k % 7) / 3.0 - 4.0;
        text.push_str(&format!("{},0,0,1,0,{force}\n", 0.01 * f64::from(k)));
    }
    text
}

fn bench(c: &mut Criterion) {
    let opened = result::open("r.json", RESULT).unwrap();
    let mut sources = Sources::default();
    let table = data::read(
        "d.csv",
        record().as_bytes(),
        &Limits::default(),
        &mut sources,
    )
    .unwrap();
    let state = sidc_system::discovery::Form::new(&opened.discovery).state;
    let start: Vec<_> = state
        .iter()
        .map(|s| (*s, if s.var.0 == 2 && s.der == 0 { 1.0 } else { 0.0 }))
        .collect();
    let model = simulate::reads(&opened.discovery, &opened.model, &start);
    let (dataset, _) = data::bind(&model, &[table], &[], &mut sources);
    let source = Source {
        discovery: &opened.discovery,
        model: &model,
        dataset: &dataset,
    };
    let run = |step: Option<f64>| -> Run {
        let options = Options {
            start: start.clone(),
            step,
            ..Options::default()
        };
        simulate::simulate(&source, 0, &options, &mut Unwatched).unwrap()
    };
    let mut group = c.benchmark_group("cart-pendulum");
    group.sample_size(10);
    group.bench_function("10^6 classical steps", |b| b.iter(|| run(Some(1e-5))));
    group.bench_function("10 s at 100 Hz, error-controlled", |b| b.iter(|| run(None)));
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);
