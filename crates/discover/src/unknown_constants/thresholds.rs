//! Numbers that decide how unknown constants are searched for.

use sidc_thresholds::{Table, family};

family! {
    /// The search for unknown constants.
    pub(crate) UNKNOWNS: Unknowns {
        /// Rows on which values are compared before they are refined.
        rows: usize = 400, unit "rows", source "ten rows for each term of a library of forty; the refinement sees all";
        /// Values of a single constant that are compared at least.
        least_values: usize = 24, unit "values", source "nine decades then have three values each";
        /// Points that are compared at most, whatever the number of constants.
        most_points: usize = 300, unit "points", source "a library of thirty terms takes some 2 ms at each";
        /// Points at which all terms together are fitted, of a single constant.
        most_points_of_whole: usize = 1500, unit "points", source "sines over forty seconds with frequencies up to 50 differ so often";
        /// Terms of an equation by which values are spaced.
        compared_terms: usize = 50, unit "terms", source "set by hand: those of one family change alike";
        /// Cosine between the columns of a term at neighbouring values, below which one between them is compared too.
        likeness: f64 = 0.95, unit "", source "the best value then lies within 9° of a value that is compared: 0.975 of its column is seen";
        /// Points from which the search goes downhill.
        starts: usize = 24, unit "points", source "as `unknowns.least_values`: terms and constants in turn, from every part of a range";
        /// Difference up to which two minima are one.
        same: f64 = 0.01, unit "of the constant", source "refined minima agree to rounding; of noisy data the likelihood of the trajectory moves them more";
        /// Minima of the residual of all terms together that join the points of the search.
        minima_of_whole: usize = 24, unit "points", source "as `unknowns.starts`; of three constants in two logistic functions (ODEBench 62) five ended in other minima";
        /// Lower bounds of the rows' errors in further searches, under which few terms have minima at the right
        /// constants.
        rough: [f64; 3] = [1e-2, 1e-3, 1e-4], unit "of the target", source "exact data of ODEBench 62 lead to wrong minima, data with 1 % noise do not";
        /// Difference from which two points of the profile may lie in different basins.
        apart: f64 = 0.2, unit "of the constant", source "set by hand";
        /// Terms of an equation up to which constants are sought for each part of them.
        part_terms: usize = 6, unit "terms", source "62 parts, each some milliseconds: as long as the points of the profile take";
        /// Rounds of choosing terms and refining constants from each.
        rounds: usize = 4, unit "rounds", source "set by hand";
        /// Rows times constants of a refinement at most: beyond, rows are left out evenly.
        room: usize = 20_000_000, unit "values", source "160 MB; two hundred runs with a value each then have 500 rows each";
        /// Other minima whose laws are compared with the answer.
        rivals: usize = 5, unit "points", source "each takes a search for terms at one value";
        /// Steps of a refinement.
        steps: usize = 40, unit "steps", source "Gauss–Newton gains at least a digit in each once near; ten more pass a valley";
        /// Step at which a refinement has settled.
        settled: f64 = 1e-12, unit "of the constant", source "rounding of its column";
    }
}

