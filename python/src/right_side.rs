//! The right side of the equations for integrators: at one point, or at several in columns.

use std::sync::{Mutex, PoisonError};

use numpy::ndarray::{ArrayD, ArrayViewD, IxDyn};
use numpy::{IntoPyArray, PyArrayDyn, PyReadonlyArray1, PyReadonlyArrayDyn};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyFloat;

/// dx/dt = f(t, x, u), compiled.
#[pyclass(module = "sidc._sidc", frozen)]
pub struct RightSide {
    inner: Mutex<sidc::RightSide>,
    states: Vec<String>,
    inputs: Vec<String>,
    delays: Vec<f64>,
}

/// One time for all points, or one for each.
enum Times<'py> {
    One(f64),
    Each(PyReadonlyArray1<'py, f64>),
}

impl<'py> Times<'py> {
    fn new(t: &Bound<'py, PyAny>) -> PyResult<Times<'py>> {
        // A float is tried first, because a failed extraction takes longer than f, even if its error is ignored. An array of one value can be a number too.
        if let Ok(t) = t.cast::<PyFloat>() {
            return Ok(Times::One(t.value()));
        }
        match t.extract() {
            Ok(each) => Ok(Times::Each(each)),
            Err(_) => t.extract().map(Times::One),
        }
    }
}

/// A function of the library that writes its values at a point to the last argument.
type AtPoint = fn(&mut sidc::RightSide, f64, &[f64], &[f64], &mut [f64]);

/// Points, with the values of each stored together.
struct Points {
    values: Vec<f64>,
    /// Number of values per point.
    size: usize,
    /// Number of points; `None` for one point that is used throughout.
    count: Option<usize>,
}

impl Points {
    /// Points in columns, or a single point; `names` are those of the rows, and messages use `what`.
    fn new(given: &ArrayViewD<f64>, names: &[String], what: &str) -> PyResult<Points> {
        let n = names.len();
        let count = match given.shape() {
            [rows] if *rows == n => None,
            [rows, columns] if *rows == n => Some(*columns),
            shape => {
                let text = format!(
                    "{what} of shape {shape:?}: the equations have {n} ({}), so it is ({n},), or ({n}, k) for k points",
                    names.join(", ")
                );
                return Err(PyValueError::new_err(text));
            }
        };
        Ok(Points {
            values: given.t().iter().copied().collect(),
            size: n,
            count,
        })
    }

    fn get(&self, number: usize) -> &[f64] {
        let from = self.count.map_or(0, |_| number * self.size);
        self.values.get(from..from + self.size).unwrap_or_default()
    }
}

impl RightSide {
    pub fn new(inner: sidc::RightSide) -> RightSide {
        RightSide {
            states: inner.states().to_vec(),
            inputs: inner.inputs().to_vec(),
            delays: inner.input_delays().to_vec(),
            inner: Mutex::new(inner),
        }
    }

    /// `size` values at each point, stored point by point, and the number of points; `None` for a single one.
    fn at_points(
        &self,
        t: &Times,
        x: &PyReadonlyArrayDyn<f64>,
        u: Option<&PyReadonlyArrayDyn<f64>>,
        (function, size): (AtPoint, usize),
    ) -> PyResult<(Vec<f64>, Option<usize>)> {
        let x = Points::new(&x.as_array(), &self.states, "x")?;
        let u = match u {
            Some(u) => Points::new(&u.as_array(), &self.inputs, "u")?,
            None => Points::new(&ArrayD::zeros(IxDyn(&[0])).view(), &self.inputs, "u")?,
        };
        let points = x.count.unwrap_or(1);
        if u.count.is_some_and(|count| count != points) {
            return Err(PyValueError::new_err(
                "x and u have different numbers of points",
            ));
        }
        let mut out = vec![0.0; size * points];
        let mut inner = self.inner.lock().unwrap_or_else(PoisonError::into_inner);
        for (number, out) in out.chunks_mut(size).enumerate() {
            let t = match t {
                Times::One(t) => *t,
                Times::Each(t) => t.as_array().get(number).copied().unwrap_or(f64::NAN),
            };
            function(&mut inner, t, x.get(number), u.get(number), out);
        }
        Ok((out, x.count))
    }
}

#[pymethods]
impl RightSide {
    /// The names of the components of x.
    #[getter]
    fn states(&self) -> Vec<String> {
        self.states.clone()
    }

    /// The names of the components of u: inputs, parameters, lagged samples.
    #[getter]
    fn inputs(&self) -> Vec<String> {
        self.inputs.clone()
    }

    /// How much later than recorded each component of u acts, in seconds.
    #[getter]
    fn input_delays(&self) -> Vec<f64> {
        self.delays.clone()
    }

    /// f at a point, n values, or at k points in columns, n by k; NaN if the equations have no value.
    #[pyo3(signature = (t, x, u=None))]
    fn rates<'py>(
        &self,
        py: Python<'py>,
        t: &Bound<'py, PyAny>,
        x: PyReadonlyArrayDyn<'py, f64>,
        u: Option<PyReadonlyArrayDyn<'py, f64>>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let n = self.states.len();
        let function = (sidc::RightSide::rates as AtPoint, n);
        let (rates, count) = self.at_points(&Times::new(t)?, &x, u.as_ref(), function)?;
        let rates = match count {
            None => ArrayD::from_shape_vec(IxDyn(&[n]), rates),
            Some(k) => ArrayD::from_shape_vec(IxDyn(&[k, n]), rates)
                .map(|by_point| by_point.reversed_axes()),
        };
        let rates = rates.map_err(|e| PyValueError::new_err(e.to_string()))?;
        Ok(rates.into_pyarray(py))
    }

    /// The derivatives of f by x at a point, n by n, or at k points, k by n by n.
    #[pyo3(signature = (t, x, u=None))]
    fn jacobian<'py>(
        &self,
        py: Python<'py>,
        t: &Bound<'py, PyAny>,
        x: PyReadonlyArrayDyn<'py, f64>,
        u: Option<PyReadonlyArrayDyn<'py, f64>>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let n = self.states.len();
        let function = (sidc::RightSide::jacobian as AtPoint, n * n);
        let (slopes, count) = self.at_points(&Times::new(t)?, &x, u.as_ref(), function)?;
        let shape: Vec<usize> = count.into_iter().chain([n, n]).collect();
        let slopes = ArrayD::from_shape_vec(IxDyn(&shape), slopes);
        let slopes = slopes.map_err(|e| PyValueError::new_err(e.to_string()))?;
        Ok(slopes.into_pyarray(py))
    }
}
