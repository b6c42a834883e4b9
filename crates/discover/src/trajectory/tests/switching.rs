//! The flow across events: ends and derivatives where a law crosses a switch, sticks, or begins at rest.

use super::{System, check_flow, flow, system};

const DRIVE: &str = "system drive\nstate x : order 2\ninput F : hold\n\
    ddx ~ <x, dx, sign(dx), F>\n";
const BODIES: &str = "system bodies\nstate x, y : order 2\ninput F : hold\n\
    ddx ~ <x, sign(dx), F, ddy>\nddy ~ <y, sign(dy), ddx>\n";
const BALL: &str = "system ball\nstate x : order 2\ninput F : hold\n\
    ddx ~ <F, step(-x), x*step(-x), dx*step(-x)>\n";

/// Coefficients of all columns, law after law; a column is known by its value where x = −2, dx = 5, ddx = 8, and 10 more (y, F) or 20 more.
fn coefficients(system: &System, known: &[&[(f64, f64)]]) -> Vec<f64> {
    let at = |s: sidc_lang::term::Signal| match (s.var.0, s.der) {
        (1, 0) => -2.0,
        (var, der) => 2.0 + 3.0 * f64::from(der) + 10.0 * f64::from(var - 1),
    };
    let coefficient = |j: usize| {
        let value = system.columns[j].eval(&at);
        let own = known[system.law_of(j)].iter();
        let found = own.clone().find(|(v, _)| *v == value);
        found.unwrap_or_else(|| panic!("{value}")).1
    };
    (0..system.columns.len()).map(coefficient).collect()
}

/// The same start for both intervals.
fn twice(state: &[f64]) -> Vec<f64> {
    let rest = vec![0.0; state.len()];
    [state, state, &rest].concat()
}

#[test]
fn derivatives_across_events_are_what_differences_give() {
    let drive = system(DRIVE);
    let all: Vec<usize> = (0..4).collect();
    // Stiff enough for several steps an interval.
    let a = coefficients(
        &drive,
        &[&[(-2.0, -2000.0), (5.0, -3.0), (1.0, -6.0), (12.0, 2.0)]],
    );
    for state in [
        // Slows down, reverses.
        [0.02, 0.3],
        // Slows down, stays.
        [0.001, 0.05],
        // Rests.
        [0.001, 0.0],
        // No event.
        [0.02, -0.3],
    ] {
        check_flow(&drive, &all, &a, &twice(&state));
    }
    let bodies = system(BODIES);
    let all: Vec<usize> = (0..7).collect();
    let x = [(-2.0, -2000.0), (1.0, -3.0), (22.0, 1.0), (18.0, 0.2)];
    let a = coefficients(&bodies, &[&x, &[(12.0, -1500.0), (1.0, -2.0), (8.0, 0.3)]]);
    for state in [
        [0.01, 0.1, -0.01, 0.2],
        [0.0005, 0.03, -0.0005, 0.02],
        [0.0005, 0.0, 0.02, 0.1],
    ] {
        check_flow(&bodies, &all, &a, &twice(&state));
    }
    let ball = system(BALL);
    let all: Vec<usize> = (0..4).collect();
    let a = coefficients(
        &ball,
        &[&[(12.0, 1.0), (1.0, 0.5), (-2.0, -4000.0), (5.0, -6.0)]],
    );
    check_flow(&ball, &all, &a, &twice(&[-0.01, -0.1]));
    check_flow(&ball, &all, &a, &twice(&[-0.001, 0.5]));
}

/// What is at rest stays where it is, and no coefficient moves it.
#[test]
fn rest_is_kept_and_says_nothing_of_the_forces() {
    let drive = system(DRIVE);
    let all: Vec<usize> = (0..4).collect();
    let block = flow(
        &drive,
        &all,
        &[-2000.0, -3.0, -6.0, 2.0],
        &twice(&[0.001, 0.0]),
    );
    for b in 0..2 {
        assert_eq!(block.end[2 * b..2 * b + 2], [0.001, 0.0]);
        assert_eq!(block.transition[4 * b..4 * b + 4], [1.0, 0.0, 0.0, 0.0]);
        assert!(block.columns[8 * b..8 * b + 8].iter().all(|u| *u == 0.0));
    }
}
