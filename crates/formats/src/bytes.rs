//! Numbers read from bytes, of either order.

use crate::fault::Fault;

/// Bytes that are read from the front.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bytes<'a> {
    rest: &'a [u8],
    pub(crate) big_endian: bool,
}

impl<'a> Bytes<'a> {
    pub(crate) fn new(rest: &'a [u8], big_endian: bool) -> Bytes<'a> {
        Bytes { rest, big_endian }
    }

    pub(crate) fn rest(&self) -> &'a [u8] {
        self.rest
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.rest.is_empty()
    }

    /// The next `count` bytes.
    ///
    /// # Errors
    /// Fewer are left.
    pub(crate) fn take(&mut self, count: u64) -> Result<&'a [u8], Fault> {
        let parts = usize::try_from(count).ok();
        let parts = parts.and_then(|count| self.rest.split_at_checked(count));
        let Some((first, rest)) = parts else {
            let left = self.rest.len();
            let text = format!("{count} bytes are announced where {left} are left");
            return Err(Fault::damaged(text));
        };
        self.rest = rest;
        Ok(first)
    }

    /// Skips `count` bytes, or as many as are left: padding at the end may be missing.
    pub(crate) fn skip(&mut self, count: usize) {
        self.rest = self.rest.get(count..).unwrap_or_default();
    }

    pub(crate) fn u16(&mut self) -> Result<u16, Fault> {
        let bytes = self.array()?;
        Ok(match self.big_endian {
            true => u16::from_be_bytes(bytes),
            false => u16::from_le_bytes(bytes),
        })
    }

    pub(crate) fn u32(&mut self) -> Result<u32, Fault> {
        let bytes = self.array()?;
        Ok(match self.big_endian {
            true => u32::from_be_bytes(bytes),
            false => u32::from_le_bytes(bytes),
        })
    }

    pub(crate) fn u64(&mut self) -> Result<u64, Fault> {
        let bytes = self.array()?;
        Ok(match self.big_endian {
            true => u64::from_be_bytes(bytes),
            false => u64::from_le_bytes(bytes),
        })
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], Fault> {
        let bytes = self.take(N as u64)?;
        let mut out = [0; N];
        out.copy_from_slice(bytes);
        Ok(out)
    }
}

/// A kind of number in memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Number {
    Half,
    Single,
    Double,
    Signed(u8),
    Unsigned(u8),
}

impl Number {
    /// Bytes of one number.
    pub(crate) fn size(self) -> usize {
        match self {
            Number::Half => 2,
            Number::Single => 4,
            Number::Double => 8,
            Number::Signed(size) | Number::Unsigned(size) => usize::from(size),
        }
    }

    /// The number in these [`Number::size`] bytes.
    pub(crate) fn read(self, bytes: &[u8], big_endian: bool) -> f64 {
        let bits = bits(bytes, big_endian);
        match self {
            Number::Half => half(bits),
            Number::Single => f64::from(f32::from_bits(bits as u32)),
            Number::Double => f64::from_bits(bits),
            Number::Signed(size) => signed(bits, size) as f64,
            Number::Unsigned(_) => bits as f64,
        }
    }
}

/// Up to eight bytes as a whole number.
pub(crate) fn bits(bytes: &[u8], big_endian: bool) -> u64 {
    let mut word = [0; 8];
    for (to, from) in word.iter_mut().zip(bytes) {
        *to = *from;
    }
    match big_endian {
        true => u64::from_be_bytes(word) >> (8 * (8 - bytes.len().min(8))).min(63),
        false => u64::from_le_bytes(word),
    }
}

/// A whole number of `size` bytes with its sign.
pub(crate) fn signed(bits: u64, size: u8) -> i64 {
    let unused = 64 - 8 * u32::from(size.clamp(1, 8));
    ((bits << unused) as i64) >> unused
}

/// A number of IEEE 754's binary16.
fn half(bits: u64) -> f64 {
    let sign = if bits & 0x8000 == 0 { 1.0 } else { -1.0 };
    let exponent = (bits >> 10 & 0x1f) as i32;
    let fraction = (bits & 0x3ff) as f64 / 1024.0;
    let size = match exponent {
        0 => fraction * 2f64.powi(-14),
        31 if fraction == 0.0 => f64::INFINITY,
        31 => f64::NAN,
        _ => (1.0 + fraction) * 2f64.powi(exponent - 15),
    };
    sign * size
}
