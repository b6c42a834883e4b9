//! A ROS message, decoded by the definitions of its fields.
//!
//! ROS 1 writes one value after the other. ROS 2 (CDR) begins with four bytes that name the encoding, and puts each number at a multiple of
//! its own size.

use crate::budget::Budget;
use crate::bytes::{Bytes, Number};
use crate::fault::Fault;
use crate::timestamps::scaled;
use crate::topics::{LONGEST_LIST, Messages, Path};

use super::definition::{Definitions, Dialect, Field, Kind, Length};

struct Decoder<'a, 'm> {
    from: Bytes<'a>,
    /// Length of the message without its header, in bytes.
    length: usize,
    /// Largest alignment of a number, in bytes.
    alignment: usize,
    /// The time that times are counted from, in nanoseconds.
    start: u64,
    defined: &'a Definitions,
    messages: &'m mut Messages,
    budget: &'m mut Budget,
    path: Path,
    /// True within a list that is too long, whose values are skipped.
    silent: bool,
}

/// # Errors
/// A message that ends before its definition; more memory than is left.
pub(super) fn message(
    defined: &Definitions,
    content: &[u8],
    start: u64,
    messages: &mut Messages,
    budget: &mut Budget,
) -> Result<(), Fault> {
    let mut from = Bytes::new(content, false);
    let mut alignment = 1;
    if defined.dialect == Dialect::Ros2 {
        let head = from.take(4)?;
        alignment = match head.get(..2) {
            Some([0, 0 | 1]) => 8,
            Some([0, 6 | 7]) => 4,
            _ => return messages.leave_out(&Path::default(), "lists of parameters", budget),
        };
        from.big_endian = head.get(1).is_some_and(|order| order % 2 == 0);
    }
    let mut decoder = Decoder {
        length: from.rest().len(),
        from,
        alignment,
        start,
        defined,
        messages,
        budget,
        path: Path::default(),
        silent: false,
    };
    decoder.fields(defined.message)
}

impl Decoder<'_, '_> {
    fn fields(&mut self, place: usize) -> Result<(), Fault> {
        let defined = self.defined;
        let fields = defined.all.get(place).map_or(&[][..], Vec::as_slice);
        for field in fields {
            let back = self.path.enter(&field.name);
            self.field(field)?;
            self.path.leave(back);
        }
        Ok(())
    }

    fn field(&mut self, field: &Field) -> Result<(), Fault> {
        let count = match field.length {
            Length::One => return self.value(field.kind),
            Length::Fixed(count) => count,
            Length::Any => {
                self.align(4);
                self.from.u32()? as usize
            }
        };
        if count <= LONGEST_LIST {
            return self.items(field.kind, count);
        }
        if !self.silent {
            self.messages
                .leave_out(&self.path, "a long list", self.budget)?;
        }
        if let Kind::Number(number) = field.kind {
            self.align(number.size());
            let bytes = (count as u64).saturating_mul(number.size() as u64);
            self.from.take(bytes)?;
            return Ok(());
        }
        let silent = std::mem::replace(&mut self.silent, true);
        self.items(field.kind, count)?;
        self.silent = silent;
        Ok(())
    }

    /// Each item takes at least one byte, so that a wrong count ends with the message.
    fn items(&mut self, kind: Kind, count: usize) -> Result<(), Fault> {
        for place in 0..count {
            let back = self.path.enter_place(place);
            self.value(kind)?;
            self.path.leave(back);
        }
        Ok(())
    }

    fn value(&mut self, kind: Kind) -> Result<(), Fault> {
        match kind {
            Kind::Number(number) => {
                let value = self.number(number)?;
                self.found(value)
            }
            Kind::Moment | Kind::Span => {
                let seconds = self.number(Number::Signed(4))?;
                let nanoseconds = self.number(Number::Unsigned(4))?;
                let whole = seconds as i128 * 1_000_000_000 + nanoseconds as i128;
                let zero = match kind {
                    Kind::Moment => i128::from(self.start),
                    _ => 0,
                };
                self.found(scaled((whole - zero) as f64, 1e-9))
            }
            Kind::Text => {
                self.align(4);
                let length = self.from.u32()?;
                self.from.take(u64::from(length))?;
                match self.silent {
                    true => Ok(()),
                    false => self.messages.leave_out(&self.path, "text", self.budget),
                }
            }
            Kind::Fields(place) => self.fields(place),
            Kind::Filler => self.from.take(1).map(|_| ()),
        }
    }

    fn found(&mut self, value: f64) -> Result<(), Fault> {
        match self.silent {
            true => Ok(()),
            false => self.messages.value(&self.path, value, self.budget),
        }
    }

    fn number(&mut self, number: Number) -> Result<f64, Fault> {
        self.align(number.size());
        let bytes = self.from.take(number.size() as u64)?;
        Ok(number.read(bytes, self.from.big_endian))
    }

    /// Skips padding before the next multiple of a size.
    fn align(&mut self, size: usize) {
        let size = size.min(self.alignment);
        let at = self.length - self.from.rest().len();
        self.from.skip((size - at % size) % size);
    }
}
