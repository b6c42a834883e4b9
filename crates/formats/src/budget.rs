//! Memory that a file may still take, asked for before it is taken.

use sidc_data::Limits;

use crate::fault::Fault;

/// What is left of the limit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Budget {
    left: u64,
    limit: u64,
}

impl Budget {
    /// What tables read before and the bytes of this file leave.
    pub(crate) fn of(limits: &Limits, file: usize) -> Budget {
        let limit = limits.table_bytes;
        Budget {
            left: limit.saturating_sub(limits.taken.saturating_add(file as u64)),
            limit,
        }
    }

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
}