family! {
    /// Basis pursuit over the ranges of unknown constants.
    pub(crate) PRICING: Pricing {
        /// Columns with a constant, at all points together.
        columns: usize = 500_000, unit "columns", source "pricing them on 400 rows takes 0.1 s";
        /// Residuals that are asked for in turn.
        stages: [f64; 5] = [0.3, 0.1, 0.03, 0.01, 0.003], unit "of the target", source "half decades: the strongest terms enter first";
        /// Rounds of pricing between the points at each of them.
        rounds: usize = 3, unit "rounds", source "the slope's root is exact, so that a second round moves a column by the change of the dual point alone";
        /// Steps of a path.
        steps: usize = 200, unit "steps", source "half of `unknowns.rows`: a longer path fits noise";
        /// Excess over |φᵀλ| ≤ w that a proposal may leave.
        violation: f64 = 1e-3, unit "", source "the norm is then within 0.1 % of the least; variable projection refines";
        /// Columns that are looked at for maxima.
        priced_columns: usize = 1000, unit "columns", source "those of the points about the maxima, of 64 ascents some fifteen each";
        /// |φᵀλ|/w from which a point may lie beside a maximum that breaks its bound.
        near_bound: f64 = 0.8, unit "", source "below the cosine of neighbouring columns, `unknowns.likeness`";
        /// Maxima that are refined in a round.
        ascents: usize = 64, unit "maxima", source "each takes some ten evaluations of a term";
        /// Sweeps over the constants of a term.
        sweeps: usize = 4, unit "sweeps", source "set by hand: the next round goes on";
        /// Evaluations along one constant.
        line_steps: usize = 12, unit "evaluations", source "regula falsi gains more than a digit in two";
        /// Difference up to which two values are one.
        same: f64 = 1e-6, unit "of the constant", source "columns then differ by their rounding after the path's products";
        /// Steps of a path at one value.
        steps_per_row: usize = 2, unit "steps", source "a fit of every row has a term a row; half the steps may turn back";
        /// Values that are proposed.
        proposals: usize = 12, unit "points", source "half of `unknowns.starts`: they are refined already";
        /// Proposals of a large library from which the search goes downhill.
        starts: usize = 4, unit "points", source "each takes up to `unknowns.rounds` solutions of the basis pursuit";
    }
}

family! {
    /// Greedy looks at many values of the constants of a large library.
    pub(crate) GREEDY: GreedyPoints {
        /// Columns at all points together.
        columns: usize = 2_000_000, unit "columns", source "twelve products with all of them take one to nine seconds; with a quarter, a frequency among 2,184 terms is missed";
        /// Terms that are taken.
        terms: usize = 12, unit "terms", source "most that a law of one equation has; a greedy path takes some wrong ones first";
        /// Minima that are kept.
        minima: usize = 12, unit "points", source "as `pricing.proposals`";
    }
}

family! {
    /// The proof that an answer has the least norm over the range of a constant.
    pub(crate) RANGE_PROOF: RangeProofNumbers {
        /// Rows times columns at all values, above which nothing is proved.
        room: usize = 30_000_000, unit "numbers", source "pricing them takes 20 ms, and a path prices them some tens of times";
        /// Values of the constant at which columns are made first.
        points: usize = 100, unit "values", source "set by hand: those between are priced by ascent";
        /// Rounds of pricing between them.
        rounds: usize = 12, unit "rounds", source "the excess falls by the square of the distance to the next column, which each round divides";
        /// Steps of a path.
        steps: usize = 300, unit "steps", source "an answer of the least norm is the end of a path of some ten steps for each term";
        /// Residuals at which the dual point is sought in turn.
        residuals: [f64; 2] = [1e-4, 0.0], unit "of the right side", source "the shortest dual point is their limit; an exact fit by nearly dependent columns is a long path";
        /// By how much the norm of another combination must be smaller to be reported.
        smaller: f64 = 0.01, unit "of the norm", source "a hundred times the residual that it may leave";
        /// Excess over |φᵀλ| ≤ w that is rounding: B − 1 of what is proved.
        bound: f64 = 1e-6, unit "", source "as the gap of the certificate at one value";
        /// First cell about the value.
        first_cell: f64 = 0.05, unit "of the value or the range", source "set by hand: it is halved until it is proved";
        /// Width of a cell below which a bound is not proved.
        least_cell: f64 = 1e-5, unit "of the value", source "set by hand: an enclosure that is too wide there stays so";
        /// Cells to each side.
        cells: usize = 400, unit "cells", source "each takes some ms; smooth terms need ten to fifty";
        /// Ranges that are tried; each ends half way to the value at which the proof on the last one failed.
        ranges: usize = 3, unit "ranges", source "set by hand: an eighth of the way is left";
    }
}

/// The families as tables.
pub(crate) fn tables() -> Vec<Table> {
    vec![
        Unknowns::table(),
        Pricing::table(),
        GreedyPoints::table(),
        RangeProofNumbers::table(),
    ]
}
