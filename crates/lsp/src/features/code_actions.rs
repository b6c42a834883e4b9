//! The help of a diagnostic as an action: every fix that changes the text.
//!
//! In: a range. Out: an action for each fix of each diagnostic on its lines. Whole lines, because the cursor of an editor is seldom exactly on the wrong
//! word.

use std::collections::HashMap;

use lsp_types::{
    CodeAction, CodeActionKind, CodeActionOrCommand, Range, TextEdit, Uri, WorkspaceEdit,
};
use sidc_lang::diagnostic::{Diagnostic, Fix};

use super::diagnostics;
use crate::analysis::OWN;
use crate::text::document::Document;

/// Whether the kinds include quick fixes; a kind includes all kinds below it.
pub fn has_fixes(kinds: &[CodeActionKind]) -> bool {
    let own = CodeActionKind::QUICKFIX;
    let holds = |k: &CodeActionKind| k.as_str().is_empty() || *k == own;
    kinds.iter().any(holds)
}

pub fn actions(document: &Document, uri: &Uri, range: Range) -> Vec<CodeActionOrCommand> {
    let lines = document.lines();
    let line = |n: u32| lines.range(&document.text, n as usize);
    let (start, end) = (line(range.start.line).start, line(range.end.line).end);
    let touched = |d: &&Diagnostic| {
        let touches = |from: usize, to: usize| from <= end && start <= to;
        let mut own = d.labels.iter().map(|l| l.span).filter(|s| s.file == OWN);
        own.any(|s| touches(s.start, s.end))
    };
    let found = document.analysis().found.iter().filter(touched);
    let each = found.flat_map(|d| {
        let own = d.fixes.iter().filter(|fix| fix.span.file == OWN);
        own.map(move |fix| (d, fix))
    });
    let actions = each.map(|(d, fix)| CodeAction {
        title: title(document, d, fix),
        kind: Some(CodeActionKind::QUICKFIX),
        diagnostics: Some(vec![diagnostics::diagnostic(document, uri, d)]),
        edit: Some(edit(document, uri, fix)),
        is_preferred: Some(d.fixes.len() == 1 && !deletes_line(document, fix)),
        ..CodeAction::default()
    });
    actions.map(CodeActionOrCommand::from).collect()
}

#[allow(
    clippy::mutable_key_type,
    reason = "the protocol's type; a URI never changes"
)]
fn edit(document: &Document, uri: &Uri, fix: &Fix) -> WorkspaceEdit {
    let range = document.range(fix.span.start..fix.span.end);
    let edit = TextEdit::new(range, fix.text.clone());
    WorkspaceEdit::new(HashMap::from([(uri.clone(), vec![edit])]))
}

/// Whether the fix deletes a line, which nobody wants unasked.
fn deletes_line(document: &Document, fix: &Fix) -> bool {
    let old = document.slice(fix.span.start..fix.span.end);
    fix.text.is_empty() && old.contains('\n')
}

/// For example ``replace `x` by `y` ``, on one line; the help itself if several lines change together.
fn title(document: &Document, d: &Diagnostic, fix: &Fix) -> String {
    let old = document.slice(fix.span.start..fix.span.end);
    let lines = old.trim_end().contains('\n') || fix.text.contains('\n');
    let (old, new) = (old.trim(), fix.text.trim());
    match (old.is_empty(), new.is_empty(), &d.help) {
        (true, false, _) if lines => format!("add the line `{}`", short(new)),
        (true, false, _) => format!("insert `{new}`"),
        (false, true, _) => format!("delete `{}`", short(old)),
        (_, _, Some(help)) if lines => help.split("; ").next().unwrap_or(help).to_string(),
        _ => format!("replace `{}` by `{}`", short(old), short(new)),
    }
}

fn short(text: &str) -> String {
    const LONGEST: usize = 40;
    let line = text.lines().next().unwrap_or("");
    match line.chars().count() > LONGEST || line.len() < text.len() {
        true => line.chars().take(LONGEST).collect::<String>() + "…",
        false => line.to_string(),
    }
}
