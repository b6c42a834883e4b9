//! The result of an identification.

use std::sync::Arc;

use numpy::{IntoPyArray, PyArray1};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use crate::inputs::Data;
use crate::raised::raised;
use crate::right_side::RightSide;
use crate::watching::{Watch, watched};

/// Columns by name.
type Columns<'py> = Vec<(String, Bound<'py, PyArray1<f64>>)>;

/// Name, simulated and measured columns, scores (signal, rows, mse, fit, r_squared), and what ended it early.
type Run<'py> = (
    String,
    Columns<'py>,
    Columns<'py>,
    Vec<(String, usize, f64, f64, f64)>,
    Option<String>,
);

/// Equations with their evidence.
#[pyclass(module = "sidc._sidc", frozen)]
pub struct Discovery {
    inner: Arc<sidc::Discovery>,
}

impl Discovery {
    pub fn new(found: sidc::Discovery) -> Discovery {
        Discovery {
            inner: Arc::new(found),
        }
    }
}

#[pymethods]
impl Discovery {
    /// Reads a result document.
    #[staticmethod]
    fn from_json(py: Python<'_>, text: &str) -> PyResult<Discovery> {
        let found = py.detach(|| sidc::Discovery::from_json(text));
        found.map(Discovery::new).map_err(|e| raised(py, &e))
    }

    /// The result document.
    fn to_json(&self, py: Python<'_>) -> PyResult<String> {
        self.inner.to_json().map_err(|e| raised(py, &e))
    }

    /// True if every equation was found and none has a doubt.
    fn passes(&self) -> bool {
        self.inner.passes()
    }

    /// The answer as the program prints it.
    fn answer(&self) -> String {
        self.inner.answer()
    }

    /// The equations, one a line.
    fn equations(&self) -> String {
        self.inner.to_string()
    }

    /// Equations, verdict and coefficients as an HTML fragment.
    fn html(&self) -> String {
        self.inner.html()
    }

    /// The equations in another language.
    fn export(&self, py: Python<'_>, target: &str) -> PyResult<String> {
        let written = sidc::Target::named(target).and_then(|t| self.inner.export(t));
        written.map_err(|e| raised(py, &e))
    }

    /// The equations in another language as the bytes of a file; also for targets with binary files.
    fn export_bytes(&self, py: Python<'_>, target: &str) -> PyResult<Vec<u8>> {
        let written = sidc::Target::named(target).and_then(|t| self.inner.export_bytes(t));
        written.map_err(|e| raised(py, &e))
    }

    /// The right side of the equations.
    fn right_side(&self, py: Python<'_>) -> PyResult<RightSide> {
        let found = self.inner.right_side();
        found.map(RightSide::new).map_err(|e| raised(py, &e))
    }

    /// Runs the equations along every record. Returns a tuple for each.
    #[pyo3(signature = (data, start, time_limit=None))]
    fn simulate<'py>(
        &self,
        py: Python<'py>,
        data: &Data,
        start: Vec<(String, f64)>,
        time_limit: Option<f64>,
    ) -> PyResult<Vec<Run<'py>>> {
        let (found, data) = (self.inner.clone(), data.inner.clone());
        let watch = Watch {
            time_limit,
            ..Watch::default()
        };
        let simulated = watched(py, watch, move |observer| {
            let start: Vec<(&str, f64)> = start.iter().map(|(n, v)| (n.as_str(), *v)).collect();
            found.simulate_from(&start, &data, observer)
        })?;
        let runs = simulated.map_err(|e| raised(py, &e))?.runs.into_iter();
        Ok(runs.map(|run| as_tuple(py, run)).collect())
    }

    /// How well the equations predict over a horizon: that part of the document, as JSON.
    #[pyo3(signature = (data, horizon=None))]
    fn predict(&self, py: Python<'_>, data: &Data, horizon: Option<f64>) -> PyResult<String> {
        let (found, data) = (self.inner.clone(), data.inner.clone());
        let predicted = watched(py, Watch::default(), move |observer| {
            found.predict(&data, horizon, observer)
        })?;
        let predicted = predicted.map_err(|e| raised(py, &e))?;
        serde_json::to_string(&predicted).map_err(|e| PyRuntimeError::new_err(e.to_string()))
    }

    /// A page of HTML with runs along these data.
    fn report(&self, py: Python<'_>, data: &Data) -> PyResult<String> {
        let (found, data) = (self.inner.clone(), data.inner.clone());
        let page = watched(py, Watch::default(), move |observer| {
            found.report(&data, observer)
        })?;
        page.map_err(|e| raised(py, &e))
    }
}

fn as_tuple(py: Python<'_>, run: sidc::SimulatedRun) -> Run<'_> {
    let time = ("t".to_string(), run.time);
    let simulated = std::iter::once(time).chain(run.signals);
    let array = |(name, values): (String, Vec<f64>)| (name, values.into_pyarray(py));
    let scores = run.scores.into_iter();
    (
        run.name,
        simulated.map(array).collect(),
        run.measured.into_iter().map(array).collect(),
        scores
            .map(|s| (s.signal, s.rows, s.mse, s.fit, s.r_squared))
            .collect(),
        run.fault,
    )
}
