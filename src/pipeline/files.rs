//! Hashes of files, so that a result says what it was found from.
//!
//! In: bytes as they are read. Out: names with hashes. Opens no file.

use std::io::{Read, Result};

use sha2::{Digest, Sha256};
use sidc_system::result::FileEntry;

/// A reader that hashes what it reads.
pub struct Hashed<R> {
    inner: R,
    hash: Sha256,
}

impl<R: Read> Hashed<R> {
    pub fn new(inner: R) -> Hashed<R> {
        Hashed {
            inner,
            hash: Sha256::new(),
        }
    }

    /// The bytes read so far, as a file of this name.
    pub fn entry(self, name: &str) -> FileEntry {
        entry(name, self.hash)
    }
}

impl<R: Read> Read for Hashed<R> {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize> {
        let n = self.inner.read(buffer)?;
        self.hash.update(buffer.get(..n).unwrap_or_default());
        Ok(n)
    }
}

/// A file of this name and content.
pub fn file_entry(name: &str, bytes: &[u8]) -> FileEntry {
    entry(name, Sha256::new_with_prefix(bytes))
}

fn entry(name: &str, hash: Sha256) -> FileEntry {
    FileEntry {
        name: name.into(),
        sha256: hash.finalize().iter().map(|b| format!("{b:02x}")).collect(),
    }
}
