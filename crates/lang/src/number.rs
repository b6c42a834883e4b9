//! Numbers as people read them, with a chosen number of significant digits.
//!
//! Used wherever a figure is printed, so that all look alike. True minus signs and raised exponents are left to code that typesets.

/// A number with `digits` significant digits, plain or in powers of ten, without trailing zeros.
pub fn significant(x: f64, digits: usize) -> String {
    if x == 0.0 || !x.is_finite() {
        return format!("{x}");
    }
    let rounded = format!("{x:.*e}", digits - 1);
    let exponent: i32 = rounded
        .split_once('e')
        .and_then(|(_, e)| e.parse().ok())
        .unwrap_or(0);
    if (-4..digits as i32 + 2).contains(&exponent) {
        let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
        let plain = format!("{x:.decimals$}");
        if !plain.contains('.') {
            return plain;
        }
        return plain
            .trim_end_matches('0')
            .trim_end_matches('.')
            .to_string();
    }
    match rounded.split_once('e') {
        Some((m, e)) if m.contains('.') => {
            format!("{}e{e}", m.trim_end_matches('0').trim_end_matches('.'))
        }
        _ => rounded,
    }
}

/// A number with its standard error in the last two digits: `0.91(20)`, `12.3(1.4)`. An error too small to show in `digits` significant
/// digits is left out.
pub fn with_error(x: f64, error: f64, digits: usize) -> String {
    let size = decade(x).max(decade(error));
    let hidden = error < 0.5 * 10_f64.powi(decade(x) + 1 - digits as i32);
    if !x.is_finite() || !error.is_finite() || error <= 0.0 || hidden {
        return significant(x, digits);
    }
    if !(-4..digits as i32 + 2).contains(&size) || decade(error) > 1 {
        let unit = 10_f64.powi(size);
        return format!("{}e{size}", with_error(x / unit, error / unit, digits));
    }
    // Decimals for two digits of the error, and none if the error is large.
    let decimals = (1 - decade(rounded(error, 2))).max(0) as usize;
    let shown = match error < 1.0 && decimals > 0 {
        true => format!("{:.0}", error * 10_f64.powi(decimals as i32)),
        false => format!("{:.decimals$}", rounded(error, 2)),
    };
    format!("{x:.decimals$}({shown})")
}

/// The power of ten of the first digit.
fn decade(x: f64) -> i32 {
    match x == 0.0 || !x.is_finite() {
        true => -400,
        false => x.abs().log10().floor() as i32,
    }
}

/// The number nearest to `x` that has `digits` significant digits.
pub fn rounded(x: f64, digits: usize) -> f64 {
    let text = format!("{x:.*e}", digits.saturating_sub(1));
    text.parse().unwrap_or(x)
}

/// A share as a percentage with two significant digits: `0.33 %`.
pub fn percent(share: f64) -> String {
    format!("{} %", significant(100.0 * share, 2))
}

/// Significant digits that tell the ends of an interval apart, and two more.
pub fn distinguishing_digits(low: f64, high: f64) -> usize {
    let size = low.abs().max(high.abs());
    let digits = (size / (high - low).abs()).log10().ceil();
    let digits = if digits.is_finite() { digits } else { 15.0 };
    digits.clamp(0.0, 13.0) as usize + 2
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_never_zero_by_rounding() {
        let cases = [
            (1.290_322_58, "1.29032"),
            (-0.064_516_129, "-0.0645161"),
            (2.0, "2"),
            (19.6, "19.6"),
            (180_000.0, "180000"),
            (1.5e5, "150000"),
            (5.5e9, "5.5e9"),
            (-4e-4, "-0.0004"),
            (1.234e-9, "1.234e-9"),
            (0.999_999_9, "1"),
        ];
        for (x, text) in cases {
            assert_eq!(significant(x, 6), text);
        }
    }

    #[test]
    fn errors_stand_in_the_last_digits() {
        let cases = [
            (0.912, 0.2, "0.91(20)"),
            (-12.34, 1.37, "-12.3(1.4)"),
            (1234.4, 32.0, "1234(32)"),
            (41_223_854.0, 613_000.0, "4.122(61)e7"),
            (0.04231, 0.0012, "0.0423(12)"),
            (999.79, 0.02, "999.790(20)"),
            (19.6, 1e-12, "19.6"),
            (2.5, 0.0996, "2.50(10)"),
            (0.4, 3.2, "0.4(3.2)"),
            (1.234e-9, 2.1e-11, "1.234(21)e-9"),
            (0.0, 0.31, "0.00(31)"),
            (1.5, f64::NAN, "1.5"),
            (0.9, 0.98, "0.90(98)"),
            (522_747.0, 5_100.0, "5.227(51)e5"),
        ];
        for (x, error, text) in cases {
            assert_eq!(with_error(x, error, 6), text, "{x} {error}");
        }
    }

    #[test]
    fn rounded_numbers_have_few_digits() {
        assert_eq!(rounded(1.290_322_58, 3), 1.29);
        assert_eq!(rounded(-9.996e-9, 3), -1e-8);
        assert!(rounded(f64::NAN, 3).is_nan());
        assert_eq!(percent(0.003_32), "0.33 %");
    }

    #[test]
    fn digits_grow_as_intervals_shrink() {
        assert_eq!(distinguishing_digits(1.0, 1.1), 4);
        assert_eq!(distinguishing_digits(1.0, 1.0), 15);
    }
}
