//! The linearised likelihood about an answer, piece by piece of the records: what any choice of terms would cost on some of them.
//!
//! In: a problem and what was found. Out: products of the columns found and of those that come nearest to standing for one.
//! A piece begins without knowing where the last one ended, so pieces together know a little less than the whole.

use std::ops::Range;

use super::moments::Moments;
use super::problem::Problem;
use super::record::Record;
use super::search::Found;
use super::stretch::stretches;

/// Groups of pieces: few, since oscillations are known by their phase over long stretches.
const GROUPS: usize = 10;
/// Fewest groups that halves can be drawn of.
const FEWEST: usize = 4;
/// Samples of a piece for each state: what a free beginning takes is then an eighth of what it tells.
const SAMPLES: usize = 8;
/// Columns beside those found.
const RIVALS: usize = 100;

/// Products of some columns on groups of pieces.
#[derive(Clone, Debug)]
pub struct Pieces {
    /// Columns of the system, rising.
    pub columns: Vec<usize>,
    /// Products of these p columns, the right side last, of each group: (p + 1) × (p + 1) by rows, in units of the noise.
    pub products: Vec<Vec<f64>>,
    /// The same of whole records.
    pub whole: Vec<f64>,
}

/// `None` where the records are too short to be divided, the laws lead nowhere, or `go_on` gave it up.
pub fn pieces(problem: &Problem, found: &Found, go_on: &mut dyn FnMut() -> bool) -> Option<Pieces> {
    let point = &found.best.point;
    let (form, whole) = problem.form_and_products(point, go_on).ok()?;
    let mut columns = point.support.clone();
    for m in form.moves(&point.support, 0.0, 4 * RIVALS) {
        columns.extend(m.comes.filter(|j| !columns.contains(j)));
        if columns.len() >= point.support.len() + RIVALS {
            break;
        }
    }
    columns.sort_unstable();
    let groups = groups(problem);
    if groups.len() < FEWEST {
        return None;
    }
    let all = problem.all.outputs();
    let used: usize = groups.iter().flatten().map(|(_, s)| s.len()).sum();
    let share = problem.samples() as f64 / used as f64;
    let part = |products: &[f64], share: f64| -> Vec<f64> {
        let places = || columns.iter().copied().chain([all]);
        places()
            .flat_map(|i| places().map(move |j| (i, j)))
            .map(|(i, j)| products[i * (all + 1) + j] * share / found.as_one)
            .collect()
    };
    let products = groups.iter().map(|group| {
        let mut moments = Moments::new(all);
        problem.linearise(point, group, &mut moments, go_on).ok()?;
        Some(part(&moments.shifted(&point.active()), share))
    });
    let products = products.collect::<Option<Vec<_>>>()?;
    Some(Pieces {
        whole: part(&whole, 1.0),
        products,
        columns,
    })
}

/// Pieces of about equal length, in groups that lie together.
fn groups(problem: &Problem) -> Vec<Vec<(usize, Range<usize>)>> {
    let lengths: Vec<usize> = problem.records.iter().map(Record::len).collect();
    let parts = stretches(&lengths);
    let total: usize = parts.iter().map(|(_, s)| s.len()).sum();
    let length = (SAMPLES * problem.states()).max(total.div_ceil(GROUPS));
    let mut pieces = Vec::new();
    for (record, samples) in parts {
        let count = (samples.len() / length).max(1);
        let edge = |i: usize| samples.start + i * samples.len() / count;
        pieces.extend((0..count).map(|i| (record, edge(i)..edge(i + 1))));
    }
    // A single sample says nothing of a law.
    pieces.retain(|(_, s)| s.len() > 1);
    let count = pieces.len().min(GROUPS);
    let mut groups = vec![Vec::new(); count];
    let all = pieces.len();
    for (i, piece) in pieces.into_iter().enumerate() {
        if let Some(group) = groups.get_mut(i * count / all) {
            group.push(piece);
        }
    }
    groups
}
