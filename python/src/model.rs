//! Models.

use std::sync::Arc;

use pyo3::prelude::*;

use crate::discovery::Discovery;
use crate::inputs::{Data, Options};
use crate::raised::raised;
use crate::reduced::Reduced;
use crate::watching::{Watch, watched};

/// A checked model.
#[pyclass(module = "sidc._sidc", frozen)]
pub struct Model {
    inner: Arc<sidc::Model>,
}

#[pymethods]
impl Model {
    /// `read` gives the text of an included file.
    #[new]
    #[pyo3(signature = (text, name, read=None))]
    fn new(
        py: Python<'_>,
        text: &str,
        name: &str,
        read: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Model> {
        let parsed = match read {
            None => py.detach(|| sidc::Model::named(name, text)),
            Some(read) => sidc::Model::with_files(name, text, |path| {
                let text = read.call1((path,)).and_then(|text| text.extract());
                text.map_err(|e| e.value(py).to_string())
            }),
        };
        let inner = Arc::new(parsed.map_err(|e| raised(py, &e))?);
        Ok(Model { inner })
    }

    /// The derivatives, next values and outputs that have an equation.
    fn targets(&self) -> Vec<String> {
        self.inner.targets()
    }

    /// The number of candidate terms of an equation; None if that equation is not searched for.
    fn candidates(&self, target: &str) -> Option<usize> {
        self.inner.candidates(target)
    }

    /// The candidate terms of an equation; None if that equation is not searched for.
    fn candidate_terms(&self, target: &str) -> Option<Vec<String>> {
        self.inner.candidate_terms(target).map(Iterator::collect)
    }

    /// The text, with included files inlined.
    fn text(&self) -> &str {
        self.inner.text()
    }

    /// The text of the model with libraries replaced by these terms, by target.
    fn with_terms(
        &self,
        py: Python<'_>,
        libraries: Vec<(String, Vec<String>)>,
    ) -> PyResult<String> {
        let libraries: Vec<(&str, Vec<String>)> = libraries
            .iter()
            .map(|(target, terms)| (target.as_str(), terms.clone()))
            .collect();
        let narrow = self
            .inner
            .with_terms(&libraries)
            .map_err(|e| raised(py, &e))?;
        Ok(narrow.text().to_string())
    }

    /// The names of functions and generators that a library may use.
    #[staticmethod]
    fn vocabulary() -> Vec<&'static str> {
        sidc::Model::vocabulary()
    }

    /// The warnings about the model, as the program prints them.
    fn warnings(&self) -> String {
        self.inner.warnings()
    }

    /// Finds the equations. `heard(place, words)` is called from time to time with the index of the current equation.
    #[pyo3(signature = (data, options, time_limit=None, proof_limit=None, heard=None))]
    fn identify(
        &self,
        py: Python<'_>,
        data: &Data,
        options: &Options,
        time_limit: Option<f64>,
        proof_limit: Option<f64>,
        heard: Option<Py<PyAny>>,
    ) -> PyResult<Discovery> {
        let (model, data) = (self.inner.clone(), data.inner.clone());
        let options = options.inner.clone();
        let equations = self.inner.targets().len();
        let watch = Watch {
            time_limit,
            proofs: proof_limit.map(|limit| (limit, equations)),
            heard,
        };
        let found = watched(py, watch, move |observer| {
            model.identify_watched(&data, &options, observer)
        })?;
        let found = found.map_err(|e| raised(py, &e))?;
        Ok(Discovery::new(found))
    }

    /// Reduces the rows of one part of a table.
    fn reduce(&self, py: Python<'_>, part: &Data, options: &Options) -> PyResult<Reduced> {
        let (model, part) = (self.inner.clone(), part.inner.clone());
        let options = options.inner.clone();
        let reduced = watched(py, Watch::default(), move |_| model.reduce(&part, &options))?;
        let inner = reduced.map_err(|e| raised(py, &e))?;
        Ok(Reduced { inner })
    }

    /// Finds the equations of reduced rows; `data` has the rows that are searched.
    #[pyo3(signature = (reduced, data, options, time_limit=None, heard=None))]
    fn identify_reduced(
        &self,
        py: Python<'_>,
        reduced: &Reduced,
        data: &Data,
        options: &Options,
        time_limit: Option<f64>,
        heard: Option<Py<PyAny>>,
    ) -> PyResult<Discovery> {
        let (model, data) = (self.inner.clone(), data.inner.clone());
        let (reduced, options) = (reduced.inner.clone(), options.inner.clone());
        let watch = Watch {
            time_limit,
            proofs: None,
            heard,
        };
        let found = watched(py, watch, move |observer| {
            model.identify_reduced_watched(&reduced, &data, &options, observer)
        })?;
        let found = found.map_err(|e| raised(py, &e))?;
        Ok(Discovery::new(found))
    }
}
