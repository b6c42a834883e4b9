//! One column of a table: the name and unit in its header, and the shape of its values.
//!
//! In: a table. Out: the usable [`Column`]s, and why the others are left out. Compares no columns.

use std::collections::BTreeMap;

use super::thresholds::DRAFT;
use crate::csv::Table;
use crate::series;
use sidc_lang::parse::{is_name, normalise};
use sidc_lang::source::printable;

/// A column of numbers with a header that a model can name.
#[derive(Clone, Debug)]
pub(super) struct Column {
    /// As the table has it.
    pub header: String,
    /// The header as a name of the language.
    pub name: String,
    /// The text in brackets behind it.
    pub unit: Option<String>,
    pub values: Vec<f64>,
    /// Whether the cells are words, which can tell runs apart; the values are their numbers in order of appearance.
    pub words: bool,
}

/// Units of time in headers, with the factor to seconds as text and as number.
const TIME_UNITS: [(&str, &str, f64); 8] = [
    ("ms", "1e-3", 1e-3),
    ("us", "1e-6", 1e-6),
    ("µs", "1e-6", 1e-6),
    ("ns", "1e-9", 1e-9),
    ("min", "60", 60.0),
    ("h", "3600", 3600.0),
    ("hour", "3600", 3600.0),
    ("hours", "3600", 3600.0),
];

/// Units that headers carry behind a `_`: `angle_deg`, `pos_mm`, `gyro_dps`.
const UNIT_SUFFIXES: [(&str, &str); 9] = [
    ("deg", "deg"),
    ("rad", "rad"),
    ("dps", "deg/s"),
    ("rpm", "rpm"),
    ("ms", "ms"),
    ("us", "us"),
    ("mm", "mm"),
    ("cm", "cm"),
    ("km", "km"),
];

/// Names of columns that number the rows.
const COUNT_NAMES: [&str; 14] = [
    "sample",
    "samples",
    "index",
    "idx",
    "row",
    "no",
    "nr",
    "n",
    "k",
    "i",
    "frame",
    "step",
    "iteration",
    "iter",
];

/// Words in names of columns that tell of the recording, and not of the system.
const RECORDING_WORDS: [&str; 8] = [
    "latency", "jitter", "seq", "sequence", "counter", "checksum", "crc", "packet",
];

/// Seconds since 1970 in other units: the least number that is no longer plausible in the larger unit, and the factor.
const EPOCHS: [(f64, (&str, &str, f64)); 3] = [
    (1e17, ("ns", "1e-9", 1e-9)),
    (1e14, ("us", "1e-6", 1e-6)),
    (1e11, ("ms", "1e-3", 1e-3)),
];

/// Names that have a meaning in a data block or everywhere.
const RESERVED_NAMES: [&str; 5] = ["t", "pi", "run", "step", "none"];

/// Columns of numbers, and why the others are left out.
pub(super) fn columns(table: &Table) -> (Vec<Column>, Vec<String>) {
    let mut used: Vec<Column> = Vec::new();
    let mut left = Vec::new();
    let mut counts = BTreeMap::new();
    for header in table.headers() {
        *counts.entry(header.as_str()).or_insert(0) += 1;
    }
    for (i, header) in table.headers().iter().enumerate() {
        if used.len() == DRAFT.max_columns {
            let more = table.headers().len() - i;
            left.push(format!(
                "the last {more} columns: a first model has at most {}",
                DRAFT.max_columns
            ));
            break;
        }
        let values = table.values(i);
        let words = has_words(table, i);
        let why = match () {
            () if header.trim().is_empty() => Some("has no header"),
            () if header.chars().any(|c| c == '"' || c.is_control()) => {
                Some("has a header that no data block can name")
            }
            () if counts.get(header.as_str()).is_some_and(|n| *n > 1) => {
                Some("stands in the table more than once")
            }
            () if words => None,
            () if table.is_faulty(i) => Some("has cells that are no numbers"),
            () if !values.iter().any(|v| v.is_finite()) => Some("holds no numbers"),
            () if counts_rows(header, values) => Some("numbers the rows"),
            () if is_of_recording(header) => Some("tells of the recording, not of the system"),
            () => None,
        };
        let values = match words {
            true => numbered(table, i),
            false => values.to_vec(),
        };
        let copy = used.iter().find(|c| same(&c.values, &values));
        let copied = copy.map(|c| format!("is a copy of \"{}\"", printable(&c.header)));
        if let Some(why) = why.map(String::from).or(copied) {
            let shown: String = header
                .chars()
                .filter(|c| !c.is_control())
                .take(40)
                .collect();
            left.push(format!("column {} (\"{shown}\") {why}", i + 1));
            continue;
        }
        let (base, unit) = parts(header);
        let name = fresh(&identifier(base), &used);
        used.push(Column {
            header: header.clone(),
            name,
            unit: unit.map(String::from),
            values,
            words,
        });
    }
    (used, left)
}

