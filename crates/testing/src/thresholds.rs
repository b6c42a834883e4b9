//! The numbers that decide, part by part, and the table of the study that moves each of them by factors.
//!
//! In: the families of all crates, and docs/thresholds-study.csv as text. Out: tables of numbers; rows of the study, read and written.
//! Moves no number: that is the program `thresholds` of the studies.

use std::fmt;

use sidc_thresholds::{Table, Threshold};

/// The table of the study.
pub const STUDY: &str = "docs/thresholds-study.csv";

const HEADER: &str = "family,name,value,factor,cases,changed,which";

/// What each number is multiplied by; whole numbers are rounded, and move by at least one.
pub const FACTORS: [f64; 2] = [0.5, 2.0];

/// Numbers that constants are made from, so that a build for the study cannot move them; the record only shows them.
pub const CONSTANTS: &[(&str, &str)] = &[
    ("LibraryLimits", "memory"),
    ("WeakFormNumbers", "stencil_points"),
    ("Whiteness", "lags"),
];

/// `sidc-cli` has no library, so its file is included.
#[path = "../../cli/src/thresholds.rs"]
mod command_line;

/// The language server is not among the dependencies of this crate, so its file is included, too.
#[path = "../../lsp/src/thresholds.rs"]
mod editor;

/// Every family, by the parts of the program.
pub fn parts() -> Vec<(&'static str, Vec<Table>)> {
    vec![
        ("Language", sidc_lang::thresholds()),
        ("Data", sidc_data::thresholds()),
        ("Solvers", sidc_solve::thresholds()),
        ("System", sidc_system::thresholds()),
        ("Discovery", sidc_discover::thresholds()),
        ("Output", sidc_emit::thresholds()),
        ("Library", sidc::pipeline::thresholds()),
        ("Editor", editor::tables()),
        ("Command line", command_line::thresholds()),
    ]
}

/// How sensitive answers are to a number: a factor that it was moved by, and what that did to the cases of the study.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensitivity {
    pub family: String,
    pub name: String,
    /// The value in the code, as [`value`] writes it: a row about another value is out of date.
    pub value: String,
    pub factor: f64,
    /// Cases that read the family. The others cannot change.
    pub cases: usize,
    /// Cases whose answer changed, each with the first part of it that changed: `lorenz: terms`.
    pub changed: Vec<String>,
}

/// The value of a number as a cell without commas.
pub fn value(number: &Threshold) -> String {
    number.value.replace(", ", " ")
}

impl Sensitivity {
    pub fn is_of(&self, family: &str, number: &Threshold, factor: f64) -> bool {
        (self.family.as_str(), self.name.as_str()) == (family, number.name)
            && self.value == value(number)
            && self.factor == factor
    }
}

impl fmt::Display for Sensitivity {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let (family, name, value, factor) = (&self.family, &self.name, &self.value, self.factor);
        let (cases, changed, which) = (self.cases, self.changed.len(), self.changed.join("; "));
        write!(
            f,
            "{family},{name},{value},{factor},{cases},{changed},{which}"
        )
    }
}

/// Rows of the table.
///
/// # Panics
/// If a line is not a row.
pub fn read(text: &str) -> Vec<Sensitivity> {
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some(HEADER));
    let row = |line: &str| -> Option<Sensitivity> {
        let [family, name, value, factor, cases, changed, which] =
            line.split(',').collect::<Vec<_>>().try_into().ok()?;
        let row = Sensitivity {
            family: family.into(),
            name: name.into(),
            value: value.into(),
            factor: factor.parse().ok()?,
            cases: cases.parse().ok()?,
            changed: which
                .split("; ")
                .filter(|c| !c.is_empty())
                .map(String::from)
                .collect(),
        };
        (row.changed.len().to_string() == changed).then_some(row)
    };
    lines
        .map(|line| row(line).unwrap_or_else(|| panic!("{STUDY}: {line}")))
        .collect()
}

/// The table of rows.
pub fn write(rows: &[Sensitivity]) -> String {
    let rows: String = rows.iter().map(|row| format!("{row}\n")).collect();
    format!("{HEADER}\n{rows}")
}

/// The rows of a number's present value, by half of it and by twice; `None` if the study has not run it.
fn moved<'a>(
    rows: &'a [Sensitivity],
    family: &str,
    number: &Threshold,
) -> Option<[&'a Sensitivity; 2]> {
    let of = |factor| rows.iter().find(|row| row.is_of(family, number, factor));
    match FACTORS.map(of) {
        [Some(half), Some(twice)] => Some([half, twice]),
        _ => None,
    }
}

/// What the study says about a number, for a cell of the documentation: answers changed by each factor, of the cases that read it.
pub fn outcome(rows: &[Sensitivity], family: &str, number: &Threshold) -> String {
    if CONSTANTS.contains(&(family, number.name)) {
        return "constant".into();
    }
    match moved(rows, family, number) {
        None => "not run".into(),
        Some([half, twice]) if half.cases == 0 && twice.cases == 0 => "not reached".into(),
        Some([half, twice]) => {
            let (half, twice, cases) = (half.changed.len(), twice.changed.len(), half.cases);
            format!("{half}, {twice} of {cases}")
        }
    }
}

/// How many answers half and twice a number changed; `None` if no case reads it, or the study has not run it.
pub fn changes(rows: &[Sensitivity], family: &str, number: &Threshold) -> Option<usize> {
    let rows = moved(rows, family, number)?;
    let read = rows.iter().any(|row| row.cases > 0);
    read.then(|| rows.iter().map(|row| row.changed.len()).sum())
}
