//! Compression of logs and of Arrow files.

use crate::budget::Budget;
use crate::fault::Fault;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Compression {
    /// In frames.
    Lz4,
    Zstd,
}

impl Compression {
    /// The unpacked bytes, as many as are announced.
    ///
    /// # Errors
    /// Another number of them, or more than is left; damage.
    pub(crate) fn unpack(
        self,
        packed: &[u8],
        announced: u64,
        budget: &mut Budget,
    ) -> Result<Vec<u8>, Fault> {
        let unpacked = match self {
            Compression::Lz4 => budget.unpack(lz4_flex::frame::FrameDecoder::new(packed))?,
            Compression::Zstd => {
                let decoder = ruzstd::decoding::StreamingDecoder::new(packed);
                let unreadable = |e| Fault::damaged(format!("it cannot be unpacked ({e})"));
                budget.unpack(decoder.map_err(unreadable)?)?
            }
        };
        let there = unpacked.len();
        match there as u64 == announced {
            true => Ok(unpacked),
            false => Err(Fault::damaged(format!(
                "{announced} bytes are announced where {there} were packed"
            ))),
        }
    }
}
