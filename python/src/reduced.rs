//! Rows of a large table, reduced part by part.

use pyo3::prelude::*;

use crate::raised::raised;

/// The rows of some parts of a table.
#[pyclass(module = "sidc._sidc")]
pub struct Reduced {
    pub inner: sidc::Reduced,
}

#[pymethods]
impl Reduced {
    /// Adds the rows of other parts.
    fn merge(&mut self, py: Python<'_>, other: &Reduced) -> PyResult<()> {
        self.inner.merge(&other.inner).map_err(|e| raised(py, &e))
    }

    /// The largest number of rows of an equation.
    fn rows(&self) -> usize {
        self.inner.rows()
    }

    /// The number of parts merged.
    fn parts(&self) -> usize {
        self.inner.parts()
    }

    /// As JSON text.
    fn to_json(&self, py: Python<'_>) -> PyResult<String> {
        self.inner.to_json().map_err(|e| raised(py, &e))
    }

    /// Reads the text of `to_json`.
    #[staticmethod]
    fn from_json(py: Python<'_>, text: &str) -> PyResult<Reduced> {
        let inner = sidc::Reduced::from_json(text).map_err(|e| raised(py, &e))?;
        Ok(Reduced { inner })
    }
}
