//! Sensor noise given outside the model.
//!
//! In: a program, noise by name. Out: the program with this noise in place of what its model declares, or the first fault.

use sidc_lang::model::{Model, VarKind};
use sidc_lang::sensor_noise::SensorNoise;
use sidc_lang::term::{Signal, SignalNames, VarId};

use super::program::Program;

/// Why noise cannot be set.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NoiseFault {
    /// This name is given twice.
    Twice(String),
    /// The model measures no signal of this name; `measured` lists those that it does measure.
    Unknown { name: String, measured: Vec<String> },
}

/// Sets noise by signal name, overriding what the model declares.
///
/// # Errors
/// The first fault.
pub fn set_noise(program: &mut Program, given: &[(String, SensorNoise)]) -> Result<(), NoiseFault> {
    let signals = sensors(&program.model);
    for (place, (name, noise)) in given.iter().enumerate() {
        if given.iter().take(place).any(|(n, _)| n == name) {
            return Err(NoiseFault::Twice(name.clone()));
        }
        let Some((_, signal)) = signals.iter().find(|(n, _)| n == name) else {
            let measured = signals.into_iter().map(|(n, _)| n).collect();
            let name = name.clone();
            return Err(NoiseFault::Unknown { name, measured });
        };
        if let Some(var) = program.model.vars.get_mut(signal.var.0 as usize) {
            var.noise.insert(signal.der, *noise);
        }
    }
    Ok(())
}

/// Every signal that a table may hold, by name: first variables, then their derivatives.
fn sensors(model: &Model) -> Vec<(String, Signal)> {
    let highest = model.vars.iter().map(|v| v.order).max().unwrap_or(0);
    let orders = (0..=highest).flat_map(|der| {
        let vars = (0..).zip(&model.vars);
        let measured = vars.filter(move |(_, v)| {
            der <= v.order && !matches!(v.kind, VarKind::Time | VarKind::Param | VarKind::Unknown)
        });
        measured.map(move |(id, _)| Signal::derivative(VarId(id), der))
    });
    orders.map(|s| (model.name(s), s)).collect()
}
