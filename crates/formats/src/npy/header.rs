//! The header of an array: its type, order and shape.

use super::dtype::Dtype;
use super::literal::{self, Literal};
use crate::bytes::Bytes;
use crate::fault::Fault;

/// Longest header that is read, bytes; NumPy itself reads 10,000 unless told otherwise.
const MAX_LENGTH: u64 = 1 << 16;

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Header {
    pub dtype: Dtype,
    /// True if the first index runs fastest.
    pub column_major: bool,
    pub shape: Vec<usize>,
    /// Bytes before the values.
    pub length: usize,
}

impl Header {
    /// # Errors
    /// Not a NumPy header.
    pub(super) fn read(bytes: &[u8]) -> Result<Header, Fault> {
        let mut all = Bytes::new(bytes, false);
        let magic = all.take(8)?;
        let length = match magic {
            [0x93, b'N', b'U', b'M', b'P', b'Y', 1, _] => u64::from(all.u16()?),
            [0x93, b'N', b'U', b'M', b'P', b'Y', 2 | 3, _] => u64::from(all.u32()?),
            _ => return Err(Fault::damaged("it does not begin as an array of NumPy")),
        };
        if length > MAX_LENGTH {
            return Err(Fault::damaged(format!(
                "its header of {length} bytes is too long"
            )));
        }
        let text = all.take(length)?;
        let text =
            std::str::from_utf8(text).map_err(|_| Fault::damaged("its header is no text"))?;
        let Literal::Dict(entries) = literal::parse(text)? else {
            return Err(Fault::damaged("its header is no dictionary"));
        };
        let entry = |key: &str| {
            let found = entries.iter().find(|(k, _)| k == key);
            let missing = || Fault::damaged(format!("its header has no `{key}`"));
            found.map(|(_, value)| value).ok_or_else(missing)
        };
        Ok(Header {
            dtype: Dtype::of(entry("descr")?)?,
            column_major: matches!(entry("fortran_order")?, Literal::Truth(true)),
            shape: shape(entry("shape")?)?,
            length: bytes.len() - all.rest().len(),
        })
    }

    /// Number of values.
    ///
    /// # Errors
    /// More than can be counted.
    pub(super) fn count(&self) -> Result<u64, Fault> {
        let sides = self.shape.iter().map(|n| *n as u64);
        let mut sides = sides.collect::<Vec<u64>>().into_iter();
        let product = sides.try_fold(1u64, |all, n| all.checked_mul(n));
        product.ok_or_else(|| Fault::damaged("its shape has more values than can be counted"))
    }
}

fn shape(literal: &Literal) -> Result<Vec<usize>, Fault> {
    let wrong = || Fault::damaged("its shape is no tuple of whole numbers");
    let Literal::Sequence(sides) = literal else {
        return Err(wrong());
    };
    let side = |side: &Literal| match side {
        Literal::Whole(n) => usize::try_from(*n).map_err(|_| wrong()),
        _ => Err(wrong()),
    };
    sides.iter().map(side).collect()
}
