//! Where a name is declared, and where it is used.
//!
//! In: a position. Out: ranges. A derivative belongs to its variable: `ddx` leads to `state x`.

use std::ops::Range;

use lsp_types::{DocumentHighlight, DocumentHighlightKind, Location, Position, Uri};

use crate::analysis::words::{Role, Word};
use crate::text::document::Document;

pub fn definition(document: &Document, uri: &Uri, at: Position) -> Option<Location> {
    let analysis = document.analysis();
    let (_, used) = analysis.name(document.offset(at))?;
    let symbol = analysis.symbols.get(used)?;
    let place = document.range(symbol.place.clone());
    Some(Location::new(uri.clone(), place))
}

pub fn references(document: &Document, uri: &Uri, at: Position, declared: bool) -> Vec<Location> {
    let at = document.offset(at);
    let uses = occurrences(document, at).into_iter();
    let uses = uses.filter(|w| !matches!(w.role, Role::Declaration(_)));
    let mut places: Vec<Range<usize>> = uses.map(|w| w.bytes.clone()).collect();
    let analysis = document.analysis();
    let symbol = analysis
        .name(at)
        .and_then(|(_, used)| analysis.symbols.get(used));
    // A name declared by a range has no word of its own there.
    places.extend(symbol.filter(|_| declared).map(|s| s.place.clone()));
    places.sort_by_key(|p| p.start);
    let places = places.into_iter().map(|p| document.range(p));
    places
        .map(|range| Location::new(uri.clone(), range))
        .collect()
}

pub fn highlights(document: &Document, at: Position) -> Vec<DocumentHighlight> {
    let found = occurrences(document, document.offset(at)).into_iter();
    let highlights = found.map(|w| DocumentHighlight {
        range: document.range(w.bytes.clone()),
        kind: Some(match w.role {
            Role::Declaration(_) => DocumentHighlightKind::WRITE,
            _ => DocumentHighlightKind::READ,
        }),
    });
    highlights.collect()
}

/// Every word that refers to the variable or `let` at a position, including the declaration.
pub fn occurrences(document: &Document, at: usize) -> Vec<&Word> {
    let analysis = document.analysis();
    let Some((_, used)) = analysis.name(at) else {
        return Vec::new();
    };
    let same = |w: &&Word| w.used().is_some_and(|u| u.symbol == used.symbol);
    analysis.words.iter().filter(same).collect()
}
