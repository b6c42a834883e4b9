//! A stirred tank with an exothermic reaction (Seborg, Edgar, Mellichamp, Doyle: Process Dynamics and Control). Its jacket is heated and cooled in steps.

use sidc_testing::integrate::grid;
use sidc_testing::plants::response::held;
use sidc_testing::random::{Random, decimals};
use sidc_testing::table::Table;

pub fn tables() -> Vec<(&'static str, Table)> {
    let f = |&[c, temperature]: &[f64; 2], jacket: f64| {
        // 8,750 K is the activation energy divided by the gas constant; at 350 K the reaction takes 1 min.
        let reaction = (8750.0 * (1.0 / 350.0 - 1.0 / temperature)).exp() * c;
        [
            1.0 - c - reaction,
            350.0 - temperature + 209.0 * reaction + 2.1 * (jacket - temperature),
        ]
    };
    let times = grid(800, 0.02);
    let jacket: Vec<f64> = Random::new(67)
        .square(times.len(), (20, 80), 8.0)
        .iter()
        .map(|s| decimals(289.0 + s, 1))
        .collect();
    let mut table = Table::new(&["t", "c", "T", "Tc"]);
    let states = held(&f, &times, [0.8, 320.0], &jacket);
    for ((t, [c, temperature]), j) in times.iter().zip(states).zip(&jacket) {
        table.push(&[*t, c, temperature, *j]);
    }
    vec![("reactor.csv", table)]
}
