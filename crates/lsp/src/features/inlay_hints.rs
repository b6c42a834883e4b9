//! The number of terms of each library: in equations, and in every `let` that is a library.

use lsp_types::{InlayHint, InlayHintKind, InlayHintLabel, InlayHintTooltip, Range};
use sidc_lang::ast::Keyword;
use sidc_lang::library::{readable, size, storage};

use crate::analysis::OWN;
use crate::analysis::libraries;
use crate::analysis::symbols::{Symbol, SymbolKind};
use crate::text::document::Document;

pub fn hints(document: &Document, range: Range) -> Vec<InlayHint> {
    let (start, end) = (document.offset(range.start), document.offset(range.end));
    let analysis = document.analysis();
    let Some(program) = document.program() else {
        return Vec::new();
    };
    let mut out: Vec<InlayHint> = Vec::new();
    let mut said: Option<(usize, usize)> = None;
    let sought = libraries::sought(program);
    for (equation, library) in sought.filter(|(e, _)| e.span.file == OWN) {
        let at = equation.span.end;
        // `ddx, ddy ~ …` is several equations, usually with the same number of terms.
        if said == Some((at, library.len())) {
            continue;
        }
        said = Some((at, library.len()));
        let about = format!("{}; {}", size(&program.model, library), storage(library));
        out.push(hint(document, at, library.len(), about));
    }
    let is_let = |s: &&Symbol| s.kind == SymbolKind::Let;
    for symbol in analysis.symbols.all.iter().filter(is_let) {
        let Some(part) = libraries::named(program, &symbol.name) else {
            continue;
        };
        let library = part.library(program);
        let statement = analysis.statement(symbol.place.start);
        let statement = statement.filter(|(_, s)| s.keyword == Some(Keyword::Let));
        let at = statement.map_or(symbol.statement.end, |(_, s)| s.bytes.end);
        let about = size(&program.model, &library);
        out.push(hint(document, at, library.len(), about));
    }
    out.retain(|h| {
        let at = document.offset(h.position);
        start <= at && at <= end
    });
    out.sort_by_key(|h| (h.position.line, h.position.character));
    out
}

fn hint(document: &Document, at: usize, terms: usize, about: String) -> InlayHint {
    let word = match terms {
        1 => "term",
        _ => "terms",
    };
    InlayHint {
        position: document.position(at),
        label: InlayHintLabel::String(format!("{} {word}", readable(terms as u128))),
        kind: Some(InlayHintKind::TYPE),
        text_edits: None,
        tooltip: Some(InlayHintTooltip::String(about)),
        padding_left: Some(true),
        padding_right: None,
        data: None,
    }
}
