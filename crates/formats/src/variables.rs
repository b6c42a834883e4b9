//! Named arrays of a file → the columns of a table.
//!
//! In: arrays of any shape. Out: a table, and what was left out of it with the reason. The table has as many rows as most arrays. The rows
//! of a matrix run along its longer side, and its columns are numbered after its name.

use std::collections::BTreeMap;

use sidc_data::{ArrayColumn, Limits, Table, Words};

use crate::fault::Fault;

/// An array with its name.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Variable {
    pub name: String,
    pub content: Content,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Content {
    /// Numbers, the first index fastest (as MATLAB has them).
    Numbers { shape: Vec<usize>, values: Vec<f64> },
    /// One text for each row.
    Words(Words),
    /// What is not a column, by a description.
    Other(String),
}

/// A table, and what in the file is not in it.
pub(crate) struct Assembled {
    pub table: Table,
    /// Each with its reason.
    pub left_out: Vec<String>,
    /// The value of a number that is named like a sampling interval.
    pub step: Option<f64>,
}

impl Variable {
    /// The sampling interval, if this is one by its name.
    fn step(&self) -> Option<f64> {
        let name = self.name.to_ascii_lowercase();
        let names = [
            "ts",
            "dt",
            "step",
            "tsample",
            "sample_time",
            "sampling_time",
        ];
        match &self.content {
            Content::Numbers { values, .. } if names.contains(&name.as_str()) => {
                let [value] = values.as_slice() else {
                    return None;
                };
                (*value > 0.0 && value.is_finite()).then_some(*value)
            }
            _ => None,
        }
    }
}

impl Content {
    pub(crate) fn vector(values: Vec<f64>) -> Content {
        let shape = vec![values.len()];
        Content::Numbers { shape, values }
    }

    /// Rows and columns of what can be a column or several.
    fn rows_and_columns(&self) -> Option<(usize, usize)> {
        match self {
            Content::Numbers { shape, .. } => sides(shape),
            Content::Words(words) => Some((words.len(), 1)),
            Content::Other(_) => None,
        }
    }
}

/// The longer side and the other one, if at most two sides of an array are not 1.
fn sides(shape: &[usize]) -> Option<(usize, usize)> {
    let long: Vec<usize> = shape.iter().copied().filter(|n| *n != 1).collect();
    match long.as_slice() {
        [] => Some((1, 1)),
        [n] => Some((*n, 1)),
        [a, b] => Some((*a.max(b), *a.min(b))),
        _ => None,
    }
}

/// The number of a matrix's first column: 0 as in NumPy, or 1 as in MATLAB.
#[derive(Clone, Copy)]
pub(crate) enum FirstIndex {
    Zero,
    One,
}

/// The table of all arrays that have the most common length.
///
/// # Errors
/// No array is a column; more columns than the limit; a name occurs twice.
pub(crate) fn assemble(
    file: &str,
    variables: Vec<Variable>,
    first: FirstIndex,
    limits: &Limits,
) -> Result<Assembled, Fault> {
    let Some(rows) = common_length(&variables) else {
        return Err(nothing(&variables));
    };
    let mut columns: Vec<(String, ArrayColumn)> = Vec::new();
    let mut left_out = Vec::new();
    let step = variables.iter().find_map(Variable::step);
    for Variable { name, content } in variables {
        let width = match content.rows_and_columns() {
            Some((length, width)) if length == rows => width,
            _ => {
                left_out.push(format!("{name} ({})", described(&content)));
                continue;
            }
        };
        let all = columns.len().saturating_add(width);
        if all > limits.columns {
            return Err(Fault::too_many_columns(all, limits.columns));
        }
        match content {
            Content::Words(words) => columns.push((name, ArrayColumn::Words(words))),
            Content::Numbers { values, .. } if width == 1 => {
                columns.push((name, ArrayColumn::Numbers(values)));
            }
            Content::Numbers { shape, values } => {
                columns.extend(split(&name, &shape, &values, first));
            }
            Content::Other(_) => {}
        }
    }
    let table = Table::from_columns(file, columns).map_err(|fault| {
        Fault::of("duplicate-header", format!(": {fault}"))
            .help("give each column a name of its own")
    })?;
    Ok(Assembled {
        table,
        left_out,
        step,
    })
}

/// The length that most columns have, the longer one of a tie; more than one row if any column has.
fn common_length(variables: &[Variable]) -> Option<usize> {
    let mut votes: BTreeMap<usize, usize> = BTreeMap::new();
    for variable in variables {
        if let Some((rows @ 1.., columns)) = variable.content.rows_and_columns() {
            let vote = if rows == 1 { 0 } else { columns };
            *votes.entry(rows).or_default() += vote;
        }
    }
    let best = votes
        .into_iter()
        .max_by_key(|(rows, votes)| (*votes, *rows));
    best.map(|(rows, _)| rows)
}

