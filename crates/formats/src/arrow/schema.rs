//! The columns of a schema. Source: Apache Arrow, format/Schema.fbs.

use super::flat::Table;
use crate::bytes::Number;
use crate::column_builder::Meaning;
use crate::fault::Fault;
use sidc_data::Limits;

/// A column, or a structure of several.
#[derive(Debug)]
pub(super) struct Field {
    /// With the names of the structures around it, joined by `_`.
    pub name: String,
    pub layout: Layout,
    pub meaning: Meaning,
    /// The id of its dictionary, and the type of its indices.
    pub dictionary: Option<(i64, Number)>,
    pub children: Vec<Field>,
}

/// How the values lie in buffers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Layout {
    Numbers(Number),
    Bits,
    /// Offsets of this type, and the text.
    Text(Number),
    /// Lengths with the first bytes or the place of the text, and any number of buffers.
    Views,
    /// The children have the same rows.
    Structure,
    /// No value at all.
    Nothing,
    /// Not read: the buffers to skip, and whether those of views follow.
    Other {
        buffers: usize,
        views: bool,
    },
}

/// Deepest nesting of fields.
const MAX_DEPTH: usize = 16;

/// # Errors
/// Damage; more columns than are allowed.
pub(super) fn fields(schema: Table, limits: &Limits) -> Result<Vec<Field>, Fault> {
    if schema.whole(0, 2, 0)? != 0 {
        let text = "an Arrow file whose numbers have their highest byte first";
        return Err(Fault::unsupported(text).help(crate::kind::CSV));
    }
    let mut count = 0;
    let mut found = Vec::new();
    for field in schema.vector(1, 4)?.tables() {
        found.push(read(field?, None, 0, &mut count, limits)?);
    }
    Ok(found)
}

fn read(
    field: Table,
    inside: Option<&str>,
    depth: usize,
    count: &mut usize,
    limits: &Limits,
) -> Result<Field, Fault> {
    *count += 1;
    if *count > limits.columns {
        return Err(Fault::too_many_columns(*count, limits.columns));
    }
    if depth > MAX_DEPTH {
        return Err(Fault::damaged("its columns are nested too deeply"));
    }
    let own = field.text(0)?;
    let name = match inside {
        Some(inside) => format!("{inside}_{own}"),
        None => own,
    };
    let (mut layout, meaning) = kind(field)?;
    let dictionary = match field.table(4)? {
        None => None,
        Some(encoding) => {
            let index = match encoding.table(1)? {
                Some(index) => whole_number(index)?,
                None => Number::Signed(4),
            };
            Some((encoding.whole(0, 8, 0)?, index))
        }
    };
    let mut children = Vec::new();
    for child in field.vector(5, 4)?.tables() {
        children.push(read(child?, Some(&name), depth + 1, count, limits)?);
    }
    // A dictionary of structures is not read.
    if dictionary.is_some() && !children.is_empty() {
        layout = other(2);
        children.clear();
    }
    Ok(Field {
        name,
        layout,
        meaning,
        dictionary,
        children,
    })
}

fn other(buffers: usize) -> Layout {
    let views = false;
    Layout::Other { buffers, views }
}

/// A whole number, by its width and sign.
fn whole_number(kind: Table) -> Result<Number, Fault> {
    let size = match kind.whole(0, 4, 0)? {
        8 => 1,
        16 => 2,
        32 => 4,
        64 => 8,
        width => {
            let text = format!("whole numbers of {width} bits");
            return Err(Fault::damaged(text));
        }
    };
    Ok(match kind.whole(1, 1, 0)? {
        0 => Number::Unsigned(size),
        _ => Number::Signed(size),
    })
}

/// A unit of time in seconds.
fn unit(code: i64) -> f64 {
    match code {
        0 => 1.0,
        1 => 1e-3,
        2 => 1e-6,
        _ => 1e-9,
    }
}

fn kind(field: Table) -> Result<(Layout, Meaning), Fault> {
    let tag = field.whole(2, 1, 0)?;
    let plain = Meaning::Number(1.0);
    let long = Layout::Numbers(Number::Signed(8));
    let short = Layout::Numbers(Number::Signed(4));
    let kind = || field.needed(3);
    Ok(match tag {
        1 => (Layout::Nothing, plain),
        2 => (Layout::Numbers(whole_number(kind()?)?), plain),
        3 => {
            let number = match kind()?.whole(0, 2, 0)? {
                0 => Number::Half,
                1 => Number::Single,
                _ => Number::Double,
            };
            (Layout::Numbers(number), plain)
        }
        5 => (Layout::Text(Number::Signed(4)), Meaning::Text),
        6 => (Layout::Bits, plain),
        8 => match kind()?.whole(0, 2, 1)? {
            0 => (short, Meaning::Moment(86_400.0)),
            _ => (long, Meaning::Moment(1e-3)),
        },
        9 => {
            let kind = kind()?;
            let layout = if kind.whole(1, 4, 32)? == 32 {
                short
            } else {
                long
            };
            (layout, Meaning::Number(unit(kind.whole(0, 2, 1)?)))
        }
        10 => (long, Meaning::Moment(unit(kind()?.whole(0, 2, 0)?))),
        18 => (long, Meaning::Number(unit(kind()?.whole(0, 2, 1)?))),
        13 => (Layout::Structure, plain),
        20 => (Layout::Text(Number::Signed(8)), Meaning::Text),
        24 => (Layout::Views, Meaning::Text),
        _ => (skipped_layout(tag, field)?, plain),
    })
}

/// The buffers of a column that is not read.
fn skipped_layout(tag: i64, field: Table) -> Result<Layout, Fault> {
    Ok(match tag {
        4 | 19 => other(3),
        7 | 11 | 12 | 15 | 17 | 21 => other(2),
        // A union: which kind each value has, and where it is.
        14 => match field.needed(3)?.whole(0, 2, 0)? {
            0 => other(1),
            _ => other(2),
        },
        16 => other(1),
        22 => other(0),
        23 => Layout::Other {
            buffers: 2,
            views: true,
        },
        25 | 26 => other(3),
        tag => {
            let text = format!("a column of an unknown kind ({tag})");
            return Err(Fault::damaged(text));
        }
    })
}
