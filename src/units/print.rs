//! A unit as text that [`super::parse`] reads back: `kg*m/s^2`, `1/(N*m)`, `m^0.5`, `1`.

use std::fmt::{Display, Formatter, Result};

use super::{Power, Unit};

impl Display for Unit {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let (mut above, mut below) = (Vec::new(), Vec::new());
        for (word, power) in &self.words {
            if power.is_negative() {
                below.push(factor(&word.text, power.negated()));
            } else {
                above.push(factor(&word.text, *power));
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

fn factor(word: &str, power: Power) -> String {
    if power == Power::ONE {
        word.into()
    } else {
        format!("{word}^{power}")
    }
}
