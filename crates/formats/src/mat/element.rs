//! A data element of a file: its kind and its bytes.

use crate::bytes::{Bytes, Number};
use crate::fault::Fault;

pub(super) const MATRIX: u32 = 14;
pub(super) const COMPRESSED: u32 = 15;
pub(super) const UTF16: u32 = 17;
pub(super) const UTF32: u32 = 18;

#[derive(Clone, Copy, Debug)]
pub(super) struct Element<'a> {
    pub kind: u32,
    pub data: &'a [u8],
    pub big_endian: bool,
}

impl<'a> Element<'a> {
    /// Reads an element and the padding after it.
    ///
    /// # Errors
    /// It is longer than what is left.
    pub(super) fn read(from: &mut Bytes<'a>) -> Result<Element<'a>, Fault> {
        let first = from.u32()?;
        let big_endian = from.big_endian;
        // Up to four bytes are stored in the tag itself, whose upper half is then their number.
        let (kind, data) = match first >> 16 {
            0 => {
                let length = from.u32()?;
                let data = from.take(u64::from(length))?;
                if first != COMPRESSED {
                    from.skip((8 - length as usize % 8) % 8);
                }
                (first, data)
            }
            length => {
                let data = from.take(u64::from(length.min(4)))?;
                from.skip(4 - length.min(4) as usize);
                (first & 0xffff, data)
            }
        };
        Ok(Element {
            kind,
            data,
            big_endian,
        })
    }

    /// The kind of its numbers.
    ///
    /// # Errors
    /// The kind is unknown.
    pub(super) fn number(&self) -> Result<Number, Fault> {
        Ok(match self.kind {
            1 => Number::Signed(1),
            2 | 16 => Number::Unsigned(1),
            3 => Number::Signed(2),
            4 | UTF16 => Number::Unsigned(2),
            5 => Number::Signed(4),
            6 | UTF32 => Number::Unsigned(4),
            7 => Number::Single,
            9 => Number::Double,
            12 => Number::Signed(8),
            13 => Number::Unsigned(8),
            other => {
                let text = format!("numbers of an unknown kind ({other})");
                return Err(Fault::damaged(text));
            }
        })
    }

    /// How many numbers it holds.
    ///
    /// # Errors
    /// As [`Element::number`].
    pub(super) fn count(&self) -> Result<usize, Fault> {
        Ok(self.data.len() / self.number()?.size())
    }

    /// # Errors
    /// As [`Element::number`].
    pub(super) fn values(&self) -> Result<impl Iterator<Item = f64>, Fault> {
        let (number, big_endian) = (self.number()?, self.big_endian);
        let cells = self.data.chunks_exact(number.size());
        Ok(cells.map(move |cell| number.read(cell, big_endian)))
    }

    /// Bytes as text, up to the first zero.
    pub(super) fn name(&self) -> String {
        let end = self.data.iter().position(|b| *b == 0);
        let bytes = end
            .and_then(|end| self.data.get(..end))
            .unwrap_or(self.data);
        String::from_utf8_lossy(bytes).into_owned()
    }
}
