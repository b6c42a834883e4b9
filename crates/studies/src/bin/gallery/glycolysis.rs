//! Glycolysis in yeast (Ruoff, Christensen, Wolf, Heinrich 2003; constants of Daniels and Nemenman 2015): seven concentrations from six starts.

use sidc_testing::integrate::grid;
use sidc_testing::plants::response::free;
use sidc_testing::table::Table;

pub fn tables() -> Vec<(&'static str, Table)> {
    let f = |_: f64, &[s1, s2, s3, s4, s5, s6, s7]: &[f64; 7]| {
        let uptake = 100.0 * s1 * s6 / (1.0 + (s6 / 0.52_f64).powi(4));
        let oxidised = 6.0 * s2 * (1.0 - s5);
        let glycerol = 12.0 * s2 * s5;
        let pyruvate = 16.0 * s3 * (4.0 - s6);
        let ethanol = 100.0 * s4 * s5;
        let outward = 13.0 * (s4 - s7);
        [
            2.5 - uptake,
            2.0 * uptake - oxidised - glycerol,
            oxidised - pyruvate,
            pyruvate - ethanol - outward,
            oxidised - ethanol - glycerol,
            -2.0 * uptake + 2.0 * pyruvate - 1.28 * s6,
            0.1 * outward - 1.8 * s7,
        ]
    };
    let times = grid(80, 0.003);
    let mut table = Table::new(&["run", "t", "S1", "S2", "S3", "S4", "S5", "S6", "S7"]);
    let starts = [
        [1.2, 0.19, 0.2, 0.1, 0.3, 0.14, 0.05],
        [0.3, 2.1, 0.05, 0.35, 0.1, 2.6, 0.1],
        [0.9, 1.2, 0.15, 0.2, 0.08, 1.2, 0.08],
        [1.6, 0.6, 0.1, 0.3, 0.2, 2.0, 0.06],
        [0.5, 0.4, 0.04, 0.3, 0.28, 0.6, 0.1],
        [1.0, 1.8, 0.18, 0.12, 0.12, 0.3, 0.07],
    ];
    for (run, start) in starts.into_iter().enumerate() {
        for (t, s) in times.iter().zip(free(&f, &times, start)) {
            table.push(&[&[run as f64 + 1.0, *t], &s[..]].concat());
        }
    }
    vec![("glycolysis.csv", table)]
}
