//! The algebra of units: products, quotients, powers, comparison.
//!
//! In: symbols with exponents. Out: units, or nothing beyond the limits of exponents. Converts no value: a unit says what a number
//! is counted in, and the number stays what it is.

use std::collections::BTreeMap;
use std::fmt::{Display, Formatter};

use crate::thresholds::UNITS;
use crate::units::exponent::Exponent;
use crate::units::unit_table::Symbol;

/// A product of powers of symbols, each once, in the order in which they are printed; empty is the pure number 1.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Unit {
    pub(crate) factors: BTreeMap<Symbol, Exponent>,
}

/// Whether two units measure the same kind of quantity, and in which ratio.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Commensurability {
    Same,
    /// The same kind of quantity; one of the first is this many of the second.
    Scaled(f64),
    Different,
}

impl Unit {
    /// The unit of pure numbers.
    pub fn one() -> Unit {
        Unit::default()
    }

    /// The unit of time if none is declared.
    pub fn second() -> Unit {
        Unit::symbol(Symbol::base("s"))
    }

    pub(crate) fn symbol(symbol: Symbol) -> Unit {
        Unit {
            factors: BTreeMap::from([(symbol, Exponent::ONE)]),
        }
    }

    /// The product; `None` if an exponent is beyond its limits.
    pub fn times(&self, other: &Unit) -> Option<Unit> {
        let mut out = self.clone();
        for (symbol, power) in &other.factors {
            let sum = match out.factors.get(symbol) {
                Some(before) => before.plus(*power)?,
                None => *power,
            };
            if sum.is_zero() {
                out.factors.remove(symbol);
            } else {
                out.factors.insert(symbol.clone(), sum);
            }
        }
        Some(out)
    }

    /// The quotient; `None` if an exponent is beyond its limits.
    pub fn per(&self, other: &Unit) -> Option<Unit> {
        self.times(&other.inverse())
    }

    /// `self^p`; `None` if `p` is not a small fraction.
    pub fn power(&self, p: f64) -> Option<Unit> {
        self.raised(Exponent::nearest(p)?)
    }

    pub(crate) fn raised(&self, p: Exponent) -> Option<Unit> {
        if p.is_zero() {
            return Some(Unit::one());
        }
        let factors = self.factors.iter();
        let factors: Option<BTreeMap<Symbol, Exponent>> = factors
            .map(|(symbol, power)| Some((symbol.clone(), power.times(p)?)))
            .collect();
        Some(Unit { factors: factors? })
    }

    fn inverse(&self) -> Unit {
        let factors = self.factors.iter();
        Unit {
            factors: factors.map(|(w, p)| (w.clone(), p.negated())).collect(),
        }
    }

    /// True of the pure number. False for `rad`, which is a symbol like others.
    pub fn is_one(&self) -> bool {
        self.factors.is_empty()
    }

    /// The unit in SI base units and custom ones, and the decimal logarithm of its scale in them. Radians become 1.
    pub(crate) fn in_base(&self) -> Option<(Unit, f64)> {
        let (mut base, mut scale) = (Unit::one(), 0.0);
        for (symbol, power) in &self.factors {
            let base_units: Unit = symbol.base_units().into_iter().collect();
            base = base.times(&base_units.raised(*power)?)?;
            scale += power.value() * symbol.scale();
        }
        Some((base, scale))
    }

    /// Whether it is a number without a unit, or an angle in rad: what sines and exponentials take.
    pub fn is_pure_number(&self) -> bool {
        self.commensurability(&Unit::one()) == Commensurability::Same
    }

    /// Whether numbers in the two units may be added, with or without a conversion.
    pub fn commensurability(&self, other: &Unit) -> Commensurability {
        let (Some((a, k)), Some((b, l))) = (self.in_base(), other.in_base()) else {
            return Commensurability::Different;
        };
        if a != b {
            Commensurability::Different
        } else if (k - l).abs() <= UNITS.scale {
            Commensurability::Same
        } else {
            Commensurability::Scaled(10f64.powf(k - l))
        }
    }
}

impl FromIterator<(Symbol, Exponent)> for Unit {
    /// From distinct symbols with nonzero exponents.
    fn from_iter<I: IntoIterator<Item = (Symbol, Exponent)>>(factors: I) -> Unit {
        Unit {
            factors: factors.into_iter().collect(),
        }
    }
}

/// As text that [`super::parse`] reads back: `kg*m/s^2`, `1/(N*m)`, `m^0.5`, `1`.
impl Display for Unit {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let (mut above, mut below) = (Vec::new(), Vec::new());
        for (symbol, power) in &self.factors {
            if power.is_negative() {
                below.push(factor(&symbol.text, power.negated()));
            } else {
                above.push(factor(&symbol.text, *power));
            }
        }
        match above.is_empty() {
            true => f.write_str("1")?,
            false => f.write_str(&above.join("*"))?,
        }
        match below.as_slice() {
            [] => Ok(()),
            [one] => write!(f, "/{one}"),
            many => write!(f, "/({})", many.join("*")),
        }
    }
}

fn factor(symbol: &str, power: Exponent) -> String {
    if power == Exponent::ONE {
        symbol.into()
    } else {
        format!("{symbol}^{power}")
    }
}
