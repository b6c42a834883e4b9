//! Arrays in memory as a table, for programs that have no file.
//!
//! In: names with their numbers or texts. Out: a [`Table`] that is read as one of a file is. NaN marks a missing value, as an empty cell does.

use std::collections::{BTreeMap, HashSet};
use std::fmt::{Display, Formatter};

use super::rows::Rows;
use super::table::{Origin, Table};
use super::words::Words;

/// Why arrays are no table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ArrayFault {
    /// No column, or no row.
    Empty,
    /// A name twice.
    Twice(String),
    /// Lengths that differ: of the first column, and of the one named.
    Ragged {
        first: usize,
        name: String,
        length: usize,
    },
}

impl Display for ArrayFault {
    fn fmt(&self, f: &mut Formatter) -> std::fmt::Result {
        match self {
            ArrayFault::Empty => write!(f, "no columns"),
            ArrayFault::Twice(name) => write!(f, "two columns are called \"{name}\""),
            ArrayFault::Ragged {
                first,
                name,
                length,
            } => {
                write!(
                    f,
                    "column \"{name}\" has {length} rows, the first one {first}"
                )
            }
        }
    }
}

/// A column in memory.
#[derive(Clone, Debug, PartialEq)]
pub enum ArrayColumn {
    Numbers(Vec<f64>),
    Words(Words),
}

impl ArrayColumn {
    fn len(&self) -> usize {
        match self {
            ArrayColumn::Numbers(values) => values.len(),
            ArrayColumn::Words(words) => words.len(),
        }
    }
}

impl Table {
    /// The table of named columns, all of one length R. Texts and infinite values are cells that are no numbers, as they are in a file of
    /// text: they matter only if a model uses their column.
    ///
    /// # Errors
    /// The first of: none, a name twice, another length.
    pub fn from_columns(
        name: &str,
        columns: Vec<(String, ArrayColumn)>,
    ) -> Result<Table, ArrayFault> {
        let length = columns.first().map_or(0, |(_, column)| column.len());
        if length == 0 {
            return Err(ArrayFault::Empty);
        }
        let mut seen = HashSet::new();
        for (name, column) in &columns {
            if !seen.insert(name.as_str()) {
                return Err(ArrayFault::Twice(name.clone()));
            }
            if column.len() != length {
                return Err(ArrayFault::Ragged {
                    first: length,
                    name: name.clone(),
                    length: column.len(),
                });
            }
        }
        let mut rows = Rows::numbered(length);
        let (mut headers, mut words) = (Vec::new(), BTreeMap::new());
        for (place, (header, column)) in columns.into_iter().enumerate() {
            headers.push(header);
            match column {
                ArrayColumn::Numbers(values) => rows.add_numbers(values),
                ArrayColumn::Words(texts) => {
                    rows.add_texts(&texts);
                    words.insert(place, texts);
                }
            }
        }
        Ok(Table {
            name: name.to_string(),
            headers,
            rows,
            origin: Origin::Arrays {
                words,
                unread: Vec::new(),
            },
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sidc_lang::source::Sources;

    fn table(arrays: &[(&str, &[f64])]) -> Result<Table, ArrayFault> {
        let numbers = |v: &[f64]| ArrayColumn::Numbers(v.to_vec());
        let columns = arrays.iter().map(|(n, v)| (n.to_string(), numbers(v)));
        Table::from_columns("run 1", columns.collect())
    }

    #[test]
    fn arrays_are_a_table_whose_cells_can_be_shown() {
        let table = table(&[("t", &[0.0, 0.5]), ("x", &[1.0, f64::NAN])]).unwrap();
        assert_eq!((table.len(), table.position("x")), (2, Some(1)));
        assert_eq!(
            (table.cell(1, 0), table.cell(1, 1)),
            ("0.5".into(), "NaN".into())
        );
        let mut sources = Sources::default();
        let span = table.cell_span(&mut sources, 1, 1);
        assert_eq!((span.start, span.end), (5, 8));
        assert_eq!(sources.get(span.file).unwrap().text, "0.5, NaN");
    }

    #[test]
    fn texts_and_infinite_values_are_cells_that_are_no_numbers() {
        let words: Words = ["a", "b ", "NaN", "2.5"].into_iter().collect();
        let numbers = ArrayColumn::Numbers(vec![0.0, f64::NEG_INFINITY, f64::NAN, 1.0]);
        let columns = vec![
            ("run".into(), ArrayColumn::Words(words)),
            ("x".into(), numbers),
        ];
        let table = Table::from_columns("rig.npz", columns).unwrap();
        let cells = |column: usize| {
            (0..4)
                .map(|row| table.cell(row, column))
                .collect::<Vec<_>>()
        };
        assert_eq!(cells(0), ["a", "b", "NaN", "2.5"]);
        assert_eq!(cells(1), ["0", "inf", "NaN", "1"]);
        assert_eq!(table.values(0)[3], 2.5);
        assert!(table.values(1)[1].is_nan());
        assert_eq!(table.faults(0).unwrap().count, 2);
        assert_eq!(table.faults(1).unwrap().count, 1);
        assert_eq!(table.place(1), "row 2");
    }

    #[test]
    fn what_is_no_table_is_refused() {
        assert_eq!(table(&[]).unwrap_err(), ArrayFault::Empty);
        assert_eq!(table(&[("t", &[])]).unwrap_err(), ArrayFault::Empty);
        let twice = table(&[("t", &[0.0]), ("t", &[0.0])]).unwrap_err();
        assert_eq!(twice, ArrayFault::Twice("t".into()));
        let ragged = table(&[("t", &[0.0]), ("x", &[])]).unwrap_err();
        let (first, name) = (1, "x".into());
        assert_eq!(
            ragged,
            ArrayFault::Ragged {
                first,
                name,
                length: 0
            }
        );
    }
}
