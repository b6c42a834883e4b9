//! The instant at which a margin becomes zero: Chandrupatla's method, bisection and inverse quadratic interpolation.
//!
//! In: an interval, a function at or above zero at its start and below it at its end. Out: where it is zero.
//! Chandrupatla, "A new hybrid quadratic/bisection algorithm for finding the zero of a nonlinear function without using derivatives",
//! Advances in Engineering Software 28 (1997).

use super::thresholds::SWITCHING;

/// Where an event is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Located {
    /// At this part of the interval.
    At(f64),
    /// At its very start.
    Start,
}

/// Finds the zero of `margin` between 0 and 1, to the last digits. `end`: its value at 1, below zero.
///
/// # Errors
/// Those of `margin`.
pub fn locate<E>(end: f64, margin: &mut dyn FnMut(f64) -> Result<f64, E>) -> Result<Located, E> {
    // A guard that starts at zero has another zero there: the bracket begins where it has left it.
    let (mut hi, mut below) = (1.0, end);
    let mut lo = 0.5;
    let mut above = margin(lo)?;
    while above < 0.0 {
        (hi, below) = (lo, above);
        lo *= 0.5;
        if lo < SWITCHING.located {
            return Ok(Located::Start);
        }
        above = margin(lo)?;
    }
    if above == 0.0 {
        return Ok(Located::At(lo));
    }
    let (mut a, mut fa, mut b, mut fb) = (hi, below, lo, above);
    let mut t = 0.5;
    for _ in 0..SWITCHING.root_steps {
        let x = a + t * (b - a);
        let fx = margin(x)?;
        let (c, fc) = match (fx < 0.0) == (fa < 0.0) {
            true => (a, fa),
            false => {
                let old = (b, fb);
                (b, fb) = (a, fa);
                old
            }
        };
        (a, fa) = (x, fx);
        let (best, least) = if fa.abs() < fb.abs() {
            (a, fa)
        } else {
            (b, fb)
        };
        let width = (b - a).abs();
        let near = SWITCHING.located / width;
        if near > 0.5 || least == 0.0 {
            return Ok(Located::At(best));
        }
        let (xi, phi) = ((a - b) / (c - b), (fa - fb) / (fc - fb));
        t = match phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi {
            true => {
                fa / (fb - fa) * fc / (fb - fc)
                    + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb)
            }
            false => 0.5,
        };
        t = t.clamp(near, 1.0 - near);
    }
    Ok(Located::At(if fa.abs() < fb.abs() { a } else { b }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zeros_are_found_to_the_last_digits_in_few_steps() {
        let cases: [(&dyn Fn(f64) -> f64, f64); 5] = [
            (&|x| 0.3 - x, 0.3),
            (&|x| x * (0.7 - x), 0.7),
            (&|x| 0.25 - x, 0.25),
            (&|x| (-20.0 * x).exp() - 0.5, 0.5f64.ln() / -20.0),
            (&|x| 1e-9 - x, 1e-9),
        ];
        for (f, zero) in cases {
            let mut calls = 0;
            let mut margin = |x: f64| {
                calls += 1;
                Ok::<f64, ()>(f(x))
            };
            let Ok(Located::At(x)) = locate(f(1.0), &mut margin) else {
                panic!("not found");
            };
            assert!((x - zero).abs() < 1e-13, "{x} {zero}");
            assert!(calls < 50, "{calls}");
        }
        let never = locate(-1.0, &mut |x: f64| Ok::<f64, ()>(-x));
        assert_eq!(never, Ok(Located::Start));
    }
}
