//! Renames a variable or `let` everywhere, including its derivatives.
//!
//! In: a position and the new name. Out: the changes, or why the name is not possible. Columns of tables keep their names and are matched by name, so the
//! user must add an entry for a renamed signal to the data block.

use std::collections::HashMap;

use lsp_types::{Position, PrepareRenameResponse, TextEdit, Uri, WorkspaceEdit};
use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::library::generator;
use sidc_lang::parse::{is_name, normalise};
use sidc_lang::term::Func;

use crate::analysis::symbols::{Symbol, SymbolKind, Use};
use crate::analysis::words::Word;
use crate::features::navigation::occurrences;
use crate::text::document::Document;
use crate::vocabulary;

/// The part of a word that would be renamed: `theta` in `ddtheta`.
///
/// # Errors
/// No name that can be changed is there.
pub fn prepare(document: &Document, at: Position) -> Result<PrepareRenameResponse, String> {
    let (word, symbol, used) = target(document, at)?;
    let base = base(document, word, used);
    Ok(PrepareRenameResponse::RangeWithPlaceholder {
        range: document.range(base),
        placeholder: symbol.name.clone(),
    })
}

/// # Errors
/// The new name is not a name, or it is taken.
#[allow(
    clippy::mutable_key_type,
    reason = "the protocol's type; a URI never changes"
)]
pub fn rename(
    document: &Document,
    uri: &Uri,
    at: Position,
    new: &str,
) -> Result<WorkspaceEdit, String> {
    let (_, symbol, _) = target(document, at)?;
    let new = normalise(new.trim());
    if !is_name(&new) {
        return Err(format!(
            "`{new}` is no name: letters, digits and `_`, a letter first"
        ));
    }
    if has_meaning(&new) {
        return Err(format!("`{new}` has a meaning in the language"));
    }
    free(document, symbol, &new)?;
    let words = occurrences(document, document.offset(at)).into_iter();
    let places: Vec<_> = words
        .filter_map(|word| Some(base(document, word, word.used()?)))
        .collect();
    still_compiles(document, symbol, &places, &new)?;
    let edit =
        |place: &std::ops::Range<usize>| TextEdit::new(document.range(place.clone()), new.clone());
    let edits = places.iter().map(edit).collect();
    Ok(WorkspaceEdit::new(HashMap::from([(uri.clone(), edits)])))
}

/// Words that have a meaning anywhere, or in a data block.
fn has_meaning(name: &str) -> bool {
    let forms = vocabulary::FORMS.iter().chain(&vocabulary::DATA);
    matches!(name, "t" | "pi" | "in")
        || Func::named(name).is_some()
        || generator(name).is_some()
        || forms.map(|e| e.word).any(|word| word == name)
}

/// Checks that renaming adds no error: ranges `x1..x5`, families and data blocks may need the old name.
fn still_compiles(
    document: &Document,
    symbol: &Symbol,
    places: &[std::ops::Range<usize>],
    new: &str,
) -> Result<(), String> {
    let mut text = document.text.clone();
    let mut places = places.to_vec();
    places.sort_by_key(|p| p.start);
    for place in places.into_iter().rev() {
        text.replace_range(place, new);
    }
    let errors = |found: &[Diagnostic]| found.iter().filter(|d| d.is_error()).count();
    let after = document.analysis_of(&text);
    if errors(&after.found) <= errors(&document.analysis().found) {
        return Ok(());
    }
    let before = &document.analysis().found;
    let known = |d: &&Diagnostic| before.iter().any(|b| b.message == d.message);
    let mut broken = after.found.iter().filter(|d| d.is_error());
    let why = broken
        .find(|d| !known(d))
        .map_or("an error", |d| d.message.as_str());
    Err(format!("`{}` cannot be `{new}`: then {why}", symbol.name))
}

fn target(document: &Document, at: Position) -> Result<(&Word, &Symbol, Use), String> {
    let analysis = document.analysis();
    let found = analysis.name(document.offset(at));
    let found = found.and_then(|(word, used)| Some((word, analysis.symbols.get(used)?, used)));
    let (word, symbol, used) = found.ok_or("no name that this model declares")?;
    match symbol.kind {
        SymbolKind::Time => Err("`t` is time in every model".into()),
        _ if symbol.by_range => Err(format!("`{}` is declared by a range", symbol.name)),
        _ => Ok((word, symbol, used)),
    }
}

/// The bytes of the variable's name in a word, without the `d`s of a derivative and without primes.
fn base(document: &Document, word: &Word, used: Use) -> std::ops::Range<usize> {
    let text = document.slice(word.bytes.clone());
    let primes = text.len() - text.trim_end_matches('\'').len();
    let letters = used.derivative.saturating_sub(primes);
    word.bytes.start + letters..word.bytes.end - primes
}

/// Checks that none of the new spellings is another name, or would become one.
fn free(document: &Document, symbol: &Symbol, new: &str) -> Result<(), String> {
    let symbols = &document.analysis().symbols;
    let argument = symbols.all.iter().find(|s| {
        let inside = symbol.kind != SymbolKind::Argument || s.statement == symbol.statement;
        s.kind == SymbolKind::Argument && s.name == new && s.place != symbol.place && inside
    });
    if argument.is_some() {
        return Err(format!("`{new}` is taken: it is an argument of a function"));
    }
    for derivative in 0..=symbol.order {
        let spelling = "d".repeat(derivative) + new;
        let taken = symbols.find(&spelling).and_then(|used| symbols.get(used));
        if let Some(other) = taken.filter(|other| other.place != symbol.place) {
            return Err(match derivative {
                0 if other.name == new => format!("`{new}` is taken"),
                0 => format!("`{new}` is taken: it belongs to `{}`", other.name),
                _ => format!(
                    "its derivative `{spelling}` would be that of `{}`",
                    other.name
                ),
            });
        }
    }
    Ok(())
}
