//! What was measured, as arrays.

use std::io::Read;

use sidc_data::draft::ChosenRoles;
use sidc_data::{ArrayColumn, ArrayFault, Limits, Table};
use sidc_lang::source::{Sources, printable};
use sidc_system::result::FileEntry;

use crate::error::{Error, ErrorKind};
use crate::pipeline::Hashed;

/// Records of one system. Each record is a set of named arrays, like the columns of a file; lengths, steps and start times may differ.
///
/// The names are those of the model's signals, or the headers named in its data block; `t` is time. NaN marks a missing value. An infinite value is an error
/// if the model reads its array.
///
/// ```
/// use sidc::Data;
///
/// let data = Data::new()
///     .run([("t", vec![0.0, 0.1, 0.2]), ("x", vec![1.0, 0.9, f64::NAN])])?
///     .run([("t", vec![0.0, 0.5]), ("x", vec![2.0, 1.2])])?;
/// assert_eq!(data.runs(), 2);
///
/// let ragged = Data::new().run([("t", vec![0.0, 0.1]), ("x", vec![1.0])]);
/// assert!(ragged.is_err_and(|e| e.to_string().contains("the array x has 1 value, but the first array has 2")));
/// # Ok::<(), sidc::Error>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Data {
    pub(crate) tables: Vec<Table>,
    pub(crate) params: Vec<(String, Vec<f64>)>,
    pub(crate) notes: Vec<String>,
    /// The files that tables were read from.
    pub(crate) files: Vec<FileEntry>,
}

impl Data {
    /// No records.
    pub fn new() -> Data {
        Data::default()
    }

    /// Adds a record called `run 1`, `run 2`, …; `columns` are pairs of a name and an array of M values.
    ///
    /// # Errors
    /// [`ErrorKind::Data`]: no values, arrays of different lengths, a repeated name.
    pub fn run<N, V>(self, columns: impl IntoIterator<Item = (N, V)>) -> Result<Data, Error>
    where
        N: Into<String>,
        V: Into<Vec<f64>>,
    {
        let name = format!("run {}", self.tables.len() + 1);
        self.named_run(&name, columns)
    }

    /// Like [`Data::run`], with a name for the record that messages and results use.
    ///
    /// # Errors
    /// As [`Data::run`].
    pub fn named_run<N, V>(
        mut self,
        name: &str,
        columns: impl IntoIterator<Item = (N, V)>,
    ) -> Result<Data, Error>
    where
        N: Into<String>,
        V: Into<Vec<f64>>,
    {
        let columns = columns.into_iter();
        let columns = columns.map(|(n, v)| (n.into(), ArrayColumn::Numbers(v.into())));
        let table = Table::from_columns(name, columns.collect());
        self.tables
            .push(table.map_err(|fault| refused(name, fault))?);
        Ok(self)
    }

    /// Adds a record from a file, read as `sidc identify` reads it: a text table with names in its first line, NumPy arrays (`.npz`), MATLAB arrays (`.mat`),
    /// or, with the feature `parquet`, a Parquet file. Messages and results call it `name`.
    ///
    /// ```
    /// let data = sidc::Data::new().file("decay.csv", "t,x\n0,2\n0.1,1.9\n".as_bytes())?;
    /// assert_eq!(data.runs(), 1);
    /// # Ok::<(), sidc::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`ErrorKind::Data`]: every fault of the table, with its line.
    pub fn file(mut self, name: &str, reader: impl Read) -> Result<Data, Error> {
        let mut sources = Sources::default();
        let limits = Limits {
            taken: self.tables.iter().map(Table::bytes).sum(),
            ..Limits::default()
        };
        let mut reader = Hashed::new(reader);
        let read = sidc_formats::read(name, &mut reader, &limits, &mut sources);
        let read = read.map_err(|found| Error::of(ErrorKind::Data, &found, &sources))?;
        self.tables.push(read.table);
        self.files.push(reader.entry(name));
        self.notes
            .extend(read.notes.iter().map(|n| printable(&n.message)));
        Ok(self)
    }

    /// What the files contain that the tables do not: arrays of another length, objects, lists.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Sets a parameter that the model declares, in its unit: one value for all records, or one per record in their order.
    pub fn param(mut self, name: &str, values: impl Into<Vec<f64>>) -> Data {
        self.params.push((name.into(), values.into()));
        self
    }

    /// A first model of the first record: states with their orders, inputs, parameters and a library to start from. Comments say what was guessed from names
    /// and shapes. Nothing is identified.
    ///
    /// ```
    /// let t: Vec<f64> = (0..60).map(|k| 0.1 * f64::from(k)).collect();
    /// let x: Vec<f64> = t.iter().map(|t| t.cos()).collect();
    /// let text = sidc::Data::new().run([("t", t), ("x", x)])?.draft()?;
    /// assert!(text.contains("state x"));
    /// assert!(sidc::Model::parse(&text).is_ok());
    /// # Ok::<(), sidc::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`ErrorKind::Data`]: no record, or no named array that varies.
    pub fn draft(&self) -> Result<String, Error> {
        let guessed = |t| sidc_data::draft::draft(t, &ChosenRoles::default()).ok();
        let text = self.tables.first().and_then(guessed).ok_or_else(|| {
            let text = "no array that has a name moves, so there is nothing to find a law of\n  = help: give time as t and an array for each signal";
            Error::new(ErrorKind::Data, "no-state", text)
        })?;
        let mut sources = Sources::default();
        let file = sources.add("model.sid", text.as_str());
        sidc_lang::format(file, &text)
            .map_err(|found| Error::of(ErrorKind::Internal, &found, &sources))
    }

    /// The files of the records, in order; empty unless every record was read from a file.
    pub(crate) fn files(&self) -> &[FileEntry] {
        match self.files.len() == self.tables.len() {
            true => &self.files,
            false => &[],
        }
    }

    /// The number of records.
    pub fn runs(&self) -> usize {
        self.tables.len()
    }
}

fn refused(run: &str, fault: ArrayFault) -> Error {
    let (code, text) = match fault {
        ArrayFault::Empty => ("no-rows", format!("{run} has no values")),
        ArrayFault::Twice(name) => (
            "duplicate-header",
            format!("{run} has two arrays called {name}"),
        ),
        ArrayFault::Ragged {
            first,
            name,
            length,
        } => (
            "ragged-row",
            format!(
                "{run}: the array {name} has {}, but the first array has {first}\n  = help: give one value for each row, NaN where it is missing",
                match length {
                    1 => "1 value".into(),
                    n => format!("{n} values"),
                }
            ),
        ),
    };
    Error::new(ErrorKind::Data, code, text)
}
