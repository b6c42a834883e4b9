//! Memory that a file may still take, asked for before it is taken.

use std::io::Read;

use sidc_data::Limits;

use crate::fault::Fault;

/// What is left of the limit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Budget {
    left: u64,
    limit: u64,
}

impl Budget {
    /// What earlier tables and the bytes of this file leave of the limit.
    pub(crate) fn of(limits: &Limits, file: usize) -> Budget {
        let limit = limits.table_bytes;
        Budget {
            left: limit.saturating_sub(limits.taken.saturating_add(file as u64)),
            limit,
        }
    }

    /// Bytes that may still be taken.
    pub(crate) fn left(&self) -> u64 {
        self.left
    }

    /// Takes `count` values of `bytes` bytes each.
    ///
    /// # Errors
    /// More than is left.
    pub(crate) fn take(&mut self, count: u64, bytes: u64) -> Result<(), Fault> {
        let all = count.saturating_mul(bytes);
        if all > self.left {
            return Err(Fault::too_large(self.limit));
        }
        self.left -= all;
        Ok(())
    }

    /// Gives back what was taken temporarily.
    pub(crate) fn give(&mut self, bytes: u64) {
        self.left = self.left.saturating_add(bytes);
    }

    /// Unpacks everything, without trusting the length that the packed bytes announce.
    ///
    /// # Errors
    /// More than is left; what cannot be unpacked.
    pub(crate) fn unpack(&mut self, packed: impl Read) -> Result<Vec<u8>, Fault> {
        let mut out = Vec::new();
        // One byte more than is left shows that the limit is passed.
        let most = self.left.saturating_add(1);
        let read = packed.take(most).read_to_end(&mut out);
        self.take(out.len() as u64, 1)?;
        read.map_err(|e| Fault::damaged(format!("it cannot be unpacked ({e})")))?;
        Ok(out)
    }
}