/// Words as numbers, in order of appearance.
fn numbered(table: &Table, column: usize) -> Vec<f64> {
    let mut seen = BTreeMap::new();
    let rows = 0..table.len();
    rows.map(|row| {
        let next = seen.len() as f64;
        *seen
            .entry(table.cell(row, column).into_owned())
            .or_insert(next)
    })
    .collect()
}

fn same(a: &[f64], b: &[f64]) -> bool {
    a.iter()
        .zip(b)
        .all(|(a, b)| a == b || a.is_nan() && b.is_nan())
}

/// 0, 1, 2, … or from another number on, under a name that says so.
fn counts_rows(header: &str, values: &[f64]) -> bool {
    let named = COUNT_NAMES.contains(&header.trim().to_lowercase().as_str());
    named && values.windows(2).all(|w| w[1] - w[0] == 1.0)
}

fn is_of_recording(header: &str) -> bool {
    let words = identifier(parts(header).0).to_lowercase();
    words.split('_').any(|word| RECORDING_WORDS.contains(&word))
}

/// Cells that are neither numbers nor missing.
fn has_words(table: &Table, column: usize) -> bool {
    let odd = table
        .values(column)
        .iter()
        .enumerate()
        .filter(|(_, v)| !v.is_finite());
    let missing = ["", "nan", "na", "n/a", "null", "-"];
    odd.take(10_000).any(|(row, _)| {
        let cell = table
            .cell(row, column)
            .trim()
            .trim_matches('"')
            .to_lowercase();
        !missing.contains(&cell.as_str())
    })
}

/// `Pos [mm]` → `Pos`, `mm`; `pos_mm` likewise
fn parts(header: &str) -> (&str, Option<&str>) {
    let text = header.trim();
    for (open, close) in [('[', ']'), ('(', ')')] {
        if let Some((before, unit)) = text.strip_suffix(close).and_then(|t| t.rsplit_once(open)) {
            let before = before.trim();
            if !before.is_empty() {
                return (before, Some(unit.trim()));
            }
        }
    }
    if let Some(before) = text
        .strip_suffix('%')
        .map(str::trim)
        .filter(|t| !t.is_empty())
    {
        return (before, Some("%"));
    }
    let suffix = |(suffix, unit): &(&str, &'static str)| {
        let before = text.strip_suffix(suffix)?.strip_suffix('_')?;
        (!before.is_empty()).then_some((before, Some(*unit)))
    };
    UNIT_SUFFIXES
        .iter()
        .find_map(suffix)
        .unwrap_or((text, None))
}

/// Letters, digits and `_`, beginning with a letter.
fn identifier(base: &str) -> String {
    let mut out = String::new();
    for c in normalise(base).chars() {
        if c.is_alphanumeric() || c == '_' {
            out.push(c);
        } else if !out.ends_with('_') && !out.is_empty() {
            out.push('_');
        }
    }
    let out: String = out.trim_end_matches('_').chars().take(40).collect();
    match is_name(&out) {
        true => out,
        false => {
            let ascii: String = out.chars().filter(char::is_ascii_alphanumeric).collect();
            format!("c{ascii}")
        }
    }
}

