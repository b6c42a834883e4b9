//! Numbers that decide on the command line: sizes of files, the comparison of models, the display of progress.
//!
//! In: nothing. Out: families of numbers, and their tables for the documentation. Never computes with them.

// The program reads the numbers; only the documentation test reads their tables.
#![allow(dead_code)]

use std::time::Duration;

use sidc_thresholds::{Table, family};

family! {
    /// What is read at most, beside tables.
    pub(crate) INPUT_LIMITS: InputLimits {
        /// Largest model; whatever it says is understood in seconds.
        model: u64 = 1 << 20, unit "bytes", source "set by hand: far beyond any model written by hand";
        /// Largest result document.
        result: u64 = 64 << 20, unit "bytes", source "set by hand";
        /// Longest number of a point, arithmetic included (`30*pi/180`); messages show as much of a wrong one.
        point_value: usize = 80, unit "characters", source "set by hand";
    }
}

family! {
    /// How several models for the same data are compared.
    pub(crate) MODEL_COMPARISON: ModelComparison {
        /// Part of every record, at its end, that is held out unless the user says what is.
        held_out: f64 = 0.25, unit "of the rows", source "set by hand";
        /// How often the records held out are halved until some model follows them.
        halvings: usize = 6, unit "", source "set by hand";
        /// Rows that the shortest part of a record keeps.
        rows: usize = 40, unit "rows", source "set by hand";
    }
}

family! {
    /// When a user hears how far the work is.
    pub(crate) PROGRESS: Progress {
        /// Work that ends sooner shows no progress line.
        delay: Duration = Duration::from_secs(1), unit "", source "set by hand";
        /// Time between two drawings of the line.
        period: Duration = Duration::from_millis(200), unit "", source "set by hand";
        /// Verifications from this size on are announced.
        announced_products: u128 = 1_000_000_000, unit "products in 106 bits", source "set by hand: some ten seconds";
        /// Speed from which the announced time follows.
        products_per_second: f64 = 1e8, unit "products in 106 bits per second", source "set by hand";
    }
}

family! {
    /// How much of a long list is printed.
    pub(crate) LISTS: Lists {
        /// Starts of one free run.
        starts: usize = 3, unit "starts", source "set by hand";
        /// Columns of the data that the model does not read.
        unread: usize = 12, unit "columns", source "set by hand";
        /// Signals with their units.
        units: usize = 24, unit "signals", source "set by hand";
    }
}

family! {
    /// What the language server reads of the files beside a model.
    pub(crate) FOLDER: FolderLimits {
        /// Entries of a folder that are looked at.
        entries: usize = 10_000, unit "entries", source "set by hand";
        /// Tables whose columns are read, of the model's folder and of its folder `data` each.
        tables: usize = 100, unit "tables", source "set by hand";
        /// Beginning of a table that is read for the names of its columns.
        bytes: u64 = 1 << 16, unit "bytes", source "set by hand: a header is rarely longer than a kilobyte";
    }
}

/// Every number that decides on the command line, family by family.
#[allow(
    dead_code,
    reason = "the program never prints it; the test that writes docs/thresholds.md does"
)]
pub(crate) fn thresholds() -> Vec<Table> {
    vec![
        InputLimits::table(),
        ModelComparison::table(),
        Progress::table(),
        Lists::table(),
        FolderLimits::table(),
    ]
}
