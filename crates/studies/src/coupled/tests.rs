//! The study's own dictionary contains the laws, and its grades multiply.

use sidc_solve::dictionary::Dictionary;
use sidc_testing::plants::coupled::{Coupled, FAMILIES, Family, Point, Swing};

use super::dictionary::Tabulated;
use super::grading::{degree, variation};
use super::library::{Library, Size};
use super::{Case, Plan, identified, trials};

#[test]
fn the_columns_of_a_law_add_up_to_its_acceleration() {
    for family in FAMILIES {
        let system = Coupled::draw(family, 2);
        let record = system.record(Swing::Large, 60, 0.05);
        let points: Vec<&Point> = record.iter().step_by(3).map(|(_, p)| p).collect();
        for law in system.laws() {
            let library = Library::new(&system, &law, Size::Own, 2);
            let phi = Tabulated::new(&library.atoms, &points)
                .dictionary()
                .unwrap();
            let mut sum = vec![0.0; points.len()];
            let mut column = sum.clone();
            for (monomial, coefficient) in &law.terms {
                phi.column(library.place(monomial).unwrap(), &mut column);
                sum.iter_mut()
                    .zip(&column)
                    .for_each(|(s, x)| *s += coefficient * x);
            }
            for (s, p) in sum.iter().zip(&points) {
                let target = p.accelerations[law.coordinate];
                assert!(
                    (s - target).abs() < 1e-9 * (1.0 + target.abs()),
                    "{family:?}"
                );
            }
        }
    }
}

#[test]
fn a_library_has_as_many_atoms_as_asked_and_the_laws_own() {
    let system = Coupled::draw(FAMILIES[0], 0);
    for law in system.laws() {
        let library = Library::new(&system, &law, Size::Atoms(12), 0);
        assert_eq!(library.atoms.len(), 12);
        assert!(law.terms.iter().all(|(m, _)| library.place(m).is_some()));
    }
}

#[test]
fn grades_are_powers_of_kappa_by_degree_and_by_variation() {
    let system = Coupled::draw(FAMILIES[0], 0);
    let law = &system.laws()[0];
    let library = Library::new(&system, law, Size::Own, 0);
    let record = system.record(Swing::Small, 60, 0.05);
    let points: Vec<&Point> = record.iter().map(|(_, p)| p).collect();
    let tabulated = Tabulated::new(&library.atoms, &points);
    let (by_degree, by_variation) = (
        tabulated.grades(&degree(2.0)),
        tabulated.grades(&variation(2.0)),
    );
    for (monomial, _) in &law.terms {
        let place = library.place(monomial).unwrap();
        let whole = 2_f64.powi(monomial.len() as i32);
        assert!((by_degree.of(place) / whole - 1.0).abs() < 1e-12);
        let by_variation = by_variation.of(place);
        assert!(
            (1.0..=whole * (1.0 + 1e-12)).contains(&by_variation),
            "{monomial:?}"
        );
    }
    // The cosine of a small angle hardly varies.
    let cosine = law
        .terms
        .iter()
        .find(|(m, _)| system.term(m) == "ddth1*cos(th1)");
    let place = library.place(&cosine.unwrap().0).unwrap();
    assert!((1.9..2.1).contains(&by_variation.of(place)) && by_degree.of(place) == 4.0);
}

#[test]
fn the_compiler_is_asked_the_same_problems() {
    let case = Case {
        family: Family::Cart,
        swing: Swing::Large,
        seed: 40,
    };
    let plan = Plan {
        rows: vec![4, 60],
        sizes: vec![Size::Atoms(6)],
        gradings: vec![degree(1.0)],
        steps: 600,
    };
    let (asked, tried) = (identified(&case, &plan).unwrap(), trials(&case, &plan));
    assert_eq!(asked.len(), tried.len());
    for (asked, tried) in asked.iter().zip(&tried) {
        // Four rows cannot distinguish a law from others with as many terms.
        assert_eq!(asked.exact, tried.rows == 60);
        assert_eq!(asked.exact, tried.outcome.exact);
        assert!(!asked.exact || asked.terms == tried.true_terms);
    }
}
