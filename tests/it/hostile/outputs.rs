//! Outputs that are not plain files: links, permissions, folders, full disks.

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

/// Writing to standard output can fail like writing to a file.
#[test]
fn a_full_disk_behind_standard_output_is_a_fault() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("t.csv"), super::decay()).unwrap();
    let done = std::process::Command::new(sidc_testing::program::binary())
        .args(["new", "t.csv"])
        .current_dir(folder.path())
        .stdout(std::fs::File::create("/dev/full").unwrap())
        .output()
        .unwrap();
    let said = String::from_utf8(done.stderr).unwrap();
    assert_eq!(done.status.code(), Some(1), "{said}");
    assert!(said.contains("error[unwritable-file]: stdout"), "{said}");
}

/// No command overwrites its own input, under whatever name.
#[test]
fn nothing_that_is_read_is_written_over() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let model = "state x\ndx ~ poly(x; 3)\n";
    std::fs::write(at("m.sid"), model).unwrap();
    std::fs::write(at("t.csv"), super::decay()).unwrap();
    std::fs::write(at("h.csv"), super::decay()).unwrap();
    run(
        folder.path(),
        &["identify", "m.sid", "t.csv", "-o", "R.json"],
    )
    .ended("identify", 0);
    let result = std::fs::read_to_string(at("R.json")).unwrap();
    symlink("t.csv", at("link.csv")).unwrap();
    std::fs::hard_link(at("t.csv"), at("twin.csv")).unwrap();
    for line in [
        "identify m.sid t.csv -o m.sid",
        "identify m.sid t.csv -o ./t.csv",
        "identify m.sid t.csv -o link.csv",
        "identify m.sid link.csv -o t.csv",
        "identify m.sid t.csv -o twin.csv",
        "identify m.sid t.csv --holdout=h.csv -o h.csv",
        "smooth m.sid t.csv -o t.csv",
        "new t.csv -o t.csv",
        "simulate R.json t.csv -o t.csv",
        "simulate R.json t.csv -o R.json",
        "report R.json t.csv -o R.json",
        "export R.json --to c -o R.json",
    ] {
        let arguments: Vec<&str> = line.split(' ').collect();
        let words = ["error[output-is-input]", "name another file"];
        run(folder.path(), &arguments).refused(line, 1, &words);
    }
    let read = |name: &str| std::fs::read_to_string(at(name)).unwrap();
    assert_eq!((read("m.sid"), read("R.json")), (model.into(), result));
    for data in ["t.csv", "h.csv", "twin.csv", "link.csv"] {
        assert_eq!(read(data), super::decay());
    }
}

#[test]
fn a_link_that_leads_nowhere_stays() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("t.csv"), super::decay()).unwrap();
    for to in ["nowhere", "m.sid"] {
        let link = folder.path().join("m.sid");
        symlink(to, &link).unwrap();
        let words = ["error[unwritable-file]: m.sid", "leads nowhere"];
        run(folder.path(), &["new", "t.csv", "-o", "m.sid"]).refused(to, 1, &words);
        assert!(link.is_symlink() && !folder.path().join("nowhere").exists());
        std::fs::remove_file(link).unwrap();
    }
}

/// An answer that took long to find is printed even if it cannot be saved.
#[test]
fn equations_are_printed_though_the_disk_is_full() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("m.sid"), "state x\ndx ~ poly(x; 3)\n").unwrap();
    std::fs::write(folder.path().join("t.csv"), super::decay()).unwrap();
    let ran = run(
        folder.path(),
        &["identify", "m.sid", "t.csv", "-o", "/dev/full"],
    );
    assert!(ran.stdout.contains("dx = -"), "{}", ran.stdout);
    ran.ended("/dev/full", 1);
}
