//! Readers of data files in all supported formats.
//!
//! In: a reader. Out: a [`FileTable`], whatever the format, or every reason why there is none. A format is recognised by the first bytes of
//! a file, not by its name. Opens no files, and takes no more memory than the limits allow.
//!
//! Flow: bytes → `kind` → `sidc_data::read` for text; `npy`, `mat`, `hdf5`, `arrow` or `parquet` → `variables` for arrays; `ulog` or `mcap`
//! → `topics` → `sidc_data::Table` for logs.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

// The crates that read Parquet and HDF5 panic on some broken files, which `parquet` and `hdf5` turn into a message. Where a panic ends the process, as
// in the profile `release`, those files are not read.

mod arrow;
mod budget;
mod bytes;
mod column_builder;
mod compression;
mod fault;
#[cfg(all(feature = "hdf5", panic = "unwind"))]
mod hdf5;
mod kind;
mod mat;
mod mcap;
mod npy;
#[cfg(all(feature = "parquet", panic = "unwind"))]
mod parquet;
mod read;
mod timestamps;
mod topics;
mod ulog;
mod variables;

pub use read::{FileTable, read};
