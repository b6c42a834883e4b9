//! Arrays in memory as a table, for programs that have no file.
//!
//! In: names with their numbers. Out: a [`Table`] that is read as one of a file is. NaN marks a missing value, as an empty cell does.

use super::lines::Line;
use super::rows::Rows;
use super::table::{Origin, Table};

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
    /// An infinite value, by its column and row, counted from 0.
    Infinite { name: String, row: usize },
}

impl Table {
    /// The table of named arrays, all of one length R.
    ///
    /// # Errors
    /// The first fault.
    pub fn from_arrays(name: &str, arrays: Vec<(String, Vec<f64>)>) -> Result<Table, ArrayFault> {
        let length = arrays.first().map_or(0, |(_, values)| values.len());
        if length == 0 {
            return Err(ArrayFault::Empty);
        }
        for (place, (name, values)) in arrays.iter().enumerate() {
            if arrays.iter().take(place).any(|(other, _)| other == name) {
                return Err(ArrayFault::Twice(name.clone()));
            }
            if values.len() != length {
                return Err(ArrayFault::Ragged {
                    first: length,
                    name: name.clone(),
                    length: values.len(),
                });
            }
            if let Some(row) = values.iter().position(|v| v.is_infinite()) {
                let name = name.clone();
                return Err(ArrayFault::Infinite { name, row });
            }
        }
        let (headers, columns) = arrays.into_iter().unzip();
        let lines = (1..=length).map(|number| Line { start: 0, number });
        Ok(Table {
            name: name.to_string(),
            headers,
            rows: Rows::of_numbers(lines.collect(), columns),
            origin: Origin::Arrays,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sidc_lang::source::Sources;

    fn table(arrays: &[(&str, &[f64])]) -> Result<Table, ArrayFault> {
        let owned = arrays.iter().map(|(n, v)| (n.to_string(), v.to_vec()));
        Table::from_arrays("run 1", owned.collect())
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
        let infinite = table(&[("t", &[0.0, f64::INFINITY])]).unwrap_err();
        assert_eq!(
            infinite,
            ArrayFault::Infinite {
                name: "t".into(),
                row: 1
            }
        );
    }
}
