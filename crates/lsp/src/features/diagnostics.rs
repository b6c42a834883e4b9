//! The compiler's diagnostics in the form of the protocol.
//!
//! In: an analysed document. Out: its diagnostics, the most severe first. Message, label, facts and help form one text, as on a terminal.

use std::ops::Range as Bytes;

use lsp_types::{
    Diagnostic, DiagnosticRelatedInformation, DiagnosticSeverity, DiagnosticTag, Location,
    NumberOrString, Uri,
};
use sidc_lang::diagnostic as lang;
use sidc_lang::source::Span;

use crate::text::document::Document;
use crate::thresholds::EDITOR;

pub fn diagnostics(document: &Document, uri: &Uri) -> Vec<Diagnostic> {
    let analysis = document.analysis();
    if analysis.too_large {
        return vec![too_large(document)];
    }
    let found = analysis.found.iter().take(EDITOR.findings);
    found.map(|d| diagnostic(document, uri, d)).collect()
}

pub fn diagnostic(document: &Document, uri: &Uri, d: &lang::Diagnostic) -> Diagnostic {
    let main = d.labels.iter().find(|l| l.primary).or(d.labels.first());
    let (range, file) = main.map_or((0..0, None), |l| place(document, l.span));
    let others = d.labels.iter().filter(|l| main != Some(*l));
    let related = others.map(|l| {
        let (range, file) = place(document, l.span);
        DiagnosticRelatedInformation {
            location: Location::new(uri.clone(), document.range(range)),
            message: file.map_or(l.text.clone(), |file| format!("in `{file}`: {}", l.text)),
        }
    });
    let mut message = file.map_or(d.message.clone(), |file| {
        format!("in `{file}`: {}", d.message)
    });
    let label = main.map(|l| l.text.clone()).filter(|t| !t.is_empty());
    for line in label.iter().chain(&d.notes) {
        message.push_str(&format!("\n{line}"));
    }
    if let Some(help) = &d.help {
        message.push_str(&format!("\nhelp: {help}"));
    }
    Diagnostic {
        range: document.range(range),
        severity: Some(match d.severity {
            lang::Severity::Error => DiagnosticSeverity::ERROR,
            lang::Severity::Warning => DiagnosticSeverity::WARNING,
            lang::Severity::Note => DiagnosticSeverity::INFORMATION,
        }),
        code: Some(NumberOrString::String(d.code.into())),
        source: Some("sidc".into()),
        message,
        related_information: Some(related.collect()),
        tags: (d.code == "unused-name").then(|| vec![DiagnosticTag::UNNECESSARY]),
        ..Diagnostic::default()
    }
}

/// The bytes of a span. For a span in an included file, the bytes of the `include` statement and the file's name.
fn place(document: &Document, span: Span) -> (Bytes<usize>, Option<&str>) {
    match document.analysis().included.get(&span.file) {
        Some(file) => (file.by.clone(), Some(&file.name)),
        None => (span.start..span.end, None),
    }
}

fn too_large(document: &Document) -> Diagnostic {
    let limit = EDITOR.text >> 20;
    Diagnostic {
        range: document.range(0..0),
        severity: Some(DiagnosticSeverity::ERROR),
        source: Some("sidc".into()),
        message: format!("larger than {limit} MiB, the limit of a model"),
        ..Diagnostic::default()
    }
}
