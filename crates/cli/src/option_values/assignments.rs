//! Options of the form name=value: parameters, noise, start values. Also sets noise in a compiled model.

use super::names::hint;
use crate::failure::Failure;
use sidc::pipeline::{self, NoiseFault, Program};
use sidc_lang::sensor_noise::SensorNoise;

const NOISE: &str =
    "a noise is a standard deviation above 0 (0.01), a share of the value (2%), or both (0.01+2%)";

/// `m=0.3,0.5`
pub fn parameter(text: &str) -> Result<(String, Vec<f64>), String> {
    let (name, values) = text
        .split_once('=')
        .ok_or("write a parameter as name=value")?;
    let values: Result<Vec<f64>, String> = values
        .split(',')
        .map(|v| match v.trim().parse::<f64>() {
            Ok(x) if x.is_finite() => Ok(x),
            _ => Err(format!("`{v}` is not a number")),
        })
        .collect();
    Ok((name.trim().to_string(), values?))
}

/// `theta=0.01`, `x=2%`, `x=0.01+2%`
pub fn noise(text: &str) -> Result<(String, SensorNoise), String> {
    let (name, parts) = text.split_once('=').ok_or("write a noise as name=value")?;
    let mut noise = SensorNoise::default();
    for part in parts.split('+').map(str::trim) {
        let (to, number, unit) = match part.strip_suffix('%') {
            Some(number) => (&mut noise.share, number, 0.01),
            None => (&mut noise.floor, part, 1.0),
        };
        match number.trim().parse::<f64>() {
            Ok(x) if x > 0.0 && x.is_finite() && *to == 0.0 => *to = unit * x,
            _ => return Err(NOISE.into()),
        }
    }
    Ok((name.trim().to_string(), noise))
}

/// `theta=0.1,dtheta=0`
pub fn start(text: &str) -> Result<Vec<(String, f64)>, String> {
    let one = |part: &str| {
        let (name, value) = part
            .split_once('=')
            .ok_or("write a start as name=value,name=value")?;
        match value.trim().parse::<f64>() {
            Ok(x) if x.is_finite() => Ok((name.trim().to_string(), x)),
            _ => Err(format!("`{value}` is not a number")),
        }
    };
    text.split(',').map(one).collect()
}

/// Sets the noise of sensors, overriding what the model declares.
///
/// # Errors
/// A name that the model does not measure, or one given twice.
pub fn set_noise(program: &mut Program, noise: &[(String, SensorNoise)]) -> Result<(), Failure> {
    pipeline::set_noise(program, noise).map_err(|fault| match fault {
        NoiseFault::Twice(name) => given_twice("--noise", &name),
        NoiseFault::Unknown { name, measured } => {
            let hint = hint(&name, measured.iter().map(String::as_str));
            Failure::new(format!(
                "error[unknown-noise]: --noise {name}: the model measures no signal of this name{hint}\n  = measured: {}",
                measured.join(", ")
            ))
        }
    })
}

/// The failure for a name that already has a value.
pub fn given_twice(option: &str, name: &str) -> Failure {
    Failure::new(format!(
        "error[given-twice]: {option} {name}: this has a value already\n  = help: one value a name"
    ))
}
