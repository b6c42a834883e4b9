//! The unit of a coefficient as people write it: few symbols, derived units where they help.
//!
//! In: a quotient of units. Out: the same unit in other symbols; never another scale.

use crate::thresholds::UNITS;
use crate::units::unit::Unit;
use crate::units::unit_table::{KNOWN, Symbol};

impl Unit {
    /// `A/(V*s)` is `1/H`, `m/(N*s^2)` is `1/kg`. Radians are left out; symbols that are not SI base or derived units stay.
    pub(crate) fn shortened(self) -> Unit {
        let plain = self.without(|word| word.is_angle());
        if plain.is_torque() {
            return plain;
        }
        let mut best = plain.clone();
        if let Some((base, scale)) = plain.in_base()
            && scale.abs() <= UNITS.scale
        {
            consider(&mut best, candidates(&base));
        }
        // Symbols with a scale (kilonewtons, minutes) stay; the rest may still become shorter.
        let kept = plain.without(|word| word.scale() == 0.0);
        if let Some((base, _)) = plain.without(|word| word.scale() != 0.0).in_base() {
            let count = plain.factors.len();
            let with_kept = candidates(&base).into_iter();
            let fewer = with_kept.filter_map(|c| c.times(&kept));
            consider(
                &mut best,
                fewer.filter(|c| c.factors.len() < count).collect(),
            );
        }
        best
    }

    fn without(&self, leave: impl Fn(&Symbol) -> bool) -> Unit {
        let factors = self.factors.iter().filter(|(word, _)| !leave(word));
        Unit {
            factors: factors.map(|(w, p)| (w.clone(), *p)).collect(),
        }
    }

    /// True of `N*m`: a torque is not given in joules.
    fn is_torque(&self) -> bool {
        self.to_string() == "N*m"
    }

    /// Sum of the sizes of the exponents, then number of symbols.
    fn length(&self) -> (f64, usize) {
        let symbols = self.factors.values().map(|p| p.value().abs()).sum();
        (symbols, self.factors.len())
    }
}

/// The base units, and each derived unit to the power 1 or −1 with base units for the rest.
fn candidates(base: &Unit) -> Vec<Unit> {
    let mut all = vec![base.clone()];
    // A derived unit with a base unit that the coefficient lacks would add a dimension: m^2/s^2 is not J/kg.
    let within = |u: &Unit| u.factors.keys().all(|word| base.factors.contains_key(word));
    for k in KNOWN
        .iter()
        .filter(|k| k.shortens && within(&k.base_units().collect()))
    {
        for p in [1.0, -1.0] {
            let with = || {
                let rest = base.per(&k.base_units().collect::<Unit>().power(p)?)?;
                rest.times(&Unit::symbol(Symbol::base(k.symbol)).power(p)?)
            };
            all.extend(with());
        }
    }
    all
}

/// Replaces the best so far by each candidate that is shorter and has no more distinct symbols.
fn consider(best: &mut Unit, candidates: Vec<Unit>) {
    for c in candidates {
        if c.length() < best.length() && c.factors.len() <= best.factors.len() {
            *best = c;
        }
    }
}
