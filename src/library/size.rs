//! How many terms an expression will have, by arithmetic: what stands between `poly(x; 1000)` and the machine's memory.

/// C(n, k), or `u128::MAX` where it does not fit.
pub(super) fn binomial(n: u128, k: u128) -> u128 {
    let k = k.min(n.saturating_sub(k));
    let mut c: u128 = 1;
    for i in 0..k {
        // c·(n−i) is divisible by i+1 at every step.
        match c.checked_mul(n - i) {
            Some(p) => c = p / (i + 1),
            None => return u128::MAX,
        }
    }
    c
}

/// base^exponent, or `u128::MAX` where it does not fit.
pub(super) fn power(base: u128, exponent: usize) -> u128 {
    u32::try_from(exponent)
        .ok()
        .and_then(|e| base.checked_pow(e))
        .unwrap_or(u128::MAX)
}

/// A count with thousands separated: `6,561`; beyond 10¹⁵ in powers of ten.
pub fn readable(n: u128) -> String {
    if n == u128::MAX {
        return "more than 10^38".into();
    }
    let digits = n.to_string();
    if digits.len() > 15 {
        return format!("about 10^{}", digits.len() - 1);
    }
    let mut out = String::new();
    for (i, d) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push(',');
        }
        out.push(d);
    }
    out
}

/// Bytes in the unit that reads best: `12 kB`, `1.5 GB`.
pub fn readable_bytes(n: u128) -> String {
    let (mut size, mut unit) = (n as f64, "bytes");
    for larger in ["kB", "MB", "GB"] {
        if size >= 1000.0 {
            (size, unit) = (size / 1000.0, larger);
        }
    }
    if size < 9.95 && size.fract() != 0.0 {
        return format!("{size:.1} {unit}");
    }
    format!("{} {unit}", readable(size.round() as u128))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_exact_or_saturate() {
        assert_eq!(binomial(6, 2), 15);
        assert_eq!(binomial(1002, 2), 501_501);
        assert_eq!(binomial(2000, 1000), u128::MAX);
        assert_eq!(power(3, 8), 6561);
        assert_eq!(power(3, 400), u128::MAX);
        assert_eq!(readable(1_594_323), "1,594,323");
        assert_eq!(readable(10u128.pow(20)), "about 10^20");
        assert_eq!(readable_bytes(8), "8 bytes");
        assert_eq!(readable_bytes(114_791_256), "115 MB");
        assert_eq!(readable_bytes(1_523_000_000), "1.5 GB");
        assert_eq!(readable_bytes(4_000_000_000), "4 GB");
        assert_eq!(readable_bytes(8 * 10u128.pow(20)), "800,000,000,000 GB");
    }
}
