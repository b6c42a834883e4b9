//! Elementary functions to some 28 digits.
//!
//! In: a [`Double`]. Out: a [`Double`] that is off by at most [`ACCURACY`] times what the function's note says. By reduction and Taylor
//! series, inverses by a step of Newton's method from the machine's own value (after Hida, Li & Bailey 2001). Nothing here is fast.

use super::double::{Double, two_prod};

/// 2⁻⁹⁰: rounding of some twenty operations after each other, generously.
pub const ACCURACY: f64 = 1.0 / (1_u128 << 90) as f64;
/// Angles beyond which quarter turns can no longer be taken off.
pub const LARGEST_ANGLE: f64 = 1e15;

/// π/2 and ln 2 in three parts.
const QUARTER: [f64; 3] = [
    std::f64::consts::FRAC_PI_2,
    6.123233995736766e-17,
    -1.4973849048591698e-33,
];
const LN_2: [f64; 3] = [
    std::f64::consts::LN_2,
    2.3190468138462996e-17,
    5.707_708_438_416_212e-34,
];

/// Terms of a series are added until they are smaller than this part of the first.
const NOTHING: f64 = 1e-36;

/// x − k · (a + b + c)
fn less(x: Double, k: f64, parts: [f64; 3]) -> Double {
    parts.iter().fold(x, |left, part| {
        let (hi, lo) = two_prod(k, *part);
        left - Double { hi, lo }
    })
}

/// eˣ, relative to itself.
pub fn exp(x: Double) -> Double {
    if x.hi < -760.0 {
        return Double::ZERO;
    }
    if x.hi >= 710.0 || x.hi.is_nan() {
        return Double::from(x.hi.exp());
    }
    let k = (x.hi / LN_2[0]).round();
    // 256ths, so that few terms do; then eʸ − 1 is doubled in its argument eight times.
    let y = less(x, k, LN_2).scaled(-8);
    let (mut sum, mut term, mut n) = (y, y, 1.0);
    while term.hi.abs() > NOTHING * y.hi.abs() {
        n += 1.0;
        term = term * y / Double::from(n);
        sum = sum + term;
    }
    for _ in 0..8 {
        sum = sum.scaled(1) + sum * sum;
    }
    (sum + Double::ONE).scaled(k as i32)
}

/// ln x for x > 0, absolute where it is below one, else relative.
pub fn log(x: Double) -> Double {
    let near = x.hi.ln();
    if !near.is_finite() {
        return Double::from(near);
    }
    let near = Double::from(near);
    // One step of Halley's method.
    let e = exp(near);
    near + ((x - e) / (x + e)).scaled(1)
}

