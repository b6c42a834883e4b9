//! Values of unknown constants that are tried first.
//!
//! In: ranges. Out: values all over them. Judges none.

use sidc_lang::term::Signal;

/// The signals of the constants, and the ranges of each.
pub(crate) type SoughtRanges = Vec<(Signal, Vec<(f64, f64)>)>;

/// Values over the ranges: evenly spaced for one constant, a Halton sequence for several.
pub(super) fn first_values(
    sought: &SoughtRanges,
    count: usize,
    combinations: usize,
) -> Vec<Vec<f64>> {
    if let [(_, ranges)] = &sought[..] {
        let of = |range: &(f64, f64)| {
            let range = *range;
            (0..count).map(move |i| vec![between(range, (i as f64 + 0.5) / count as f64)])
        };
        return ranges.iter().flat_map(of).collect();
    }
    let bases = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29];
    let point = |k: usize| -> Vec<f64> {
        let constants = sought.iter().enumerate();
        constants
            .map(|(i, (_, ranges))| {
                let part = radical_inverse(k + 1, bases[i % bases.len()]);
                let place = part * ranges.len() as f64;
                let which = (place as usize).min(ranges.len() - 1);
                between(ranges[which], place - which as f64)
            })
            .collect()
    };
    (0..combinations).map(point).collect()
}

/// Part of the way through a range: by the logarithm where its ends have one sign.
pub(crate) fn between((from, to): (f64, f64), part: f64) -> f64 {
    match from * to > 0.0 {
        true => from * (to / from).powf(part),
        false => from + part * (to - from),
    }
}

/// The digits of a number mirrored behind the point (van der Corput).
fn radical_inverse(mut number: usize, base: usize) -> f64 {
    let (mut inverse, mut digit) = (0.0, 1.0 / base as f64);
    while number > 0 {
        inverse += (number % base) as f64 * digit;
        number /= base;
        digit /= base as f64;
    }
    inverse
}

/// The range that holds a value; that value alone if none does.
pub(super) fn holding(ranges: &[(f64, f64)], value: f64) -> (f64, f64) {
    let mut all = ranges.iter().copied();
    all.find(|(from, to)| (*from..=*to).contains(&value))
        .unwrap_or((value, value))
}
