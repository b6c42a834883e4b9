//! Numbers as people read them: so many significant digits.
//!
//! Used wherever a figure is printed, so that all print alike. Typography (true minus signs, raised exponents) is left to those
//! who typeset.

/// A number with so many significant digits, plain or in powers of ten, without trailing zeros.
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

/// The number nearest to `x` that has so many significant digits.
pub fn rounded(x: f64, digits: usize) -> f64 {
    let text = format!("{x:.*e}", digits.saturating_sub(1));
    text.parse().unwrap_or(x)
}

/// A share as per cent with two significant digits: `0.33 %`.
pub fn percent(share: f64) -> String {
    format!("{} %", significant(100.0 * share, 2))
}

/// Significant digits with which the ends of an interval differ, and two more.
pub fn digits_apart(low: f64, high: f64) -> usize {
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
    fn rounded_numbers_have_few_digits() {
        assert_eq!(rounded(1.290_322_58, 3), 1.29);
        assert_eq!(rounded(-9.996e-9, 3), -1e-8);
        assert!(rounded(f64::NAN, 3).is_nan());
        assert_eq!(percent(0.003_32), "0.33 %");
    }

    #[test]
    fn digits_grow_as_intervals_shrink() {
        assert_eq!(digits_apart(1.0, 1.1), 4);
        assert_eq!(digits_apart(1.0, 1.0), 15);
    }
}
