//! The unit of a coefficient as people write it: the fewest symbols, derived names where they help.
//!
//! In: a quotient of units. Out: the same unit in other words; never another scale.

use super::table::{KNOWN, Word};
use super::{SAME_SCALE, Unit};

impl Unit {
    /// `A/(V*s)` is `1/H`, `m/(N*s^2)` is `1/kg`. Angles in rad are left out; words whose scale is not SI's stay.
    pub(super) fn shortened(self) -> Unit {
        let plain = self.without(|word| word.is_angle());
        if plain.is_torque() {
            return plain;
        }
        let mut best = plain.clone();
        if let Some((base, scale)) = plain.in_base()
            && scale.abs() <= SAME_SCALE
        {
            consider(&mut best, candidates(&base));
        }
        // Kilonewtons, minutes and the like stand as they are; the rest may still say itself shorter.
        let kept = plain.without(|word| word.scale() == 0.0);
        if let Some((base, _)) = plain.without(|word| word.scale() != 0.0).in_base() {
            let count = plain.words.len();
            let with_kept = candidates(&base).into_iter();
            let fewer = with_kept.filter_map(|c| c.times(&kept));
            consider(&mut best, fewer.filter(|c| c.words.len() < count).collect());
        }
        best
    }

    fn without(&self, leave: impl Fn(&Word) -> bool) -> Unit {
        let words = self.words.iter().filter(|(word, _)| !leave(word));
        Unit {
            words: words.map(|(w, p)| (w.clone(), *p)).collect(),
        }
    }

    /// `N*m` is no energy to those who wrote it.
    fn is_torque(&self) -> bool {
        self.to_string() == "N*m"
    }

    /// Symbols to read, powers counted; then words.
    fn length(&self) -> (f64, usize) {
        let symbols = self.words.values().map(|p| p.value().abs()).sum();
        (symbols, self.words.len())
    }
}

/// Base units, or one derived unit above or below the line with base units for the rest.
fn candidates(base: &Unit) -> Vec<Unit> {
    let mut all = vec![base.clone()];
    // A derived unit that brings in a base unit of its own says more than the coefficient does: m^2/s^2 is not J/kg.
    let within = |u: &Unit| u.words.keys().all(|word| base.words.contains_key(word));
    for k in KNOWN.iter().filter(|k| k.shortens && within(&k.in_base())) {
        for p in [1.0, -1.0] {
            let with = || {
                let rest = base.per(&k.in_base().power(p)?)?;
                rest.times(&k.unit().power(p)?)
            };
            all.extend(with());
        }
    }
    all
}

/// The first that is shorter than all before it, and has no more words.
fn consider(best: &mut Unit, candidates: Vec<Unit>) {
    for c in candidates {
        if c.length() < best.length() && c.words.len() <= best.words.len() {
            *best = c;
        }
    }
}
