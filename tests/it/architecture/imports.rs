//! Which files of a crate import which, read from `use` trees and paths in whole files, including test modules.
//!
//! In: the folder of a crate's sources. Out: for each file the files it imports. Re-exports lead to the file that defines the item, and are not imports of
//! the file that re-exports. Reads only the text, not what macros generate.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Files by their path below `src`, with the files that each imports.
pub type Imports = BTreeMap<String, BTreeSet<String>>;

/// One file as a module.
struct Module {
    file: String,
    text: String,
    /// Names re-exported from other modules: name → path segments.
    reexports: BTreeMap<String, Vec<String>>,
}

/// All `.rs` files below a folder, in order.
pub fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// A file's code without its comments.
pub fn code(path: &Path) -> String {
    let text = fs::read_to_string(path).unwrap();
    let lines = text.lines().filter(|l| !l.trim_start().starts_with("//"));
    lines.map(|l| format!("{l}\n")).collect()
}

/// `a/b.rs` and `a/b/mod.rs` are the module a::b, lib.rs and main.rs the root.
fn module_of(file: &str) -> Vec<String> {
    let stem = file.trim_end_matches(".rs").trim_end_matches("/mod");
    if matches!(stem, "lib" | "main" | "mod") {
        return Vec::new();
    }
    stem.split('/').map(String::from).collect()
}

fn in_a_name(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// The paths in a use tree: `a::{b, c::d as e}` gives a::b and a::c::d.
fn paths_of_tree(tree: &str) -> Vec<Vec<String>> {
    let tree = tree.trim();
    let segments = |text: &str| -> Vec<String> {
        let text = text.split(" as ").next().unwrap_or_default();
        let parts = text.split("::").map(str::trim);
        parts.filter(|p| !p.is_empty()).map(String::from).collect()
    };
    let Some((head, rest)) = tree.split_once('{') else {
        return vec![segments(tree)];
    };
    let inner = rest.rsplit_once('}').map_or(rest, |(inner, _)| inner);
    let head = segments(head);
    let (mut depth, mut start, mut parts) = (0, 0, Vec::new());
    for (i, c) in inner.char_indices() {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                parts.push(&inner[start..i]);
                start = i + 1;
            }
            _ => {}
        }
    }
    parts.push(&inner[start..]);
    let parts = parts.into_iter().filter(|p| !p.trim().is_empty());
    let below = parts.flat_map(paths_of_tree);
    below.map(|path| [head.clone(), path].concat()).collect()
}

/// Use trees: whether each is a re-export, and its paths.
fn uses(text: &str) -> Vec<(bool, Vec<Vec<String>>)> {
    let mut found = Vec::new();
    for (i, _) in text.match_indices("use ") {
        let line = text[..i].rsplit('\n').next().unwrap_or_default().trim();
        let public = line.starts_with("pub");
        if !line.is_empty() && !public {
            continue;
        }
        let tree = text[i + 4..].split(';').next().unwrap_or_default();
        found.push((public, paths_of_tree(tree)));
    }
    found
}

/// Paths in code that start with `first`, as segments: `super::a::b(…)` gives super, a, b.
fn inline_paths(text: &str, first: &str) -> Vec<Vec<String>> {
    let mark = format!("{first}::");
    let mut found = Vec::new();
    for (i, _) in text.match_indices(&mark) {
        let before = &text[..i];
        if before.ends_with(in_a_name) || before.ends_with("::") {
            continue;
        }
        let end = text[i..].find(|c: char| !in_a_name(c) && c != ':');
        let path = &text[i..end.map_or(text.len(), |e| i + e)];
        let parts = path.split("::").filter(|p| !p.is_empty());
        found.push(parts.map(String::from).collect());
    }
    found
}

/// Splits a file at its inline test modules into its own code and the code one level deeper.
fn levels(text: &str) -> (String, String) {
    let (mut own, mut inner, mut inside) = (String::new(), String::new(), false);
    for line in text.lines() {
        let opens = line.starts_with("mod ") || line.starts_with("pub mod ");
        inside |= opens && line.ends_with('{');
        let level = if inside { &mut inner } else { &mut own };
        level.push_str(line);
        level.push('\n');
        inside &= line != "}";
    }
    (own, inner)
}

struct Crate {
    modules: BTreeMap<Vec<String>, Module>,
}

