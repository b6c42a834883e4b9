//! Errors in families of equations and their indices.

use crate::diagnostic::{Diagnostic, Edit};
use crate::source::Span;

/// An index of a family that has the name of something else.
pub fn index_declared(at: Span, name: &str, other: &str) -> Diagnostic {
    Diagnostic::error(
        "name-clash",
        format!("the index `{name}` has the name of something else"),
    )
    .at(at, "which of the two is meant in the equation?")
    .help(format!(
        "give the index a name that nothing else has: `{other}`"
    ))
    .edit(Edit::RenameAll(at, name.to_string(), other.to_string()))
}

/// An end of a range that is not a whole number; `example` is a number that occurs in the declared names.
pub fn index_end(at: Span, example: Option<usize>) -> Diagnostic {
    let d = Diagnostic::error("index", "an index runs between whole numbers")
        .at(at, "no whole number that is known here")
        .help("write numbers, `i = 1..10`, or a `let` that is one");
    example.into_iter().fold(d, |d, n| d.fix(at, n.to_string()))
}

pub fn index_ends(at: Span, from: i64, to: i64, most: usize) -> Diagnostic {
    let d = Diagnostic::error(
        "index",
        format!("an index does not run from {from} to {to}"),
    );
    match from > to {
        true => d
            .at(at, "the smaller number comes first")
            .help(format!("write `{to}..{from}`"))
            .fix(at, format!("{to}..{from}")),
        false => d.at(at, "out of bounds").help(format!(
            "names have numbers from 0 on, and a family at most {most} equations"
        )),
    }
}

/// `x[i/2]`
pub fn index_not_whole(at: Span, index: &str) -> Diagnostic {
    Diagnostic::error(
        "index",
        "an index is a whole number in every equation of its family",
    )
    .at(at, "not one, or not known here")
    .help(format!(
        "an index is made of the family's own and of whole numbers: `x[{index}]`, `x[{index} - 1]`, `x[2*{index}]`"
    ))
    .fix(at, index)
}

/// `x[i + 1]` beyond the last declared name. `name` is the index with its `value`, `range` the place of its range.
pub fn index_beyond(at: Span, wanted: &str, (name, value): (&str, i64), range: Span) -> Diagnostic {
    Diagnostic::error("index", format!("`{wanted}` is not declared"))
        .at(at, format!("`{wanted}` where {name} is {value}"))
        .also(range, "here the index runs")
        .help("let the index run over fewer numbers, with equations of their own for the ends; or in a ring, whose ends are neighbours, by ` cyclic` behind the range")
        .fix(range.after(), " cyclic")
}

/// `x[3]` outside a family; `name` is a signal to write instead.
pub fn index_without_range(at: Span, name: &str) -> Diagnostic {
    Diagnostic::error("index", "an index stands only in a family of equations")
        .at(at, "no index runs here")
        .help(format!(
            "write out which one is meant, `{name}`; or end the equation in `, i = 1..10`"
        ))
        .fix(at, name)
}
