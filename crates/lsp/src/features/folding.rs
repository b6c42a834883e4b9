//! What can be folded: statements of several lines, and runs of comments.

use lsp_types::{FoldingRange, FoldingRangeKind};

use crate::analysis::words::Role;
use crate::text::document::Document;

pub fn ranges(document: &Document) -> Vec<FoldingRange> {
    let analysis = document.analysis();
    let line = |at: usize| document.lines().line(at);
    let statements = analysis.statements.iter();
    let mut out: Vec<FoldingRange> = statements
        .filter_map(|s| range(line(s.bytes.start), line(s.bytes.end), None))
        .collect();
    let mut run: Option<(usize, usize)> = None;
    let comments = analysis.words.iter().filter(|w| w.role == Role::Comment);
    for at in comments.map(|w| line(w.bytes.start)) {
        match run {
            Some((first, last)) if at == last + 1 => run = Some((first, at)),
            _ => {
                out.extend(run.and_then(comment));
                run = Some((at, at));
            }
        }
    }
    out.extend(run.and_then(comment));
    out
}

fn comment((first, last): (usize, usize)) -> Option<FoldingRange> {
    range(first, last, Some(FoldingRangeKind::Comment))
}

fn range(first: usize, last: usize, kind: Option<FoldingRangeKind>) -> Option<FoldingRange> {
    (first < last).then(|| FoldingRange {
        start_line: first as u32,
        end_line: last as u32,
        kind,
        ..FoldingRange::default()
    })
}
