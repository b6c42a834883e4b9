//! Diagnostics → text, plain or coloured. The only place that knows the diagnostics crate.
//!
//! In: diagnostics, and the texts their places point into. Out: what a terminal shows. Adds no content.

mod excerpt;

use std::ops::Range;

use codespan_reporting::diagnostic::{self as report, LabelStyle};
use codespan_reporting::files::{Error, Files};
use codespan_reporting::term::termcolor::{Ansi, NoColor, WriteColor};
use codespan_reporting::term::{self, Config};

use crate::diagnostic::{Diagnostic, Severity};
use crate::source::{FileId, Source, Sources, floor_boundary, printable};
use crate::thresholds::MESSAGES;
use excerpt::shorten;

/// All diagnostics, each followed by an empty line; of very many, the first ones and the number of the others.
pub fn render(diagnostics: &[Diagnostic], sources: &Sources, colour: bool) -> String {
    let sources = &sources.printable();
    let diagnostics = &first_of_each(diagnostics);
    if colour {
        write_all(
            Ansi::new(Vec::new()),
            diagnostics,
            sources,
            Ansi::into_inner,
        )
    } else {
        write_all(
            NoColor::new(Vec::new()),
            diagnostics,
            sources,
            NoColor::into_inner,
        )
    }
}

/// The first diagnostics of each severity, as many as [`MESSAGES`] allows; the last of them says how many were left out.
fn first_of_each(diagnostics: &[Diagnostic]) -> Vec<Diagnostic> {
    let mut counts = std::collections::BTreeMap::new();
    let mut shown = Vec::new();
    for d in diagnostics {
        let count = counts.entry(d.severity).or_insert(0);
        *count += 1;
        if *count > MESSAGES.findings {
            continue;
        }
        let mut d = d.clone();
        if *count == MESSAGES.findings {
            let all = diagnostics.iter().filter(|o| o.severity == d.severity);
            match all.count() - MESSAGES.findings {
                0 => {}
                more => d.notes.push(format!("and {more} more after this one")),
            }
        }
        shown.push(d);
    }
    shown
}

fn write_all<W: WriteColor>(
    mut out: W,
    diagnostics: &[Diagnostic],
    sources: &Sources,
    into_bytes: impl Fn(W) -> Vec<u8>,
) -> String {
    let whole = Lines::of(sources);
    let config = Config {
        start_context_lines: 1,
        end_context_lines: 1,
        ..Config::default()
    };
    for d in diagnostics {
        let short = shorten(d, sources);
        let (d, files) = match &short {
            Some(s) => (&s.finding, &Lines::with_columns(&s.sources, &s.columns)),
            None => (d, &whole),
        };
        // Writing to memory cannot fail, but a place outside its text is refused; the message is then written without places.
        let mut write = |d: &Diagnostic| {
            let converted = convert(d, files.sources);
            term::emit_to_write_style(&mut out, &config, files, &converted)
        };
        if write(d).is_err() {
            let _ = write(&Diagnostic {
                labels: Vec::new(),
                ..d.clone()
            });
        }
    }
    let text = String::from_utf8_lossy(&into_bytes(out)).into_owned();
    drop_empty_borders(&text)
}

fn convert(d: &Diagnostic, sources: &Sources) -> report::Diagnostic<FileId> {
    let severity = match d.severity {
        Severity::Error => report::Severity::Error,
        Severity::Warning => report::Severity::Warning,
        Severity::Note => report::Severity::Note,
    };
    let labels = d.labels.iter().map(|l| {
        let style = if l.primary {
            LabelStyle::Primary
        } else {
            LabelStyle::Secondary
        };
        report::Label::new(
            style,
            l.span.file,
            visible(l.span.start..l.span.end, sources.get(l.span.file)),
        )
        .with_message(printable(&truncate_middle(&l.text)))
    });
    let help = d
        .help
        .iter()
        .map(|h| wrap("help: ", &printable(&truncate_middle(h))));
    report::Diagnostic::new(severity)
        .with_code(d.code)
        .with_message(printable(&truncate_middle(&d.message)))
        .with_labels(labels.collect())
        .with_notes(
            d.notes
                .iter()
                .map(|n| wrap("", &printable(&truncate_middle(n))))
                .chain(help)
                .collect(),
        )
}

