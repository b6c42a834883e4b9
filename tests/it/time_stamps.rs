//! Time stamps that scatter: those of a computer about even samples, and those of samples that were themselves uneven.

use sidc::{Data, Discovery, Model, Options};
use sidc_testing::integrate::integrate;
use sidc_testing::random::Random;

const MODEL: &str = "state q : order 2
input u : linear
ddq ~ <1, q, dq, u, sin q, cos q, q^3, dq*abs(dq)>
";

fn force(t: f64) -> f64 {
    1.5 * (0.7 * t).sin() + 1.2 * (1.3 * t + 1.0).cos() + (2.1 * t).sin()
}

/// Positions of a forced pendulum at rising instants.
fn positions(instants: &[f64]) -> Vec<f64> {
    let law = |t: f64, z: &[f64; 2]| [z[1], -9.0 * z[0].sin() - 0.4 * z[1] + force(t)];
    let (mut at, mut state) = (0.0, [1.0, 0.0]);
    let mut read = Vec::new();
    for t in instants {
        state = integrate(&law, at, *t, state);
        at = *t;
        read.push(state[0]);
    }
    read
}

fn identify(stamps: &[f64], instants: &[f64]) -> Discovery {
    let q = positions(instants);
    let u: Vec<f64> = instants.iter().map(|t| force(*t)).collect();
    let data = Data::new()
        .run([("t", stamps), ("q", &q), ("u", &u)])
        .unwrap();
    let model = Model::parse(MODEL).unwrap();
    model.identify(&data, &Options::default()).unwrap()
}

fn coefficient(found: &Discovery, term: &str) -> f64 {
    let terms = &found.equations()[0].terms;
    assert_eq!(terms.len(), 3, "{terms:?}");
    let found = terms.iter().find(|t| t.term == term);
    found.unwrap_or_else(|| panic!("no {term}")).coefficient
}

/// A fifth of a step off: with the stamps as they are, `sin(q)` is off by 1e-3 and the law is doubted.
#[test]
fn readings_of_an_even_clock_are_used_at_its_instants() {
    let mut random = Random::new(1);
    let even: Vec<f64> = (0..1200).map(|k| 0.02 * f64::from(k)).collect();
    let scattered: Vec<f64> = even
        .iter()
        .map(|t| t + 0.004 * random.uniform(-1.0, 1.0))
        .collect();
    for (instants, moved) in [(&even, true), (&scattered, false)] {
        let found = identify(&scattered, instants);
        let told = found.warnings().iter().any(|w| w.code == "time-jitter");
        assert_eq!(told, moved);
        assert!(found.passes(), "{}", found.answer());
        for (term, truth) in [("sin(q)", -9.0), ("dq", -0.4), ("u", 1.0)] {
            let error = coefficient(&found, term) / truth - 1.0;
            assert!(error.abs() < 1e-4, "{term}: {error:e}");
        }
    }
}
