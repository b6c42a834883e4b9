//! Parts of records along which a ball lies on the floor.

use super::system;
use crate::trajectory::model::Problem;
use sidc_data::{Dataset, Trajectory};
use sidc_random::Numbers;

const G: f64 = 9.81;

/// The problem of a ball read every `step` seconds, its floor at zero or at an unknown height.
fn ball(floor: &str, step: f64, heights: Vec<f64>) -> Problem {
    let system = system(&format!(
        "system ball\nstate y : order 2\nunknown e in 0.1 .. 1\nunknown h in -1 .. 1\n\
         ddy ~ <1, dy>\nwhen y < {floor} : dy -> -e*dy\n"
    ));
    let time: Vec<f64> = (0..heights.len()).map(|k| step * k as f64).collect();
    let constants = system.exogenous.iter();
    let constants = constants.map(|s| (*s, vec![0.5; heights.len()]));
    let read = (system.states[0], heights.clone());
    let dataset = Dataset {
        trajectories: vec![Trajectory {
            name: String::new(),
            file: 0,
            columns: constants.chain([read]).collect(),
            time,
        }],
        ..Dataset::default()
    };
    Problem::new(system, &dataset, &|_| None, false).unwrap()
}

/// Heights of a ball dropped from 1 m that keeps 0.7 of its speed. It has come to rest after 2.56 s.
fn dropped(step: f64, until: f64) -> Vec<f64> {
    let (mut began, mut height, mut speed) = (0.0, 1.0, 0.0);
    let mut out = Vec::new();
    for k in 0.. {
        let t = step * f64::from(k);
        if t > until {
            return out;
        }
        loop {
            let flight = (speed + f64::sqrt(speed * speed + 2.0 * G * height)) / G;
            if t < began + flight || flight < 1e-9 {
                break;
            }
            (began, height, speed) = (began + flight, 0.0, 0.7 * (G * flight - speed));
        }
        let s = f64::min(t - began, 1.0);
        out.push((height + speed * s - G / 2.0 * s * s).max(0.0));
    }
    out
}

/// Flights of twelve readings are 17.7 mm high. The last higher one is below that from 2.175 s on, the last higher than 16 times the noise of
/// 5 mm below 80 mm from 1.769 s on.
#[test]
fn a_record_ends_where_its_flights_become_short() {
    let heights = dropped(0.01, 4.0);
    let mut numbers = Numbers(5);
    let mut noise = |size: f64| size * f64::sqrt(3.0) * numbers.next();
    let readings = |error: &mut dyn FnMut(f64) -> f64| heights.iter().map(|y| error(*y)).collect();
    let cases: [(Vec<f64>, f64); 4] = [
        (heights.clone(), 2.175),
        (readings(&mut |y| (y * 1000.0).round() / 1000.0), 2.175),
        (readings(&mut |y| y + noise(0.001)), 2.175),
        (readings(&mut |y| y + noise(0.005)), 1.769),
    ];
    for (readings, ends) in cases {
        for (floor, above) in [("0", 0.0), ("h", 0.3)] {
            let readings = readings.iter().map(|y| y + above).collect();
            let problem = ball(floor, 0.01, readings);
            let [record] = &problem.records[..] else {
                panic!("{} records", problem.records.len());
            };
            let [rest] = &problem.rests[..] else {
                panic!("{:?}", problem.rests);
            };
            let last = record.time[record.len() - 1];
            assert!((last - ends).abs() < 0.025, "{last}, not {ends}");
            assert!(rest.time[0] > last && rest.time[0] < last + 0.011);
            assert!(rest.time[1] > 3.95, "{rest:?}");
        }
    }
}

/// Readings near the floor are no rest where the ball passes them, however slowly.
#[test]
fn a_ball_that_bounces_does_not_rest() {
    let mut noise = Numbers(7);
    for (step, draws) in [(1e-3, 20), (1e-4, 2)] {
        let flights = dropped(step, 1.2);
        for size in [0.0, 1e-3, 2e-3, 5e-3, 1e-2] {
            for _ in 0..draws {
                let readings = flights.iter().map(|y| y + size * noise.next()).collect();
                let problem = ball("0", step, readings);
                assert_eq!(problem.rests, [], "{size}");
            }
        }
    }
}

/// Whatever is held above an unknown floor does not lie on it.
#[test]
fn what_stands_still_above_the_floor_does_not_rest_on_it() {
    let mut heights = dropped(0.01, 1.0);
    let last = heights[heights.len() - 1];
    heights.extend([last; 100]);
    assert_eq!(ball("h", 0.01, heights).rests, []);
}
