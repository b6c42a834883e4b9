//! Inputs: data as arrays, and options. Each method corresponds to that of the library with the same name.

use std::mem::take;
use std::sync::Arc;

use numpy::PyReadonlyArray1;
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;

use crate::raised::raised;
use crate::watching::{Watch, watched};

/// Records of one system.
#[pyclass(module = "sidc._sidc")]
#[derive(Default)]
pub struct Data {
    /// Shared with running work, so that arrays are copied only once.
    pub inner: Arc<sidc::Data>,
}

impl Data {
    /// Takes the data out, to be put back; copies them while work uses them.
    fn take(&mut self) -> sidc::Data {
        Arc::unwrap_or_clone(take(&mut self.inner))
    }
}

#[pymethods]
impl Data {
    #[new]
    fn new() -> Data {
        Data::default()
    }

    /// Adds a named record: columns are pairs of a name and M values, NaN if missing.
    fn run(
        &mut self,
        py: Python<'_>,
        name: &str,
        columns: Vec<(String, PyReadonlyArray1<'_, f64>)>,
    ) -> PyResult<()> {
        let copied = columns.iter().map(|(name, values)| {
            let view = values.as_array();
            (name.as_str(), view.iter().copied().collect::<Vec<f64>>())
        });
        let more = self.take().named_run(name, copied);
        self.inner = Arc::new(more.map_err(|e| raised(py, &e))?);
        Ok(())
    }

    /// Adds a record from the bytes of a file. After Ctrl-C there are no records.
    fn file(&mut self, py: Python<'_>, name: String, bytes: PyBackedBytes) -> PyResult<()> {
        let before = self.take();
        let more = watched(py, Watch::default(), move |_| before.file(&name, &*bytes))?;
        self.inner = Arc::new(more.map_err(|e| raised(py, &e))?);
        Ok(())
    }

    /// What the files contain that the tables do not.
    fn notes(&self) -> Vec<String> {
        self.inner.notes().to_vec()
    }

    /// Sets a parameter that the model declares: one value for all records, or one per record.
    fn param(&mut self, name: &str, values: Vec<f64>) {
        self.inner = Arc::new(self.take().param(name, values));
    }

    /// The text of a first model of the first record.
    fn draft(&self, py: Python<'_>) -> PyResult<String> {
        self.inner.draft().map_err(|e| raised(py, &e))
    }
}

/// How to search for equations.
#[pyclass(module = "sidc._sidc")]
#[derive(Default)]
pub struct Options {
    pub inner: sidc::Options,
}

impl Options {
    fn change(&mut self, change: impl FnOnce(sidc::Options) -> sidc::Options) {
        self.inner = change(take(&mut self.inner));
    }

    fn try_change(
        &mut self,
        py: Python<'_>,
        change: impl FnOnce(sidc::Options) -> Result<sidc::Options, sidc::Error>,
    ) -> PyResult<()> {
        let changed = change(take(&mut self.inner));
        self.inner = changed.map_err(|e| raised(py, &e))?;
        Ok(())
    }
}

#[pymethods]
impl Options {
    #[new]
    fn new() -> Options {
        Options::default()
    }

    /// Noise of a signal, with standard deviation sqrt(floor² + (share · value)²).
    fn noise(&mut self, signal: &str, floor: f64, share: f64) {
        self.change(|o| match share == 0.0 {
            true => o.noise(signal, floor),
            false => o.growing_noise(signal, floor, share),
        });
    }

    /// Holds out the last part of every record, 0 < part < 1.
    fn hold_out_last(&mut self, part: f64) {
        self.change(|o| o.hold_out(sidc::HoldOutRange::Last(part)));
    }

    /// Holds out the rows with start <= t <= end of every record.
    fn hold_out_times(&mut self, start: Option<f64>, end: Option<f64>) {
        self.change(|o| o.hold_out(sidc::HoldOutRange::Times(start, end)));
    }

    /// Holds out the record at this place, counted from 0.
    fn hold_out_run(&mut self, place: usize) {
        self.change(|o| o.hold_out_run(place));
    }

    /// Uses only rows with start <= t <= end.
    fn window(&mut self, start: Option<f64>, end: Option<f64>) {
        self.change(|o| o.window(start, end));
    }

    /// How far ahead predictions are compared.
    fn horizon(&mut self, ahead: f64) {
        self.change(|o| o.horizon(ahead));
    }

    /// The largest error of predictions, as a fraction of each signal's spread.
    fn good(&mut self, part: f64) {
        self.change(|o| o.good(part));
    }

    /// The largest error of predictions of one signal, in its unit.
    fn good_signal(&mut self, signal: &str, error: f64) {
        self.change(|o| o.good_signal(signal, error));
    }

    /// How equations are found, by name.
    fn method(&mut self, py: Python<'_>, name: &str) -> PyResult<()> {
        self.try_change(py, |o| o.method_named(name))
    }

    /// The sparse solver, by name.
    fn solver(&mut self, py: Python<'_>, name: &str) -> PyResult<()> {
        self.try_change(py, |o| o.solver(name))
    }

    /// Uses this many random rows.
    fn samples(&mut self, rows: usize, seed: u64) {
        self.change(|o| o.samples(rows, seed));
    }

    /// Seed of every random choice.
    fn seed(&mut self, seed: u64) {
        self.change(|o| o.seed(seed));
    }

    /// Largest number of bytes that the values of one library may take.
    fn memory(&mut self, bytes: u64) {
        self.change(|o| o.memory(bytes));
    }

    /// Rejects outliers.
    fn robust(&mut self) {
        self.change(sidc::Options::robust);
    }

    /// Adds the answers for larger tolerances.
    fn path(&mut self) {
        self.change(sidc::Options::path);
    }

    /// Searches for the sparsest equation, with a proof.
    fn prove_sparsest(&mut self) {
        self.change(sidc::Options::prove_sparsest);
    }

    /// Checks every equation and its certificate again, in 106-bit arithmetic.
    fn verify(&mut self) {
        self.change(sidc::Options::verify);
    }
}