/// A text without its middle if it is very long: names from files may have any length.
fn truncate_middle(text: &str) -> String {
    let length = text.chars().count();
    if length <= MESSAGES.text {
        return text.to_string();
    }
    let half = MESSAGES.text / 2;
    let end: String = text.chars().skip(length - half).collect();
    text.chars()
        .take(half)
        .chain("…".chars())
        .collect::<String>()
        + &end
}

/// The range, clamped to its text and to character boundaries.
fn visible(range: Range<usize>, source: Option<&Source>) -> Range<usize> {
    let Some(source) = source else {
        return range;
    };
    let start = floor_boundary(&source.text, range.start);
    start..floor_boundary(&source.text, range.end).max(start)
}

/// Wraps a long line at spaces, with a hanging indent.
fn wrap(lead: &str, text: &str) -> String {
    let mut out = lead.to_string();
    let mut width = lead.len();
    for (i, line) in text.lines().enumerate() {
        if i > 0 {
            out.push('\n');
            out.push_str(&" ".repeat(lead.len()));
            width = lead.len();
        }
        for (j, word) in line.split(' ').enumerate() {
            let length = word.chars().count();
            if j > 0 && width + 1 + length > MESSAGES.width {
                out.push('\n');
                out.push_str(&" ".repeat(lead.len().max(2)));
                width = lead.len().max(2);
            } else if j > 0 {
                out.push(' ');
                width += 1;
            }
            out.push_str(word);
            width += length;
        }
    }
    out
}

/// Drops the empty border lines above and below an excerpt.
fn drop_empty_borders(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for line in text.lines() {
        if plain(line).trim() != "│" {
            out.push_str(line.trim_end());
            out.push('\n');
        }
    }
    out
}

/// A line without its colour codes.
fn plain(line: &str) -> String {
    let mut out = String::with_capacity(line.len());
    let mut inside = false;
    for c in line.chars() {
        match (inside, c) {
            (false, '\u{1b}') => inside = true,
            (true, 'm') => inside = false,
            (true, _) => {}
            (false, c) => out.push(c),
        }
    }
    out
}

/// The texts, with their line starts found on demand.
struct Lines<'a> {
    sources: &'a Sources,
    /// Column numbers of places in shortened lines: those of the whole line.
    columns: &'a [(FileId, usize, usize)],
    starts: std::cell::RefCell<Vec<(FileId, Vec<usize>)>>,
}

impl<'a> Lines<'a> {
    fn of(sources: &'a Sources) -> Self {
        Lines::with_columns(sources, &[])
    }

    fn with_columns(sources: &'a Sources, columns: &'a [(FileId, usize, usize)]) -> Self {
        Lines {
            sources,
            columns,
            starts: std::cell::RefCell::default(),
        }
    }

    fn source_of(&self, id: FileId) -> Result<&'a Source, Error> {
        self.sources.get(id).ok_or(Error::FileMissing)
    }

    /// Runs `f` on the line starts of a file, found once.
    fn with_starts<T>(&self, id: FileId, f: impl FnOnce(&[usize]) -> T) -> Result<T, Error> {
        let text = &self.source_of(id)?.text;
        let mut all = self.starts.borrow_mut();
        if let Some((_, starts)) = all.iter().find(|(i, _)| *i == id) {
            return Ok(f(starts));
        }
        let starts: Vec<usize> = codespan_reporting::files::line_starts(text).collect();
        let result = f(&starts);
        all.push((id, starts));
        Ok(result)
    }
}

