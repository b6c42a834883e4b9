//! The model as a list of declarations and equations.

use lsp_types::{DocumentSymbol, SymbolKind as Shown};
use sidc_lang::ast::Keyword;

use crate::analysis::Outline;
use crate::analysis::symbols::{Symbol, SymbolKind};
use crate::text::document::Document;

pub fn symbols(document: &Document) -> Vec<DocumentSymbol> {
    let analysis = document.analysis();
    let mut out: Vec<(usize, DocumentSymbol)> = Vec::new();
    let listed = |s: &&Symbol| s.kind != SymbolKind::Argument;
    for symbol in analysis.symbols.all.iter().filter(listed) {
        out.push((symbol.place.start, declared(document, symbol)));
    }
    for statement in &analysis.statements {
        out.extend(stated(document, statement).map(|s| (statement.bytes.start, s)));
    }
    out.sort_by_key(|(at, _)| *at);
    out.into_iter().map(|(_, s)| s).collect()
}

fn declared(document: &Document, symbol: &Symbol) -> DocumentSymbol {
    let (kind, word) = match symbol.kind {
        SymbolKind::Time => (Shown::CONSTANT, "time"),
        SymbolKind::State => (Shown::VARIABLE, "state"),
        SymbolKind::Input => (Shown::FIELD, "input"),
        SymbolKind::Output => (Shown::PROPERTY, "output"),
        SymbolKind::Param => (Shown::CONSTANT, "param"),
        SymbolKind::Unknown => (Shown::CONSTANT, "unknown"),
        SymbolKind::Let => (Shown::CONSTANT, "let"),
        SymbolKind::Function => (Shown::FUNCTION, "function"),
        SymbolKind::Argument => (Shown::VARIABLE, "argument"),
    };
    let order = match (symbol.kind, symbol.order) {
        (SymbolKind::State | SymbolKind::Input, order) if order > 1 => format!(" of order {order}"),
        _ => String::new(),
    };
    let unit = symbol.unit.as_ref().map(|u| format!(", {u}"));
    let detail = format!("{word}{order}{}", unit.unwrap_or_default());
    entry(
        document,
        symbol.name.clone(),
        detail,
        kind,
        (&symbol.statement, &symbol.place),
    )
}

/// An equation, the data block, the name of the model, or a statement about coefficients.
fn stated(document: &Document, statement: &Outline) -> Option<DocumentSymbol> {
    let text = document.slice(statement.bytes.clone());
    let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
    let (name, detail, kind) = match statement.keyword {
        None => {
            let (left, right) = words.split_once(['~', '='])?;
            let detail: String = right.trim().chars().take(60).collect();
            (left.trim().to_string(), detail, Shown::FUNCTION)
        }
        Some(Keyword::Data) => ("data".into(), String::new(), Shown::STRUCT),
        Some(Keyword::System) => {
            let name = words.strip_prefix("system").unwrap_or("").trim();
            (name.to_string(), "system".into(), Shown::MODULE)
        }
        Some(Keyword::Constrain | Keyword::Coef | Keyword::Symmetry) => {
            let short: String = words.chars().take(60).collect();
            (short, String::new(), Shown::OPERATOR)
        }
        _ => return None,
    };
    // Clients reject symbols without a name.
    let name = match name.is_empty() {
        true => "…".to_string(),
        false => name,
    };
    let all = &statement.bytes;
    Some(entry(document, name, detail, kind, (all, all)))
}

fn entry(
    document: &Document,
    name: String,
    detail: String,
    kind: Shown,
    (all, own): (&std::ops::Range<usize>, &std::ops::Range<usize>),
) -> DocumentSymbol {
    // The field is deprecated by the protocol, but its type has no default.
    #[allow(deprecated)]
    DocumentSymbol {
        name,
        detail: Some(detail),
        kind,
        tags: None,
        deprecated: None,
        range: document.range(all.clone()),
        selection_range: document.range(own.clone()),
        children: None,
    }
}
