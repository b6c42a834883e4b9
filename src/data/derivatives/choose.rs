//! The local polynomial of least estimated error: one for the whole record, another where it is clearly better.
//!
//! In: a signal, its noise, the stretches. Out: an [`Estimate`]. The bias of a fit is judged by its difference r·reach to a
//! finer fit, averaged over neighbouring samples after the noise in it is taken off: bias² = reach² · max(0, ⟨r²⟩ − σ²).

use std::collections::BTreeMap;
use std::rc::Rc;

use super::stencil::{Choice, Stencil, Stencils, dot};
use super::{Estimate, Grid, Stopped, Stretch};

/// Samples that the choice for the whole record is made on, at most; a sixteenth of it on uneven grids, where weights cost more.
const TRIED: usize = 16_384;
/// Choices besides the common one on longer records.
const FEW: usize = 4;
/// Samples worked on at once.
const BLOCK: usize = 16_384;
/// A local choice must promise this much less mean squared error than the choice for the whole record.
const CLEARLY: f64 = 0.4;

/// A window whose mean squared error is this much above the least, in geometric mean, is not widened further.
const HOPELESS: f64 = 1e6;
/// What a fit leaves of the next degrees is surely no noise if its mean square is so many times the noise's.
const CERTAIN: f64 = 4.0;
/// Bias hides in the noise of r: this part of the noise's mean square may always be bias.
const UNSEEN: f64 = 0.5;
/// Stands for zero in logarithms.
const TINY: f64 = 1e-300;

/// Widths of least-squares windows, samples.
const WIDTHS: [usize; 12] = [7, 9, 13, 17, 23, 33, 47, 65, 91, 129, 181, 257];

/// All polynomials tried: interpolating ones of 3 to 13 points, least squares of degrees 2 to 8.
fn candidates(order: usize, longest: usize, even: bool) -> Vec<Choice> {
    // On uneven grids every stencil is made anew: every other width will do.
    let widths = || WIDTHS.into_iter().step_by(if even { 1 } else { 2 });
    let mut out = Vec::new();
    for degree in (2..=12).step_by(2) {
        out.push(Choice {
            points: degree + 1,
            degree,
        });
    }
    for degree in (2..=8).step_by(2) {
        for points in widths().filter(|n| *n >= degree + 3) {
            out.push(Choice { points, degree });
        }
    }
    out.retain(|c| c.degree >= order && c.points <= longest);
    out.sort_by_key(|c| (c.degree, c.points));
    out
}

pub(super) fn least_error(
    grid: &Grid,
    values: &[f64],
    stretches: &[Stretch],
    order: usize,
    sigma: f64,
    go_on: &mut dyn FnMut() -> bool,
) -> Result<Estimate, Stopped> {
    let longest = stretches.iter().map(Stretch::len).max().unwrap_or(0);
    let mut work = Work {
        even: grid.step.is_some(),
        stencils: Stencils::new(grid, order),
        values,
        sigma,
        cache: BTreeMap::new(),
    };
    let all = candidates(order, longest, grid.step.is_some());
    let tried = if grid.step.is_some() {
        TRIED
    } else {
        TRIED / 4
    };
    let rows: usize = stretches.iter().map(|s| s.rows_end - s.start).sum();
    let parts = sampled(stretches, tried);
    let (best, kept) = if rows <= tried {
        work.contest(&all, &parts)
    } else {
        work.contest_few(&all, &parts)
    };
    let mut out = Estimate {
        values: vec![f64::NAN; values.len()],
        error: vec![f64::NAN; values.len()],
        points: 0,
        degree: 0,
    };
    let mut used: BTreeMap<Choice, usize> = BTreeMap::new();
    for part in blocks(stretches, BLOCK) {
        if !go_on() {
            return Err(Stopped);
        }
        let mut floor = (0, Vec::new());
        let mut judged: Vec<(Choice, Vec<Judged>)> = Vec::with_capacity(kept.len() + 1);
        for c in kept.iter().filter(|c| c.points <= part.stretch.len()) {
            let mut rows = work.judge(*c, part);
            grow(*c, &mut rows, &mut floor);
            judged.push((*c, rows));
        }
        if let Some(c) = short(part.stretch, order) {
            judged.push((c, work.judge(c, part)));
        }
        for row in part.from..part.to {
            let at = |j: &Vec<Judged>| j.get(row - part.from).copied();
            let common = judged
                .iter()
                .find(|(c, _)| Some(*c) == best)
                .and_then(|(c, j)| Some((*c, at(j)?)));
            let local = judged
                .iter()
                .filter_map(|(c, j)| Some((*c, at(j)?)))
                .min_by(|(_, a), (_, b)| a.square.total_cmp(&b.square));
            let taken = match (common, local) {
                (Some(c), Some(l)) if l.1.square < CLEARLY * c.1.square => l,
                (Some(c), _) => c,
                (None, Some(l)) => l,
                (None, None) => continue,
            };
            *used.entry(taken.0).or_default() += 1;
            if let (Some(v), Some(e)) = (out.values.get_mut(row), out.error.get_mut(row)) {
                *v = taken.1.value;
                *e = taken.1.square.sqrt();
            }
        }
    }
    if let Some((choice, _)) = used.into_iter().max_by_key(|(_, n)| *n) {
        (out.points, out.degree) = (choice.points, choice.degree);
    }
    Ok(out)
}

