//! Results out: whole or not at all.

use std::fs::{File, Metadata};
use std::io::Write;
use std::path::Path;

use super::{Failure, inputs, limits};
use crate::lang::source::printable;

/// Prints what people read: names from files steer no terminal.
pub fn show(text: &str) -> Result<(), Failure> {
    print(&printable(text))
}

/// Prints to stdout in one piece; a closed pipe is no fault.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
        other => other.map_err(|e| Failure::new(format!("error[unwritable-file]: stdout: {e}"))),
    }
}

/// Temporary files are hidden, and say whose they are: a killed process leaves one where it was writing.
const TEMPORARY: &str = ".sidc-";

/// Writes a file by way of a temporary one beside it, so that the old file stays whole until the new one is. A link is followed;
/// the file keeps its permissions.
pub fn write(path: &Path, text: &str) -> Result<(), Failure> {
    let fail = |e: &dyn std::fmt::Display| {
        let place = inputs::shown(path);
        Failure::new(format!("error[unwritable-file]: {place}: {e}"))
    };
    let old = std::fs::metadata(path).ok();
    if old.as_ref().is_some_and(|m| !m.is_file()) {
        // /dev/stdout and the like cannot be renamed over.
        return std::fs::write(path, text).map_err(|e| fail(&e));
    }
    if old.as_ref().is_some_and(|m| m.permissions().readonly()) {
        return Err(fail(
            &"the file is read-only; allow writing, or name another",
        ));
    }
    // Ctrl-C waits: a process that is ended here would leave its temporary file.
    let _whole = limits::unbroken();
    let place = match &old {
        Some(_) => std::fs::canonicalize(path).map_err(|e| fail(&e))?,
        None => path.to_path_buf(),
    };
    let folder = match place.parent() {
        Some(p) if !p.as_os_str().is_empty() => p,
        _ => Path::new("."),
    };
    let mut file = temporary(folder).map_err(|e| fail(&e))?;
    file.write_all(text.as_bytes()).map_err(|e| fail(&e))?;
    if let Some(old) = &old {
        keep_rights(file.as_file(), old).map_err(|e| fail(&e))?;
    }
    file.as_file().sync_all().map_err(|e| fail(&e))?;
    file.persist(&place).map_err(|e| fail(&e.error))?;
    Ok(())
}

#[cfg(unix)]
fn temporary(folder: &Path) -> std::io::Result<tempfile::NamedTempFile> {
    use std::os::unix::fs::PermissionsExt;
    // Readable as any new file is; the default of temporary files is the owner alone.
    tempfile::Builder::new()
        .prefix(TEMPORARY)
        .permissions(std::fs::Permissions::from_mode(0o666))
        .tempfile_in(folder)
}

#[cfg(not(unix))]
fn temporary(folder: &Path) -> std::io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(TEMPORARY).tempfile_in(folder)
}

/// The new file may be read and written by whom the old one may.
#[cfg(unix)]
fn keep_rights(new: &File, old: &Metadata) -> std::io::Result<()> {
    use std::os::unix::fs::{MetadataExt, fchown};
    // Only root can give files away, and only root finds files of others.
    let _ = fchown(new, Some(old.uid()), Some(old.gid()));
    new.set_permissions(old.permissions())
}

#[cfg(not(unix))]
fn keep_rights(_new: &File, _old: &Metadata) -> std::io::Result<()> {
    Ok(())
}
