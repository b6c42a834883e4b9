//! Kinds of coupled mechanisms, with random masses, lengths, springs and frictions.
//!
//! In: a family, random numbers. Out: a mechanism with the names of its coordinates. Angles are absolute, so that every M_ii is constant
//! and each law can be solved for its own acceleration.

use super::lagrange::{Mass, Mechanism};
use crate::random::{Random, decimals};

/// A kind of mechanism.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Family {
    /// A cart with a double pendulum
    CartChain,
    /// A cart with two pendulums side by side
    Twins,
    /// A double pendulum on a fixed pivot
    Links,
    /// A triple pendulum on a fixed pivot
    ThreeLinks,
    /// A link that two pendulums hang from
    Fork,
    /// A cart that rides on a cart and carries a pendulum
    CartOnCart,
    /// Two carts joined by a spring, each with a pendulum
    TwoCarts,
    /// Three pendulums joined by springs
    Springs,
    /// A cart with a pendulum
    Cart,
    /// A pendulum, driven at its pivot: one law
    Pendulum,
}

pub const FAMILIES: [Family; 10] = [
    Family::CartChain,
    Family::Twins,
    Family::Links,
    Family::ThreeLinks,
    Family::Fork,
    Family::CartOnCart,
    Family::TwoCarts,
    Family::Springs,
    Family::Cart,
    Family::Pendulum,
];

impl Family {
    pub fn name(self) -> &'static str {
        match self {
            Family::CartChain => "cart with two links",
            Family::Twins => "cart with two pendulums",
            Family::Links => "two links",
            Family::ThreeLinks => "three links",
            Family::Fork => "fork of three links",
            Family::CartOnCart => "cart on a cart",
            Family::TwoCarts => "two carts",
            Family::Springs => "sprung pendulums",
            Family::Cart => "cart with a pendulum",
            Family::Pendulum => "pendulum",
        }
    }

    /// The names of the coordinates: positions on a track, and angles.
    pub fn coordinates(self) -> &'static [&'static str] {
        match self {
            Family::CartChain | Family::Twins => &["x", "th1", "th2"],
            Family::Links => &["th1", "th2"],
            Family::Cart => &["x", "th1"],
            Family::Pendulum => &["th1"],
            Family::ThreeLinks | Family::Fork | Family::Springs => &["th1", "th2", "th3"],
            Family::CartOnCart => &["x1", "x2", "th1"],
            Family::TwoCarts => &["x1", "x2", "th1", "th2"],
        }
    }

    pub fn mechanism(self, random: &mut Random) -> Mechanism {
        let mut build = Builder {
            made: Mechanism::default(),
            random,
        };
        match self {
            Family::CartChain => build.on_a_cart(&[&[1], &[1, 2]]),
            Family::Twins => build.on_a_cart(&[&[1], &[2]]),
            Family::Links => build.tree(&[&[0], &[0, 1]]),
            Family::ThreeLinks => build.tree(&[&[0], &[0, 1], &[0, 1, 2]]),
            Family::Fork => build.tree(&[&[0], &[0, 1], &[0, 2]]),
            Family::CartOnCart => build.cart_on_cart(),
            Family::TwoCarts => build.two_carts(),
            Family::Springs => build.springs(),
            Family::Cart => build.on_a_cart(&[&[1]]),
            Family::Pendulum => build.tree(&[&[0]]),
        }
        build.made
    }
}

struct Builder<'a> {
    made: Mechanism,
    random: &'a mut Random,
}

impl Builder<'_> {
    /// Rounded to three decimals, as on a data sheet.
    fn uniform(&mut self, low: f64, high: f64) -> f64 {
        decimals(self.random.uniform(low, high), 3)
    }

    fn even_odds(&mut self) -> bool {
        self.random.unit() < 0.5
    }

    fn mass(&mut self, carts: &[usize], rods: &[(usize, f64)]) {
        let mass = self.uniform(0.15, 0.8);
        let (carts, rods) = (carts.to_vec(), rods.to_vec());
        self.made.masses.push(Mass { mass, carts, rods });
    }

    fn damper(&mut self, range: (f64, f64), of: &[(usize, f64)]) {
        let friction = self.uniform(range.0, range.1);
        self.made.dampers.push((friction, of.to_vec()));
    }

    fn spring(&mut self, range: (f64, f64), of: &[(usize, f64)]) {
        let stiffness = self.uniform(range.0, range.1);
        self.made.springs.push((stiffness, of.to_vec()));
    }

    /// Bobs at the ends of `paths` of links, on `carts`. In half of the draws rods have a mass of their own; in half of them the friction
    /// of a joint acts between two links.
    fn hang(&mut self, carts: &[usize], paths: &[&[usize]]) {
        let lengths: Vec<f64> = (0..4).map(|_| self.uniform(0.25, 0.7)).collect();
        let (heavy, relative) = (self.even_odds(), self.even_odds());
        for path in paths {
            let rods: Vec<(usize, f64)> = path.iter().map(|i| (*i, lengths[*i % 4])).collect();
            self.mass(carts, &rods);
            let Some((own, before)) = path.split_last() else {
                continue;
            };
            if heavy {
                let inertia = self.uniform(0.002, 0.02);
                self.made.inertias.push((*own, inertia));
            }
            let joint = match before.last() {
                Some(b) if relative => vec![(*own, 1.0), (*b, -1.0)],
                _ => vec![(*own, 1.0)],
            };
            self.damper((0.005, 0.03), &joint);
        }
    }

    /// On a fixed pivot; a motor turns the first link, sometimes the last one too.
    fn tree(&mut self, paths: &[&[usize]]) {
        self.hang(&[], paths);
        self.made.inputs = vec![0];
        if paths.len() > 1 && self.even_odds() {
            self.made.inputs.push(paths.len() - 1);
        }
    }

    fn cart(&mut self, carts: &[usize], own: usize) {
        self.mass(carts, &[]);
        self.damper((0.03, 0.3), &[(own, 1.0)]);
    }

    /// Links on one cart, which a spring holds in half of the draws.
    fn on_a_cart(&mut self, paths: &[&[usize]]) {
        self.cart(&[0], 0);
        self.hang(&[0], paths);
        if self.even_odds() {
            self.spring((0.5, 4.0), &[(0, 1.0)]);
        }
        self.made.inputs = vec![0];
    }

    fn cart_on_cart(&mut self) {
        self.cart(&[0], 0);
        self.cart(&[0, 1], 1);
        self.hang(&[0, 1], &[&[2]]);
        self.spring((0.5, 4.0), &[(0, 1.0)]);
        self.spring((0.5, 4.0), &[(1, 1.0)]);
        self.made.inputs = vec![0];
        if self.even_odds() {
            self.made.inputs.push(1);
        }
    }

    fn two_carts(&mut self) {
        self.cart(&[0], 0);
        self.cart(&[1], 1);
        self.hang(&[0], &[&[2]]);
        self.hang(&[1], &[&[3]]);
        self.spring((0.5, 6.0), &[(0, 1.0), (1, -1.0)]);
        self.damper((0.02, 0.2), &[(0, 1.0), (1, -1.0)]);
        self.made.inputs = vec![0];
    }

    fn springs(&mut self) {
        self.hang(&[], &[&[0], &[1], &[2]]);
        self.spring((0.1, 1.0), &[(0, 1.0), (1, -1.0)]);
        self.spring((0.1, 1.0), &[(1, 1.0), (2, -1.0)]);
        self.made.inputs = vec![0];
    }
}
