//! Cuts long source lines down to the places that a diagnostic points at.
//!
//! In: a diagnostic and the texts its places point into. Out: both, with long lines cut to the parts near the places and `…` for the rest;
//! nothing if all lines are short enough. Changes no message.

use crate::diagnostic::{Diagnostic, Label};
use crate::source::{FileId, Source, Sources, Span, floor_boundary};
use crate::thresholds::MESSAGES;

const LEFT_OUT: char = '…';

/// A diagnostic whose lines fit, with its texts.
pub(crate) struct Shortened {
    pub finding: Diagnostic,
    pub sources: Sources,
    /// File, byte offset in the cut text, and column in the whole text, from 1.
    pub columns: Vec<(FileId, usize, usize)>,
}

/// `None` if no text that would be shown has a long line.
pub(crate) fn shorten(d: &Diagnostic, sources: &Sources) -> Option<Shortened> {
    let files = d.labels.iter().map(|l| l.span.file);
    let long: Vec<FileId> = files.filter(|f| has_long_lines(*f, sources)).collect();
    if long.is_empty() {
        return None;
    }
    let mut short = Shortened {
        finding: d.clone(),
        sources: sources.clone(),
        columns: Vec::new(),
    };
    for file in long {
        let Some(source) = sources.get(file) else {
            continue;
        };
        let (text, kept) = cut(source, file, &d.labels);
        short.sources.replace(file, text);
        let own = d.labels.iter().zip(&mut short.finding.labels);
        for (label, new) in own.filter(|(l, _)| l.span.file == file) {
            let (start, end) = (kept.shifted(label.span.start), kept.shifted(label.span.end));
            new.span = Span::new(file, start, end.max(start));
            let column = column(&source.text, label.span.start);
            short.columns.push((file, start, column));
        }
    }
    Some(short)
}

fn has_long_lines(file: FileId, sources: &Sources) -> bool {
    let text = sources.get(file).map_or("", |s| s.text.as_str());
    text.len() > MESSAGES.line && text.lines().any(|l| l.len() > MESSAGES.line)
}

fn column(text: &str, at: usize) -> usize {
    let before = text.get(..at).unwrap_or("");
    let start = before.rfind('\n').map_or(0, |n| n + 1);
    before.get(start..).unwrap_or("").chars().count() + 1
}

/// The parts of a text that were kept: start and end in the whole text, start in the cut one.
struct Kept(Vec<(usize, usize, usize)>);

impl Kept {
    fn shifted(&self, at: usize) -> usize {
        let place = self.0.partition_point(|(from, _, _)| *from <= at);
        match place.checked_sub(1).and_then(|p| self.0.get(p)) {
            Some((from, to, now)) => now + at.min(*to) - from,
            None => 0,
        }
    }
}

/// The text with its long lines cut to the places of the labels, and the parts that were kept.
fn cut(source: &Source, file: FileId, labels: &[Label]) -> (String, Kept) {
    let text = source.text.as_str();
    let mut out = String::new();
    let mut kept = Vec::new();
    let mut start = 0;
    for line in text.split_inclusive('\n') {
        let end = start + line.len();
        let shown = line.trim_end_matches(['\n', '\r']).len();
        let windows = match shown > MESSAGES.line {
            true => windows(text, (start, start + shown), file, labels),
            false => vec![(start, start + shown)],
        };
        let mut reached = start;
        for (from, to) in windows {
            if from > reached {
                out.push(LEFT_OUT);
            }
            kept.push((from, to, out.len()));
            out.push_str(text.get(from..to).unwrap_or(""));
            reached = to;
        }
        if reached < start + shown {
            out.push(LEFT_OUT);
        }
        kept.push((start + shown, end, out.len()));
        out.push_str(text.get(start + shown..end).unwrap_or(""));
        start = end;
    }
    (out, Kept(kept))
}

