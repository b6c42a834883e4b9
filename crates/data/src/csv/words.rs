//! A column of texts: each different one is kept once.

use std::collections::HashMap;

/// R texts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Words {
    different: Vec<String>,
    places: HashMap<String, u32>,
    rows: Vec<u32>,
}

impl Words {
    /// Adds the text of the next row.
    pub fn push(&mut self, word: &str) {
        let place = match self.places.get(word) {
            Some(place) => *place,
            None => {
                let place = self.different.len() as u32;
                self.different.push(word.into());
                self.places.insert(word.into(), place);
                place
            }
        };
        self.rows.push(place);
    }

    /// Number of rows R.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// The text of a row, trimmed; empty beyond the last.
    pub fn get(&self, row: usize) -> &str {
        let place = self.rows.get(row).map(|place| *place as usize);
        let word = place.and_then(|place| self.different.get(place));
        word.map_or("", |word| word.trim())
    }
}

impl<S: AsRef<str>> FromIterator<S> for Words {
    fn from_iter<I: IntoIterator<Item = S>>(words: I) -> Words {
        let mut all = Words::default();
        for word in words {
            all.push(word.as_ref());
        }
        all
    }
}
