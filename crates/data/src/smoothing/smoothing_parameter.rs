//! The smoothing parameter of a channel, by the criterion that fits what is known of its noise.
//!
//! In: a channel and a criterion. Out: the best width with its residual sum of squares and degrees of freedom. A coarse grid of
//! widths is followed by a golden-section search; of long records only excerpts are looked at.

use super::information_smoother::{InformationSmoother, Node, State, Transition};
use super::thresholds::{SEARCH, SMOOTHING};

/// One channel in units of its own spread, by row; weight 0 marks a value without influence.
#[derive(Clone, Copy)]
pub(super) struct Channel<'a> {
    pub nodes: &'a [Node],
    pub values: &'a [f64],
    pub weights: &'a [f64],
}

impl Channel<'_> {
    /// Calls `each(row, state)` for every row, last to first, with the spline of this width.
    pub(super) fn for_each_row(
        &self,
        width: f64,
        smoother: &mut InformationSmoother,
        mut each: impl FnMut(usize, State),
    ) {
        smoother.run(self.nodes, self.values, self.weights, width, |k, state| {
            if let Some(node) = self.nodes.get(k).filter(|n| n.uses_reading) {
                each(node.row, state);
            }
        });
    }

    pub(super) fn weight(&self, row: usize) -> f64 {
        self.weights.get(row).copied().unwrap_or(0.0)
    }

    pub(super) fn value(&self, row: usize) -> f64 {
        self.values.get(row).copied().unwrap_or(0.0)
    }
}

/// The criterion that decides.
#[derive(Clone, Copy, Debug)]
pub(super) enum Criterion {
    /// Unknown noise: generalised cross-validation (Craven and Wahba 1979, Numerische Mathematik 31).
    CrossValidation,
    /// White noise of this variance: Mallows' C_p (Mallows 1973, Technometrics 15).
    Mallows(f64),
    /// The stiffest spline that leaves no more than this variance. For noise that keeps its value over several samples, such
    /// as rounding, which the other two criteria would take for signal.
    Bounded(f64),
}

/// A spline of one width, as the criteria see it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fit {
    /// λ^(1/6), in median steps.
    pub width: f64,
    /// Weighted residual sum of squares.
    pub rss: f64,
    /// Effective degrees of freedom: the trace of the hat matrix.
    pub degrees_of_freedom: f64,
    /// Number of values.
    pub count: f64,
}

impl Fit {
    /// Variance of the noise, if it is white and the spline has no bias.
    pub(super) fn variance(&self) -> f64 {
        self.rss / self.residual_degrees_of_freedom()
    }

    fn residual_degrees_of_freedom(&self) -> f64 {
        (self.count - self.degrees_of_freedom).max(1e-3 * self.count)
    }

    /// Less is better.
    pub(super) fn score(&self, criterion: Criterion) -> f64 {
        let m = self.count;
        let cost = SMOOTHING.degrees_of_freedom_cost;
        match criterion {
            Criterion::CrossValidation => {
                let free = 1.0 - cost * self.degrees_of_freedom / m;
                if free > 0.0 {
                    self.rss / m / (free * free)
                } else {
                    f64::INFINITY
                }
            }
            Criterion::Mallows(v) => self.rss / m + 2.0 * cost * v * self.degrees_of_freedom / m,
            Criterion::Bounded(v) => {
                // A mean square of m values varies by √(2/m) of itself.
                let deviations = SMOOTHING.bound_deviations;
                let allowed = v * (1.0 + (deviations * deviations * 2.0 / m).sqrt());
                let excess = self.rss / self.residual_degrees_of_freedom() / allowed;
                if excess <= 1.0 { -self.width } else { excess }
            }
        }
    }
}

/// The fit of the best width in `min..=max` median steps.
pub(super) fn select(
    channel: &Channel,
    criterion: Criterion,
    (min, max): (f64, f64),
    smoother: &mut InformationSmoother,
) -> Fit {
    let parts = excerpts(channel.nodes);
    let mut try_width = |width: f64| evaluate_parts(&parts, channel, width, smoother);
    let mut best = try_width(min);
    let mut at = min;
    while at < max {
        at *= SEARCH.coarse_ratio;
        let fit = try_width(at);
        // Of equals the stiffest, so that a constant is no signal.
        if fit.score(criterion) <= best.score(criterion) {
            best = fit;
        }
        // The residual only grows with the width, so that nothing wider can be better.
        let hopeless = match criterion {
            // A narrow spline leaves so few degrees of freedom that its residual says little.
            Criterion::Bounded(_) => fit.score(criterion) > SMOOTHING.hopeless_excess,
            _ => fit.rss / fit.count > best.score(criterion),
        };
        if hopeless {
            break;
        }
    }
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    let ratio = SEARCH.coarse_ratio;
    let (mut a, mut b) = (best.width / ratio, best.width * ratio);
    let inner = |a: f64, b: f64| (b * (a / b).powf(golden), a * (b / a).powf(golden));
    let (x, y) = inner(a, b);
    let (mut x, mut y) = (try_width(x), try_width(y));
    for _ in 0..SEARCH.golden_steps {
        if x.score(criterion) <= y.score(criterion) {
            (b, y) = (y.width, x);
            x = try_width(inner(a, b).0);
        } else {
            (a, x) = (x.width, y);
            y = try_width(inner(a, b).1);
        }
        let better = if x.score(criterion) <= y.score(criterion) {
            x
        } else {
            y
        };
        if better.score(criterion) < best.score(criterion) {
            best = better;
        }
    }
    best
}

/// All nodes, or of a long record pieces from all over.
fn excerpts(nodes: &[Node]) -> Vec<Vec<Node>> {
    if nodes.len() <= SEARCH.max_nodes {
        return vec![nodes.to_vec()];
    }
    let length = SEARCH.excerpt_nodes;
    let last = nodes.len() - length;
    (0..SEARCH.excerpts)
        .map(|k| {
            let start = last * k / (SEARCH.excerpts - 1);
            let mut part = nodes.get(start..start + length).unwrap_or(&[]).to_vec();
            if let Some(node) = part.last_mut() {
                node.next = Transition::Reset(0);
            }
            part
        })
        .collect()
}

/// The fit of the whole channel at one width.
pub(super) fn evaluate(channel: &Channel, width: f64, smoother: &mut InformationSmoother) -> Fit {
    evaluate_parts(&[channel.nodes.to_vec()], channel, width, smoother)
}

fn evaluate_parts(
    parts: &[Vec<Node>],
    channel: &Channel,
    width: f64,
    smoother: &mut InformationSmoother,
) -> Fit {
    let mut fit = Fit {
        width,
        rss: 0.0,
        degrees_of_freedom: 0.0,
        count: 0.0,
    };
    for nodes in parts {
        let part = Channel { nodes, ..*channel };
        part.for_each_row(width, smoother, |row, state| {
            let weight = channel.weight(row);
            if weight > 0.0 {
                fit.rss += weight * (channel.value(row) - state.mean[0]).powi(2);
                fit.degrees_of_freedom += weight * state.variance[0];
                fit.count += 1.0;
            }
        });
    }
    fit
}
