//! The table of units: symbols, prefixes, and the names that people write instead.
//!
//! In: one word. Out: what it is in SI base units. A word that is not here is a custom unit (`cells`, `USD`).
//! Source: the SI brochure, 9th edition (BIPM 2019), tables 2 to 8.

use std::f64::consts::PI;

use crate::thresholds::SPELLING;
use crate::units::exponent::Exponent;

/// A known unit.
pub(crate) struct Known {
    /// As it is printed.
    pub symbol: &'static str,
    /// Other spellings that mean the same.
    pub also: &'static [&'static str],
    /// Written-out names: not accepted, but offered as corrections.
    pub names: &'static [&'static str],
    /// Its size in SI base units.
    scale: f64,
    /// Exponents of kg, m, s, A, K, mol, cd.
    dimensions: [i8; 7],
    /// Takes prefixes.
    prefixed: bool,
    /// Replaces base units if that makes a coefficient's unit shorter.
    pub shortens: bool,
}

const BASE: [&str; 7] = ["kg", "m", "s", "A", "K", "mol", "cd"];

/// Prefixes, their powers of ten, and their names.
pub(crate) const PREFIXES: [(&str, i32, &str); 9] = [
    ("G", 9, "giga"),
    ("M", 6, "mega"),
    ("k", 3, "kilo"),
    ("c", -2, "centi"),
    ("m", -3, "milli"),
    ("µ", -6, "micro"),
    ("μ", -6, ""),
    ("u", -6, ""),
    ("n", -9, "nano"),
];

const fn known(
    symbol: &'static str,
    also: &'static [&'static str],
    names: &'static [&'static str],
    scale: f64,
    dimensions: [i8; 7],
) -> Known {
    Known {
        symbol,
        also,
        names,
        scale,
        dimensions,
        prefixed: false,
        shortens: false,
    }
}

impl Known {
    const fn prefixed(mut self) -> Known {
        self.prefixed = true;
        self
    }

    const fn shortens(mut self) -> Known {
        self.shortens = true;
        self
    }
}

const DIMENSIONLESS: [i8; 7] = [0; 7];
const TIME: [i8; 7] = [0, 0, 1, 0, 0, 0, 0];

