//! Places to write to that are no plain file: links, rights, folders, full disks.

use std::fs::Permissions;
use std::os::unix::fs::{PermissionsExt, symlink};

use super::run;

const LOOSE: &str = "state   x\ndx ~  <x>\n";
const NEAT: &str = "state x\ndx ~ <x>\n";

fn mode(path: &std::path::Path) -> u32 {
    std::fs::metadata(path).unwrap().permissions().mode() & 0o777
}

#[test]
fn a_link_is_followed_and_rights_are_kept() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::create_dir(at("store")).unwrap();
    std::fs::write(at("store/real.sid"), LOOSE).unwrap();
    std::fs::set_permissions(at("store/real.sid"), Permissions::from_mode(0o640)).unwrap();
    symlink("store/real.sid", at("m.sid")).unwrap();
    run(folder.path(), &["fmt", "m.sid"]).ended("fmt", 0);
    assert!(std::fs::symlink_metadata(at("m.sid")).unwrap().is_symlink());
    assert_eq!(std::fs::read_to_string(at("store/real.sid")).unwrap(), NEAT);
    assert_eq!(mode(&at("store/real.sid")), 0o640);
}

#[test]
fn a_file_that_is_read_only_stays() {
    let folder = tempfile::tempdir().unwrap();
    let model = folder.path().join("m.sid");
    std::fs::write(&model, LOOSE).unwrap();
    std::fs::set_permissions(&model, Permissions::from_mode(0o444)).unwrap();
    let words = ["error[unwritable-file]", "m.sid", "read-only"];
    run(folder.path(), &["fmt", "m.sid"]).refused("fmt", 1, &words);
    assert_eq!(std::fs::read_to_string(&model).unwrap(), LOOSE);
}

#[test]
fn where_nothing_can_be_written_the_place_is_named() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("t.csv"), super::decay()).unwrap();
    std::fs::create_dir(folder.path().join("folder.sid")).unwrap();
    for (place, word) in [
        ("folder.sid", "irectory"),
        ("none/m.sid", "o such file"),
        ("t.csv/m.sid", "ot a directory"),
        ("/dev/full", "o space left"),
    ] {
        let ran = run(folder.path(), &["new", "t.csv", "-o", place]);
        ran.refused(place, 1, &["error[unwritable-file]", place, word]);
        let mut names: Vec<_> = std::fs::read_dir(folder.path())
            .unwrap()
            .flatten()
            .collect();
        names.retain(|e| e.file_name().to_string_lossy().starts_with(".sidc-"));
        assert!(names.is_empty(), "{names:?}");
    }
}

/// Standard output is a file like any other.
#[test]
fn a_full_disk_behind_standard_output_is_a_fault() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("t.csv"), super::decay()).unwrap();
    let done = std::process::Command::new(env!("CARGO_BIN_EXE_sidc"))
        .args(["new", "t.csv"])
        .current_dir(folder.path())
        .stdout(std::fs::File::create("/dev/full").unwrap())
        .output()
        .unwrap();
    let said = String::from_utf8(done.stderr).unwrap();
    assert_eq!(done.status.code(), Some(1), "{said}");
    assert!(said.contains("error[unwritable-file]: stdout"), "{said}");
}
