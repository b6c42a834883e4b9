//! NumPy types, and their values as numbers or texts.

use super::literal::Literal;
use crate::budget::Budget;
use crate::bytes::{Number, bits, signed};
use crate::fault::Fault;
use crate::timestamps::from_first;
use crate::variables::Content;
use sidc_data::Words;

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Dtype {
    One(Scalar),
    /// Structures of `size` bytes.
    Fields {
        fields: Vec<Field>,
        size: usize,
    },
}

/// A field of a structure, `offset` bytes after its beginning.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Field {
    pub name: String,
    pub scalar: Scalar,
    pub offset: usize,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Scalar {
    kind: ScalarKind,
    /// Bytes.
    pub size: usize,
    big_endian: bool,
}

#[derive(Clone, Debug, PartialEq)]
enum ScalarKind {
    Number(Number),
    /// Times, or spans of time, in units of `unit` seconds.
    Time {
        unit: f64,
        since_1970: bool,
    },
    /// UTF-32, padded by zeros.
    Text,
    /// Bytes, padded by zeros.
    ByteText,
    /// A type that is not read, and what it is.
    Other(&'static str),
}

impl Dtype {
    /// # Errors
    /// A description that NumPy does not write.
    pub(super) fn of(descr: &Literal) -> Result<Dtype, Fault> {
        let wrong = || Fault::damaged("its type is none of NumPy's");
        match descr {
            Literal::Text(code) => Scalar::of(code).map(Dtype::One).ok_or_else(wrong),
            Literal::Sequence(items) => {
                let (mut fields, mut size) = (Vec::new(), 0usize);
                for item in items {
                    let (name, scalar) = field(item).ok_or_else(wrong)?;
                    let offset = size;
                    size = size.checked_add(scalar.size).ok_or_else(wrong)?;
                    // A field without a name is padding.
                    if !name.is_empty() {
                        fields.push(Field {
                            name,
                            scalar,
                            offset,
                        });
                    }
                }
                Ok(Dtype::Fields { fields, size })
            }
            _ => Err(wrong()),
        }
    }

    /// Bytes of one value.
    pub(super) fn size(&self) -> usize {
        match self {
            Dtype::One(scalar) => scalar.size,
            Dtype::Fields { size, .. } => *size,
        }
    }
}

/// `('x', '<f8')`, or `(('title', 'x'), '<f8', (3,))`.
fn field(item: &Literal) -> Option<(String, Scalar)> {
    let Literal::Sequence(parts) = item else {
        return None;
    };
    let name = match parts.first()? {
        Literal::Text(name) => name.clone(),
        Literal::Sequence(titled) => match titled.last()? {
            Literal::Text(name) => name.clone(),
            _ => return None,
        },
        _ => return None,
    };
    let mut count = 1usize;
    if let Some(Literal::Sequence(sides)) = parts.get(2) {
        for side in sides {
            let Literal::Whole(side) = side else {
                return None;
            };
            count = count.checked_mul(usize::try_from(*side).ok()?)?;
        }
    }
    let scalar = match parts.get(1)? {
        Literal::Text(code) => Scalar::of(code)?,
        nested => Scalar {
            kind: ScalarKind::Other("a structure within a structure"),
            size: Dtype::of(nested).ok()?.size(),
            big_endian: false,
        },
    };
    let size = scalar.size.checked_mul(count)?;
    let kind = match parts.len() {
        2 => scalar.kind,
        _ => ScalarKind::Other("an array in each row"),
    };
    Some((
        name,
        Scalar {
            kind,
            size,
            ..scalar
        },
    ))
}

impl Scalar {
    /// The type of a code such as `<f8`.
    fn of(code: &str) -> Option<Scalar> {
        let (order, rest) = code.split_at_checked(1)?;
        if !["<", ">", "|", "="].contains(&order) {
            return None;
        }
        let (letter, rest) = rest.split_at_checked(1)?;
        let (digits, unit) = match rest.find('[') {
            Some(at) => rest.split_at_checked(at)?,
            None => (rest, ""),
        };
        // Objects have no size of their own.
        let count: usize = if letter == "O" {
            8
        } else {
            digits.parse().ok()?
        };
        let kind = match (letter, count) {
            ("f", 2) => ScalarKind::Number(Number::Half),
            ("f", 4) => ScalarKind::Number(Number::Single),
            ("f", 8) => ScalarKind::Number(Number::Double),
            ("i", 1 | 2 | 4 | 8) => ScalarKind::Number(Number::Signed(count as u8)),
            ("u" | "b", 1) | ("u", 2 | 4 | 8) => ScalarKind::Number(Number::Unsigned(count as u8)),
            ("M" | "m", 8) => ScalarKind::Time {
                unit: seconds(unit)?,
                since_1970: letter == "M",
            },
            ("U", _) => ScalarKind::Text,
            ("S", _) => ScalarKind::ByteText,
            ("c", _) => ScalarKind::Other("complex numbers"),
            ("f", _) => ScalarKind::Other("numbers of extended precision"),
            ("O", _) => ScalarKind::Other("objects of Python"),
            ("V", _) => ScalarKind::Other("raw bytes"),
            _ => return None,
        };
        let size = match letter {
            "U" => count.checked_mul(4)?,
            _ => count,
        };
        let big_endian = order == ">";
        Some(Scalar {
            kind,
            size,
            big_endian,
        })
    }