/// In the order in which they are printed in a product. A frequency in Hz is 1/s; a speed in rpm is an angle per time.
#[rustfmt::skip]
pub(crate) static KNOWN: &[Known] = &[
    known("thousand", &[], &[], 1e3, DIMENSIONLESS),
    known("million", &[], &[], 1e6, DIMENSIONLESS),
    known("%", &[], &["percent"], 1e-2, DIMENSIONLESS),
    known("ppm", &[], &[], 1e-6, DIMENSIONLESS),
    known("N", &[], &["newton"], 1.0, [1, 1, -2, 0, 0, 0, 0]).prefixed().shortens(),
    known("Pa", &[], &["pascal"], 1.0, [1, -1, -2, 0, 0, 0, 0]).prefixed().shortens(),
    known("bar", &[], &[], 1e5, [1, -1, -2, 0, 0, 0, 0]).prefixed(),
    known("J", &[], &["joule"], 1.0, [1, 2, -2, 0, 0, 0, 0]).prefixed().shortens(),
    known("W", &[], &["watt"], 1.0, [1, 2, -3, 0, 0, 0, 0]).prefixed().shortens(),
    known("C", &[], &["coulomb"], 1.0, [0, 0, 1, 1, 0, 0, 0]).prefixed().shortens(),
    known("V", &[], &["volt"], 1.0, [1, 2, -3, -1, 0, 0, 0]).prefixed().shortens(),
    known("Ω", &["ohm", "Ohm", "\u{2126}"], &["ohms"], 1.0, [1, 2, -3, -2, 0, 0, 0]).prefixed().shortens(),
    known("F", &[], &["farad"], 1.0, [-1, -2, 4, 2, 0, 0, 0]).prefixed().shortens(),
    known("H", &[], &["henry"], 1.0, [1, 2, -2, -2, 0, 0, 0]).prefixed().shortens(),
    known("T", &[], &["tesla"], 1.0, [1, 0, -2, -1, 0, 0, 0]).prefixed().shortens(),
    known("kg", &[], &["kilogram"], 1.0, [1, 0, 0, 0, 0, 0, 0]),
    known("g", &[], &["gram"], 1e-3, [1, 0, 0, 0, 0, 0, 0]).prefixed(),
    known("mol", &[], &["mole"], 1.0, [0, 0, 0, 0, 0, 1, 0]).prefixed(),
    known("M", &[], &["molar"], 1e3, [0, -3, 0, 0, 0, 1, 0]).prefixed(),
    known("L", &["l"], &["litre", "liter"], 1e-3, [0, 3, 0, 0, 0, 0, 0]).prefixed(),
    known("m", &[], &["metre", "meter"], 1.0, [0, 1, 0, 0, 0, 0, 0]).prefixed(),
    known("A", &[], &["ampere", "amp"], 1.0, [0, 0, 0, 1, 0, 0, 0]).prefixed(),
    known("K", &[], &["kelvin"], 1.0, [0, 0, 0, 0, 1, 0, 0]).prefixed(),
    known("°C", &["degC", "\u{2103}"], &["celsius"], 1.0, [0, 0, 0, 0, 1, 0, 0]),
    known("cd", &[], &["candela"], 1.0, [0, 0, 0, 0, 0, 0, 1]).prefixed(),
    known("rad", &[], &["radian"], 1.0, DIMENSIONLESS).prefixed(),
    known("deg", &["°"], &["degree"], PI / 180.0, DIMENSIONLESS),
    known("rpm", &[], &[], PI / 30.0, [0, 0, -1, 0, 0, 0, 0]),
    known("Hz", &[], &["hertz"], 1.0, [0, 0, -1, 0, 0, 0, 0]).prefixed(),
    known("s", &[], &["second", "sec"], 1.0, TIME).prefixed(),
    known("min", &[], &["minute"], 60.0, TIME),
    known("h", &[], &["hour", "hr"], 3600.0, TIME),
    known("day", &["d"], &["days"], 86_400.0, TIME),
    known("year", &[], &["years", "yr"], 31_557_600.0, TIME),
];

/// Pairs that are written without a sign between them.
const PAIRS: [(&str, &str); 6] = [
    ("N", "m"),
    ("W", "h"),
    ("A", "h"),
    ("W", "s"),
    ("V", "s"),
    ("A", "s"),
];

/// Custom units are printed after the counts (`thousand pelts`), before everything else.
const CUSTOM_RANK: usize = 2;

/// One word of a unit, with its prefix; ordered as printed.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct Symbol {
    /// Place in [`KNOWN`], with one place for custom units between.
    rank: usize,
    /// As it is printed.
    pub text: String,
    /// The prefix's power of ten.
    ten: i32,
}

impl Symbol {
    /// A known unit, with a prefix or without.
    pub fn known(text: &str) -> Option<Symbol> {
        if let Some((rank, k)) = find(text) {
            return Some(Symbol::of(rank, k.symbol.into(), 0));
        }
        PREFIXES.iter().find_map(|(prefix, ten, _)| {
            let (rank, k) = find(text.strip_prefix(prefix)?)?;
            // Micro has one spelling in print; `kg` is an entry of the table itself.
            let prefix = if *ten == -6 { "µ" } else { prefix };
            let text = format!("{prefix}{}", k.symbol);
            k.prefixed.then(|| match find(&text) {
                Some((rank, same)) => Symbol::of(rank, same.symbol.into(), 0),
                None => Symbol::of(rank, text, *ten),
            })
        })
    }

