//! Converts positions between bytes, as the compiler counts, and lines and characters, as an editor does.
//!
//! In: a text. Out: its lines, and conversions in both directions. A position outside the text is clamped to it.

use lsp_types::{Position, PositionEncodingKind, Range};

/// The unit of positions within a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// Bytes.
    Utf8,
    /// UTF-16 code units, which every client supports.
    Utf16,
}

impl Encoding {
    /// UTF-8 if the client offers it.
    pub fn offered(kinds: Option<&Vec<PositionEncodingKind>>) -> Encoding {
        match kinds.is_some_and(|k| k.contains(&PositionEncodingKind::UTF8)) {
            true => Encoding::Utf8,
            false => Encoding::Utf16,
        }
    }

    pub fn kind(self) -> PositionEncodingKind {
        match self {
            Encoding::Utf8 => PositionEncodingKind::UTF8,
            Encoding::Utf16 => PositionEncodingKind::UTF16,
        }
    }

    /// Length of a text in this unit.
    pub fn width(self, text: &str) -> u32 {
        match self {
            Encoding::Utf8 => text.len() as u32,
            Encoding::Utf16 => text.chars().map(|c| c.len_utf16() as u32).sum(),
        }
    }
}

/// The byte at which each line begins. Lines end with `\n`, `\r\n` or `\r`, as in the protocol.
#[derive(Clone, Debug, Default)]
pub struct Lines {
    starts: Vec<usize>,
}

impl Lines {
    pub fn of(text: &str) -> Lines {
        let bytes = text.as_bytes();
        let ends = bytes.iter().enumerate().filter(|(i, b)| match b {
            b'\n' => true,
            b'\r' => bytes.get(i + 1) != Some(&b'\n'),
            _ => false,
        });
        let starts = std::iter::once(0).chain(ends.map(|(i, _)| i + 1));
        Lines {
            starts: starts.collect(),
        }
    }

    /// Index of the line that holds a byte, from 0.
    pub fn line(&self, offset: usize) -> usize {
        self.starts
            .partition_point(|s| *s <= offset)
            .saturating_sub(1)
    }

    /// The bytes of a line without its end.
    pub fn range(&self, text: &str, line: usize) -> std::ops::Range<usize> {
        let start = self.starts.get(line).copied().unwrap_or(text.len());
        let end = self.starts.get(line + 1).copied().unwrap_or(text.len());
        let whole = text.get(start..end).unwrap_or("");
        start..start + whole.trim_end_matches(['\r', '\n']).len()
    }

    pub fn position(&self, text: &str, offset: usize, encoding: Encoding) -> Position {
        let line = self.line(offset);
        let start = self.starts.get(line).copied().unwrap_or(0);
        let before = (start..=offset.min(text.len()))
            .rev()
            .find_map(|end| text.get(start..end));
        Position::new(line as u32, encoding.width(before.unwrap_or("")))
    }

    pub fn positions(
        &self,
        text: &str,
        bytes: std::ops::Range<usize>,
        encoding: Encoding,
    ) -> Range {
        Range::new(
            self.position(text, bytes.start, encoding),
            self.position(text, bytes.end, encoding),
        )
    }

    /// The byte of a position. Beyond the line or text it is the end of either; inside a character it is the first byte of that.
    pub fn offset(&self, text: &str, position: Position, encoding: Encoding) -> usize {
        let Some(&start) = self.starts.get(position.line as usize) else {
            return text.len();
        };
        let line = self.range(text, position.line as usize);
        let mut left = position.character;
        let mut at = start;
        for c in text.get(line).unwrap_or("").chars() {
            let width = match encoding {
                Encoding::Utf8 => c.len_utf8(),
                Encoding::Utf16 => c.len_utf16(),
            };
            if left < width as u32 {
                break;
            }
            left -= width as u32;
            at += c.len_utf8();
        }
        at
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_encodings_lead_there_and_back() {
        let text = "θ = 1\r\n𝛼x # é\rlast";
        let lines = Lines::of(text);
        for encoding in [Encoding::Utf8, Encoding::Utf16] {
            for (at, _) in text.char_indices() {
                let inside_end = text.as_bytes().get(at) == Some(&b'\n');
                let place = lines.position(text, at, encoding);
                let back = lines.offset(text, place, encoding);
                assert!(back == at || inside_end, "{encoding:?} {at} {place:?}");
            }
        }
        let place = lines.position(text, text.find('x').unwrap(), Encoding::Utf16);
        assert_eq!(place, Position::new(1, 2));
        let place = lines.position(text, text.find("last").unwrap(), Encoding::Utf8);
        assert_eq!(place, Position::new(2, 0));
    }

    #[test]
    fn places_outside_are_clamped() {
        let lines = Lines::of("ab\nc");
        let at = |l, c| lines.offset("ab\nc", Position::new(l, c), Encoding::Utf16);
        assert_eq!([at(0, 9), at(1, 9), at(7, 0)], [2, 4, 4]);
        // Inside a surrogate pair.
        assert_eq!(
            Lines::of("𝛼").offset("𝛼", Position::new(0, 1), Encoding::Utf16),
            0
        );
        assert_eq!(
            Lines::of("θ").position("θ", 1, Encoding::Utf8),
            Position::new(0, 0)
        );
    }
}
