//! What files are called in messages and results.

use std::path::Path;

use sidc_lang::source::printable;

/// The file's name without folders: what messages and results call it.
pub fn short_name(path: &Path) -> String {
    path.file_name().map_or_else(
        || path.display().to_string(),
        |n| n.to_string_lossy().into_owned(),
    )
}

/// A path as messages show it: a name may be any bytes.
pub fn shown(path: &Path) -> String {
    printable(&path.display().to_string())
}
