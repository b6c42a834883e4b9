//! Writes files completely or not at all.
//!
//! In: a path, a text or bytes. Out: the file replaced, or a failure with the old file unchanged.

use std::fs::{File, Metadata};
use std::io::Write;
use std::path::{Path, PathBuf};

use super::paths::shown;
use super::stdout;
use crate::failure::Failure;
use crate::monitoring::interrupts;
use sidc_data::io_error_text;

/// Prefix of temporary files: hidden, and with the name of the program, because a killed process may leave one behind.
const TEMPORARY: &str = ".sidc-";

/// Checks before the work starts that the result can be written and overwrites no input.
///
/// # Errors
/// The path is one of `inputs`, possibly under another name, or cannot be written to.
pub fn check_writable<'a>(
    place: Option<&Path>,
    inputs: impl IntoIterator<Item = &'a PathBuf>,
) -> Result<(), Failure> {
    let Some(path) = place else { return Ok(()) };
    let Some(target) = Target::of(path)? else {
        return Ok(());
    };
    if let Some(read) = inputs.into_iter().find(|i| target.is(i)) {
        return Err(Failure::new(format!(
            "error[output-is-input]: {}: the output would replace {}, which is read\n  = help: name another file after -o",
            shown(path),
            shown(read)
        )));
    }
    // An unnamed file, so that nothing is left behind if the process ends here.
    tempfile::tempfile_in(&target.folder)
        .map(drop)
        .map_err(|e| fail(path, &e))
}

/// Writes to a file, or to standard output if no file is named.
pub fn write_or_print(place: Option<&Path>, content: impl AsRef<[u8]>) -> Result<(), Failure> {
    match place {
        Some(path) => write(path, content),
        None => stdout::print(content),
    }
}

/// Writes a temporary file in the same folder and renames it, so that the old file is intact until the new one is complete. Links are followed, and
/// permissions are kept.
pub fn write(path: &Path, content: impl AsRef<[u8]>) -> Result<(), Failure> {
    let content = content.as_ref();
    let fail = |e: &std::io::Error| fail(path, e);
    let Some(target) = Target::of(path)? else {
        return std::fs::write(path, content).map_err(|e| fail(&e));
    };
    // If Ctrl-C ended the process here, the temporary file would remain.
    let _whole = interrupts::hold_off();
    let mut file = temporary(&target.folder).map_err(|e| fail(&e))?;
    file.write_all(content).map_err(|e| fail(&e))?;
    if let Some(old) = &target.old {
        copy_permissions(file.as_file(), old).map_err(|e| fail(&e))?;
    }
    file.as_file().sync_all().map_err(|e| fail(&e))?;
    file.persist(&target.place).map_err(|e| fail(&e.error))?;
    Ok(())
}

/// A file to write, with all links resolved.
struct Target {
    place: PathBuf,
    folder: PathBuf,
    /// The file there now.
    old: Option<Metadata>,
}

impl Target {
    /// `None` for /dev/stdout and the like, which cannot be replaced by renaming.
    fn of(path: &Path) -> Result<Option<Target>, Failure> {
        let refuse = |why: &str| Err(unwritable(path, why));
        let old = std::fs::metadata(path).ok();
        let place = match &old {
            Some(m) if m.is_dir() => return refuse("this is a directory; name a file in it"),
            Some(m) if !m.is_file() => return Ok(None),
            Some(m) if m.permissions().readonly() => {
                return refuse("the file is read-only; allow writing, or name another");
            }
            Some(_) => std::fs::canonicalize(path).map_err(|e| fail(path, &e))?,
            None if path.is_symlink() => {
                return refuse("a link that leads nowhere; remove it, or name another file");
            }
            None => path.to_path_buf(),
        };
        let folder = place.parent().filter(|p| !p.as_os_str().is_empty());
        let folder = folder.unwrap_or(Path::new(".")).to_path_buf();
        Ok(Some(Target { place, folder, old }))
    }

    /// Whether another path leads to this file, by symbolic or hard links.
    #[cfg(unix)]
    fn is(&self, other: &Path) -> bool {
        use std::os::unix::fs::MetadataExt;
        let file = |m: &Metadata| (m.dev(), m.ino());
        let read = std::fs::metadata(other).ok();
        self.old.is_some() && self.old.as_ref().map(file) == read.as_ref().map(file)
    }

    /// Whether another path leads to this file; hard links are not detected.
    #[cfg(not(unix))]
    fn is(&self, other: &Path) -> bool {
        std::fs::canonicalize(other).is_ok_and(|p| p == self.place)
    }
}

fn fail(path: &Path, e: &std::io::Error) -> Failure {
    unwritable(path, &io_error_text(e))
}

fn unwritable(path: &Path, why: &str) -> Failure {
    let place = shown(path);
    Failure::new(format!("error[unwritable-file]: {place}: {why}"))
}

#[cfg(unix)]
fn temporary(folder: &Path) -> std::io::Result<tempfile::NamedTempFile> {
    use std::os::unix::fs::PermissionsExt;
    // Default permissions of a new file; those of temporary files exclude all others.
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

/// Copies owner and permissions of the old file to the new one.
#[cfg(unix)]
fn copy_permissions(new: &File, old: &Metadata) -> std::io::Result<()> {
    use std::os::unix::fs::{MetadataExt, fchown};
    // Only root may change the owner; for others it is already the same.
    let _ = fchown(new, Some(old.uid()), Some(old.gid()));
    new.set_permissions(old.permissions())
}

#[cfg(not(unix))]
fn copy_permissions(_new: &File, _old: &Metadata) -> std::io::Result<()> {
    Ok(())
}