/// Rows `from..to` of one stretch.
#[derive(Clone, Copy)]
struct Part {
    stretch: Stretch,
    from: usize,
    to: usize,
}

/// One candidate's estimate at one row, and its estimated mean squared error.
#[derive(Clone, Copy)]
struct Judged {
    value: f64,
    square: f64,
    /// The part of the squared bias that noise cannot explain.
    certain: f64,
}

/// Takes it that bias grows with the width of a window, degree by degree: a window far too wide for the motion leaves
/// nothing in the next degrees either, and would look unbiased.
fn grow(choice: Choice, judged: &mut [Judged], floor: &mut (usize, Vec<f64>)) {
    if floor.0 != choice.degree || floor.1.len() != judged.len() {
        *floor = (choice.degree, vec![0.0; judged.len()]);
    }
    for (j, f) in judged.iter_mut().zip(&mut floor.1) {
        *f = f.max(j.certain);
        j.square = j.square.max(*f);
    }
}

fn blocks(stretches: &[Stretch], size: usize) -> impl Iterator<Item = Part> {
    stretches.iter().flat_map(move |s| {
        (s.start..s.rows_end).step_by(size).map(move |from| Part {
            stretch: *s,
            from,
            to: (from + size).min(s.rows_end),
        })
    })
}

/// Blocks spread evenly over the record, `most` rows together.
fn sampled(stretches: &[Stretch], most: usize) -> Vec<Part> {
    let rows: usize = stretches.iter().map(|s| s.rows_end - s.start).sum();
    if rows <= most {
        return blocks(stretches, BLOCK).collect();
    }
    let all: Vec<Part> = blocks(stretches, 512).collect();
    let stride = rows.div_ceil(most);
    all.into_iter().step_by(stride).collect()
}

/// What a stretch of a few samples allows: the polynomial through all of them.
fn short(stretch: Stretch, order: usize) -> Option<Choice> {
    let n = stretch.len();
    (n > order && n <= 6).then_some(Choice {
        points: n,
        degree: n - 1,
    })
}

/// Mean over i − reach … i + reach for every i, as far as there are values.
///
/// From sums that run from block to block and never subtract: beside a spike, a difference of running sums would keep
/// nothing of what is small (van Herk 1992, there for maxima).
fn local_means(values: &[f64], reach: usize) -> Vec<f64> {
    let (n, block) = (values.len(), 2 * reach + 1);
    let (mut before, mut after) = (values.to_vec(), values.to_vec());
    for i in 1..n {
        if i % block != 0 {
            before[i] += before[i - 1];
        }
    }
    for i in (1..n).rev() {
        if i % block != 0 {
            after[i - 1] += after[i];
        }
    }
    (0..n)
        .map(|i| {
            let (a, b) = (i.saturating_sub(reach), (i + reach).min(n - 1));
            let sum = match (a % block == 0, a / block == b / block) {
                (true, _) => before[b],
                (false, true) => after[a],
                (false, false) => after[a] + before[b],
            };
            sum / (b - a + 1) as f64
        })
        .collect()
}

