//! Chooses the atoms of a library: those of the law, and others.
//!
//! In: a system, a law, a size. Out: atoms; the library has all products of their powers 0, 1 and 2.

use sidc_testing::plants::coupled::{Coupled, Factor, Law};
use sidc_testing::random::Random;

/// Highest power of an atom.
pub const POWER: usize = 2;

/// The number of atoms of a library.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Size {
    /// Those of the law, and no others.
    Own,
    /// This many: those of the law, then others at random.
    Atoms(usize),
}

pub struct Library {
    pub atoms: Vec<Factor>,
}

impl Library {
    pub fn new(system: &Coupled, law: &Law, size: Size, seed: u64) -> Library {
        let mut own: Vec<Factor> = law.terms.iter().flat_map(|(m, _)| m.clone()).collect();
        own.sort_unstable();
        own.dedup();
        let mut others = every(system, law.coordinate);
        others.retain(|f| !own.contains(f));
        let mut random = Random::new(40_000 + seed);
        for k in (1..others.len()).rev() {
            others.swap(k, random.whole(0, k));
        }
        let most = match size {
            Size::Own => 0,
            Size::Atoms(n) => n,
        };
        own.extend(others.into_iter().take(most.saturating_sub(own.len())));
        own.sort_unstable();
        Library { atoms: own }
    }

    /// The index of a term, from its powers as digits; `None` if an atom or power is missing.
    pub fn place(&self, monomial: &[Factor]) -> Option<usize> {
        let count = |f: &Factor| monomial.iter().filter(|g| *g == f).count();
        let powers: Vec<usize> = self.atoms.iter().map(count).collect();
        let complete = powers.iter().sum::<usize>() == monomial.len();
        let digits = powers.iter().fold(0, |n, p| n * (POWER + 1) + p);
        (complete && powers.iter().all(|p| *p <= POWER)).then_some(digits)
    }
}

/// All atoms that a law may contain.
fn every(system: &Coupled, target: usize) -> Vec<Factor> {
    let mut all = Vec::new();
    for i in 0..system.coordinates() {
        all.extend([Factor::Position(i), Factor::Speed(i)]);
        if i != target {
            all.push(Factor::Acceleration(i));
        }
        if system.is_angle(i) {
            all.extend([Factor::Sin(i), Factor::Cos(i)]);
        }
    }
    all.extend((0..system.inputs()).map(Factor::Input));
    all
}
