//! How one equation depends on others, and the rules that make it a copy.
//!
//! In: a separation of gradients and the uncertainty of the equations. Out: yes or no. Never looks at samples.

use crate::redundancy::gradients::Separation;
use crate::redundancy::thresholds::{INDEPENDENT_LAW, REDUNDANCY};

/// How one equation of a dependent set depends on the others.
#[derive(Clone, Copy)]
pub(super) struct Dependence {
    pub separation: Separation,
    /// The joint uncertainty of all equations of the set, in units of this equation's target.
    pub uncertainty: f64,
}

impl Dependence {
    /// Two equations are one relation if their gradients are nearly parallel and the derivatives by the unknowns differ by no more
    /// than the uncertainty. Derivatives by other signals are not compared: a series for 1/cos θ is close to it, but steeper in
    /// places.
    pub fn is_same_relation(&self) -> bool {
        let a = &self.separation;
        a.condition >= REDUNDANCY.close
            && a.part <= REDUNDANCY.alike
            && a.of_unknowns <= REDUNDANCY.certain * self.uncertainty
    }

    /// A nearly singular mass matrix: the equations differ too little for the highest derivatives to be determined.
    fn uninformative(&self) -> bool {
        let a = &self.separation;
        a.condition >= REDUNDANCY.singular && a.of_unknowns <= REDUNDANCY.certain * self.uncertainty
    }

    pub fn is_dependent(&self) -> bool {
        self.is_same_relation() || self.uninformative()
    }

    /// By which factor the residual grows when the system is solved; `None` if the equation depends on the others.
    pub fn growth_if_independent(&self) -> Option<f64> {
        (self.separation.condition <= INDEPENDENT_LAW.condition && !self.is_dependent())
            .then_some(self.separation.growth)
    }
}
