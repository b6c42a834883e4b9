//! How stiff shall the spline be? One number for a channel, by the criterion that what is known of its noise allows.
//!
//! In: chains of nodes, values, weights. Out: the width of the spline's memory, what it leaves and what it takes.

use super::posterior::{Node, Step, Sweep};

/// Degrees of freedom count so much more than once: plain cross-validation now and then follows the noise (Cummins, Filloon
/// & Nychka 2001, Journal of the American Statistical Association 96).
const COST: f64 = 1.2;
/// Ratio of neighbouring widths of the first search.
const COARSE: f64 = 1.8;
/// Steps of the second.
const GOLDEN: usize = 7;
/// Nodes that the search looks at in full; of longer chains it takes excerpts.
const FULL: usize = 32_768;
const EXCERPTS: usize = 12;
const EXCERPT: usize = 2_048;

/// One channel in units of its own spread, by row; weight 0 where there is no value to go by.
pub(super) struct Channel<'a> {
    pub chain: &'a [Node],
    pub values: &'a [f64],
    pub weights: &'a [f64],
}

/// What decides.
#[derive(Clone, Copy, Debug)]
pub(super) enum Rule {
    /// Generalised cross-validation (Craven & Wahba 1979): the noise is not known.
    Unknown,
    /// Mallows' criterion: white noise of this variance.
    White(f64),
    /// The stiffest spline that leaves no more than this variance: noise that keeps its value over several samples, such as
    /// that of coarse digits, would pass for signal with the others.
    Bounded(f64),
}

/// A stiffness with its merits.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fit {
    pub width: f64,
    /// Weighted sum of squares left.
    pub left: f64,
    /// Effective degrees of freedom: the trace of the hat matrix.
    pub freedom: f64,
    /// Values seen.
    pub count: f64,
}

impl Fit {
    /// Variance of the noise, if it is white and the spline is not too stiff.
    pub(super) fn variance(&self) -> f64 {
        self.left / (self.count - self.freedom).max(1e-3 * self.count)
    }

    /// Less is better.
    pub(super) fn score(&self, rule: Rule) -> f64 {
        let m = self.count;
        match rule {
            Rule::Unknown => {
                let free = 1.0 - COST * self.freedom / m;
                if free > 0.0 {
                    self.left / m / (free * free)
                } else {
                    f64::INFINITY
                }
            }
            Rule::White(v) => self.left / m + 2.0 * COST * v * self.freedom / m,
            Rule::Bounded(v) => {
                let allowed = v * (1.0 + (8.0 / m).sqrt());
                let excess = self.left / (m - self.freedom).max(1e-3 * m) / allowed;
                if excess <= 1.0 { -self.width } else { excess }
            }
        }
    }
}

/// The best width between `range`, in median steps.
pub(super) fn width(channel: &Channel, rule: Rule, range: (f64, f64), sweep: &mut Sweep) -> Fit {
    let parts = excerpts(channel.chain);
    let (least, most) = range;
    let mut look = |width: f64| look_at(&parts, channel, width, sweep);
    let mut best = look(least);
    let mut at = least;
    while at < most {
        at *= COARSE;
        let fit = look(at);
        // Of equals the stiffest: a constant is no signal.
        if fit.score(rule) <= best.score(rule) {
            best = fit;
        }
        // What is left only grows with the width, so from here on nothing can be better.
        let hopeless = match rule {
            // Few values are free of a narrow spline, and what it leaves of them says little.
            Rule::Bounded(_) => fit.score(rule) > 4.0,
            _ => fit.left / fit.count > best.score(rule),
        };
        if hopeless {
            break;
        }
    }
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    let (mut a, mut b) = (best.width / COARSE, best.width * COARSE);
    let inner = |a: f64, b: f64| (b * (a / b).powf(golden), a * (b / a).powf(golden));
    let (x, y) = inner(a, b);
    let (mut x, mut y) = (look(x), look(y));
    for _ in 0..GOLDEN {
        if x.score(rule) <= y.score(rule) {
            (b, y) = (y.width, x);
            x = look(inner(a, b).0);
        } else {
            (a, x) = (x.width, y);
            y = look(inner(a, b).1);
        }
        let better = if x.score(rule) <= y.score(rule) { x } else { y };
        if better.score(rule) < best.score(rule) {
            best = better;
        }
    }
    best
}

/// All of it, or pieces from all over.
fn excerpts(chain: &[Node]) -> Vec<Vec<Node>> {
    if chain.len() <= FULL {
        return vec![chain.to_vec()];
    }
    let last = chain.len() - EXCERPT;
    (0..EXCERPTS)
        .map(|k| {
            let start = last * k / (EXCERPTS - 1);
            let mut part = chain.get(start..start + EXCERPT).unwrap_or(&[]).to_vec();
            if let Some(node) = part.last_mut() {
                node.next = Step::Jump(0);
            }
            part
        })
        .collect()
}

fn look_at(parts: &[Vec<Node>], channel: &Channel, width: f64, sweep: &mut Sweep) -> Fit {
    let mut fit = Fit {
        width,
        left: 0.0,
        freedom: 0.0,
        count: 0.0,
    };
    for chain in parts {
        sweep.run(chain, channel.values, channel.weights, width, |k, state| {
            let Some(node) = chain.get(k).filter(|n| n.sees) else {
                return;
            };
            let weight = channel.weights.get(node.row).copied().unwrap_or(0.0);
            if weight > 0.0 {
                let value = channel.values.get(node.row).copied().unwrap_or(0.0);
                let [mean, ..] = state.mean;
                let [variance, ..] = state.variance;
                fit.left += weight * (value - mean).powi(2);
                fit.freedom += weight * variance;
                fit.count += 1.0;
            }
        });
    }
    fit
}

/// The whole channel at one width; what excerpts said of it does not add up.
pub(super) fn whole(channel: &Channel, width: f64, sweep: &mut Sweep) -> Fit {
    look_at(&[channel.chain.to_vec()], channel, width, sweep)
}
