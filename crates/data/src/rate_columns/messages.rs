//! What is said about a rate column.

use super::consistency::{Fault, FaultKind};
use sidc_lang::number::with_error;
use sidc_lang::words::listed;

/// Most significant digits of a number.
const DIGITS: usize = 6;

/// Factors that units explain, the explanation, and the arithmetic that undoes them.
#[rustfmt::skip]
const UNIT_RATIOS: [(f64, &str, &str); 9] = [
    (1000.0, "is the derivative in mm/s, or the time in ms", "* 1e-3"),
    (1e-3, "is the signal in mm and its derivative in m/s", "* 1e3"),
    (100.0, "is the derivative in cm/s", "* 1e-2"),
    (57.29578, "is the derivative in degrees per second", "* pi/180"),
    (0.0174533, "is the signal in degrees and its derivative in rad/s", "* 180/pi"),
    (9.549297, "is the derivative in revolutions per minute", "* 2*pi/60"),
    (60.0, "is the derivative per minute", "/ 60"),
    (0.159155, "is the derivative in turns per second", "* 2*pi"),
    (-1.0, "does one of them point the other way", "* -1"),
];

/// The unit that explains a factor, and the arithmetic that undoes the factor.
pub(super) fn unit_of(factor: f64, tolerance: f64) -> Option<(&'static str, &'static str)> {
    let near = |(ratio, _, _): &&(f64, &str, &str)| (factor / ratio - 1.0).abs() < tolerance;
    UNIT_RATIOS
        .iter()
        .find(near)
        .map(|(_, why, fix)| (*why, *fix))
}

/// All faults of `rate` against the samples of `state`, as one clause. `unit` is that of time.
pub(super) fn clause(rate: &str, state: &str, faults: &[Fault], unit: &str) -> String {
    let said: Vec<String> = faults.iter().map(|f| phrase(f, state, unit)).collect();
    format!("{rate} {}", listed(&said))
}

fn phrase(fault: &Fault, state: &str, unit: &str) -> String {
    let Fault { kind, value, error } = fault;
    let shown = with_error(value.abs(), *error, DIGITS);
    match kind {
        FaultKind::Gain => format!(
            "is {} times the slope of {state}",
            with_error(*value, *error, DIGITS)
        ),
        FaultKind::Bias if *value > 0.0 => format!("reads {shown} more than the slope of {state}"),
        FaultKind::Bias => format!("reads {shown} less than the slope of {state}"),
        FaultKind::Lag if *value > 0.0 => {
            format!("comes {shown} {unit} after the slope of {state}")
        }
        FaultKind::Lag => format!("comes {shown} {unit} before the slope of {state}"),
        FaultKind::Smoothing => {
            format!(
                "is the slope of {state} smoothed by a window of standard deviation {shown} {unit}"
            )
        }
    }
}
