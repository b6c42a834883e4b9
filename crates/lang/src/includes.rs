//! Models in several files: `include "constants.sid"` stands for the statements of that file.
//!
//! In: a text among the sources, and a function that reads files. Out: the included files among the sources; one [`File`] with the
//! statements of all. A file is read once, however often it is included. Opens no file itself.

use std::collections::BTreeSet;

use crate::ast::{File, Keyword, Statement, StatementKind};
use crate::diagnostic::Diagnostic;
use crate::parse::lexer::{TokenKind, tokenize};
use crate::parse::parse;
use crate::parse::statements::split_statements;
use crate::source::{FileId, Sources, Span};
use crate::thresholds::MODEL;

/// Reads a file by its path: its text, or why there is none.
pub type Read<'a> = &'a mut dyn FnMut(&str) -> Result<String, String>;

/// Adds to the sources the files that a text includes, directly or indirectly. Paths are relative to the folder of the including file.
/// Returns the paths that were read, in order.
pub fn load(file: FileId, sources: &mut Sources, read: Read) -> Vec<String> {
    let mut loaded: Vec<(String, FileId)> = Vec::new();
    let name = sources.get(file).map_or(String::new(), |s| plain(&s.name));
    let mut waiting = vec![(name, file)];
    let own = waiting.clone();
    while let Some((from, id)) = waiting.pop() {
        let text = sources.get(id).map_or("", |s| s.text.as_str());
        for (path, _) in paths(text) {
            let name = beside(&from, &path);
            let known = own.iter().chain(&loaded).find(|(n, _)| *n == name);
            let linked = match known {
                Some((_, id)) => Ok(*id),
                None if loaded.len() >= MODEL.included => {
                    Err(format!("a model includes {} files at most", MODEL.included))
                }
                None => read(&name).map(|text| {
                    let id = sources.add(name.as_str(), text);
                    loaded.push((name.clone(), id));
                    waiting.push((name, id));
                    id
                }),
            };
            sources.link(id, &path, linked);
        }
    }
    loaded.into_iter().map(|(name, _)| name).collect()
}

/// The paths that a text includes, with the bytes of their statements.
fn paths(text: &str) -> Vec<(String, std::ops::Range<usize>)> {
    // Most models are one file.
    if !text.contains(Keyword::Include.text()) {
        return Vec::new();
    }
    let (tokens, _) = tokenize(FileId(0), text);
    let (pieces, _) = split_statements(FileId(0), &tokens);
    let own = pieces
        .iter()
        .filter(|p| p.keyword == Some(Keyword::Include));
    let path = own.filter_map(|p| {
        let code: Vec<_> = tokens
            .get(p.tokens.clone())?
            .iter()
            .filter(|t| t.is_code())
            .collect();
        match code.as_slice() {
            [word, path] if path.kind == TokenKind::Text => Some((
                path.text.trim_matches('"').to_string(),
                word.start..path.end,
            )),
            _ => None,
        }
    });
    path.collect()
}

/// A path resolved against the folder of another file.
fn beside(from: &str, path: &str) -> String {
    let path = path.replace('\\', "/");
    let drive = path.as_bytes().get(1) == Some(&b':');
    let folder = from.rfind('/').and_then(|at| from.get(..=at));
    match folder {
        Some(folder) if !path.starts_with('/') && !drive => plain(&format!("{folder}{path}")),
        _ => plain(&path),
    }
}

/// A path without `.` and without `..` after a folder, so that one file has one name.
fn plain(path: &str) -> String {
    let path = path.replace('\\', "/");
    let mut parts: Vec<&str> = Vec::new();
    for (i, part) in path.split('/').enumerate() {
        match part {
            "." => {}
            "" if i > 0 => {}
            ".." if parts.last().is_some_and(|p| !["", ".."].contains(p)) => {
                parts.pop();
            }
            part => parts.push(part),
        }
    }
    parts.join("/")
}

