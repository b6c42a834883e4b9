//! Results out: whole or not at all.

use std::io::Write;
use std::path::Path;

use super::Failure;

/// Prints to stdout in one piece; a closed pipe is no fault.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
        other => other.map_err(|e| Failure::new(format!("error[unwritable-file]: stdout: {e}"))),
    }
}

/// Writes a file by way of a temporary one beside it, so that the old file stays whole until the new one is.
pub fn write(path: &Path, text: &str) -> Result<(), Failure> {
    let fail = |e: &dyn std::fmt::Display| {
        Failure::new(format!("error[unwritable-file]: {}: {e}", path.display()))
    };
    let special = std::fs::metadata(path).is_ok_and(|m| !m.is_file());
    if special {
        // /dev/stdout and the like cannot be renamed over.
        return std::fs::write(path, text).map_err(|e| fail(&e));
    }
    let folder = match path.parent() {
        Some(p) if !p.as_os_str().is_empty() => p,
        _ => Path::new("."),
    };
    let mut file = temporary(folder).map_err(|e| fail(&e))?;
    file.write_all(text.as_bytes())
        .and_then(|()| file.as_file().sync_all())
        .map_err(|e| fail(&e))?;
    file.persist(path).map_err(|e| fail(&e.error))?;
    Ok(())
}

#[cfg(unix)]
fn temporary(folder: &Path) -> std::io::Result<tempfile::NamedTempFile> {
    use std::os::unix::fs::PermissionsExt;
    // Readable as any new file is; the default of temporary files is the owner alone.
    tempfile::Builder::new()
        .permissions(std::fs::Permissions::from_mode(0o666))
        .tempfile_in(folder)
}

#[cfg(not(unix))]
fn temporary(folder: &Path) -> std::io::Result<tempfile::NamedTempFile> {
    tempfile::NamedTempFile::new_in(folder)
}
