//! What was measured, as arrays.

use std::io::Read;

use sidc_data::draft::ChosenRoles;
use sidc_data::{ArrayColumn, ArrayFault, Limits, Table};
use sidc_lang::source::{Sources, printable};
use sidc_system::result::FileEntry;

use crate::error::{Error, ErrorKind};
use crate::pipeline::Hashed;

/// Records of one system: each is a set of arrays with names, as the columns of a file would be. Lengths, steps and starts may
/// differ between records.
///
/// Names are those of the model's signals, or the headers that its data block reads; `t` is time. NaN marks a missing value; an
/// infinite one is refused where a model reads its array.
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
    /// Those of the tables that were read from files.
    pub(crate) files: Vec<FileEntry>,
}

impl Data {
    pub fn new() -> Data {
        Data::default()
    }

    /// Adds a record called `run 1`, `run 2`, …; `columns` are pairs of a name and M values.
    ///
    /// # Errors
    /// [`ErrorKind::Data`]: no values, arrays of different lengths, a name twice.
    pub fn run<N, V>(self, columns: impl IntoIterator<Item = (N, V)>) -> Result<Data, Error>
    where
        N: Into<String>,
        V: Into<Vec<f64>>,
    {
        let name = format!("run {}", self.tables.len() + 1);
        self.named_run(&name, columns)
    }

    /// The same for a record with a name of its own, by which messages and results call it.
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

    /// Adds a record from a file, as `sidc identify` reads it: a table of text with names in its first line, arrays of NumPy (`.npz`) or
    /// MATLAB (`.mat`), or with the feature `parquet` a Parquet file. `name` is what messages and results call it.
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

    /// What of the files is not in their tables: arrays of another length, objects, lists.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Sets a parameter that the model declares: one value for all records, or one for each in their order.
    pub fn param(mut self, name: &str, values: impl Into<Vec<f64>>) -> Data {
        self.params.push((name.into(), values.into()));
        self
    }

    /// A first model of the first record: states with their orders, inputs, parameters, a library to start from, with comments that
    /// say what was guessed from names and shapes. Nothing is identified.
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
    /// [`ErrorKind::Data`]: no record, or no array that moves.
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

    /// The files of the records, in their order; none if a record is of arrays.
    pub(crate) fn files(&self) -> &[FileEntry] {
        match self.files.len() == self.tables.len() {
            true => &self.files,
            false => &[],
        }
    }

    /// How many records there are.
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