/// The parts of a line near labels, in order and disjoint; the beginning of the line if there is no label.
fn windows(
    text: &str,
    (start, end): (usize, usize),
    file: FileId,
    labels: &[Label],
) -> Vec<(usize, usize)> {
    let floor = |at| floor_boundary(text, at);
    let own = labels.iter().map(|l| l.span);
    let own = own.filter(|s| s.file == file && s.start <= end && s.end >= start);
    let mut wanted: Vec<(usize, usize)> = own
        .map(|s| {
            let at = s.start.clamp(start, end);
            let to = s.end.min(at + MESSAGES.place) + MESSAGES.after_place;
            (
                floor(at.saturating_sub(MESSAGES.before_place).max(start)),
                floor(to.min(end)),
            )
        })
        .collect();
    wanted.sort_unstable();
    if wanted.is_empty() {
        wanted.push((start, floor(start + MESSAGES.place)));
    }
    let mut apart: Vec<(usize, usize)> = Vec::new();
    for (from, to) in wanted {
        match apart.last_mut() {
            Some(last) if from <= last.1 => last.1 = last.1.max(to),
            _ => apart.push((from, to)),
        }
    }
    apart
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn shortened(text: &str, places: &[(usize, usize)]) -> Option<(String, Vec<String>)> {
        let mut sources = Sources::default();
        let file = sources.add("m.sid", text);
        let mut d = Diagnostic::error("syntax", "wrong");
        for (start, end) in places {
            d = d.at(Span::new(file, *start, *end), "here");
        }
        let short = shorten(&d, &sources)?;
        let shown = short.sources.get(file).unwrap().text.clone();
        let spans = short.finding.labels.iter().map(|l| l.span);
        let marked = spans.map(|s| short.sources.slice(s).to_string());
        Some((shown, marked.collect()))
    }

    #[test]
    fn short_lines_are_left_alone() {
        assert!(shortened("state x\ndx ~ <y>\n", &[(14, 15)]).is_none());
        let lines = "x\n".repeat(10_000);
        assert!(shortened(&lines, &[(5000, 5001)]).is_none());
    }

    #[test]
    fn long_lines_are_cut_about_their_places() {
        let text = format!(
            "a\n{}!{}?{}\nb\n",
            "é".repeat(5000),
            "-".repeat(5000),
            "+".repeat(9)
        );
        let (bang, what) = (2 + 10_000, 2 + 10_001 + 5000);
        let (shown, marked) = shortened(&text, &[(bang, bang + 1), (what, what + 1)]).unwrap();
        assert_eq!(marked, ["!", "?"]);
        assert!(shown.len() < 1000, "{shown}");
        assert!(
            shown.starts_with("a\n…é") && shown.ends_with("+\nb\n"),
            "{shown}"
        );
        let (shown, marked) = shortened(&text, &[(2, text.len())]).unwrap();
        assert!(shown.len() < 1000 && marked[0].starts_with('é'), "{shown}");
    }

    #[test]
    fn the_longest_line_that_is_shown_whole_is_shown_whole() {
        let edge = "x".repeat(MESSAGES.line);
        assert!(shortened(&format!("{edge}\n{edge}\n"), &[(7, 8)]).is_none());
        let text = format!("{edge}\n{}\n", "y".repeat(MESSAGES.line + 1));
        let (shown, _) = shortened(&text, &[(MESSAGES.line + 4, MESSAGES.line + 5)]).unwrap();
        assert!(shown.starts_with(&format!("{edge}\nyyy")), "{shown}");
        assert!(shown.ends_with("…\n"), "{shown}");
    }

    #[test]
    fn places_beside_each_other_are_shown_once() {
        let digits: String = (0..1000)
            .map(|k| char::from(b'0' + (k % 10) as u8))
            .collect();
        let (shown, marked) = shortened(&digits, &[(500, 501), (533, 535)]).unwrap();
        assert_eq!(shown, format!("…{}…", &digits[440..575]));
        assert_eq!(marked, ["0", "34"]);
    }

    #[test]
    fn lines_without_a_place_show_how_they_begin() {
        let long = "z".repeat(400);
        let begin = format!("{}…", "z".repeat(MESSAGES.place));
        let (shown, marked) =
            shortened(&format!("a!\n{long}\nb?\n"), &[(1, 2), (405, 406)]).unwrap();
        assert_eq!(shown, format!("a!\n{begin}\nb?\n"));
        assert_eq!(marked, ["!", "?"]);
    }

    #[test]
    fn places_are_those_of_their_own_file() {
        let mut sources = Sources::default();
        let model = sources.add("m.sid", "m".repeat(400));
        let data = sources.add("d.csv", "d".repeat(400));
        let d = Diagnostic::error("syntax", "wrong")
            .at(Span::new(model, 390, 391), "here")
            .also(Span::new(data, 0, 1), "there");
        let short = shorten(&d, &sources).unwrap();
        let text = |f| short.sources.get(f).unwrap().text.as_str();
        assert_eq!(text(model), format!("…{}", "m".repeat(70)));
        assert_eq!(text(data), format!("{}…", "d".repeat(41)));
    }
}
