//! Tables with one observation per row, as CSV, or a selection as Markdown; and readable numbers.

use super::Attachment;

pub struct Tidy {
    names: Vec<&'static str>,
    rows: Vec<Vec<String>>,
}

impl Tidy {
    pub fn new(names: &[&'static str]) -> Tidy {
        Tidy {
            names: names.to_vec(),
            rows: Vec::new(),
        }
    }

    pub fn push<const N: usize>(&mut self, cells: [String; N]) {
        self.rows.push(cells.to_vec());
    }

    /// The table as a file. Cells with a comma or a quote are quoted.
    pub fn csv(&self, name: &str) -> Attachment {
        let quoted = |cell: &str| match cell.contains([',', '"']) {
            true => format!("\"{}\"", cell.replace('"', "\"\"")),
            false => cell.to_string(),
        };
        let mut content = self.names.join(",") + "\n";
        for row in &self.rows {
            let cells: Vec<String> = row.iter().map(|c| quoted(c)).collect();
            content += &(cells.join(",") + "\n");
        }
        Attachment {
            name: name.to_string(),
            content,
        }
    }

    /// Numbers are aligned right, words left.
    pub fn markdown(&self) -> String {
        let numeric = |i: usize| {
            let mut cells = self.rows.iter().map(|r| r[i].as_str());
            cells.all(|c| {
                c.starts_with(|d: char| d.is_ascii_digit() || "−-–<≤> ".contains(d)) || c.is_empty()
            })
        };
        let rule = |i: usize| if numeric(i) { "---:" } else { "---" };
        let rules: Vec<&str> = (0..self.names.len()).map(rule).collect();
        let mut text = format!(
            "| {} |\n| {} |\n",
            self.names.join(" | "),
            rules.join(" | ")
        );
        for row in &self.rows {
            let cells: Vec<String> = row.iter().map(|c| c.replace('|', "\\|")).collect();
            text += &format!("| {} |\n", cells.join(" | "));
        }
        text
    }
}

/// Shortest text that reads back as the same number.
pub fn exact(value: f64) -> String {
    match value {
        v if v.is_infinite() => "inf".to_string(),
        v if v == 0.0 || (1e-4..1e6).contains(&v.abs()) => format!("{v}"),
        v => format!("{v:e}"),
    }
}

/// Three significant digits, for figures of no higher precision.
pub fn rough(value: f64) -> String {
    let parsed: f64 = format!("{value:.2e}").parse().unwrap_or(value);
    exact(parsed)
}

/// A relative error: in per cent if large, as a power of ten if small.
pub fn error(value: f64) -> String {
    match value {
        v if !v.is_finite() => "∞".to_string(),
        0.0 => "0".to_string(),
        v if v >= 0.001 => format!("{:.2} %", 100.0 * v),
        v => format!("{v:.0e}"),
    }
}

pub fn percent(share: f64) -> String {
    format!("{} %", super::plot::short((1000.0 * share).round() / 10.0))
}

pub fn median(values: &[f64]) -> f64 {
    quantile(values, 0.5)
}

/// Linear interpolation between order statistics; NaN if there are no values.
pub fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let Some(last) = sorted.len().checked_sub(1) else {
        return f64::NAN;
    };
    let place = share * last as f64;
    let (low, high) = (
        sorted[place.floor() as usize],
        sorted[place.ceil() as usize],
    );
    match low == high {
        true => low,
        false => low + (place - place.floor()) * (high - low),
    }
}