/// (sin x, cos x), absolute; |x| up to [`LARGEST_ANGLE`].
pub fn sin_cos(x: Double) -> (Double, Double) {
    let turns = (x.hi / QUARTER[0]).round();
    let r = less(x, turns, QUARTER);
    let square = r * r;
    let (mut sin, mut cos) = (r, Double::ONE);
    let (mut odd, mut even, mut n) = (r, Double::ONE, 0.0);
    while even.hi.abs() > NOTHING {
        n += 2.0;
        even = -(even * square) / Double::from(n * (n - 1.0));
        odd = -(odd * square) / Double::from(n * (n + 1.0));
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
fn angle(s: Double, c: Double) -> Double {
    let near = Double::from(s.hi.atan2(c.hi));
    let (sin, cos) = sin_cos(near);
    // The sine of what is missing, which is that itself.
    near + (s * cos - c * sin)
}

/// arcsin x, absolute; NaN outside [−1, 1].
pub fn asin(x: Double) -> Double {
    angle(x, beside(x))
}

/// arccos x, absolute; NaN outside [−1, 1].
pub fn acos(x: Double) -> Double {
    angle(beside(x), x)
}

/// √(1 − x²)
fn beside(x: Double) -> Double {
    ((Double::ONE - x) * (Double::ONE + x)).sqrt()
}

/// arctan x, absolute.
pub fn atan(x: Double) -> Double {
    if x.hi.abs() > 1.0 {
        let turned = angle_of_slope(Double::ONE / x);
        let quarter = Double {
            hi: QUARTER[0],
            lo: QUARTER[1],
        };
        return if x.hi > 0.0 {
            quarter - turned
        } else {
            -quarter - turned
        };
    }
    angle_of_slope(x)
}

fn angle_of_slope(x: Double) -> Double {
    let length = (Double::ONE + x * x).sqrt();
    angle(x / length, Double::ONE / length)
}

/// (sinh x, cosh x), relative to cosh x.
pub fn sinh_cosh(x: Double) -> (Double, Double) {
    let (up, down) = (exp(x.scaled(-1)), exp(-x.scaled(-1)));
    // Halves of squares: eˣ alone overflows a little earlier.
    let (up, down) = (up.scaled(-1) * up, down.scaled(-1) * down);
    (up - down, up + down)
}

/// tanh x, absolute.
pub fn tanh(x: Double) -> Double {
    if x.hi.abs() > 40.0 {
        return Double::from(x.hi.signum());
    }
    let (sinh, cosh) = sinh_cosh(x);
    sinh / cosh
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(found: Double, wanted: (f64, f64), what: &str) {
        let off = (found
            - Double {
                hi: wanted.0,
                lo: wanted.1,
            })
        .abs()
        .value();
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
            let x = Double::from(*x);
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
            let x = Double::from(0.0371 * f64::from(i)) * Double::sum(1.0, 1e-20);
            let (s, c) = sin_cos(x);
            close(s * s + c * c, (1.0, 0.0), "sin² + cos²");
            let (sh, ch) = sinh_cosh(x);
            let rest = (ch * ch - sh * sh - Double::ONE).abs().value();
            assert!(rest <= ACCURACY * ch.hi * ch.hi, "cosh² − sinh²: {rest:e}");
            let e = exp(x);
            let back = (log(e) - x).abs().value();
            assert!(
                back <= ACCURACY * x.hi.abs().max(1.0),
                "log exp {}: {back:e}",
                x.hi
            );
            let off = (e * exp(-x) - Double::ONE).abs().value();
            assert!(off <= 2.0 * ACCURACY, "exp: {off:e}");
            let t = atan(x);
            let (s, c) = sin_cos(t);
            let off = (s - c * x).abs().value();
            assert!(
                off <= ACCURACY * (1.0 + x.hi.abs()),
                "tan atan {}: {off:e}",
                x.hi
            );
            if s.hi.abs() < 1.0 {
                let off = (asin(s) - t).abs().value();
                assert!(off * c.hi <= 4.0 * ACCURACY, "asin sin {}: {off:e}", x.hi);
                let off = (acos(c) - t.abs()).abs().value();
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
            let (s, c) = sin_cos(Double::from(x));
            let (s1, c1) = sin_cos(Double::from(0.5 * x));
            close(s1 * c1 * 2.0, (s.hi, s.lo), "sin 2x");
            close(c1 * c1 - s1 * s1, (c.hi, c.lo), "cos 2x");
            assert!((s.hi - x.sin()).abs() < 1e-15 && (c.hi - x.cos()).abs() < 1e-15);
        }
    }

    #[test]
    fn borders_are_what_the_machine_says() {
        assert_eq!(exp(Double::from(-1000.0)), Double::ZERO);
        assert!(!exp(Double::from(1000.0)).is_finite());
        assert!(!exp(Double::from(f64::NAN)).is_finite());
        assert!(!log(Double::ZERO).is_finite() && !log(Double::from(-1.0)).is_finite());
        assert!(!asin(Double::from(1.5)).is_finite());
        assert_eq!(exp(Double::ZERO), Double::ONE);
        assert_eq!(sin_cos(Double::ZERO), (Double::ZERO, Double::ONE));
        assert_eq!(tanh(Double::from(-100.0)).value(), -1.0);
        assert!((asin(Double::ONE).value() - std::f64::consts::FRAC_PI_2).abs() < 1e-30);
    }
}
