//! Errors of the library as Python exceptions.

use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyType;

/// An instance of `sidc.Error` with the text that the program prints, the kind of the fault and its stable codes.
pub fn raised(py: Python<'_>, error: &sidc::Error) -> PyErr {
    static CLASS: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    let kind = format!("{:?}", error.kind()).to_lowercase();
    let class = CLASS.import(py, "sidc._errors", "Error");
    match class.and_then(|class| class.call1((error.to_string(), kind, error.codes()))) {
        Ok(made) => PyErr::from_value(made),
        Err(other) => other,
    }
}
