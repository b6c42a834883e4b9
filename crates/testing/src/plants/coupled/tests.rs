//! The laws hold on the rows, and agree with laws that were derived by hand.

use super::lagrange::{Mass, Mechanism};
use super::*;

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |most, v| f64::max(most, v.abs()))
}

#[test]
fn every_law_holds_on_every_row() {
    for family in FAMILIES {
        for swing in [Swing::Large, Swing::Small] {
            let system = Coupled::draw(family, 3);
            let record = system.record(swing, 300, 0.05);
            for law in system.laws() {
                let misfit = record.iter().map(|(_, at)| {
                    let product = |m: &Monomial| m.iter().map(|f| f.value(at)).product::<f64>();
                    let right: f64 = law.terms.iter().map(|(m, c)| c * product(m)).sum();
                    right - at.accelerations[law.coordinate]
                });
                let misfit = largest(misfit);
                let size = largest(record.iter().map(|(_, p)| p.accelerations[law.coordinate]));
                assert!(
                    size > 1e-3 && misfit < 1e-10 * size,
                    "{family:?} {} {misfit} of {size}",
                    law.coordinate
                );
            }
        }
    }
}

#[test]
fn angles_go_as_far_as_asked() {
    for family in FAMILIES {
        let system = Coupled::draw(family, 1);
        let angles: Vec<usize> = (0..system.coordinates())
            .filter(|i| system.is_angle(*i))
            .collect();
        for i in angles {
            let far = reach(&system.record(Swing::Large, 400, 0.05), i);
            let near = reach(&system.record(Swing::Small, 400, 0.05), i);
            assert!(far > 2.5 && near < 0.6, "{family:?} {far} {near}");
        }
    }
}

/// Speeds and accelerations are derivatives of the positions: central differences of a fine record.
#[test]
fn accelerations_belong_to_the_motion() {
    let system = Coupled::draw(Family::CartChain, 0);
    let step = 1e-3;
    let record = system.record(Swing::Small, 500, step);
    for i in 0..3 {
        let fast = largest(record.iter().map(|(_, p)| p.speeds[i]));
        let strong = largest(record.iter().map(|(_, p)| p.accelerations[i]));
        for three in record.windows(3) {
            let [(_, a), (_, b), (_, c)] = three else {
                continue;
            };
            if a.inputs == b.inputs {
                let rate = (c.positions[i] - a.positions[i]) / (2.0 * step);
                assert!((rate - b.speeds[i]).abs() < 1e-3 * fast);
                let rate = (c.speeds[i] - a.speeds[i]) / (2.0 * step);
                assert!((rate - b.accelerations[i]).abs() < 1e-3 * strong);
            }
        }
    }
}

/// The laws of the gallery's double pendulum, which were derived by hand.
#[test]
fn a_cart_with_two_links_has_the_laws_of_the_double_pendulum() {
    let mass = |mass, rods: &[(usize, f64)]| Mass {
        mass,
        carts: vec![0],
        rods: rods.to_vec(),
    };
    let upper = (1, 0.5);
    let mechanism = Mechanism {
        masses: vec![
            mass(0.6, &[]),
            mass(0.3, &[upper]),
            mass(0.2, &[upper, (2, 0.4)]),
        ],
        dampers: vec![
            (0.05, vec![(0, 1.0)]),
            (0.01, vec![(1, 1.0)]),
            (0.01, vec![(2, 1.0)]),
        ],
        inputs: vec![0],
        ..Mechanism::default()
    };
    let laws = mechanism.laws(3);
    use Factor::{Acceleration, Cos, Input, Sin, Speed};
    let lower: Vec<(Monomial, f64)> = vec![
        (vec![Acceleration(0), Cos(2)], -2.5),
        (vec![Acceleration(1), Cos(1), Cos(2)], -1.25),
        (vec![Acceleration(1), Sin(1), Sin(2)], -1.25),
        (vec![Speed(1), Speed(1), Cos(1), Sin(2)], -1.25),
        (vec![Speed(1), Speed(1), Cos(2), Sin(1)], 1.25),
        (vec![Speed(2)], -0.3125),
        (vec![Sin(2)], -24.525),
    ];
    let cart: Vec<(Monomial, f64)> = vec![
        (vec![Acceleration(1), Cos(1)], -0.25 / 1.1),
        (vec![Acceleration(2), Cos(2)], -0.08 / 1.1),
        (vec![Speed(0)], -0.05 / 1.1),
        (vec![Speed(1), Speed(1), Sin(1)], 0.25 / 1.1),
        (vec![Speed(2), Speed(2), Sin(2)], 0.08 / 1.1),
        (vec![Input(0)], 1.0 / 1.1),
    ];
    for (at, wanted) in [(0, cart), (2, lower)] {
        let found = laws.explicit(at);
        assert_eq!(found.len(), wanted.len(), "{found:?}");
        for (mut term, coefficient) in wanted {
            term.sort_unstable();
            let has = found.iter().find(|(m, _)| *m == term);
            assert!(
                has.is_some_and(|(_, c)| (c - coefficient).abs() < 1e-12),
                "{term:?} in {found:?}"
            );
        }
    }
}

#[test]
fn terms_are_written_as_the_program_prints_them() {
    let system = Coupled::draw(Family::Links, 0);
    let term = [
        Factor::Speed(0),
        Factor::Speed(0),
        Factor::Sin(0),
        Factor::Cos(1),
    ];
    assert_eq!(system.term(&term), "dth1^2*sin(th1)*cos(th2)");
    assert_eq!(system.term(&[]), "1");
    assert!(
        system
            .declared()
            .starts_with("state th1, th2 : order 2\ninput F")
    );
}
