//! Counts and sizes as people read them: `6,561`, `1.5 GB`.

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
    fn long_numbers_are_grouped_or_shortened() {
        assert_eq!(readable(1_594_323), "1,594,323");
        assert_eq!(readable(10u128.pow(20)), "about 10^20");
        assert_eq!(readable_bytes(8), "8 bytes");
        assert_eq!(readable_bytes(114_791_256), "115 MB");
        assert_eq!(readable_bytes(1_523_000_000), "1.5 GB");
        assert_eq!(readable_bytes(4_000_000_000), "4 GB");
        assert_eq!(readable_bytes(8 * 10u128.pow(20)), "800,000,000,000 GB");
    }
}
