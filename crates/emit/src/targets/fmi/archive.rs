//! A zip archive.
//!
//! In: names and contents. Out: the bytes of the archive; the same for the same files, because the time stamps are fixed.

use std::io::Write;

use flate2::Compression;
use flate2::write::DeflateEncoder;
use rawzip::time::UtcDateTime;
use rawzip::{CompressionMethod, ZipArchiveWriter};

/// # Errors
/// Never in practice: only memory is written to.
pub(super) fn zip(files: &[(&str, &[u8])]) -> Result<Vec<u8>, String> {
    let mut archive = ZipArchiveWriter::new(Vec::new());
    for (name, content) in files {
        add(&mut archive, name, content).map_err(|e| format!("{name} cannot be packed: {e}"))?;
    }
    let finished = archive.finish();
    finished.map_err(|e| format!("the files cannot be packed: {e}"))
}

fn add(
    archive: &mut ZipArchiveWriter<Vec<u8>>,
    name: &str,
    content: &[u8],
) -> Result<(), Box<dyn std::error::Error>> {
    // The earliest time that an archive can store.
    let time = UtcDateTime::from_components(1980, 1, 1, 0, 0, 0, 0).ok_or("no time")?;
    let file = archive
        .new_file(name)
        .compression_method(CompressionMethod::DEFLATE);
    let (mut entry, config) = file.last_modified(time).start()?;
    let packer = DeflateEncoder::new(&mut entry, Compression::default());
    let mut writer = config.wrap(packer);
    writer.write_all(content)?;
    let (packer, descriptor) = writer.finish()?;
    packer.finish()?;
    entry.finish(descriptor)?;
    Ok(())
}
