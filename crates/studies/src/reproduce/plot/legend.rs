//! The names of lines and dots, in rows above the panels, where they hide nothing.

use super::draw::{escaped, marker, stroke};
use super::{Look, Mark, Panel};

const ROW: f64 = 22.0;
/// Length of a line sample, and space after a name.
const SAMPLE: f64 = 30.0;
const AFTER: f64 = 22.0;

struct Entry {
    name: String,
    look: Look,
    line: bool,
    /// Distance from the left, and row.
    at: (f64, usize),
}

pub struct Legend {
    entries: Vec<Entry>,
    rows: usize,
}

impl Legend {
    pub fn of(panels: &[Panel], width: f64) -> Legend {
        let mut entries: Vec<Entry> = Vec::new();
        let (mut x, mut row) = (0.0, 0);
        for mark in panels.iter().flat_map(|p| &p.marks) {
            let (name, look, line) = match mark {
                Mark::Line { name, look, .. } => (name, look, true),
                Mark::Dots { name, look, .. } => (name, look, false),
                _ => continue,
            };
            if name.is_empty() || entries.iter().any(|e| e.name == *name) {
                continue;
            }
            let wide = SAMPLE + 6.0 + extent(name);
            if x > 0.0 && x + wide > width {
                (x, row) = (0.0, row + 1);
            }
            entries.push(Entry {
                name: name.clone(),
                look: *look,
                line,
                at: (x, row),
            });
            x += wide + AFTER;
        }
        let rows = if entries.is_empty() { 0 } else { row + 1 };
        Legend { entries, rows }
    }

    pub fn height(&self) -> f64 {
        self.rows as f64 * ROW
    }

    pub fn svg(&self, left: f64) -> String {
        let mut out = String::new();
        for e in &self.entries {
            let (x, y) = (left + e.at.0, ROW * e.at.1 as f64 + 14.0);
            if e.line {
                out += &format!(
                    "<path class='l' d='M{x:.1} {y}h{SAMPLE}'{}/>\n",
                    stroke(e.look)
                );
            }
            if e.look.marker {
                out += &marker(e.look, (x + SAMPLE / 2.0, y), 3.6);
            }
            out += &format!(
                "<text x='{:.1}' y='{}'>{}</text>\n",
                x + SAMPLE + 6.0,
                y + 4.5,
                escaped(&e.name)
            );
        }
        out
    }
}

/// The approximate width of a text.
fn extent(text: &str) -> f64 {
    let wide = |c: char| match c {
        'i' | 'l' | 'j' | '.' | ',' | '\'' | '|' | ' ' | '(' | ')' | 't' | 'f' => 4.0,
        'm' | 'w' | 'M' | 'W' | '%' => 10.5,
        '\u{307}' | '\u{308}' => 0.0,
        c if c.is_uppercase() => 9.0,
        _ => 7.3,
    };
    text.chars().map(wide).sum()
}
