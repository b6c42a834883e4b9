//! FlatBuffers tables, with which Arrow describes its bytes.
//!
//! Every offset is checked. Source: the FlatBuffers documentation, "FlatBuffer Internals".

use crate::bytes::bits;
use crate::fault::Fault;

/// A table in a buffer, by its place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Table<'a> {
    bytes: &'a [u8],
    at: usize,
}

/// A vector in a buffer: where its first element is, and how many there are.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vector<'a> {
    bytes: &'a [u8],
    at: usize,
    count: usize,
}

fn broken() -> Fault {
    Fault::damaged("it is no whole Arrow file (an offset leads out of its message)")
}

/// An unsigned whole number of `size` bytes.
fn number(bytes: &[u8], at: usize, size: usize) -> Result<u64, Fault> {
    let end = at.checked_add(size).ok_or_else(broken)?;
    let cell = bytes.get(at..end).ok_or_else(broken)?;
    Ok(bits(cell, false))
}

/// Where the offset at this place leads.
fn follow(bytes: &[u8], at: usize) -> Result<usize, Fault> {
    let offset = number(bytes, at, 4)? as usize;
    at.checked_add(offset).ok_or_else(broken)
}

impl<'a> Table<'a> {
    pub(super) fn root(bytes: &'a [u8]) -> Result<Table<'a>, Fault> {
        let at = follow(bytes, 0)?;
        Ok(Table { bytes, at })
    }

    /// Where a field is; `None` if it has its default.
    fn field(&self, index: usize) -> Result<Option<usize>, Fault> {
        let back = number(self.bytes, self.at, 4)? as u32 as i32;
        let list = (self.at as i64).checked_sub(i64::from(back));
        let list = list.and_then(|place| usize::try_from(place).ok());
        let list = list.ok_or_else(broken)?;
        let size = number(self.bytes, list, 2)? as usize;
        let entry = 4 + 2 * index;
        if entry + 2 > size {
            return Ok(None);
        }
        let offset = number(self.bytes, list.saturating_add(entry), 2)? as usize;
        Ok((offset > 0).then(|| self.at.saturating_add(offset)))
    }

    /// A signed whole number of `size` bytes.
    pub(super) fn whole(&self, index: usize, size: u8, default: i64) -> Result<i64, Fault> {
        let Some(at) = self.field(index)? else {
            return Ok(default);
        };
        let bits = number(self.bytes, at, usize::from(size))?;
        Ok(crate::bytes::signed(bits, size))
    }

    pub(super) fn table(&self, index: usize) -> Result<Option<Table<'a>>, Fault> {
        let Some(at) = self.field(index)? else {
            return Ok(None);
        };
        let at = follow(self.bytes, at)?;
        let bytes = self.bytes;
        Ok(Some(Table { bytes, at }))
    }

    /// # Errors
    /// Damage, or the field is missing.
    pub(super) fn needed(&self, index: usize) -> Result<Table<'a>, Fault> {
        self.table(index)?.ok_or_else(broken)
    }

    /// A vector of elements of `size` bytes; empty if the field is missing.
    pub(super) fn vector(&self, index: usize, size: usize) -> Result<Vector<'a>, Fault> {
        let bytes = self.bytes;
        let Some(at) = self.field(index)? else {
            let (at, count) = (0, 0);
            return Ok(Vector { bytes, at, count });
        };
        let at = follow(bytes, at)?;
        let count = number(bytes, at, 4)? as usize;
        let at = at + 4;
        let end = count.checked_mul(size).and_then(|all| at.checked_add(all));
        if end.is_none_or(|end| end > bytes.len()) {
            return Err(broken());
        }
        Ok(Vector { bytes, at, count })
    }

    pub(super) fn text(&self, index: usize) -> Result<String, Fault> {
        let Vector { bytes, at, count } = self.vector(index, 1)?;
        let text = bytes.get(at..at + count).unwrap_or_default();
        Ok(String::from_utf8_lossy(text).into_owned())
    }
}

impl<'a> Vector<'a> {
    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// Its tables.
    pub(super) fn tables(self) -> impl Iterator<Item = Result<Table<'a>, Fault>> {
        let places = (0..self.count).map(move |k| self.at + 4 * k);
        places.map(move |place| {
            let at = follow(self.bytes, place)?;
            let bytes = self.bytes;
            Ok(Table { bytes, at })
        })
    }

    /// The first eight bytes of each element as a whole number.
    pub(super) fn firsts(self, size: usize) -> impl Iterator<Item = Result<i64, Fault>> {
        let places = (0..self.count).map(move |k| self.at + size * k);
        places.map(move |place| Ok(number(self.bytes, place, 8)? as i64))
    }

    /// Its elements of sixteen bytes as pairs of whole numbers.
    pub(super) fn pairs(self) -> impl Iterator<Item = Result<(i64, i64), Fault>> {
        let places = (0..self.count).map(move |k| self.at + 16 * k);
        places.map(move |place| {
            let first = number(self.bytes, place, 8)? as i64;
            let second = number(self.bytes, place + 8, 8)? as i64;
            Ok((first, second))
        })
    }
}