    /// `Nm`, `kWh`: two units that are written as one word.
    pub fn pair(text: &str) -> Option<(Symbol, Symbol)> {
        PAIRS.iter().find_map(|(first, second)| {
            let before = text.strip_suffix(second)?;
            let fits = before.ends_with(first);
            Some((
                Symbol::known(before).filter(|_| fits)?,
                Symbol::known(second)?,
            ))
        })
    }

    /// A custom unit.
    pub fn custom(text: &str) -> Symbol {
        Symbol {
            rank: CUSTOM_RANK,
            text: text.into(),
            ten: 0,
        }
    }

    pub fn base(symbol: &'static str) -> Symbol {
        Symbol::known(symbol).unwrap_or_else(|| Symbol::custom(symbol))
    }

    fn of(place: usize, text: String, ten: i32) -> Symbol {
        let rank = if place < CUSTOM_RANK {
            place
        } else {
            place + 1
        };
        Symbol { rank, text, ten }
    }

    fn entry(&self) -> Option<&'static Known> {
        match self.rank {
            CUSTOM_RANK => None,
            place if place < CUSTOM_RANK => KNOWN.get(place),
            place => KNOWN.get(place - 1),
        }
    }

    /// In base units, without its scale; a custom unit is a base unit of its own.
    pub fn base_units(&self) -> Vec<(Symbol, Exponent)> {
        match self.entry() {
            None => vec![(self.clone(), Exponent::ONE)],
            Some(k) => k.base_units().collect(),
        }
    }

    /// log₁₀ of its size in its base units.
    pub fn scale(&self) -> f64 {
        self.entry()
            .map_or(0.0, |k| k.scale.log10() + f64::from(self.ten))
    }

    /// True of rad, which is 1 in the algebra and kept for the reader.
    pub fn is_angle(&self) -> bool {
        self.text == "rad"
    }
}

impl Known {
    /// Its SI base units with their exponents.
    pub fn base_units(&self) -> impl Iterator<Item = (Symbol, Exponent)> {
        let present = BASE.iter().zip(self.dimensions).filter(|(_, n)| *n != 0);
        present.filter_map(|(symbol, n)| Some((Symbol::base(symbol), Exponent::new(n.into(), 1)?)))
    }
}

fn find(text: &str) -> Option<(usize, &'static Known)> {
    KNOWN
        .iter()
        .enumerate()
        .find(|(_, k)| k.symbol == text || k.also.contains(&text))
}

/// The known unit that a custom one is probably a misspelling of: `Kg`, `meters`, `secnods`.
pub(crate) fn likely_meant(word: &str) -> Option<String> {
    let lower = word.to_lowercase();
    let prefixes = || PREFIXES.iter().filter(|(_, _, name)| !name.is_empty());
    for k in KNOWN {
        let spellings = k.also.iter().chain([&k.symbol]);
        for spelling in spellings.filter(|s| s.is_ascii()) {
            if lower == spelling.to_lowercase() {
                return Some(k.symbol.into());
            }
            let cased = prefixes()
                .filter(|_| k.prefixed)
                .find(|(p, ..)| lower == format!("{p}{spelling}").to_lowercase());
            if let Some((prefix, ..)) = cased {
                return Some(format!("{prefix}{}", k.symbol));
            }
        }
    }
    let named = |rest: &str| KNOWN.iter().find(|k| k.names.iter().any(|n| near(rest, n)));
    if let Some(k) = named(&lower) {
        return Some(k.symbol.into());
    }
    prefixes().find_map(|(prefix, _, name)| {
        let k = named(lower.strip_prefix(name)?).filter(|k| k.prefixed)?;
        Some(format!("{prefix}{}", k.symbol))
    })
}

fn near(word: &str, name: &str) -> bool {
    let one = word.strip_suffix('s').unwrap_or(word);
    let long = one.chars().count() >= SPELLING.unit_name && name.len() >= SPELLING.unit_name;
    word == name || one == name || long && strsim::damerau_levenshtein(one, name) <= SPELLING.edits
}
