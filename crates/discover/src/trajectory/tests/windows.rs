//! States of records that are swept again, window by window.

use super::{CART, named, system};
use crate::trajectory::integration::CompiledLaws;
use crate::trajectory::least_squares::IncrementalQr;
use crate::trajectory::likelihood::EliminatedRecords;
use crate::trajectory::model::{LinearizationPoint, Problem};
use sidc_data::{Dataset, Trajectory};
use sidc_progress::Unwatched;
use sidc_random::Numbers;

/// Two runs of the cart, of which only the places are read.
pub(crate) fn cart_runs(lengths: [usize; 2]) -> Problem {
    let system = system(CART);
    let mut numbers = Numbers(3);
    let mut run = |length: usize| {
        let time: Vec<f64> = (0..length).map(|k| 0.02 * k as f64).collect();
        let mut read = |w: f64| -> Vec<f64> {
            let read = time.iter().map(|t| (w * t).sin() + 0.01 * numbers.next());
            read.collect()
        };
        let signals = [system.states[0], system.states[2], system.exogenous[0]];
        Trajectory {
            name: String::new(),
            file: 0,
            columns: signals
                .into_iter()
                .zip([1.0, 2.3, 0.7].map(&mut read))
                .collect(),
            time,
        }
    };
    let dataset = Dataset {
        trajectories: lengths.map(&mut run).into(),
        ..Dataset::default()
    };
    Problem::new(system, &dataset, &|_| None, false).unwrap()
}

#[test]
fn windows_swept_again_give_the_states_of_whole_records() {
    for memory in [Vec::new(), vec![0.03, 0.0, 0.05, 0.0]] {
        check_windows(memory);
    }
}

/// With noise of the sensors that lasts so long, state by state.
fn check_windows(memory: Vec<f64>) {
    let mut problem = cart_runs([300, 129]);
    for record in &mut problem.records {
        record.noise_time_constant.clone_from(&memory);
    }
    let laws: [(usize, &[&str]); 4] = [(0, &["1"]), (0, &["6"]), (1, &["2"]), (1, &["4"])];
    let point = LinearizationPoint {
        support: named(&problem.system, &laws),
        coefficients: vec![-0.5, 1.3, -0.4, -0.9],
        ..problem.initial_point(&problem.noise)
    };
    let code = CompiledLaws::new(&problem.system, &point.support);
    let states = |window| {
        let mut qr = IncrementalQr::new(point.support.len());
        let of = (&problem, &code);
        let all = EliminatedRecords::in_windows(of, &point, window, &mut qr, &mut Unwatched);
        all.unwrap()
            .states(&[0.3, -0.2, 0.1, 0.4], &mut Unwatched)
            .unwrap()
    };
    let whole = states(None);
    assert_eq!(whole.iter().map(Vec::len).collect::<Vec<_>>(), [1200, 516]);
    assert!(whole.iter().flatten().all(|x| x.is_finite()));
    // A last window of one sample, of one interval, of many.
    for window in [64, 128, 256] {
        assert_eq!(states(Some(window)), whole, "{window}");
    }
}
