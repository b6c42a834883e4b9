//! Pairs of columns that bring a residual within a tolerance, from products alone.
//!
//! In: lengths and products of columns with a target and with a probe. Out: every single column and every pair that may fit.
//! Rounding is given the benefit of the doubt; whoever asks tests what passes.
//!
//! Where ε is small, a pair φ, ψ that fits the target spans nearly the same plane as φ and the target. With the target projected
//! off, both have the same direction, up to the sign: pairs are neighbours in the order of one product of that direction, instead
//! of being sought among all N²/2.

use crate::thresholds::SPARSEST;

/// Columns as numbers.
pub(super) struct Pairs {
    /// Squared lengths.
    pub lengths: Vec<f64>,
    /// Products with the target.
    pub target_products: Vec<f64>,
    /// Products with the probe, a unit vector.
    pub probe_products: Vec<f64>,
    /// Product of the target with the probe.
    pub target_probed: f64,
    /// Squared length of the target.
    pub square: f64,
    /// Squared tolerance.
    pub allowed: f64,
}

/// The direction of a column with the target projected off.
struct Direction {
    place: usize,
    /// Magnitude of its product with the probe.
    key: f64,
    /// How far the key of a partner may be.
    reach: f64,
}

impl Pairs {
    /// Places of columns that may fit alone.
    pub fn singles(&self) -> Vec<usize> {
        let all = 0..self.lengths.len();
        all.filter(|i| self.passes(self.square, self.target_products[*i], self.lengths[*i]))
            .collect()
    }

    /// Places of pairs that may fit; `product` gives that of two columns.
    pub fn pairs(&self, product: &impl Fn(usize, usize) -> f64) -> Vec<(usize, usize)> {
        let n = self.lengths.len();
        let mut found = Vec::new();
        let Some((mut directions, special)) = self.directions() else {
            for i in 0..n {
                found.extend(
                    (i + 1..n)
                        .filter(|j| self.pair_passes((i, *j), product))
                        .map(|j| (i, j)),
                );
            }
            return found;
        };
        for i in &special {
            let partners = (0..n).filter(|j| j > i || special.binary_search(j).is_err());
            let partners = partners.filter(|j| j != i);
            let fitting = partners.filter(|j| self.pair_passes((*i, *j), product));
            found.extend(fitting.map(|j| (*i.min(&j), *i.max(&j))));
        }
        directions.sort_by(|a, b| a.key.total_cmp(&b.key).then(a.place.cmp(&b.place)));
        for (k, one) in directions.iter().enumerate() {
            let near = directions.iter().skip(k + 1);
            for other in near.take_while(|d| d.key - one.key <= one.reach) {
                let pair = (one.place.min(other.place), one.place.max(other.place));
                if self.pair_passes(pair, product) {
                    found.push(pair);
                }
            }
        }
        found
    }

    /// The directions of the columns, and the places of those that are too near to the target, or to nothing, to have one; `None`
    /// where ε is too large for directions to say much.
    ///
    /// Let z = α φ + β ψ + e with unit columns and ‖e‖ ≤ ε. If |α| ≤ η, ψ alone leaves at most ε + η: it is special. Otherwise the
    /// directions differ by at most ε/(η ν), where ν = ‖φ − (ẑᵀφ) ẑ‖.
    fn directions(&self) -> Option<(Vec<Direction>, Vec<usize>)> {
        let length = self.square.sqrt();
        let tolerance = self.allowed.sqrt() + SPARSEST.rounding;
        let least = SPARSEST.least_share * length;
        if tolerance > SPARSEST.narrow * least {
            return None;
        }
        let (mut directions, mut special) = (Vec::new(), Vec::new());
        for place in 0..self.lengths.len() {
            let (square, along) = (self.lengths[place], self.target_products[place] / length);
            let across = (square - along * along).max(0.0).sqrt();
            let unit = square.sqrt();
            if unit <= SPARSEST.least_share || across / unit * length <= tolerance + least {
                special.push(place);
                continue;
            }
            let key = (self.probe_products[place] - along * self.target_probed / length) / across;
            directions.push(Direction {
                place,
                key: key.abs(),
                reach: 2.0 * tolerance * unit / (least * across)
                    + SPARSEST.rounding / (across * across),
            });
        }
        (special.len() <= self.lengths.len() / 4).then_some((directions, special))
    }

    fn pair_passes(&self, (i, j): (usize, usize), product: &impl Fn(usize, usize) -> f64) -> bool {
        let (first, second) = match self.lengths[i] >= self.lengths[j] {
            true => (i, j),
            false => (j, i),
        };
        let length = self.lengths[first];
        if length <= 0.0 {
            return false;
        }
        let product = product(first, second);
        let along = self.target_products[first];
        let square = self.square - along * along / length;
        let along = self.target_products[second] - product * along / length;
        self.passes(
            square,
            along,
            self.lengths[second] - product * product / length,
        )
    }

    /// Whether a column of this squared length and product with the target may bring the residual within the tolerance.
    fn passes(&self, square: f64, along: f64, length: f64) -> bool {
        let slack = SPARSEST.screening * self.square;
        (square - self.allowed - slack) * length <= along * along + slack
    }
}
