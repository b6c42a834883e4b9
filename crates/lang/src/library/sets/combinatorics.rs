//! Numbers of terms by arithmetic, so that `poly(x; 1000)` is refused before it takes memory.

/// C(n, k), or `u128::MAX` if it does not fit.
pub(crate) fn binomial(n: u128, k: u128) -> u128 {
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

/// base^exponent, or `u128::MAX` if it does not fit.
pub(crate) fn power(base: u128, exponent: usize) -> u128 {
    u32::try_from(exponent)
        .ok()
        .and_then(|e| base.checked_pow(e))
        .unwrap_or(u128::MAX)
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
    }
}