    /// The values in these cells of [`Scalar::size`] bytes each.
    ///
    /// # Errors
    /// Texts that take more memory than is left.
    pub(super) fn content<'a>(
        &self,
        cells: impl Iterator<Item = &'a [u8]>,
        shape: &[usize],
        column_major: bool,
        budget: &mut Budget,
    ) -> Result<Content, Fault> {
        let numbers = |values: Vec<f64>| {
            // `Content` has the first index fastest. If the last one is, reversing the shape makes it the first.
            let mut shape = shape.to_vec();
            if !column_major {
                shape.reverse();
            }
            Content::Numbers { shape, values }
        };
        Ok(match self.kind {
            ScalarKind::Number(number) => {
                numbers(cells.map(|c| number.read(c, self.big_endian)).collect())
            }
            ScalarKind::Time { unit, since_1970 } => {
                let counts = cells.map(|c| signed(bits(c, self.big_endian), 8));
                numbers(from_first(counts.collect(), unit, since_1970))
            }
            ScalarKind::Text | ScalarKind::ByteText => {
                let mut words = Words::default();
                for cell in cells {
                    budget.take(cell.len() as u64 + 4, 1)?;
                    words.push(&self.text(cell));
                }
                match shape {
                    [_] => Content::Words(words),
                    _ => Content::Other("an array of texts".into()),
                }
            }
            ScalarKind::Other(what) => Content::Other(what.into()),
        })
    }

    fn text(&self, cell: &[u8]) -> String {
        let text: String = match self.kind {
            ScalarKind::Text => cell
                .chunks_exact(4)
                .map(|c| char::from_u32(bits(c, self.big_endian) as u32).unwrap_or('\u{fffd}'))
                .collect(),
            _ => String::from_utf8_lossy(cell).into_owned(),
        };
        text.trim_end_matches('\0').to_string()
    }
}

/// Seconds of one unit: `[ns]`, `[10ms]`. Months and years have no fixed length.
fn seconds(unit: &str) -> Option<f64> {
    let unit = unit.strip_prefix('[')?.strip_suffix(']')?;
    let name = unit.trim_start_matches(|c: char| c.is_ascii_digit());
    let count = match unit.strip_suffix(name)? {
        "" => 1.0,
        digits => digits.parse().ok()?,
    };
    let one = match name {
        "W" => 604_800.0,
        "D" => 86_400.0,
        "h" => 3_600.0,
        "m" => 60.0,
        "s" => 1.0,
        "ms" => 1e-3,
        "us" => 1e-6,
        "ns" => 1e-9,
        "ps" => 1e-12,
        "fs" => 1e-15,
        "as" => 1e-18,
        _ => return None,
    };
    Some(count * one)
}
