//! Units as an algebra: texts such as `kg*m/s^2` multiplied, divided, raised to powers, compared, made short.
//!
//! In: texts, and terms whose signals have units. Out: units, or nothing where one is unknown. Converts no value: a unit says
//! what a number is counted in, and the number stays what it is.

mod parse;
mod power;
mod print;
mod shorten;
mod table;
mod terms;

use std::collections::BTreeMap;

pub use parse::{Fault, Suspect, parse};
pub use power::Power;
pub use terms::{coefficient, derivative, of_term};

use table::Word;

/// A product of powers of words, each once, in the order of print; empty is the pure number 1.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Unit {
    words: BTreeMap<Word, Power>,
}

/// How two units stand to each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Likeness {
    Same,
    /// The same kind of quantity; one of the first is so many of the second.
    Scaled(f64),
    Different,
}

/// Difference of logarithms within which two scales are one.
const SAME_SCALE: f64 = 1e-9;

impl Unit {
    /// The pure number.
    pub fn one() -> Unit {
        Unit::default()
    }

    /// What `t` is counted in where nothing else is said.
    pub fn second() -> Unit {
        Unit::word(Word::base("s"))
    }

    fn word(word: Word) -> Unit {
        Unit {
            words: BTreeMap::from([(word, Power::ONE)]),
        }
    }

    /// The product; `None` beyond the limits of [`Power`].
    pub fn times(&self, other: &Unit) -> Option<Unit> {
        let mut out = self.clone();
        for (word, power) in &other.words {
            let sum = match out.words.get(word) {
                Some(before) => before.plus(*power)?,
                None => *power,
            };
            if sum.is_zero() {
                out.words.remove(word);
            } else {
                out.words.insert(word.clone(), sum);
            }
        }
        Some(out)
    }

    /// The quotient; `None` beyond the limits of [`Power`].
    pub fn per(&self, other: &Unit) -> Option<Unit> {
        self.times(&other.inverse())
    }

    /// `self^p`; `None` if `p` is no small fraction.
    pub fn power(&self, p: f64) -> Option<Unit> {
        self.raised(Power::of(p)?)
    }

    fn raised(&self, p: Power) -> Option<Unit> {
        if p.is_zero() {
            return Some(Unit::one());
        }
        let words = self.words.iter();
        let words: Option<BTreeMap<Word, Power>> = words
            .map(|(word, power)| Some((word.clone(), power.times(p)?)))
            .collect();
        Some(Unit { words: words? })
    }

    fn inverse(&self) -> Unit {
        let words = self.words.iter();
        Unit {
            words: words.map(|(w, p)| (w.clone(), p.negated())).collect(),
        }
    }

    /// True if no word is left; `rad` is one.
    pub fn is_one(&self) -> bool {
        self.words.is_empty()
    }

    /// In SI base units and words of their own, and the logarithm to base 10 of how many of these one is. Angles in rad vanish.
    fn in_base(&self) -> Option<(Unit, f64)> {
        let (mut base, mut scale) = (Unit::one(), 0.0);
        for (word, power) in &self.words {
            base = base.times(&word.in_base().raised(*power)?)?;
            scale += power.value() * word.scale();
        }
        Some((base, scale))
    }

    /// Whether numbers in the two may be added as they are.
    pub fn likeness(&self, other: &Unit) -> Likeness {
        let (Some((a, k)), Some((b, l))) = (self.in_base(), other.in_base()) else {
            return Likeness::Different;
        };
        if a != b {
            Likeness::Different
        } else if (k - l).abs() <= SAME_SCALE {
            Likeness::Same
        } else {
            Likeness::Scaled(10f64.powf(k - l))
        }
    }
}