fn nothing(variables: &[Variable]) -> Fault {
    let shown = variables.iter().take(5);
    let found: Vec<String> = shown
        .map(|v| format!("{} ({})", v.name, described(&v.content)))
        .collect();
    let found = match found.as_slice() {
        [] => String::new(),
        some => format!(": {}", some.join(", ")),
    };
    Fault::no_columns(found).help("save one array of numbers for each signal, all of one length")
}

/// What an array is, for a user who misses it in the table.
fn described(content: &Content) -> String {
    match content {
        Content::Numbers { shape, values } => match (sides(shape), values.as_slice()) {
            (_, []) => "empty".into(),
            (Some((1, 1)), [value]) => format!("one number, {value}"),
            (Some((length, 1)), _) => format!("{length} values"),
            _ => {
                let sides: Vec<String> = shape.iter().map(usize::to_string).collect();
                format!("an array of {}", sides.join(" x "))
            }
        },
        Content::Words(words) => format!("{} texts", words.len()),
        Content::Other(what) => what.clone(),
    }
}

/// A matrix as columns, `y_0`, `y_1`, …
fn split(
    name: &str,
    shape: &[usize],
    values: &[f64],
    first: FirstIndex,
) -> Vec<(String, ArrayColumn)> {
    let (rows, width) = sides(shape).unwrap_or_default();
    // The first side that is longer than 1 runs fastest.
    let rows_run_fastest = shape.iter().find(|n| **n != 1) == Some(&rows);
    let at = |row: usize, column: usize| match rows_run_fastest {
        true => row + rows * column,
        false => column + width * row,
    };
    let column = |k: usize| -> Vec<f64> {
        let places = (0..rows).map(|row| at(row, k));
        places
            .filter_map(|place| values.get(place).copied())
            .collect()
    };
    let offset = match first {
        FirstIndex::Zero => 0,
        FirstIndex::One => 1,
    };
    let numbered = |k: usize| format!("{name}_{}", k + offset);
    (0..width)
        .map(|k| (numbered(k), ArrayColumn::Numbers(column(k))))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(name: &str, shape: &[usize]) -> Variable {
        let count: usize = shape.iter().product();
        Variable {
            name: name.into(),
            content: Content::Numbers {
                shape: shape.to_vec(),
                values: (0..count).map(|v| v as f64).collect(),
            },
        }
    }

    fn assembled(variables: Vec<Variable>) -> Assembled {
        assemble("rig.mat", variables, FirstIndex::One, &Limits::default()).unwrap()
    }

    #[test]
    fn rows_are_as_many_as_most_have() {
        let words = Variable {
            name: "well".into(),
            content: Content::Words(["a", "a", "b"].into_iter().collect()),
        };
        let other = Variable {
            name: "f".into(),
            content: Content::Other("a function".into()),
        };
        let all = vec![
            numbers("t", &[3, 1]),
            numbers("u", &[1, 3]),
            numbers("Ts", &[1, 1]),
            numbers("long", &[7]),
            numbers("cube", &[2, 2, 2]),
            words,
            other,
        ];
        let Assembled {
            table, left_out, ..
        } = assembled(all);
        assert_eq!(table.headers(), ["t", "u", "well"]);
        assert_eq!(table.values(1), [0.0, 1.0, 2.0]);
        assert_eq!(table.cell(2, 2), "b");
        assert_eq!(
            left_out,
            [
                "Ts (one number, 0)",
                "long (7 values)",
                "cube (an array of 2 x 2 x 2)",
                "f (a function)"
            ]
        );
    }

    #[test]
    fn a_matrix_is_cut_along_its_longer_side() {
        for (shape, second) in [([3, 2], [3.0, 4.0, 5.0]), ([2, 3], [1.0, 3.0, 5.0])] {
            let Assembled { table, .. } = assembled(vec![numbers("y", &shape)]);
            assert_eq!(table.headers(), ["y_1", "y_2"]);
            assert_eq!(table.values(1), second);
        }
    }

    #[test]
    fn what_holds_no_column_is_told_what_it_holds() {
        let none = assemble("x.mat", Vec::new(), FirstIndex::One, &Limits::default());
        assert!(none.is_err());
        let cube = vec![numbers("cube", &[2, 2, 2])];
        let fault = assemble("x.mat", cube, FirstIndex::One, &Limits::default());
        let text = format!("{:?}", fault.err().unwrap());
        assert!(text.contains("cube (an array of 2 x 2 x 2)"), "{text}");
    }
}
