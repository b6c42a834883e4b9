//! The layout of `sidc fmt`, as an edit.
//!
//! In: a document. Out: one edit from the first changed line to the last; none if nothing changes or the text has errors.

use lsp_types::TextEdit;
use sidc_lang::source::FileId;

use crate::text::document::Document;

pub fn edits(document: &Document) -> Option<Vec<TextEdit>> {
    if document.analysis().too_large {
        return None;
    }
    let old = document.text.as_str();
    let new = sidc_lang::format(FileId(0), old).ok()?;
    if new == old {
        return Some(Vec::new());
    }
    let (a, b): (Vec<&str>, Vec<&str>) = (lines(old), lines(&new));
    let same = |(x, y): &(&&str, &&str)| x == y;
    let front = a.iter().zip(&b).take_while(same).count();
    let room = a.len().min(b.len()) - front;
    let back = a.iter().rev().zip(b.iter().rev()).take_while(same);
    let back = back.count().min(room);
    let length = |lines: &[&str]| lines.iter().map(|l| l.len()).sum::<usize>();
    let start = length(a.get(..front)?);
    let end = old.len() - length(a.get(a.len() - back..)?);
    let text = b.get(front..b.len() - back)?.concat();
    Some(vec![TextEdit::new(document.range(start..end), text)])
}

fn lines(text: &str) -> Vec<&str> {
    text.split_inclusive('\n').collect()
}
