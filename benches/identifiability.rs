//! The cost of the whole assessment of one equation: rank, relations, equivalent supports, excitation, advice, stability, alternatives.
//!
//! 1,000 terms on 10,000 rows is promised to take less than two seconds.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use sidc::pipeline;
use sidc_data::{Column, Origin, Samples};
use sidc_discover::Options;
use sidc_discover::identifiability::{Rows, assess};
use sidc_discover::scaled_design::ScaledDesign;
use sidc_discover::uncertainty;
use sidc_lang::source::Sources;
use sidc_lang::term::{Signal, Term, VarId};
use sidc_system::discovery::{Discovery, Equation, Evidence, FoundTerm, Status};

/// Nine weakly correlated signals.
fn samples(rows: usize) -> Samples {
    let wave = |i: u16, k: usize| {
        let (i, t) = (f64::from(i), k as f64 * 0.01);
        (t * (1.0 + 0.37 * i) + i).sin() + 0.5 * (t * (2.3 - 0.11 * i)).cos()
    };
    let signal = |i: u16| match i {
        9 => Signal::derivative(VarId(1), 1),
        i => Signal::new(VarId(i + 1)),
    };
    let mut columns: Vec<Column> = (0..10)
        .map(|i| Column {
            signal: signal(i),
            values: (0..rows).map(|k| wave(i, k)).collect(),
            origin: Origin::Measured { noise: None },
        })
        .collect();
    columns.sort_by_key(|c| c.signal);
    Samples {
        trajectory: vec![0; rows],
        time: (0..rows).map(|k| k as f64 * 0.01).collect(),
        columns,
    }
}

fn whole(c: &mut Criterion) {
    let mut group = c.benchmark_group("identifiability");
    group.sample_size(10);
    for (degree, rows) in [(2, 1000), (3, 1000), (5, 10_000)] {
        let mut sources = Sources::default();
        let names = "x1, x2, x3, x4, x5, x6, x7, x8, x9";
        let text = format!("state {names}\ndx1 ~ poly({names}; {degree}) + x1^3*<x2^2, x3^2>\n");
        let file = sources.add("bench.sid", text);
        let (program, _) = pipeline::compile(file, &sources, pipeline::MEMORY);
        let Some(program) = program else { continue };
        let Some(Some(library)) = program.libraries.first() else {
            continue;
        };
        let terms: Vec<Term> = library.terms().map(|(_, t)| t).take(1000).collect();
        let library = sidc_lang::library::Library::listed(terms.clone());
        let mut samples = samples(rows);
        let found: Vec<FoundTerm> = [1, 4, 12, 30]
            .into_iter()
            .filter_map(|k| terms.get(k).cloned())
            .map(|term| FoundTerm {
                term,
                coefficient: 0.7,
                fixed: false,
                standard_error: Some(0.01),
                evidence: None,
                runs: Vec::new(),
            })
            .collect();
        let mut y = vec![0.0; rows];
        for t in &found {
            let values = sidc_discover::dictionary::evaluate(&t.term, &samples);
            y.iter_mut().zip(values).for_each(|(y, v)| *y += 0.7 * v);
        }
        let target = Signal::derivative(VarId(1), 1);
        for column in samples.columns.iter_mut().filter(|c| c.signal == target) {
            column.values.clone_from(&y);
        }
        let equation = Equation {
            target,
            terms: found,
            status: Status::Doubt,
            reasons: Vec::new(),
            evidence: Some(Evidence::default()),
            path: Vec::new(),
        };
        let mut discovery = Discovery::of(&program.model);
        discovery.equations.push(equation.clone());
        let options = Options {
            samples: Some(rows),
            ..Options::default()
        };
        let given = Rows {
            samples: &samples,
            read: None,
            unread: &[],
        };
        let name = format!("{} terms", library.len());
        group.bench_function(BenchmarkId::new(name, rows), |b| {
            b.iter(|| {
                let design =
                    ScaledDesign::new(&program.model, &library, &samples, &equation, &options)?;
                let told = assess(&design, &library, given, true);
                let mut found = discovery.clone();
                if let Some(stretches) = uncertainty::block_normal_equations(&design) {
                    let stability = uncertainty::stability_selection(&stretches);
                    uncertainty::assess_terms(&stretches, &stability, &mut found);
                }
                Some(black_box((told, found)))
            });
        });
    }
    group.finish();
}

criterion_group!(benches, whole);
criterion_main!(benches);
