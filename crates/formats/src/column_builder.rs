//! The values of one column, gathered batch by batch, and what they mean.

use crate::timestamps::{from_first, scaled};
use crate::variables::Content;
use sidc_data::Words;

/// What whole numbers and bytes stand for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Meaning {
    /// Numbers, of this unit.
    Number(f64),
    #[cfg(all(feature = "parquet", panic = "unwind"))]
    Unsigned,
    #[cfg(all(feature = "parquet", panic = "unwind"))]
    Half,
    /// Times, in units of this many seconds.
    Moment(f64),
    Text,
}

/// A column so far.
pub(crate) struct ColumnBuilder {
    meaning: Meaning,
    numbers: Vec<f64>,
    /// `i64::MIN` stands for a missing value.
    moments: Vec<i64>,
    words: Words,
}

impl ColumnBuilder {
    #[cfg(all(feature = "parquet", panic = "unwind"))]
    pub(crate) fn meaning(&self) -> Meaning {
        self.meaning
    }

    pub(crate) fn new(meaning: Meaning) -> ColumnBuilder {
        ColumnBuilder {
            meaning,
            numbers: Vec::new(),
            moments: Vec::new(),
            words: Words::default(),
        }
    }

    pub(crate) fn content(self) -> Content {
        match self.meaning {
            Meaning::Text => Content::Words(self.words),
            Meaning::Moment(unit) => Content::vector(from_first(self.moments, unit, true)),
            _ => Content::vector(self.numbers),
        }
    }

    #[cfg(all(feature = "parquet", panic = "unwind"))]
    pub(crate) fn len(&self) -> usize {
        self.numbers.len() + self.moments.len() + self.words.len()
    }

    pub(crate) fn number(&mut self, value: Option<f64>) {
        let unit = match self.meaning {
            Meaning::Number(unit) => unit,
            _ => 1.0,
        };
        self.numbers
            .push(value.map_or(f64::NAN, |v| scaled(v, unit)));
    }

    pub(crate) fn moment(&mut self, value: Option<i64>) {
        self.moments.push(value.unwrap_or(i64::MIN));
    }

    pub(crate) fn word(&mut self, text: &str) {
        self.words.push(text);
    }

    /// Adds a value that is missing.
    pub(crate) fn missing(&mut self) {
        match self.meaning {
            Meaning::Text => self.word(""),
            Meaning::Moment(_) => self.moment(None),
            _ => self.number(None),
        }
    }
}