fn fresh(name: &str, used: &[Column]) -> String {
    let free = |n: &str| used.iter().all(|c| c.name != n);
    if free(name) {
        return name.into();
    }
    let mut numbers = 2..;
    numbers
        .find_map(|k| Some(format!("{name}_{k}")).filter(|n| free(n)))
        .unwrap_or_default()
}

impl Column {
    /// A name that can be declared.
    pub fn declared(&self) -> String {
        match RESERVED_NAMES.contains(&self.name.as_str()) {
            true => format!("{}_", self.name),
            false => self.name.clone(),
        }
    }

    pub fn range(&self) -> (f64, f64) {
        series::range(&self.values)
    }

    /// True if all values are one.
    pub fn is_constant(&self) -> bool {
        let (low, high) = self.range();
        high - low <= DRAFT.constant * high.abs().max(low.abs())
    }

    /// True if most consecutive values are equal, and some are not.
    pub fn is_held(&self) -> bool {
        let steps = self
            .values
            .windows(2)
            .filter(|w| w[0].is_finite() && w[1].is_finite());
        let (mut same, mut all) = (0usize, 0usize);
        for w in steps {
            all += 1;
            same += usize::from(w[0] == w[1]);
        }
        all >= DRAFT.min_differences && 2 * same > all && same < all
    }

    /// True if every value is above the one before.
    pub fn rises(&self) -> bool {
        let mut last = f64::NEG_INFINITY;
        self.values.iter().all(|v| {
            let up = v.is_finite() && *v > last;
            last = *v;
            up
        })
    }

    /// The header in lower case, without what stands in brackets.
    pub fn word(&self) -> String {
        self.name.to_lowercase()
    }

    /// The factor to seconds, as text; `None` if there is none.
    pub fn seconds(&self) -> Option<&'static str> {
        self.clock().map(|(_, text, _)| *text)
    }

    /// The factor of the column in a first model: times become seconds, degrees radians.
    pub fn scale(&self) -> f64 {
        let clock = self.clock().map(|(_, _, factor)| *factor);
        let angle = self.is_degrees().then_some(std::f64::consts::PI / 180.0);
        clock.or(angle).unwrap_or(1.0)
    }

    pub fn is_degrees(&self) -> bool {
        self.unit_is(&["deg", "°", "degree", "degrees"])
    }

    fn clock(&self) -> Option<&'static (&'static str, &'static str, f64)> {
        let Some(unit) = self.unit.as_deref() else {
            let first = self.values.iter().find(|v| v.is_finite())?;
            return EPOCHS
                .iter()
                .find(|(least, _)| first > least)
                .map(|(_, unit)| unit);
        };
        TIME_UNITS.iter().find(|(name, _, _)| *name == unit)
    }

    pub fn unit_is(&self, names: &[&str]) -> bool {
        let unit = self.unit.as_deref().map(str::to_lowercase);
        unit.is_some_and(|u| names.contains(&u.as_str()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headers_become_names_and_units() {
        assert_eq!(parts("Pos [mm]"), ("Pos", Some("mm")));
        assert_eq!(parts("Time (ms)"), ("Time", Some("ms")));
        assert_eq!(parts("Cmd %"), ("Cmd", Some("%")));
        assert_eq!(parts("(m)"), ("(m)", None));
        assert_eq!(parts("angle_deg"), ("angle", Some("deg")));
        assert_eq!(parts("_deg"), ("_deg", None));
        assert_eq!(identifier("wheel speed, left"), "wheel_speed_left");
        assert_eq!(identifier("2nd"), "c2nd");
        assert_eq!(identifier("θ"), "θ");
    }
}
