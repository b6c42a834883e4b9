//! The pendulum on a cart, from two positions and the command, with the library of models/pendulum_positions.sid.
//!
//! In: nothing. Out: the cases. The motion is that of the program `plant`: ten seconds of held forces on a bounded track.

use super::case::{Case, Motion, Sensor};
use sidc_testing::integrate::{grid, integrate};
use sidc_testing::plants::cart_pendulum::{Plant, State};
use sidc_testing::plants::force::{Force, Kind};
use sidc_testing::random::Random;
use sidc_testing::table::Table;

const MODEL: &str = "system pendulum_on_cart
state y, theta : order 2
input F : hold
let trig = <1, sin theta, cos theta>
let motion = poly(dy, dtheta; 2) * <1, sin theta, cos theta, F>
ddy     ~ motion + ddtheta * trig
ddtheta ~ motion + ddy * trig
";
const ROWS: usize = 1001;
const STEP: f64 = 0.01;
/// Correlation between samples after a filter over three samples.
const FILTERED: f64 = 0.7;
/// Noise at level 1, in metres and radians.
const SIZES: (f64, f64) = (0.3, 1.0);

/// Cases with white noise, and with noise that is correlated over some samples, as after a filter.
pub fn cases() -> Vec<Case> {
    vec![
        cart_pendulum("cart_pendulum", 0.0),
        cart_pendulum("cart_pendulum_filtered", FILTERED),
    ]
}

fn cart_pendulum(name: &'static str, memory: f64) -> Case {
    let plant = Plant::default();
    let mut random = Random::new(1);
    let mut force = Force::draw(Kind::Track, ROWS, 1.0 / STEP, &mut random);
    let mut x: State = [0.0, 0.0, 1.2, 0.0];
    let mut table = Table::new(&["t", "y", "theta", "F"]);
    for (k, t) in grid(ROWS, STEP).into_iter().enumerate() {
        let f = force.at(k, &plant, &x);
        table.push(&[t, x[0], x[2], f]);
        x = integrate(&|_, x: &State| plant.derivative(x, f), 0.0, STEP, x);
    }
    let sensor = |column, size| Sensor {
        column,
        size,
        memory,
    };
    Case {
        name,
        model: MODEL.into(),
        laws: plant.laws().to_vec(),
        motion: Motion::Fixed(vec![table]),
        sensors: vec![sensor("y", SIZES.0), sensor("theta", SIZES.1)],
    }
}
