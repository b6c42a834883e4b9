//! The right side of the equations as a function, for integrators outside this library.

use sidc_lang::term::SignalNames;
use sidc_system::simulate::RightSide as Compiled;

use crate::discovery::Discovery;
use crate::error::{Error, ErrorKind};

/// ẋ = f(t, x, u) and ∂f/∂x, compiled; in discrete time f gives the next x. Coupled equations are solved at every point.
///
/// ```
/// use sidc::{Data, Model, Options};
///
/// let t: Vec<f64> = (0..60).map(|k| 0.1 * f64::from(k)).collect();
/// let x: Vec<f64> = t.iter().map(|t| 2.0 * (-0.5 * t).exp()).collect();
/// let data = Data::new().run([("t", t), ("x", x)])?;
/// let found = Model::parse("state x\ndx ~ poly(x; 3)\n")?.identify(&data, &Options::default())?;
///
/// let mut right_side = found.right_side()?;
/// assert_eq!(right_side.states(), ["x"]);
/// let mut rate = [0.0];
/// right_side.rates(0.0, &[4.0], &[], &mut rate);
/// assert!((rate[0] + 2.0).abs() < 1e-5);
/// # Ok::<(), sidc::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct RightSide {
    compiled: Compiled,
    states: Vec<String>,
    inputs: Vec<String>,
    delays: Vec<f64>,
}

impl RightSide {
    /// The names of the n components of x.
    pub fn states(&self) -> &[String] {
        &self.states
    }

    /// The names of the m components of u: inputs, parameters and lagged samples that the equations mention, in this order.
    pub fn inputs(&self) -> &[String] {
        &self.inputs
    }

    /// How much later than recorded each component of u acts, in the unit of time. f takes the delayed value.
    pub fn input_delays(&self) -> &[f64] {
        &self.delays
    }

    /// Writes f at a point to `out`. `x` and `out` have length n, `u` has length m. NaN if the equations have no value or the lengths differ.
    pub fn rates(&mut self, t: f64, x: &[f64], u: &[f64], out: &mut [f64]) {
        self.compiled.rates(t, x, u, out);
    }

    /// Writes ∂f/∂x at a point to `out`, n × n by rows; NaN as in [`RightSide::rates`].
    pub fn jacobian(&mut self, t: f64, x: &[f64], u: &[f64], out: &mut [f64]) {
        self.compiled.jacobian(t, x, u, out);
    }
}

impl Discovery {
    /// The right side of the equations. Coefficients and constants that differ between runs are replaced by their means.
    ///
    /// # Errors
    /// [`ErrorKind::Export`]: no equations, or equations that are not a function of state and inputs.
    pub fn right_side(&self) -> Result<RightSide, Error> {
        let discovery = &self.opened.discovery;
        let compiled = Compiled::new(discovery)
            .map_err(|why| Error::new(ErrorKind::Export, "not-exported", why))?;
        let names = |signals: Vec<_>| signals.iter().map(|s| discovery.name(*s)).collect();
        let delays = compiled.inputs().into_iter();
        Ok(RightSide {
            states: names(compiled.states()),
            inputs: names(compiled.inputs()),
            delays: delays.map(|s| discovery.input_delay(s.var)).collect(),
            compiled,
        })
    }
}
