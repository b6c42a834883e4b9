//! The lines of a table that hold data, with their places.
//!
//! In: a text. Out: its lines one by one, without blank lines and `#` comments. Lines end with LF, CR LF or CR, also mixed.
//! Copies nothing.

/// Where a line starts in the text, and its number in the file, from 1.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Line {
    pub start: usize,
    pub number: usize,
}

/// The lines from here on; remembers the last comment it skipped.
#[derive(Clone)]
pub(super) struct Lines<'a> {
    text: &'a str,
    /// Whether a carriage return occurs anywhere without a line feed.
    lone_returns: bool,
    next: Line,
    comment: Option<&'a str>,
}

impl<'a> Lines<'a> {
    pub fn of(text: &'a str) -> Lines<'a> {
        let lone = |(at, _): (usize, &str)| text.as_bytes().get(at + 1) != Some(&b'\n');
        Lines {
            text,
            lone_returns: text.match_indices('\r').any(lone),
            next: Line {
                start: 0,
                number: 1,
            },
            comment: None,
        }
    }

    /// The last comment before the lines given so far.
    pub fn comment(&self) -> Option<&'a str> {
        self.comment
    }

    /// Upper bound of the number of lines that follow.
    pub fn at_most(&self) -> usize {
        let rest = self.text.as_bytes().get(self.next.start..).unwrap_or(&[]);
        let ends = |b: &&u8| **b == b'\n' || self.lone_returns && **b == b'\r';
        rest.iter().filter(ends).count() + 1
    }

    /// Bytes that follow.
    pub fn length(&self) -> usize {
        self.text.len().saturating_sub(self.next.start)
    }

    /// Lines before the next, blank ones and comments too.
    pub fn before(&self) -> usize {
        self.next.number - 1
    }

    /// The rest in up to `count` parts of similar length. Lines of all parts but the first are numbered from 1.
    pub fn parts(self, count: usize) -> Vec<Lines<'a>> {
        let (text, mut next) = (self.text, self.next);
        let step = self.length() / count.max(1) + 1;
        let mut parts = Vec::new();
        while next.start < text.len() || parts.is_empty() {
            // Cut behind a line feed, never between a carriage return and its line feed.
            let rest = text.as_bytes().get(next.start + step..).unwrap_or(&[]);
            let line = rest.iter().position(|b| *b == b'\n');
            let end = line.map_or(text.len(), |at| next.start + step + at + 1);
            parts.push(Lines {
                text: text.get(..end).unwrap_or(text),
                next,
                ..self
            });
            next = Line {
                start: end,
                number: 1,
            };
        }
        parts
    }

    /// The line at a place, and how many bytes end it.
    fn at(&self, rest: &'a str) -> (&'a str, usize) {
        if !self.lone_returns {
            let line = rest.split('\n').next().unwrap_or(rest);
            return (
                line.strip_suffix('\r').unwrap_or(line),
                1 + usize::from(line.ends_with('\r')),
            );
        }
        let line = rest.split(['\n', '\r']).next().unwrap_or(rest);
        let end = rest.get(line.len()..).unwrap_or("");
        (line, 1 + usize::from(end.starts_with("\r\n")))
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = (Line, &'a str);

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            let at = self.next;
            let rest = self.text.get(at.start..).filter(|r| !r.is_empty())?;
            let (line, end) = self.at(rest);
            self.next = Line {
                start: at.start + line.len() + end,
                number: at.number + 1,
            };
            let shown = line.trim_start();
            if shown.starts_with('#') {
                self.comment = Some(shown);
            } else if !shown.is_empty() {
                return Some((at, line));
            }
        }
    }
}
