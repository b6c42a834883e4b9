//! What the project requires of those who build it.

use std::path::PathBuf;
use std::process::Command;

use sidc_testing::program::root;

/// The numbers of `1.89` or `1.89.0`.
fn version(text: &str) -> Vec<u32> {
    let mut numbers: Vec<u32> = text.split('.').map(|n| n.parse().unwrap()).collect();
    numbers.resize(3, 0);
    numbers
}

/// Name, version and licence of every crate built here. `cargo metadata` cannot be used: other crates, such as those of the Python package, may not have been
/// fetched. `cargo deny` checks them all.
fn crates() -> Vec<(String, String, String)> {
    let run = Command::new(env!("CARGO"))
        .args(["tree", "--locked", "--offline", "--prefix", "none"])
        .args(["--no-dedupe", "--format", "{p}|{l}"])
        .current_dir(root())
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&run.stderr);
    assert!(run.status.success(), "{said}");
    let text = String::from_utf8(run.stdout).unwrap();
    let mut lines: Vec<&str> = text.lines().filter(|l| !l.is_empty()).collect();
    lines.sort_unstable();
    lines.dedup();
    let split = |line: &str| {
        let (package, licence) = line.split_once('|').unwrap();
        let mut words = package.split(' ');
        let (name, version) = (words.next().unwrap(), words.next().unwrap());
        (
            name.into(),
            version.trim_start_matches('v').into(),
            licence.into(),
        )
    };
    let all: Vec<_> = lines.into_iter().map(split).collect();
    assert!(all.len() > 50);
    all
}

/// The folders that cargo unpacks crates into.
fn registries() -> Vec<PathBuf> {
    let home = std::env::var_os("CARGO_HOME").map(PathBuf::from);
    let home =
        home.unwrap_or_else(|| PathBuf::from(std::env::var_os("HOME").unwrap()).join(".cargo"));
    let folders = std::fs::read_dir(home.join("registry/src")).unwrap();
    folders.map(|f| f.unwrap().path()).collect()
}

/// The compiler version in `Cargo.toml` suffices for every dependency; clippy checks our own code.
#[test]
fn the_oldest_compiler_is_new_enough_for_all_dependencies() {
    let own = version(env!("CARGO_PKG_RUST_VERSION"));
    let registries = registries();
    let mut read = 0;
    for (name, v, _) in crates() {
        let manifests = registries
            .iter()
            .map(|r| r.join(format!("{name}-{v}/Cargo.toml")));
        let Some(text) = manifests
            .filter_map(|m| std::fs::read_to_string(m).ok())
            .next()
        else {
            continue;
        };
        read += 1;
        let line = text.lines().find_map(|l| l.strip_prefix("rust-version = "));
        let needed = line.unwrap_or("0").trim_matches('"');
        assert!(
            version(needed) <= own,
            "{name} needs Rust {needed}, Cargo.toml says {own:?}"
        );
    }
    assert!(read > 50, "{read} manifests in {registries:?}");
}

/// Every crate is available under a licence that `deny.toml` allows. `cargo deny check` parses licences completely; here no expression may have an OR around
/// an AND.
#[test]
fn licences_are_those_allowed() {
    let deny = std::fs::read_to_string(root().join("deny.toml")).unwrap();
    let list = deny.split("allow = [").nth(1).unwrap();
    let list = list.split(']').next().unwrap();
    let allowed: Vec<&str> = list.split('"').skip(1).step_by(2).collect();
    assert!(allowed.contains(&"MIT"));
    for (name, _, licence) in crates() {
        let text = licence.replace('/', " OR ");
        let every = text.split(" AND ").all(|part| {
            let part = part.trim_matches(['(', ')']);
            part.split(" OR ").any(|l| allowed.contains(&l.trim()))
        });
        assert!(every, "{name}: {text}");
    }
}