impl Crate {
    fn read(src: &Path) -> Crate {
        let mut modules = BTreeMap::new();
        for path in sources(src) {
            let file = path.strip_prefix(src).unwrap().to_str().unwrap();
            if file.starts_with("bin/") {
                continue;
            }
            let module = module_of(file);
            let text = code(&path);
            let mut reexports = BTreeMap::new();
            for (public, paths) in uses(&levels(&text).0) {
                for path in paths.into_iter().filter(|_| public) {
                    if let Some(name) = path.last() {
                        reexports.insert(name.clone(), path.clone());
                    }
                }
            }
            modules.insert(
                module,
                Module {
                    file: file.into(),
                    text,
                    reexports,
                },
            );
        }
        Crate { modules }
    }

    /// The module that a path leads to from another module; `None` if it is outside the crate.
    fn target(&self, from: &[String], path: &[String], depth: usize) -> Option<Vec<String>> {
        let mut at = from.to_vec();
        let mut rest = path;
        match path.first()?.as_str() {
            "crate" => {
                at.clear();
                rest = &path[1..];
            }
            "self" => rest = &path[1..],
            "super" => {
                while rest.first().is_some_and(|s| s == "super") {
                    at.pop()?;
                    rest = &rest[1..];
                }
            }
            // A module below this one, or another crate.
            first => {
                let below = [from, &[first.to_string()]].concat();
                if !self.modules.contains_key(&below) {
                    return None;
                }
            }
        }
        while let Some(next) = rest.first() {
            let below = [at.as_slice(), std::slice::from_ref(next)].concat();
            if self.modules.contains_key(&below) {
                (at, rest) = (below, &rest[1..]);
                continue;
            }
            let again = self.modules.get(&at)?.reexports.get(next);
            if let Some(again) = again.filter(|_| depth < 8)
                && let Some(found) = self.target(&at, again, depth + 1)
            {
                return Some(found);
            }
            break;
        }
        Some(at)
    }

    fn imports(&self) -> Imports {
        let mut all = Imports::new();
        for (module, m) in &self.modules {
            let mut found = BTreeSet::new();
            let (own, inner) = levels(&m.text);
            for (text, deeper) in [(own, false), (inner, true)] {
                let mut paths = Vec::new();
                for (public, trees) in uses(&text) {
                    paths.extend(trees.into_iter().filter(|_| !public));
                }
                let children = self
                    .modules
                    .keys()
                    .filter(|k| k.len() == module.len() + 1 && k.starts_with(module));
                let children = children.filter_map(|k| k.last().map(String::as_str));
                let reexported: String = without_uses(&text);
                for first in ["crate", "super", "self"].into_iter().chain(children) {
                    paths.extend(inline_paths(&reexported, first));
                }
                for mut path in paths {
                    if deeper && path.first().is_some_and(|s| s == "super") {
                        path[0] = "self".into();
                        if path.get(1).is_some_and(|s| s == "super") {
                            path.remove(0);
                        }
                    }
                    let target = self.target(module, &path, 0);
                    let file = target.and_then(|t| self.modules.get(&t));
                    if let Some(file) = file.filter(|f| f.file != m.file) {
                        found.insert(file.file.clone());
                    }
                }
            }
            all.insert(m.file.clone(), found);
        }
        all
    }
}

/// Code without its use declarations, which are parsed as trees.
fn without_uses(text: &str) -> String {
    let mut out = String::new();
    let mut inside = false;
    for line in text.lines() {
        let start = line.trim_start();
        let begins = ["use ", "pub use ", "pub(crate) use ", "pub(super) use "];
        inside |= begins.iter().any(|b| start.starts_with(b));
        if !inside {
            out.push_str(line);
            out.push('\n');
        }
        inside &= !line.trim_end().ends_with(';');
    }
    out
}

/// The files that each file of a crate imports.
pub fn imports(src: &Path) -> Imports {
    Crate::read(src).imports()
}

/// Sets of files that import each other, directly or indirectly, in order of their names.
pub fn circles(imports: &Imports) -> Vec<Vec<String>> {
    let reach = |from: &String| -> BTreeSet<String> {
        let (mut seen, mut next) = (BTreeSet::new(), vec![from.clone()]);
        while let Some(file) = next.pop() {
            for other in imports.get(&file).into_iter().flatten() {
                if seen.insert(other.clone()) {
                    next.push(other.clone());
                }
            }
        }
        seen
    };
    let reached: BTreeMap<&String, BTreeSet<String>> =
        imports.keys().map(|file| (file, reach(file))).collect();
    let mut found = BTreeSet::new();
    for (file, seen) in &reached {
        if seen.contains(*file) {
            let back = |other: &&String| reached.get(other).is_some_and(|r| r.contains(*file));
            found.insert(seen.iter().filter(back).cloned().collect::<Vec<String>>());
        }
    }
    found.into_iter().collect()
}