/// What a stencil on an even grid depends on: the choice, and the room to the left, to the right and together.
type Key = (Choice, usize, usize, usize);

struct Work<'a> {
    even: bool,
    stencils: Stencils<'a>,
    values: &'a [f64],
    sigma: f64,
    cache: BTreeMap<Key, Rc<Stencil>>,
}

impl Work<'_> {
    /// The choice of least mean log error over the sampled rows, and all choices that win at more than a few of them.
    ///
    /// Windows of one degree are tried from narrow to wide, until their bias has made them hopeless.
    fn contest(&mut self, all: &[Choice], parts: &[Part]) -> (Option<Choice>, Vec<Choice>) {
        let rows: usize = parts.iter().map(|p| p.to - p.from).sum();
        let mut least = vec![(f64::INFINITY, None); rows];
        let mut tried: Vec<(Choice, Vec<f64>)> = Vec::new();
        let mut hopeless: Option<usize> = None;
        // Degree and mean log error of the window before.
        let mut narrower = (0, f64::INFINITY);
        let mut floors = vec![(0, Vec::new()); parts.len()];
        for choice in all {
            if hopeless == Some(choice.degree) {
                continue;
            }
            let mut squares = Vec::with_capacity(rows);
            for (part, floor) in parts.iter().zip(&mut floors) {
                if choice.points <= part.stretch.len() {
                    let mut judged = self.judge(*choice, *part);
                    grow(*choice, &mut judged, floor);
                    squares.extend(judged.iter().map(|j| j.square));
                } else {
                    squares.extend((part.from..part.to).map(|_| f64::INFINITY));
                }
            }
            let (mut excess, mut level, mut fitting) = (0.0, 0.0, 0.0);
            for (square, least) in squares.iter().zip(&mut least) {
                if *square < least.0 {
                    *least = (*square, Some(*choice));
                }
                if square.is_finite() {
                    excess += (square.max(TINY) / least.0.max(TINY)).ln();
                    level += square.max(TINY).ln();
                    fitting += 1.0;
                }
            }
            // Far from the best because too narrow is no reason to stop: only if widening made it worse.
            level /= f64::max(fitting, 1.0);
            let worse = narrower.0 == choice.degree && level > narrower.1;
            hopeless = (worse && excess > HOPELESS.ln() * fitting).then_some(choice.degree);
            narrower = (choice.degree, level);
            tried.push((*choice, squares));
        }
        let mut worst = vec![0.0f64; rows];
        for (_, squares) in &tried {
            for (w, s) in worst.iter_mut().zip(squares).filter(|(_, s)| s.is_finite()) {
                *w = w.max(*s);
            }
        }
        // A window that does not fit counts as the worst that does.
        let score = |squares: &[f64]| -> f64 {
            let logs = squares
                .iter()
                .zip(&worst)
                .map(|(s, w)| s.min(*w).max(TINY).ln());
            logs.sum()
        };
        let best = tried
            .iter()
            .map(|(c, squares)| (*c, score(squares)))
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(c, _)| c);
        let mut wins: BTreeMap<Choice, usize> = BTreeMap::new();
        for choice in least.iter().filter_map(|(_, c)| *c) {
            *wins.entry(choice).or_default() += 1;
        }
        let often = |c: &Choice| wins.get(c).is_some_and(|w| *w > rows / 2000) || Some(*c) == best;
        // Narrower windows of a degree stay, to tell how biased the wider ones are.
        let widest = |degree: usize| {
            let won = tried.iter().map(|(c, _)| *c);
            won.filter(|c| c.degree == degree && often(c))
                .map(|c| c.points)
                .max()
        };
        let kept = tried
            .iter()
            .map(|(c, _)| *c)
            .filter(|c| widest(c.degree).is_some_and(|w| c.points <= w))
            .collect();
        (best, kept)
    }

    /// For records too long to try everything everywhere: the common choice, and the few best of those no wider, which
    /// need no floor of narrower ones.
    fn contest_few(&mut self, all: &[Choice], parts: &[Part]) -> (Option<Choice>, Vec<Choice>) {
        let (best, kept) = self.contest(all, parts);
        let width = best.map_or(0, |c| c.points);
        let mut few: Vec<Choice> = kept
            .into_iter()
            .filter(|c| c.points <= width && Some(*c) != best)
            .collect();
        few.sort_by_key(|c| std::cmp::Reverse((c.points, c.degree)));
        // Spread over the widths that are left, the common choice first.
        let stride = few.len().div_ceil(FEW).max(1);
        (
            best,
            best.into_iter()
                .chain(few.into_iter().step_by(stride))
                .collect(),
        )
    }

    /// Estimates and errors of one choice at the rows of a part; the stretch must hold its points.
    fn judge(&mut self, choice: Choice, part: Part) -> Vec<Judged> {
        let Stretch {
            start, rows_end, ..
        } = part.stretch;
        let reach = choice.points;
        let (from, to) = (
            part.from.saturating_sub(reach).max(start),
            (part.to + reach).min(rows_end),
        );
        let mut last: Option<(Key, Rc<Stencil>)> = None;
        let mut squares = Vec::with_capacity(to - from);
        let mut raw = Vec::with_capacity(part.to - part.from);
        for i in from..to {
            let stencil = self.stencil(choice, i, part.stretch, &mut last);
            let first = (i as isize + stencil.first) as usize;
            let window = self
                .values
                .get(first..first + stencil.weights.len())
                .unwrap_or(&[]);
            let r = dot(&stencil.contrast, window);
            squares.push(r * r);
            if i >= part.from && i < part.to {
                raw.push((dot(&stencil.weights, window), stencil.norm, stencil.reach));
            }
        }
        let noise = self.sigma * self.sigma;
        let means = local_means(&squares, reach);
        raw.into_iter()
            .zip(means.into_iter().skip(part.from - from))
            .map(|((value, norm, length), left)| {
                let bias = |square: f64| square.max(0.0) * length * length;
                Judged {
                    value,
                    square: noise * norm * norm + bias((left - noise).max(UNSEEN * noise)),
                    certain: bias(left - CERTAIN * noise),
                }
            })
            .collect()
    }

    fn stencil(
        &mut self,
        choice: Choice,
        i: usize,
        stretch: Stretch,
        last: &mut Option<(Key, Rc<Stencil>)>,
    ) -> Rc<Stencil> {
        let ends = (stretch.start, stretch.end);
        if !self.even {
            return Rc::new(self.stencils.at(i, ends, choice));
        }
        // On an even grid only the room to both ends matters, and only as far as the wider window reaches.
        let wide = choice.points.max(choice.degree + 3);
        let key = (
            choice,
            (i - stretch.start).min(wide),
            (stretch.end - i).min(wide),
            stretch.len().min(wide),
        );
        if let Some((k, s)) = last
            && *k == key
        {
            return s.clone();
        }
        let make = || Rc::new(self.stencils.at(i, ends, choice));
        let s = self.cache.entry(key).or_insert_with(make).clone();
        *last = Some((key, s.clone()));
        s
    }
}

#[cfg(test)]
mod tests {
    use super::local_means;

    #[test]
    fn local_means_keep_small_values_beside_a_spike() {
        let values: Vec<f64> = (0..60)
            .map(|i| if i == 20 { 1e20 } else { f64::from(i) * 1e-9 })
            .collect();
        for reach in [1, 4, 7, 100] {
            for (i, mean) in local_means(&values, reach).into_iter().enumerate() {
                let window = &values[i.saturating_sub(reach)..(i + reach + 1).min(60)];
                let want = window.iter().sum::<f64>() / window.len() as f64;
                assert!((mean - want).abs() <= 1e-12 * want, "{reach} {i}");
            }
        }
    }
}
