//! The two controllers of the experiment: balance the rod upright, and swing it up.
//!
//! Both ask for an acceleration of the cart, which [`Plant::force_for`] turns into a force.

use super::cart_pendulum::{Plant, State};
use std::f64::consts::{PI, TAU};

/// Largest acceleration asked for while swinging up, m/s².
const SWING: f64 = 8.0;

/// Angle from upright, in (−π, π].
fn from_upright(theta: f64) -> f64 {
    theta - PI - TAU * ((theta - PI) / TAU).round()
}

/// Linear state feedback that balances the rod, all four poles at −`pole`.
///
/// Near upright, with φ = θ − π, w² = g/L and a = ÿ: φ̈ = w²φ + a/L. Feedback a = k₁y + k₂ẏ + k₃φ + k₄φ̇ has the
/// characteristic polynomial s⁴ − (k₂ + k₄/L)s³ − (w² + k₁ + k₃/L)s² + k₂w²s + k₁w², which is set to (s + p)⁴.
fn balance(plant: &Plant, x: &State, pole: f64) -> f64 {
    let w2 = plant.gravity / plant.rod;
    let (a3, a2, a1, a0) = (
        4.0 * pole,
        6.0 * pole.powi(2),
        4.0 * pole.powi(3),
        pole.powi(4),
    );
    let k1 = a0 / w2;
    let k2 = a1 / w2;
    let k3 = -plant.rod * (a2 + w2 + k1);
    let k4 = -plant.rod * (a3 + k2);
    k1 * x[0] + k2 * x[1] + k3 * from_upright(x[2]) + k4 * x[3]
}

/// Force that balances the rod.
pub fn stabilise(plant: &Plant, x: &State) -> f64 {
    plant.force_for(x, balance(plant, x, 3.0))
}

/// Force that pumps energy into the rod until it is upright (Åström, Furuta, Automatica 36, 2000), then balances it.
pub fn swing_up(plant: &Plant, x: &State) -> f64 {
    let [y, dy, theta, dtheta] = *x;
    let w2 = plant.gravity / plant.rod;
    let angle = from_upright(theta);
    // The rod is caught where the unstable mode φ + φ̇/w is small: it alone decides whether the rod falls.
    if angle.abs() < 0.5 && (angle + dtheta / w2.sqrt()).abs() < 0.2 {
        return stabilise(plant, x);
    }
    // Energy over m L², zero for a rod at rest upright; a little more is asked for, since friction in the pivot takes some of it.
    let energy = 0.5 * dtheta * dtheta - w2 * (theta.cos() + 1.02);
    // d(energy)/dt = −a θ̇ cos θ / L. A weak spring and damper keep the cart on its track.
    let pump = (2.0 * energy * (dtheta * theta.cos()).signum()).clamp(-SWING, SWING);
    plant.force_for(x, pump - 2.0 * y - 2.0 * dy)
}
