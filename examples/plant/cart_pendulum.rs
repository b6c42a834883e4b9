//! The cart-pendulum as physics gives it; θ = 0 hangs down.
//!
//!   (m+M) ÿ = F − c_c ẏ − m L θ̈ cos θ + m L θ̇² sin θ
//!   m L² θ̈ = −c_p θ̇ − m g L sin θ − m L ÿ cos θ

use clap::Args;

/// Masses, length and frictions; the defaults are the plant of the benchmark.
#[derive(Args, Clone, Debug)]
pub struct Plant {
    /// Mass of the cart, kg
    #[arg(long, default_value_t = 0.5)]
    pub cart: f64,
    /// Mass of the bob, kg
    #[arg(long, default_value_t = 0.275)]
    pub bob: f64,
    /// Length of the rod, m
    #[arg(long, default_value_t = 0.5)]
    pub rod: f64,
    /// Friction of the pivot, N m s
    #[arg(long, default_value_t = 0.01)]
    pub pivot_friction: f64,
    /// Friction of the track, N s/m
    #[arg(long, default_value_t = 0.05)]
    pub cart_friction: f64,
    /// Acceleration of gravity, m/s²
    #[arg(long, default_value_t = 9.8)]
    pub gravity: f64,
}

/// Position of the cart, its speed, angle of the rod, its speed.
pub type State = [f64; 4];

impl Plant {
    /// (ÿ, θ̈): both equations at once, a linear 2 × 2 system.
    pub fn accelerations(&self, x: &State, force: f64) -> (f64, f64) {
        let [_, dy, theta, dtheta] = *x;
        let (sin, cos) = theta.sin_cos();
        let ml = self.bob * self.rod;
        let mass = [[self.bob + self.cart, ml * cos], [ml * cos, ml * self.rod]];
        let right = [
            force - self.cart_friction * dy + ml * dtheta * dtheta * sin,
            -self.pivot_friction * dtheta - ml * self.gravity * sin,
        ];
        let det = mass[0][0] * mass[1][1] - mass[0][1] * mass[1][0];
        (
            (right[0] * mass[1][1] - mass[0][1] * right[1]) / det,
            (mass[0][0] * right[1] - right[0] * mass[1][0]) / det,
        )
    }

    pub fn derivative(&self, x: &State, force: f64) -> State {
        let (ddy, ddtheta) = self.accelerations(x, force);
        [x[1], ddy, x[3], ddtheta]
    }

    /// The force under which the cart accelerates by `ddy`: the rod's reaction is compensated, so that a controller
    /// may think of the cart's acceleration as its input.
    pub fn force_for(&self, x: &State, ddy: f64) -> f64 {
        let [_, dy, theta, dtheta] = *x;
        let (sin, cos) = theta.sin_cos();
        let ml = self.bob * self.rod;
        let ddtheta = (-self.pivot_friction * dtheta - ml * self.gravity * sin - ml * ddy * cos)
            / (ml * self.rod);
        (self.bob + self.cart) * ddy + self.cart_friction * dy + ml * ddtheta * cos
            - ml * dtheta * dtheta * sin
    }

    /// The equations in the form they are to be found in.
    pub fn equations(&self) -> [String; 2] {
        let total = self.bob + self.cart;
        let ml = self.bob * self.rod;
        [
            format!(
                "ddy = {}*F - {}*dy - {}*ddtheta*cos(theta) + {}*dtheta^2*sin(theta)",
                1.0 / total,
                self.cart_friction / total,
                ml / total,
                ml / total
            ),
            format!(
                "ddtheta = -{}*dtheta - {}*sin(theta) - {}*ddy*cos(theta)",
                self.pivot_friction / (ml * self.rod),
                self.gravity / self.rod,
                1.0 / self.rod
            ),
        ]
    }
}
