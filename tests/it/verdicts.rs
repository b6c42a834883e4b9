//! Attacks on the verdict: a wrong law does not pass, the reason is right, and a right law is not doubted.

use sidc::{Data, Discovery, Model, Options, ReasonCode};
use sidc_testing::attacks::{Attack, Case, case};

const SEEDS: u64 = 3;

fn identify(case: &Case) -> Discovery {
    let model = Model::parse(&case.model).unwrap();
    let mut data = Data::new();
    for run in case.columns() {
        data = data.run(run).unwrap();
    }
    model.identify(&data, &Options::default()).unwrap()
}

/// The terms and doubts of ddx.
fn answer(found: &Discovery) -> (Vec<String>, Vec<ReasonCode>) {
    let equation = found
        .equations()
        .iter()
        .find(|e| e.target == "ddx")
        .unwrap();
    let terms = equation.terms.iter().map(|t| t.term.clone()).collect();
    let doubts = equation.reasons.iter().map(|r| r.code.clone()).collect();
    (terms, doubts)
}

fn law(case: &Case) -> Vec<String> {
    case.laws[0].terms.clone()
}

#[test]
fn an_honest_law_passes_at_every_level_of_noise() {
    for (seed, noise) in (0..SEEDS).flat_map(|s| [0.0, 0.01, 0.05].map(|n| (s, n))) {
        let case = case(Attack::Honest, seed, noise);
        let found = identify(&case);
        assert_eq!(answer(&found), (law(&case), vec![]), "{seed} {noise}");
    }
}

#[test]
fn random_laws_pass_on_exact_data_and_without_a_term_they_do_not() {
    for seed in 0..SEEDS {
        let found = identify(&case(Attack::RandomSystem, seed, 0.0));
        assert!(found.passes(), "{seed}: {found}");
        for noise in [0.0, 0.001] {
            let case = case(Attack::OmittedTerm, seed, noise);
            let found = identify(&case);
            let law = case.laws.iter().find(|l| !l.offered).unwrap();
            let doubted = found.doubts().any(|(target, _)| target == law.target);
            assert!(doubted, "{seed} {noise}: {found}");
        }
    }
}

#[test]
fn a_term_that_the_library_lacks_is_named() {
    for (seed, noise) in (0..SEEDS).flat_map(|s| [0.01, 0.03].map(|n| (s, n))) {
        let found = identify(&case(Attack::MissingTerm, seed, noise));
        let equation = &found.equations()[0];
        let advice: Vec<&str> = equation.reasons.iter().map(|r| r.advice()).collect();
        let said = advice.contains(&"add sin(x) to the library");
        assert!(said, "{seed} {noise}: {advice:?}");
    }
}

#[test]
fn a_copy_of_the_target_is_left_out_and_the_law_found() {
    for (seed, noise) in (0..SEEDS).flat_map(|s| [0.0, 0.01].map(|n| (s, n))) {
        let case = case(Attack::Copy, seed, noise);
        let found = identify(&case);
        assert_eq!(answer(&found), (law(&case), vec![]), "{seed} {noise}");
        let warned = found.warnings().iter();
        let copies = warned.filter(|w| w.code == "target-copied").count();
        assert_eq!(copies, 2, "{seed} {noise}: {:?}", found.warnings());
    }
}

#[test]
fn two_sensors_of_one_rate_are_no_law() {
    for (seed, noise) in (0..SEEDS).flat_map(|s| [0.0, 0.01].map(|n| (s, n))) {
        let found = identify(&case(Attack::SecondSensor, seed, noise));
        let (terms, doubts) = answer(&found);
        let seen = doubts.contains(&ReasonCode::DependentStates);
        assert!(terms != ["dw"] || seen, "{seed} {noise}: {doubts:?}");
        assert!(!doubts.is_empty(), "{seed} {noise}: {terms:?}");
    }
}

#[test]
fn a_series_of_the_law_does_not_pass_on_exact_data_and_the_law_is_named() {
    for seed in 0..SEEDS {
        let found = identify(&case(Attack::Series, seed, 0.0));
        let reasons = &found.equations()[0].reasons;
        let misfit = reasons.iter().find(|r| r.code == ReasonCode::Misfit);
        let advice = misfit.map(|r| r.advice());
        assert_eq!(advice, Some("add sin(x) to the library"), "{reasons:?}");
    }
}

/// The residual is far above rounding, but no term is missing.
#[test]
fn the_error_of_the_solver_that_made_the_data_is_no_misfit() {
    for seed in 0..SEEDS {
        let case = case(Attack::CoarseSolver, seed, 0.0);
        assert_eq!(answer(&identify(&case)), (law(&case), vec![]), "{seed}");
    }
}

#[test]
fn a_steady_sine_shows_its_relation() {
    for seed in 0..SEEDS {
        let case = case(Attack::SteadySine, seed, 0.01);
        let (terms, doubts) = answer(&identify(&case));
        assert!(
            terms == law(&case) || !doubts.is_empty(),
            "{seed}: {terms:?}"
        );
    }
}
