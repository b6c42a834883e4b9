//! The cart-pendulum as physics gives it; θ = 0 hangs down.
//!
//!   (m+M) ÿ = F − c_c ẏ − m L θ̈ cos θ + m L θ̇² sin θ
//!   m L² θ̈ = −c_p θ̇ − m g L sin θ − m L ÿ cos θ

use clap::Args;

/// A target and the terms that make it up, each with its coefficient.
pub type Law = (&'static str, Vec<(&'static str, f64)>);

/// Masses, length and frictions; the defaults are the plant of the benchmark.
#[derive(Args, Clone, Debug)]
pub struct Plant {
    /// Mass of the cart, kg
    #[arg(long, default_value_t = Plant::default().cart)]
    pub cart: f64,
    /// Mass of the bob, kg
    #[arg(long, default_value_t = Plant::default().bob)]
    pub bob: f64,
    /// Length of the rod, m
    #[arg(long, default_value_t = Plant::default().rod)]
    pub rod: f64,
    /// Friction of the pivot, N m s
    #[arg(long, default_value_t = Plant::default().pivot_friction)]
    pub pivot_friction: f64,
    /// Friction of the track, N s/m
    #[arg(long, default_value_t = Plant::default().cart_friction)]
    pub cart_friction: f64,
    /// Acceleration of gravity, m/s²
    #[arg(long, default_value_t = Plant::default().gravity)]
    pub gravity: f64,
}

/// Position of the cart, its speed, angle of the rod, its speed.
pub type State = [f64; 4];

impl Default for Plant {
    fn default() -> Self {
        Plant {
            cart: 0.5,
            bob: 0.275,
            rod: 0.5,
            pivot_friction: 0.01,
            cart_friction: 0.05,
            gravity: 9.8,
        }
    }
}

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

    /// The force under which the cart accelerates by `ddy`: the rod's reaction is compensated, so that a controller can use the cart's
    /// acceleration as its input.
    pub fn force_for(&self, x: &State, ddy: f64) -> f64 {
        let [_, dy, theta, dtheta] = *x;
        let (sin, cos) = theta.sin_cos();
        let ml = self.bob * self.rod;
        let ddtheta = (-self.pivot_friction * dtheta - ml * self.gravity * sin - ml * ddy * cos)
            / (ml * self.rod);
        (self.bob + self.cart) * ddy + self.cart_friction * dy + ml * ddtheta * cos
            - ml * dtheta * dtheta * sin
    }

    /// The equations in the form in which they are to be found; terms are spelled as sidc prints them.
    pub fn laws(&self) -> [Law; 2] {
        let total = self.bob + self.cart;
        let ml = self.bob * self.rod;
        let cart = vec![
            ("F", 1.0 / total),
            ("dy", -self.cart_friction / total),
            ("ddtheta*cos(theta)", -ml / total),
            ("dtheta^2*sin(theta)", ml / total),
        ];
        let rod = vec![
            ("dtheta", -self.pivot_friction / (ml * self.rod)),
            ("sin(theta)", -self.gravity / self.rod),
            ("ddy*cos(theta)", -1.0 / self.rod),
        ];
        [("ddy", cart), ("ddtheta", rod)]
    }

    /// The laws as text.
    pub fn equations(&self) -> [String; 2] {
        self.laws().map(|(target, terms)| {
            let mut text = format!("{target} =");
            for (i, (term, c)) in terms.iter().enumerate() {
                text += match (i, *c < 0.0) {
                    (0, true) => " -",
                    (0, false) => " ",
                    (_, true) => " - ",
                    (_, false) => " + ",
                };
                text += &format!("{}*{term}", c.abs());
            }
            text
        })
    }
}
