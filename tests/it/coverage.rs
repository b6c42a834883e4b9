//! Standard errors are right: intervals contain the known coefficients as often as they claim.

use sidc_studies::coverage::figures::Row;
use sidc_studies::coverage::{accelerometer, odebench, run, sampled_input};

/// Draws a case a few times and checks all intervals together, and the size of every standard error. `cargo run --release -p sidc-studies --bin coverage`
/// makes 200 draws of all cases.
fn holds(name: &str, count: u64, exact: usize) {
    let mut all = odebench::cases();
    all.extend(accelerometer::cases());
    let case = all.iter().find(|c| c.name == name).unwrap();
    let draws = run::draws(case, 0.01, count).unwrap();
    let row = Row::new(case, &draws);
    let text = format!("{}\n{}", row.text(), row.terms_text());
    assert!(
        draws.iter().filter(|d| d.exact.is_some()).count() >= exact,
        "{text}"
    );
    let (covered, all) = row.covered();
    let share = f64::from(covered) / f64::from(all);
    assert!((0.88..=0.995).contains(&share), "{text}");
    for term in &row.terms {
        assert!((0.7..1.4).contains(&term.ratio), "{text}");
        assert!(term.bias.abs() < 0.6, "{text}");
    }
}

/// With weak damping over many swings, the slack in the laws must not add to the errors of the coefficients.
#[test]
fn the_slack_of_the_laws_is_no_error_of_the_coefficients() {
    holds("ode32_double_well", 40, 40);
}

/// Samples of an input leave open what it did between them, so the intervals must contain both answers.
#[test]
fn inputs_between_samples_widen_the_intervals() {
    for case in sampled_input::cases() {
        let draws = run::draws(&case, 1e-3, 12).unwrap();
        let row = Row::new(&case, &draws);
        let (covered, all) = row.covered();
        let text = format!("{}\n{}", row.text(), row.terms_text());
        assert!(all >= 33, "{text}");
        // A draw with a large error misses with all of its terms.
        assert!(f64::from(covered) >= 0.85 * f64::from(all), "{text}");
    }
}

/// Least squares on a target with white errors, and on one with correlated errors.
#[test]
fn errors_that_follow_each_other_widen_the_intervals() {
    holds("accelerometer", 80, 80);
    holds("accelerometer_filtered", 80, 60);
}