/// Parses a text with all that it includes: an included file's statements replace the statement that names it.
pub(crate) fn parse_all(id: FileId, sources: &Sources) -> (File, Vec<Diagnostic>) {
    let text = sources.get(id).map_or("", |s| s.text.as_str());
    let (file, found) = parse(id, text);
    let includes = |s: &Statement| matches!(s.kind, StatementKind::Include { .. });
    if !file.statements.iter().any(includes) {
        return (file, found);
    }
    let mut joined = Joined {
        sources,
        read: BTreeSet::from([id]),
        file: File {
            statements: Vec::new(),
            broken: Vec::new(),
            ..file.clone()
        },
        found,
    };
    joined.add(file);
    (joined.file, joined.found)
}

struct Joined<'a> {
    sources: &'a Sources,
    read: BTreeSet<FileId>,
    file: File,
    found: Vec<Diagnostic>,
}

impl Joined<'_> {
    fn add(&mut self, file: File) {
        self.file.broken.extend(file.broken);
        for s in file.statements {
            match &s.kind {
                StatementKind::Include { path, at } => self.include(s.span, path, *at),
                _ => self.file.statements.push(s),
            }
        }
    }

    fn include(&mut self, statement: Span, path: &str, at: Span) {
        let id = match self.sources.linked(at.file, path) {
            Some(Ok(id)) => *id,
            Some(Err(why)) => return self.missing(statement, unreadable(at, path, why)),
            None => return self.missing(statement, no_files(at, path)),
        };
        if !self.read.insert(id) {
            return;
        }
        let text = self.sources.get(id).map_or("", |s| s.text.as_str());
        let (mut file, found) = parse(id, text);
        self.found.extend(found);
        self.file.included.push((id, file.text.clone()));
        // Each file may begin with its version.
        if matches!(file.statements.first(), Some(s) if matches!(s.kind, StatementKind::Version(v) if v == 1.0))
        {
            file.statements.remove(0);
        }
        self.add(file);
    }

    /// The file may have declared any name, so there is no model.
    fn missing(&mut self, span: Span, error: Diagnostic) {
        self.found.push(error);
        self.file.broken.push(crate::ast::Broken {
            keyword: Some(Keyword::Include),
            names: Vec::new(),
            span,
        });
    }
}

fn unreadable(at: Span, path: &str, why: &str) -> Diagnostic {
    Diagnostic::error("include", format!("`{path}` cannot be read"))
        .at(at, why)
        .help("the path leads from the folder of this file; the statements of that file may also stand here")
}

fn no_files(at: Span, path: &str) -> Diagnostic {
    Diagnostic::error("include", format!("`{path}` is not at hand here"))
        .at(at, "this text came without other files")
        .help("its statements may stand here instead")
}

/// One text with the same meaning: files in place of the lines that include them.
pub fn flattened(id: FileId, sources: &Sources) -> String {
    let mut read = BTreeSet::from([id]);
    flat(id, sources, &mut read)
}

fn flat(id: FileId, sources: &Sources, read: &mut BTreeSet<FileId>) -> String {
    let text = sources.get(id).map_or("", |s| s.text.as_str());
    let (mut out, mut at) = (String::new(), 0);
    for (path, bytes) in paths(text) {
        out += text.get(at..bytes.start).unwrap_or("");
        at = bytes.end;
        if let Some(Ok(other)) = sources.linked(id, &path)
            && read.insert(*other)
        {
            let own = flat(*other, sources, read);
            out += without_version(&own).trim_end();
            out.push('\n');
        }
    }
    out += text.get(at..).unwrap_or("");
    out
}

/// A text without its leading `sidc 1`.
fn without_version(text: &str) -> String {
    let (tokens, _) = tokenize(FileId(0), text);
    let (pieces, _) = split_statements(FileId(0), &tokens);
    let first = pieces.first().filter(|p| p.keyword == Some(Keyword::Sidc));
    let own = first.and_then(|p| tokens.get(p.tokens.clone()));
    let bytes = own.and_then(|own| Some(own.first()?.start..own.last()?.end));
    let mut text = text.to_string();
    if let Some(bytes) = bytes {
        text.replace_range(bytes, "");
    }
    text
}
