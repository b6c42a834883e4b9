//! What a file is, by its first bytes.

use crate::fault::Fault;

/// First and last bytes of an Arrow file.
pub(crate) const ARROW: &[u8] = b"ARROW1";

/// First bytes of every Arrow message, and so of a stream.
const ARROW_STREAM: &[u8] = b"\xff\xff\xff\xff";

/// First bytes of a PX4 log, without the version.
const ULOG: &[u8] = b"ULog\x01\x12\x35";

/// First bytes of an MCAP file.
pub(crate) const MCAP: &[u8] = b"\x89MCAP0\r\n";

/// Bytes that are enough to recognise every format.
pub(crate) const HEAD: u64 = 512;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Text, or an unknown format: the reader of text says what is wrong with it.
    Text,
    Npy,
    Zip,
    Mat,
    Hdf5,
    Parquet,
    Arrow,
    Ulog,
    Mcap,
}

impl Kind {
    /// # Errors
    /// A format that is recognised but not read.
    pub(crate) fn of(head: &[u8]) -> Result<Kind, Fault> {
        let starts = |magic: &[u8]| head.starts_with(magic);
        if starts(b"\x93NUMPY") {
            return Ok(Kind::Npy);
        }
        if starts(b"PK\x03\x04") || starts(b"PK\x05\x06") {
            return Ok(Kind::Zip);
        }
        if starts(b"PAR1") {
            return Ok(Kind::Parquet);
        }
        if starts(ARROW) || starts(ARROW_STREAM) {
            return Ok(Kind::Arrow);
        }
        if starts(ULOG) {
            return Ok(Kind::Ulog);
        }
        if starts(MCAP) {
            return Ok(Kind::Mcap);
        }
        if starts(b"MATLAB 7.3") || starts(b"\x89HDF") {
            return Ok(Kind::Hdf5);
        }
        if is_mat(head) {
            return Ok(Kind::Mat);
        }
        if starts(b"FEA1") {
            return Err(Fault::unsupported("a Feather file of version 1")
                .help("write it again, by a pandas or pyarrow of today"));
        }
        if starts(b"\xd0\xcf\x11\xe0") {
            return Err(Fault::unsupported("an old Excel workbook").help(CSV));
        }
        if starts(b"\x1f\x8b") {
            return Err(Fault::unsupported("compressed with gzip").help("unpack it: gunzip FILE"));
        }
        Ok(Kind::Text)
    }
}

/// Remedy for files of other programs.
pub(crate) const CSV: &str = "export the data as CSV in UTF-8";

/// A MAT-file of level 5: text, then a version and the order of bytes (MathWorks, MAT-File Format, 1-6).
fn is_mat(head: &[u8]) -> bool {
    matches!(
        head.get(124..128),
        Some([0, 1, b'I', b'M'] | [1, 0, b'M', b'I'])
    )
}
