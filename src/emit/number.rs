//! Numbers for people: few digits, none lost to rounding.

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

/// Significant digits that tell the ends of an interval apart, and two more.
pub fn apart(low: f64, high: f64) -> usize {
    let size = low.abs().max(high.abs());
    let digits = (size / (high - low).abs()).log10().ceil();
    let digits = if digits.is_finite() { digits } else { 15.0 };
    digits.clamp(0.0, 13.0) as usize + 2
}

#[cfg(test)]
mod tests {
    use super::significant;

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
}
