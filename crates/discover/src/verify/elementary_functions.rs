//! Elementary functions to some 28 digits.
//!
//! In: a [`DoubleDouble`]. Out: a [`DoubleDouble`] with an error of at most [`ACCURACY`], times the size that the function's comment names.
//! Functions are computed by range reduction and Taylor series, inverse functions by one step of Newton's method from the value in f64
//! (after Hida, Li & Bailey 2001). Made for accuracy, not for speed.

use super::double_double::{DoubleDouble, two_prod};
use super::thresholds::ARITHMETIC;

/// 2⁻⁹⁰: some twenty operations after each other, each with a rounding of 2⁻¹⁰², lose less than 5 bits; 12 are allowed.
pub const ACCURACY: f64 = 1.0 / (1_u128 << 90) as f64;

/// π/2 as a sum of three f64.
const QUARTER_TURN: [f64; 3] = [
    std::f64::consts::FRAC_PI_2,
    6.123233995736766e-17,
    -1.4973849048591698e-33,
];
/// ln 2 as a sum of three f64.
const LN_2: [f64; 3] = [
    std::f64::consts::LN_2,
    2.3190468138462996e-17,
    5.707_708_438_416_212e-34,
];

/// x − k (a + b + c)
fn subtract_multiple(x: DoubleDouble, k: f64, parts: [f64; 3]) -> DoubleDouble {
    parts.iter().fold(x, |left, part| {
        let (hi, lo) = two_prod(k, *part);
        left - DoubleDouble { hi, lo }
    })
}

/// eˣ, relative to itself.
pub fn exp(x: DoubleDouble) -> DoubleDouble {
    if x.hi < -760.0 {
        return DoubleDouble::ZERO;
    }
    if x.hi >= 710.0 || x.hi.is_nan() {
        return DoubleDouble::from(x.hi.exp());
    }
    let k = (x.hi / LN_2[0]).round();
    // A 256th of the rest needs few terms; eʸ − 1 then gets twice the argument, eight times over.
    let y = subtract_multiple(x, k, LN_2).scaled(-8);
    let (mut sum, mut term, mut n) = (y, y, 1.0);
    while term.hi.abs() > ARITHMETIC.series_end * y.hi.abs() {
        n += 1.0;
        term = term * y / DoubleDouble::from(n);
        sum = sum + term;
    }
    for _ in 0..8 {
        sum = sum.scaled(1) + sum * sum;
    }
    (sum + DoubleDouble::ONE).scaled(k as i32)
}

/// ln x for x > 0, absolute where it is below one, else relative.
pub fn log(x: DoubleDouble) -> DoubleDouble {
    let start = x.hi.ln();
    if !start.is_finite() {
        return DoubleDouble::from(start);
    }
    let start = DoubleDouble::from(start);
    // One step of Halley's method.
    let e = exp(start);
    start + ((x - e) / (x + e)).scaled(1)
}