impl<'a> Files<'a> for Lines<'_> {
    type FileId = FileId;
    type Name = &'a str;
    type Source = &'a str;

    fn name(&'a self, id: FileId) -> Result<&'a str, Error> {
        Ok(&self.source_of(id)?.name)
    }

    fn source(&'a self, id: FileId) -> Result<&'a str, Error> {
        Ok(&self.source_of(id)?.text)
    }

    fn line_index(&'a self, id: FileId, byte: usize) -> Result<usize, Error> {
        self.with_starts(id, |starts| {
            starts.partition_point(|s| *s <= byte).saturating_sub(1)
        })
    }

    fn column_number(&'a self, id: FileId, line: usize, byte: usize) -> Result<usize, Error> {
        let known = self.columns.iter().find(|c| (c.0, c.1) == (id, byte));
        if let Some((_, _, column)) = known {
            return Ok(*column);
        }
        let range = self.line_range(id, line)?;
        let text = &self.source_of(id)?.text;
        Ok(codespan_reporting::files::column_index(text, range, byte) + 1)
    }

    fn line_number(&'a self, id: FileId, line: usize) -> Result<usize, Error> {
        Ok(self.source_of(id)?.first_line + line)
    }

    fn line_range(&'a self, id: FileId, line: usize) -> Result<Range<usize>, Error> {
        let end_of_text = self.source_of(id)?.text.len();
        self.with_starts(id, |starts| {
            let start = starts.get(line).copied().unwrap_or(end_of_text);
            start..starts.get(line + 1).copied().unwrap_or(end_of_text)
        })
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn long_texts_lose_their_middle_and_nothing_else() {
        let exactly = "ä".repeat(MESSAGES.text);
        assert_eq!(truncate_middle(&exactly), exactly);
        let long: String = (0..3 * MESSAGES.text)
            .map(|i| char::from(b'a' + (i % 23) as u8))
            .collect();
        let (start, end) = truncate_middle(&long)
            .split_once('…')
            .map(|(a, b)| (a.to_string(), b.to_string()))
            .unwrap();
        assert_eq!(
            (start.len(), end.len()),
            (MESSAGES.text / 2, MESSAGES.text / 2)
        );
        assert!(long.starts_with(&start) && long.ends_with(&end));
    }

    #[test]
    fn long_facts_break_at_spaces_only_where_they_are_too_wide() {
        let words = ["word"; 60].join(" ");
        let lines: Vec<String> = wrap("help: ", &words).lines().map(str::to_string).collect();
        assert!(lines.len() == 3 && lines.iter().all(|l| l.chars().count() <= MESSAGES.width));
        // One more word would not fit on the line.
        assert!(
            lines
                .iter()
                .take(2)
                .all(|l| l.chars().count() + " word".len() > MESSAGES.width),
            "{lines:?}"
        );
        assert!(
            lines.iter().skip(1).all(|l| l.starts_with("      word")),
            "{lines:?}"
        );
        let shown: Vec<&str> = lines.iter().flat_map(|l| l.split_whitespace()).collect();
        assert_eq!(shown.len(), 61);
        let exact = "x".repeat(MESSAGES.width - 6);
        assert_eq!(wrap("help: ", &exact), format!("help: {exact}"));
        let too_wide = format!("{exact} y");
        assert_eq!(wrap("help: ", &too_wide), format!("help: {exact}\n      y"));
        assert_eq!(wrap("", "a\nb c"), "a\nb c");
    }

    #[test]
    fn of_very_many_the_first_are_shown_and_the_others_counted() {
        let many = |n: usize| -> Vec<Diagnostic> {
            (0..n)
                .map(|k| Diagnostic::error("syntax", format!("number {k}")))
                .collect()
        };
        assert_eq!(
            first_of_each(&many(MESSAGES.findings)).len(),
            MESSAGES.findings
        );
        let shown = first_of_each(&many(MESSAGES.findings + 7));
        assert_eq!(shown.len(), MESSAGES.findings);
        let last = shown.last().unwrap();
        assert_eq!(
            (last.message.as_str(), last.notes.as_slice()),
            ("number 49", &["and 7 more after this one".to_string()][..])
        );
        assert!(
            shown
                .iter()
                .take(MESSAGES.findings - 1)
                .all(|d| d.notes.is_empty())
        );
        let exactly = first_of_each(&many(MESSAGES.findings));
        assert!(exactly.iter().all(|d| d.notes.is_empty()));
    }
}
