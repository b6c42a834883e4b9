//! Whether a column is the rate of another, and in which unit.
//!
//! In: the columns of time, a state and a possible rate. Out: the factor that converts the rate, found by least squares on the
//! slope of the state. Looks at no names.

use std::f64::consts::PI;

use super::law_order::reach;
use super::table_column::Column;
use super::thresholds::RATE;

/// Factors from the units of sensors to those of the model: degrees, turns a minute, prefixes, km/h.
const FACTORS: [(&str, f64); 15] = [
    ("", 1.0),
    ("pi/180", PI / 180.0),
    ("pi/180 * 1e3", PI / 0.18),
    ("2*pi/60", PI / 30.0),
    ("2*pi", 2.0 * PI),
    ("180/pi", 180.0 / PI),
    ("1e-3", 1e-3),
    ("1e3", 1e3),
    ("1e-6", 1e-6),
    ("1e6", 1e6),
    ("1e-2", 1e-2),
    ("1e2", 1e2),
    ("1/60", 1.0 / 60.0),
    ("60", 60.0),
    ("1/3.6", 1.0 / 3.6),
];

/// The factor that makes a column the rate of a state, both in units of the model, as text; `None` if it is no rate.
/// Without units in the headers only a factor near 1 counts.
pub(super) fn rate_factor(time: &Column, state: &Column, rate: &Column) -> Option<&'static str> {
    let own = (proportion(time, state, rate)?) * state.scale() / time.scale();
    let units = [state, rate].iter().any(|c| c.unit.is_some());
    let known = FACTORS.iter().take(if units { FACTORS.len() } else { 1 });
    let near = known.filter(|(_, f)| {
        (own / f - 1.0).abs()
            < RATE
                .unit_tolerance
                .max(if *f == 1.0 { RATE.unexplained } else { 0.0 })
    });
    let off = |f: &f64| (own / f - 1.0).abs();
    let best = near.min_by(|a, b| off(&a.1).total_cmp(&off(&b.1)));
    best.map(|(text, _)| *text)
}

/// The least-squares k of x(b) − x(a) = k ∫ v dt, over spans in which the state moves visibly, so that noise of neither decides;
/// `None` if that does not explain the differences.
fn proportion(time: &Column, state: &Column, rate: &Column) -> Option<f64> {
    let (t, x, v) = (&time.values, &state.values, &rate.values);
    let n = t.len().min(x.len()).min(v.len());
    let reach = reach(x);
    let area = |k: usize| 0.5 * (v[k] + v[k - 1]) * (t[k] - t[k - 1]);
    let (mut moves, mut both, mut areas, mut rows) = (0.0, 0.0, 0.0, 0usize);
    for a in 0..n.saturating_sub(2 * reach) {
        let b = a + 2 * reach;
        let span = t[b] - t[a];
        let slope = (x[b] - x[a]) / span;
        let mean = (a + 1..=b).map(area).sum::<f64>() / span;
        let rises = (a + 1..=b).all(|k| t[k] > t[k - 1]);
        if rises && slope.is_finite() && mean.is_finite() {
            moves += slope * slope;
            both += slope * mean;
            areas += mean * mean;
            rows += 1;
        }
    }
    let left = moves - both * both / areas;
    let explained =
        rows >= RATE.min_rows && both > 0.0 && left <= RATE.unexplained * RATE.unexplained * moves;
    explained.then_some(both / areas)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn column(header: &str, unit: Option<&str>, f: impl Fn(f64) -> f64) -> Column {
        Column {
            header: header.into(),
            name: header.into(),
            unit: unit.map(String::from),
            values: (0..400).map(|k| f(f64::from(k) * 0.01)).collect(),
            words: false,
        }
    }

    #[test]
    fn a_rate_is_known_in_any_unit_and_a_stranger_is_none() {
        let seconds = column("t", Some("s"), |t| t);
        let millis = column("t", Some("ms"), |t| 1000.0 * t);
        let metres = column("x", Some("m"), |t| (3.0 * t).sin());
        let degrees = column("a", Some("deg"), |t| 90.0 * (3.0 * t).sin());
        let bare = column("x", None, |t| (3.0 * t).sin());
        let rate =
            |unit: Option<&str>, size: f64| column("v", unit, move |t| size * (3.0 * t).cos());
        assert_eq!(rate_factor(&seconds, &bare, &rate(None, 3.0)), Some(""));
        assert_eq!(rate_factor(&seconds, &bare, &rate(None, 3000.0)), None);
        assert_eq!(
            rate_factor(&seconds, &metres, &rate(Some("mm/s"), 3000.0)),
            Some("1e-3")
        );
        assert_eq!(
            rate_factor(&millis, &metres, &rate(Some("km/h"), 10.8)),
            Some("1/3.6")
        );
        assert_eq!(
            rate_factor(&seconds, &degrees, &rate(Some("deg/s"), 270.0)),
            Some("pi/180")
        );
        assert_eq!(
            rate_factor(&seconds, &degrees, &rate(Some("rpm"), 45.0)),
            Some("2*pi/60")
        );
        assert_eq!(
            rate_factor(&millis, &degrees, &rate(Some("rad/s"), 1.5 * PI)),
            Some("")
        );
        let other = column("w", Some("V"), |t| (5.0 * t).cos());
        assert_eq!(rate_factor(&seconds, &metres, &other), None);
        // In proportion, but to no unit: a tachometer's volts, a current into a capacitor.
        assert_eq!(rate_factor(&seconds, &metres, &rate(Some("V"), 0.37)), None);
    }
}
