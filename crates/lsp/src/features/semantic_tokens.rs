//! The role of every word, for syntax highlighting.
//!
//! In: a document. Out: tokens in the packed form of the protocol, each position relative to the one before.

use lsp_types::{SemanticToken, SemanticTokenModifier, SemanticTokenType};

use crate::analysis::symbols::SymbolKind;
use crate::analysis::words::{Role, Word};
use crate::text::document::Document;

/// The types that tokens refer to by index.
pub const TYPES: [SemanticTokenType; 11] = [
    SemanticTokenType::KEYWORD,
    SemanticTokenType::PROPERTY,
    SemanticTokenType::VARIABLE,
    SemanticTokenType::PARAMETER,
    SemanticTokenType::FUNCTION,
    SemanticTokenType::MACRO,
    SemanticTokenType::NUMBER,
    SemanticTokenType::STRING,
    SemanticTokenType::COMMENT,
    SemanticTokenType::OPERATOR,
    SemanticTokenType::NAMESPACE,
];

/// The modifiers, one bit each.
pub const MODIFIERS: [SemanticTokenModifier; 3] = [
    SemanticTokenModifier::DECLARATION,
    SemanticTokenModifier::READONLY,
    SemanticTokenModifier::DEFAULT_LIBRARY,
];

const DECLARATION: u32 = 1;
const READONLY: u32 = 2;
const BUILT_IN: u32 = 4;

pub fn tokens(document: &Document) -> Vec<SemanticToken> {
    let mut out = Vec::new();
    let (mut line, mut start) = (0, 0);
    for word in &document.analysis().words {
        let Some((token_type, modifiers)) = meaning(document, word) else {
            continue;
        };
        let place = document.position(word.bytes.start);
        // A token must not extend beyond its line.
        let end = document
            .lines()
            .range(&document.text, place.line as usize)
            .end;
        let text = document.slice(word.bytes.start..word.bytes.end.min(end));
        let delta_line = place.line - line;
        let delta_start = match delta_line {
            0 => place.character - start,
            _ => place.character,
        };
        out.push(SemanticToken {
            delta_line,
            delta_start,
            length: document.encoding.width(text),
            token_type,
            token_modifiers_bitset: modifiers,
        });
        (line, start) = (place.line, place.character);
    }
    out
}

/// The type of a word, as its index in [`TYPES`], and its modifiers.
fn meaning(document: &Document, word: &Word) -> Option<(u32, u32)> {
    let of = |used, more: u32| {
        let symbol = document.analysis().symbols.get(used)?;
        Some(match symbol.kind {
            SymbolKind::State | SymbolKind::Output => (2, more),
            SymbolKind::Input => (3, more),
            SymbolKind::Time => (2, more | READONLY),
            SymbolKind::Param | SymbolKind::Unknown => (3, more | READONLY),
            SymbolKind::Let => (2, more | READONLY),
            SymbolKind::Function => (4, more),
            SymbolKind::Argument => (3, more),
        })
    };
    match word.role {
        Role::Keyword => Some((0, 0)),
        Role::Attribute => Some((1, 0)),
        Role::Declaration(used) => of(used, DECLARATION),
        Role::Use(used) => of(used, 0),
        Role::Function => Some((4, BUILT_IN)),
        Role::Generator => Some((5, BUILT_IN)),
        Role::Constant => Some((2, READONLY | BUILT_IN)),
        Role::System => Some((10, DECLARATION)),
        Role::Number => Some((6, 0)),
        Role::Text => Some((7, 0)),
        Role::Comment => Some((8, 0)),
        Role::Symbol => Some((9, 0)),
        Role::Other => None,
    }
}