/// (sin x, cos x), absolute; |x| up to `ARITHMETIC.angle`.
pub fn sin_cos(x: DoubleDouble) -> (DoubleDouble, DoubleDouble) {
    let turns = (x.hi / QUARTER_TURN[0]).round();
    let r = subtract_multiple(x, turns, QUARTER_TURN);
    let square = r * r;
    let (mut sin, mut cos) = (r, DoubleDouble::ONE);
    let (mut odd, mut even, mut n) = (r, DoubleDouble::ONE, 0.0);
    while even.hi.abs() > ARITHMETIC.series_end {
        n += 2.0;
        even = -(even * square) / DoubleDouble::from(n * (n - 1.0));
        odd = -(odd * square) / DoubleDouble::from(n * (n + 1.0));
        cos = cos + even;
        sin = sin + odd;
    }
    match turns.rem_euclid(4.0) as u8 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// The angle of the direction (c, s) of length one, absolute.
fn angle(s: DoubleDouble, c: DoubleDouble) -> DoubleDouble {
    let start = DoubleDouble::from(s.hi.atan2(c.hi));
    let (sin, cos) = sin_cos(start);
    // The sine of the missing angle, which is so small that it equals the angle.
    start + (s * cos - c * sin)
}

/// arcsin x, absolute; NaN outside [−1, 1].
pub fn asin(x: DoubleDouble) -> DoubleDouble {
    angle(x, cosine_of_arcsine(x))
}

/// arccos x, absolute; NaN outside [−1, 1].
pub fn acos(x: DoubleDouble) -> DoubleDouble {
    angle(cosine_of_arcsine(x), x)
}

/// √(1 − x²)
fn cosine_of_arcsine(x: DoubleDouble) -> DoubleDouble {
    ((DoubleDouble::ONE - x) * (DoubleDouble::ONE + x)).sqrt()
}

/// arctan x, absolute.
pub fn atan(x: DoubleDouble) -> DoubleDouble {
    if x.hi.abs() > 1.0 {
        let complement = angle_of_slope(DoubleDouble::ONE / x);
        let quarter = DoubleDouble {
            hi: QUARTER_TURN[0],
            lo: QUARTER_TURN[1],
        };
        return if x.hi > 0.0 {
            quarter - complement
        } else {
            -quarter - complement
        };
    }
    angle_of_slope(x)
}

fn angle_of_slope(x: DoubleDouble) -> DoubleDouble {
    let length = (DoubleDouble::ONE + x * x).sqrt();
    angle(x / length, DoubleDouble::ONE / length)
}

/// (sinh x, cosh x), relative to cosh x.
pub fn sinh_cosh(x: DoubleDouble) -> (DoubleDouble, DoubleDouble) {
    let (up, down) = (exp(x.scaled(-1)), exp(-x.scaled(-1)));
    // Half the square of e^(x/2), since eˣ alone overflows a little earlier.
    let (up, down) = (up.scaled(-1) * up, down.scaled(-1) * down);
    (up - down, up + down)
}

/// tanh x, absolute.
pub fn tanh(x: DoubleDouble) -> DoubleDouble {
    if x.hi.abs() > 40.0 {
        return DoubleDouble::from(x.hi.signum());
    }
    let (sinh, cosh) = sinh_cosh(x);
    sinh / cosh
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(found: DoubleDouble, wanted: (f64, f64), what: &str) {
        let off = (found
            - DoubleDouble {
                hi: wanted.0,
                lo: wanted.1,
            })
        .abs()
        .to_f64();
        let size = wanted.0.abs().max(1.0);
        assert!(off <= 1e-29 * size, "{what}: off by {off:e}");
    }

    /// Values to 31 digits, from series summed to 80 digits in decimal arithmetic.
    #[rustfmt::skip]
    const KNOWN: &[(&str, f64, (f64, f64))] = &[
        ("sin", 0.7, (0.644217687237691, 2.8740567927338755e-18)),
        ("cos", 0.7, (0.7648421872844885, -4.013780434022238e-17)),
        ("exp", 0.7, (2.0137527074704766, -2.0058243549764793e-16)),
        ("log", 0.7, (-0.35667494393873245, 4.82556379937662e-18)),
        ("atan", 0.7, (0.6107259643892086, 2.2418914462967458e-17)),
        ("sinh", 0.7, (0.7585837018395335, -4.9693841630321686e-17)),
        ("cosh", 0.7, (1.255169005630943, -3.986629140481058e-17)),
        ("tanh", 0.7, (0.6043677771171635, -2.7916180015425346e-17)),
        ("sin", -1.3, (-0.963558185417193, -1.8247650480909386e-17)),
        ("cos", -1.3, (0.26749882862458735, 1.6094564897898917e-17)),
        ("exp", -1.3, (0.2725317930340126, -1.6829627435184408e-18)),
        ("log", -1.3, (0.26236426446749106, 2.6633628353477566e-17)),
        ("atan", -1.3, (-0.9151007005533605, 2.4613983255192613e-17)),
        ("sinh", -1.3, (-1.698382437292616, 5.785602655070164e-17)),
        ("cosh", -1.3, (1.9709142303266285, -4.027838062962253e-18)),
        ("tanh", -1.3, (-0.8617231593133063, -3.4082750348316456e-17)),
        ("sin", 2.9, (0.23924932921398243, -1.1267666643498124e-17)),
        ("cos", 2.9, (-0.9709581651495905, 4.579633153232696e-17)),
        ("exp", 2.9, (18.17414536944306, -1.0319935825855902e-15)),
        ("log", 2.9, (1.0647107369924282, 7.091773787274429e-17)),
        ("atan", 2.9, (1.2387368592520112, -2.571119118874906e-17)),
        ("sinh", 2.9, (9.059561074693326, 3.254893475385555e-16)),
        ("cosh", 2.9, (9.114584294749733, 4.1887390927610487e-16)),
        ("tanh", 2.9, (0.9939631673505831, 5.218429969538943e-17)),
        ("sin", 11.5, (-0.8754521746884285, -1.8679979518471452e-17)),
        ("cos", 11.5, (0.4833047587530059, 8.0659703069212e-18)),
        ("exp", 11.5, (98715.7710107605, 3.036676373480473e-12)),
        ("log", 11.5, (2.4423470353692043, 1.0359019419133584e-16)),
        ("atan", 11.5, (1.4840579881189115, -3.445451067863594e-17)),
        ("sinh", 11.5, (49357.8855003152, 3.472772410566974e-12)),
        ("cosh", 11.5, (49357.885510445296, -4.360960370865006e-13)),
        ("tanh", 11.5, (0.9999999997947624, 1.2076069266947573e-17)),
        ("asin", 0.7, (0.775397496610753, 3.395027444633425e-17)),
        ("acos", 0.7, (0.7953988301841436, 2.7282065511033407e-17)),
        ("asin", -0.3, (-0.3046926540153975, 2.7469740051157017e-17)),
        ("acos", -0.3, (1.8754889808102941, -2.1748551325047183e-17)),
        ("asin", 0.999, (1.526071239626163, 7.84631528833658e-17)),
        ("acos", 0.999, (0.044725087168733454, -3.3530251181836818e-18)),
        ("asin", 1e-05, (1.0000000000166668e-05, -6.182252729529485e-22)),
        ("acos", 1e-05, (1.5707863267948965, -3.992310451025695e-17)),
    ];

    #[test]
    fn values_are_right_to_29_digits() {
        for (name, x, wanted) in KNOWN {
            let x = DoubleDouble::from(*x);
            let found = match *name {
                "sin" => sin_cos(x).0,
                "cos" => sin_cos(x).1,
                "exp" => exp(x),
                "log" => log(x.abs()),
                "atan" => atan(x),
                "sinh" => sinh_cosh(x).0,
                "cosh" => sinh_cosh(x).1,
                "tanh" => tanh(x),
                "asin" => asin(x),
                _ => acos(x),
            };
            close(found, *wanted, &format!("{name} {}", x.hi));
        }
    }

    #[test]
    fn identities_hold_everywhere() {
        for i in -400..400 {
            let x = DoubleDouble::from(0.0371 * f64::from(i)) * DoubleDouble::sum(1.0, 1e-20);
            let (s, c) = sin_cos(x);
            close(s * s + c * c, (1.0, 0.0), "sin² + cos²");
            let (sh, ch) = sinh_cosh(x);
            let rest = (ch * ch - sh * sh - DoubleDouble::ONE).abs().to_f64();
            assert!(rest <= ACCURACY * ch.hi * ch.hi, "cosh² − sinh²: {rest:e}");
            let e = exp(x);
            let back = (log(e) - x).abs().to_f64();
            assert!(
                back <= ACCURACY * x.hi.abs().max(1.0),
                "log exp {}: {back:e}",
                x.hi
            );
            let off = (e * exp(-x) - DoubleDouble::ONE).abs().to_f64();
            assert!(off <= 2.0 * ACCURACY, "exp: {off:e}");
            let t = atan(x);
            let (s, c) = sin_cos(t);
            let off = (s - c * x).abs().to_f64();
            assert!(
                off <= ACCURACY * (1.0 + x.hi.abs()),
                "tan atan {}: {off:e}",
                x.hi
            );
            if s.hi.abs() < 1.0 {
                let off = (asin(s) - t).abs().to_f64();
                assert!(off * c.hi <= 4.0 * ACCURACY, "asin sin {}: {off:e}", x.hi);
                let off = (acos(c) - t.abs()).abs().to_f64();
                assert!(
                    off * s.hi.abs() <= 4.0 * ACCURACY,
                    "acos cos {}: {off:e}",
                    x.hi
                );
            }
        }
    }

    #[test]
    fn large_angles_keep_their_digits() {
        // sin² + cos² does not see a wrong angle; the sum of two angles does.
        for x in [1e3, 1e6, 1e10, 7.3e14] {
            let (s, c) = sin_cos(DoubleDouble::from(x));
            let (s1, c1) = sin_cos(DoubleDouble::from(0.5 * x));
            close(s1 * c1 * 2.0, (s.hi, s.lo), "sin 2x");
            close(c1 * c1 - s1 * s1, (c.hi, c.lo), "cos 2x");
            assert!((s.hi - x.sin()).abs() < 1e-15 && (c.hi - x.cos()).abs() < 1e-15);
        }
    }

    #[test]
    fn limits_are_those_of_f64() {
        assert_eq!(exp(DoubleDouble::from(-1000.0)), DoubleDouble::ZERO);
        assert!(!exp(DoubleDouble::from(1000.0)).is_finite());
        assert!(!exp(DoubleDouble::from(f64::NAN)).is_finite());
        assert!(!log(DoubleDouble::ZERO).is_finite() && !log(DoubleDouble::from(-1.0)).is_finite());
        assert!(!asin(DoubleDouble::from(1.5)).is_finite());
        assert_eq!(exp(DoubleDouble::ZERO), DoubleDouble::ONE);
        assert_eq!(
            sin_cos(DoubleDouble::ZERO),
            (DoubleDouble::ZERO, DoubleDouble::ONE)
        );
        assert_eq!(tanh(DoubleDouble::from(-100.0)).to_f64(), -1.0);
        assert!((asin(DoubleDouble::ONE).to_f64() - std::f64::consts::FRAC_PI_2).abs() < 1e-30);
    }
}
