//! Data files of every kind that is read.
//!
//! In: a reader. Out: a [`FileTable`], whatever the file was, or every reason why there is none. What a file is, is told by its first
//! bytes and not by its name. Opens no files, and takes no memory that the limits do not allow.
//!
//! Flow: bytes → `kind` → `sidc_data::read` (text); or `npy`, `mat`, `hdf5`, `arrow`, `parquet` → `variables`; or, of logs, `ulog`, `mcap` → `topics` → `sidc_data::Table`.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

// The crates that read Parquet and HDF5 panic on some broken files, which `parquet` and `hdf5` turn into a message. Where a panic ends the process, as
// in the profile `release`, those files are not read.

mod arrow;
mod budget;
mod bytes;
mod fault;
mod gathered;
#[cfg(all(feature = "hdf5", panic = "unwind"))]
mod hdf5;
mod kind;
mod mat;
mod mcap;
mod moments;
mod npy;
mod packing;
#[cfg(all(feature = "parquet", panic = "unwind"))]
mod parquet;
mod read;
mod topics;
mod ulog;
mod variables;

pub use read::{FileTable, read};
