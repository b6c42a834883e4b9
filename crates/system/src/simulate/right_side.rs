//! The right side of found equations as a function of time, state and inputs.
//!
//! In: a discovery, points. Out: rates and their Jacobian, one point at a time. Integrates nothing.

use super::compiled::compiled_system::{CompiledSystem, Workspace};
use crate::discovery::{Discovery, Form};
use sidc_lang::term::{Signal, SignalNames};

/// ẋ = f(t, x, u), or the next x in discrete time, compiled.
#[derive(Clone, Debug)]
pub struct RightSide {
    system: CompiledSystem,
    work: Workspace,
    given: usize,
}

impl RightSide {
    /// # Errors
    /// Why there is no such function.
    pub fn new(d: &Discovery) -> Result<RightSide, String> {
        if d.equations.is_empty() {
            return Err("the result has no equations".into());
        }
        let form = Form::new(d);
        if form.state.is_empty() {
            return Err("no equation has a state".into());
        }
        let system =
            CompiledSystem::new(form).map_err(|s| format!("nothing gives {}", d.name(s)))?;
        let work = system.work();
        let given = system.form.inputs.len() + system.form.params.len() + system.form.history.len();
        Ok(RightSide {
            system,
            work,
            given,
        })
    }

    /// x, n components.
    pub fn states(&self) -> Vec<Signal> {
        self.system.form.state.clone()
    }

    /// u, m components: inputs, parameters, lagged samples.
    pub fn inputs(&self) -> Vec<Signal> {
        let form = &self.system.form;
        let all = [&form.inputs, &form.params, &form.history];
        all.into_iter().flatten().copied().collect()
    }

    /// f at a point into `out`, length n; NaN where it has no value.
    pub fn rates(&mut self, t: f64, x: &[f64], u: &[f64], out: &mut [f64]) {
        let n = self.system.states();
        let is_solved =
            self.give(x, u, out.len() == n) && self.system.rates(&mut self.work, t, x, out).is_ok();
        if !is_solved {
            out.fill(f64::NAN);
        }
    }

    /// ∂f/∂x at a point into `out`, n × n by rows; NaN where it has no value.
    pub fn jacobian(&mut self, t: f64, x: &[f64], u: &[f64], out: &mut [f64]) {
        let n = self.system.states();
        let is_solved = self.give(x, u, out.len() == n * n)
            && self.system.jacobian(&mut self.work, t, x, out).is_ok();
        if !is_solved {
            out.fill(f64::NAN);
        }
    }

    /// Sets the inputs; false if a length is wrong.
    fn give(&mut self, x: &[f64], u: &[f64], has_room: bool) -> bool {
        let fits = has_room && x.len() == self.system.states() && u.len() == self.given;
        if fits && self.given > 0 {
            self.system.give(&mut self.work, u);
        }
        fits
    }
}
