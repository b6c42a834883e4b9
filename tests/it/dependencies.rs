//! What the crate asks of those who build it.

use std::process::Command;

use serde_json::Value;

use sidc_testing::program::root;

/// Numbers of `1.89` or `1.89.0`.
fn version(text: &str) -> Vec<u32> {
    let mut numbers: Vec<u32> = text.split('.').map(|n| n.parse().unwrap()).collect();
    numbers.resize(3, 0);
    numbers
}

/// The platform this runs on, `x86_64-unknown-linux-gnu`.
fn host() -> String {
    let run = Command::new("rustc").arg("-vV").output().unwrap();
    let said = String::from_utf8(run.stdout).unwrap();
    let host = said.lines().find_map(|l| l.strip_prefix("host: "));
    host.unwrap().into()
}

/// The crates that are built here, as cargo knows them: others need not have been fetched. `cargo deny` looks at all.
fn packages() -> Vec<Value> {
    let run = Command::new(env!("CARGO"))
        .args(["metadata", "--format-version", "1", "--locked", "--offline"])
        .args(["--filter-platform", &host()])
        .current_dir(root())
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&run.stderr);
    assert!(run.status.success(), "{said}");
    let all: Value = serde_json::from_slice(&run.stdout).unwrap();
    let packages = all["packages"].as_array().unwrap().clone();
    assert!(packages.len() > 50);
    packages
}

/// The compiler that `Cargo.toml` names suffices for every crate; clippy looks at what our own code asks of it.
#[test]
fn the_oldest_compiler_is_new_enough_for_all_dependencies() {
    let own = version(env!("CARGO_PKG_RUST_VERSION"));
    for p in packages() {
        let needed = p["rust_version"].as_str().unwrap_or("0");
        let name = &p["name"];
        assert!(
            version(needed) <= own,
            "{name} needs Rust {needed}, Cargo.toml says {own:?}"
        );
    }
}

/// Every crate can be had under licences that `deny.toml` allows. `cargo deny check` reads licences whole; here no expression has
/// an OR around an AND.
#[test]
fn licences_are_those_allowed() {
    let deny = std::fs::read_to_string(root().join("deny.toml")).unwrap();
    let list = deny.split("allow = [").nth(1).unwrap();
    let list = list.split(']').next().unwrap();
    let allowed: Vec<&str> = list.split('"').skip(1).step_by(2).collect();
    assert!(allowed.contains(&"MIT"));
    for p in packages() {
        let text = p["license"].as_str().unwrap().replace('/', " OR ");
        let every = text.split(" AND ").all(|part| {
            let part = part.trim_matches(['(', ')']);
            part.split(" OR ").any(|l| allowed.contains(&l.trim()))
        });
        assert!(every, "{}: {text}", p["name"]);
    }
}
