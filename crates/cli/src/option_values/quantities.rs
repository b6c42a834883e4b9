//! Options whose value is a number, usually with a unit: times, sizes, decibels.

use std::time::Duration;

/// [`sidc::pipeline::MEMORY`] as the help shows it.
pub const MEMORY: &str = "4GB";

/// Units of time in seconds.
const TIMES: [(&str, f64); 4] = [("ms", 1e-3), ("s", 1.0), ("m", 60.0), ("h", 3600.0)];

/// Units of size in bytes, powers of ten and of two.
const SIZES: [(&str, f64); 9] = [
    ("B", 1.0),
    ("KB", 1e3),
    ("MB", 1e6),
    ("GB", 1e9),
    ("TB", 1e12),
    ("KiB", 1024.0),
    ("MiB", 1048576.0),
    ("GiB", 1073741824.0),
    ("TiB", 1099511627776.0),
];

/// `30`, `30s`, `5m`, `1h`, `500ms`
pub fn time(text: &str) -> Result<Duration, String> {
    let help = "write a time as 30, 30s, 5m or 1h";
    let seconds = measure(text, &TIMES, "s").ok_or(help)?;
    Duration::try_from_secs_f64(seconds)
        .ok()
        .filter(|limit| !limit.is_zero())
        .ok_or_else(|| format!("a time limit is above 0 and below 10^19 s; {help}"))
}

/// `2GB`, `500MB`, `2GiB`, or a number of bytes.
pub fn memory(text: &str) -> Result<u64, String> {
    let help = "write a size as 500MB or 2GB (powers of ten), or 2GiB (powers of two)";
    let bytes = measure(text, &SIZES, "B").ok_or(help)?;
    if (1.0..u64::MAX as f64).contains(&bytes) {
        Ok(bytes as u64)
    } else {
        Err(format!(
            "a memory limit is at least 1 byte and below 2^64; {help}"
        ))
    }
}

/// Converts a number with a unit, in any case of letters; a number alone has the unit `plain`.
fn measure(text: &str, units: &[(&str, f64)], plain: &str) -> Option<f64> {
    let text = text.trim();
    let end = text
        .trim_end_matches(|c: char| c.is_ascii_alphabetic())
        .len();
    let (number, unit) = text.split_at_checked(end)?;
    let unit = match unit {
        "" => plain,
        named => named,
    };
    let known = units
        .iter()
        .find(|(name, _)| name.eq_ignore_ascii_case(unit))?;
    let number: f64 = number.trim_end().parse().ok()?;
    number.is_finite().then_some(number * known.1)
}

/// `-60`, `-60dB`
pub fn decibels(text: &str) -> Result<f64, String> {
    let number = text.trim_end_matches("dB").trim();
    match number.parse::<f64>() {
        Ok(x) if x.is_finite() => Ok(x),
        _ => Err("write decibels as -60; 0 dB is an error as large as the signal".into()),
    }
}

/// A finite number above 0.
pub fn positive(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(x) if x.is_finite() && x > 0.0 => Ok(x),
        _ => Err(format!("`{text}` is not a number above 0")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_units_or_are_seconds() {
        let cases = [
            ("30", 30.0),
            ("30s", 30.0),
            ("0.001s", 1e-3),
            ("5m", 300.0),
            ("1.5 h", 5400.0),
            ("250ms", 0.25),
            ("1e3", 1e3),
        ];
        for (text, seconds) in cases {
            assert_eq!(time(text), Ok(Duration::from_secs_f64(seconds)), "{text}");
        }
        for text in [
            "", "s", "soon", "0", "-5", "0s", "5d", "inf", "nan", "1e30", "1e400", "5 5", "٣s",
        ] {
            assert!(time(text).is_err(), "{text}");
        }
    }

    #[test]
    fn sizes_are_decimal_or_binary() {
        let cases = [
            ("1", 1),
            ("2GB", 2_000_000_000),
            ("2gib", 2 << 30),
            ("0.5 KiB", 512),
            ("4kb", 4000),
            ("1TiB", 1 << 40),
        ];
        for (text, bytes) in cases {
            assert_eq!(memory(text), Ok(bytes), "{text}");
        }
        assert_eq!(memory(MEMORY), Ok(sidc::pipeline::MEMORY));
        for text in [
            "", "GB", "0", "-1GB", "2G", "2 giga", "1e30GB", "NaN", "infinity",
        ] {
            assert!(memory(text).is_err(), "{text}");
        }
    }
}
