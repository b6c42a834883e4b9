//! Options that limit errors: fractions of the spread, or values of signals.

use sidc_system::predict::ErrorLimit;

/// `10%`, `theta=0.02`, or several separated by commas.
pub fn good(text: &str) -> Result<Vec<ErrorLimit>, String> {
    text.split(',').map(|part| one(part.trim())).collect()
}

fn one(text: &str) -> Result<ErrorLimit, String> {
    let above_zero = |number: &str| {
        let value = number.trim().parse::<f64>().ok();
        value.filter(|x| *x > 0.0 && x.is_finite())
    };
    if let Some((name, value)) = text.split_once('=') {
        let value =
            above_zero(value).ok_or_else(|| format!("`{value}` is not a number above 0"))?;
        return Ok(ErrorLimit::Signal(name.trim().into(), value));
    }
    let part = text.strip_suffix('%').and_then(above_zero);
    let help =
        "write an error as a part of each signal's spread, 10%, or in a signal's unit, theta=0.02";
    part.map(|p| ErrorLimit::Share(p / 100.0))
        .ok_or_else(|| help.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_parts_or_values() {
        assert_eq!(good("10%"), Ok(vec![ErrorLimit::Share(0.1)]));
        let both = vec![
            ErrorLimit::Signal("theta".into(), 0.02),
            ErrorLimit::Signal("x".into(), 0.1),
        ];
        assert_eq!(good("theta=0.02, x=0.1"), Ok(both));
        for text in [
            "",
            "10",
            "%",
            "0%",
            "-5%",
            "nan%",
            "theta=",
            "theta=0",
            "theta=inf",
            "x=1,",
        ] {
            assert!(good(text).is_err(), "{text}");
        }
    }
}
