//! The tables and figures of the thesis, and the questions it leaves open: one file per section.
//!
//! In: the effort. Out: text, tables and figures, the same for the same effort on the same machine. Writes no files.

use std::error::Error;

mod bounds;
mod coupled;
mod decorrelated;
mod differences;
mod double;
mod excitation;
mod experiment;
mod graded;
mod isometry;
mod libraries;
mod phase;
mod plot;
mod predictors;
mod record;
mod rows;
mod setup;
mod single;
mod smallest;
mod subrate;
mod success;
pub mod tables;
mod textbook;
mod tidy;
mod work;

/// An error, for the user of the program.
pub type Fault = Box<dyn Error + Send + Sync>;

/// How much to compute.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Effort {
    /// The committed figures.
    Full,
    /// Every section with few draws: seconds instead of minutes.
    Quick,
}

impl Effort {
    pub fn of<T>(self, full: T, quick: T) -> T {
        match self {
            Effort::Full => full,
            Effort::Quick => quick,
        }
    }
}

/// A file that accompanies the text.
pub struct Attachment {
    pub name: String,
    pub content: String,
}

/// The content of a section: Markdown below its heading, and files.
pub struct Section {
    pub text: String,
    pub files: Vec<Attachment>,
}

pub struct Chapter {
    /// The name for `--only`, and the prefix of its files' names.
    pub name: &'static str,
    pub title: &'static str,
    pub write: fn(Effort) -> Result<Section, Fault>,
}

/// In the order of the document.
pub static CHAPTERS: &[Chapter] = &[
    Chapter {
        name: "isometry",
        title: "Table 4.1: the restricted isometry",
        write: isometry::section,
    },
    Chapter {
        name: "experiment",
        title: "Figures 5.4 to 5.6: the experiment",
        write: experiment::section,
    },
    Chapter {
        name: "subrate",
        title: "Figures 5.7 to 5.9: error against subrate",
        write: subrate::section,
    },
    Chapter {
        name: "tables",
        title: "Tables 5.2 and 5.3: the coefficients",
        write: tables::section,
    },
    Chapter {
        name: "smallest",
        title: "The fewest samples that do",
        write: smallest::section,
    },
    Chapter {
        name: "graded",
        title: "Fewer samples in graded norms",
        write: graded::section,
    },
    Chapter {
        name: "phase",
        title: "Samples and noise: a phase diagram",
        write: phase::section,
    },
    Chapter {
        name: "bounds",
        title: "Noise bounds",
        write: bounds::section,
    },
    Chapter {
        name: "excitation",
        title: "Which excitation makes Φ recoverable",
        write: excitation::section,
    },
    Chapter {
        name: "rows",
        title: "Consecutive rows against random rows",
        write: rows::section,
    },
    Chapter {
        name: "frequencies",
        title: "Frequencies sin ωθ",
        write: libraries::of_frequencies,
    },
    Chapter {
        name: "powers",
        title: "Total power",
        write: libraries::of_powers,
    },
    Chapter {
        name: "decorrelated",
        title: "Decorrelated columns",
        write: decorrelated::section,
    },
    Chapter {
        name: "double",
        title: "The cart with a double pendulum",
        write: double::section,
    },
    Chapter {
        name: "coupled",
        title: "Random coupled systems",
        write: coupled::section,
    },
    Chapter {
        name: "differences",
        title: "What differs from the thesis and why",
        write: differences::section,
    },
];
