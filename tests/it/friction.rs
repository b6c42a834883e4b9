//! Friction that sticks: identified from positions or rates under voltages that reverse.

use crate::disturbed::identify;
use sidc_testing::integrate::{grid, integrate};
use sidc_testing::random::Random;

#[test]
fn a_motor_with_dry_friction_settles() {
    // Draws in which an event changes its interval at every full step.
    for seed in [7, 13, 16] {
        let mut random = Random::new(seed);
        let (mut state, mut volts) = ([0.0, 0.0], 0.0);
        let mut text = String::from("t,i,w,V\n");
        for (k, t) in grid(2000, 2e-3).into_iter().enumerate() {
            if k % 100 == 0 {
                volts = random.uniform(-12.0, 12.0);
            }
            let read = [
                state[0] + 0.04 * random.normal(),
                state[1] + 0.3 * random.normal(),
            ];
            text += &format!("{t},{},{},{volts}\n", read[0], read[1]);
            let law = |_: f64, &[i, w]: &[f64; 2]| {
                [
                    (volts - 1.2 * i - 0.05 * w) / 0.003,
                    250.0 * i - 0.5 * w - 100.0 * (w / 0.01).tanh(),
                ]
            };
            state = integrate(&law, t, t + 2e-3, state);
        }
        let model = "state i, w\ninput V : hold\ndi ~ <1, i, w, V>\ndw ~ <1, i, w, V, sign w>\n";
        let (run, found) = identify(model, &text, &[]);
        assert!(run.stdout.contains("law: passes"), "{}", run.stdout);
        let count = |k: usize| found["equations"][k]["terms"].as_array().unwrap().len();
        assert_eq!((count(0), count(1)), (3, 3), "{}", run.stdout);
    }
}
