//! The laws hold on the rows, and are those that textbooks have.

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

/// The double pendulum's law of the lower rod, as it stands in textbooks.
#[test]
fn two_links_have_the_law_of_the_double_pendulum() {
    let system = Coupled::draw(Family::Links, 0);
    let [_, lower] = &system.laws()[..] else {
        panic!("two laws");
    };
    let names: Vec<String> = lower.terms.iter().map(|(m, _)| system.term(m)).collect();
    for term in [
        "ddth1*sin(th1)*sin(th2)",
        "ddth1*cos(th1)*cos(th2)",
        "dth1^2*sin(th1)*cos(th2)",
        "dth1^2*sin(th2)*cos(th1)",
        "sin(th2)",
        "dth2",
    ] {
        assert!(names.iter().any(|n| n == term), "{names:?}");
    }
}
