//! A table of numbers and its CSV text.

use std::fmt::Write;

/// Columns by name, rows in order.
pub struct Table {
    /// Comment lines above the header, without `#`.
    pub comments: Vec<String>,
    pub names: Vec<&'static str>,
    pub rows: Vec<Vec<f64>>,
    /// Significant digits written; `None` writes the shortest text that reads back as the same f64.
    pub digits: Option<usize>,
    pub separator: char,
}

impl Table {
    /// An empty table. Twelve digits: ample for states, and half the size.
    pub fn new(names: &[&'static str]) -> Self {
        Table {
            comments: Vec::new(),
            names: names.to_vec(),
            rows: Vec::new(),
            digits: Some(12),
            separator: ',',
        }
    }

    pub fn push(&mut self, row: &[f64]) {
        self.rows.push(row.to_vec());
    }

    pub fn csv(&self) -> String {
        let separator = self.separator.to_string();
        let mut text = String::new();
        for line in &self.comments {
            let _ = writeln!(text, "# {line}");
        }
        let _ = writeln!(text, "{}", self.names.join(&separator));
        for row in &self.rows {
            let cells: Vec<String> = row.iter().map(|&v| number(v, self.digits)).collect();
            let _ = writeln!(text, "{}", cells.join(&separator));
        }
        text
    }
}

fn number(value: f64, digits: Option<usize>) -> String {
    let value = match digits {
        Some(n) => format!("{value:.*e}", n.saturating_sub(1))
            .parse()
            .unwrap_or(value),
        None => value,
    };
    let size = value.abs();
    if value.is_nan() {
        // A sample that was not taken.
        String::new()
    } else if value == 0.0 {
        "0".to_string()
    } else if (1e-5..1e15).contains(&size) {
        format!("{value}")
    } else {
        format!("{value:e}")
    }
}
