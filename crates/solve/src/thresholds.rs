//! Numbers that decide in solvers, certificates and linear algebra.
//!
//! In: nothing. Out: families of numbers, and their tables for the documentation. Never computes with them. Sizes of tiles and
//! panels, which only change how fast a kernel is, stay beside their kernels.

use std::time::Duration;

use sidc_thresholds::{Table, family};

family! {
    /// When a column, a pivot or a singular value counts as zero.
    pub(crate) NUMERICAL_RANK: NumericalRank {
        /// Part of a column of length one outside the span of others, or pivot relative to the first, below which a column is
        /// dependent on the others.
        dependent: f64 = 1e-11, unit "", source "set by hand";
        /// Singular value below which a matrix has lost a rank.
        singular_value: f64 = 1e-13, unit "of the largest", source "set by hand, some hundred roundings of a column of length one";
        /// Length below which a column counts as all zero, so that dividing by it does not overflow.
        zero_column: f64 = 1e-290, unit "", source "set by hand; the largest number is 1.8e308";
    }
}

family! {
    /// Factorisations of dense matrices.
    pub(crate) FACTORISATION: Factorisation {
        /// Sweeps of Jacobi rotations over all pairs of columns.
        max_sweeps: usize = 60, unit "sweeps", source "set by hand; six to ten are usual (Golub & Van Loan, section 8.6)";
        /// Dimension up to which singular values are always computed by rotations.
        jacobi_dimension: usize = 64, unit "rows or columns", source "set by hand: rotations cost some ten times as much as bidiagonalisation";
        /// Steps of the QR iteration for singular values.
        qr_steps: usize = 100, unit "steps for each singular value", source "set by hand";
        /// Error of A − UΣVᵀ, and of UᵀU − I, above which a decomposition is rejected.
        reconstruction_error: f64 = 1e-12, unit "of the norm of A", source "set by hand";
        /// Squared part of a column norm that is left below which the norm is computed anew instead of updated.
        norm_update: f64 = 1e-8, unit "", source "about the root of the machine epsilon (Drmač & Bujanović 2008, LAPACK working note 176)";
        /// Bisections for the largest eigenvalue when eigenvalues are counted.
        bisections: usize = 40, unit "bisections", source "set by hand; 2^-40 of the first interval is left";
    }
}

family! {
    /// How work is shared between threads.
    pub(crate) PARALLELISM: Parallelism {
        /// Work below which a second thread costs more than it saves.
        min_work: usize = 2_000_000, unit "multiplications", source "set by hand: starting a thread takes some 30 µs";
        /// Numbers of a stored matrix that a thread prices before it asks for more.
        dense_task: usize = 131_072, unit "numbers", source "set by hand";
        /// Work on products of factors that a thread does before it asks for more.
        factored_task: usize = 4_000_000, unit "multiplications", source "set by hand";
        /// How often an observer is asked while only other threads work.
        ask_every: Duration = Duration::from_millis(20), unit "", source "set by hand: what a user does not notice";
    }
}

family! {
    /// What a residual, a duality gap and a coefficient prove.
    pub(crate) CERTIFICATES: Certificates {
        /// With ε = 0, a residual up to this is rounding and no contradiction.
        consistent: f64 = 1e-9, unit "of the target", source "set by hand";
        /// |a_j|‖φ_j‖ above which a column belongs to the support.
        support: f64 = 1e-6, unit "of the largest", source "set by hand";
        /// Relative duality gap that proves optimality.
        optimal_gap: f64 = 1e-6, unit "", source "set by hand";
        /// Residual allowed beyond ε.
        feasible: f64 = 1e-6, unit "of ε, or of the target where ε = 0", source "set by hand";
        /// Bound on the part of another minimiser's 1-norm off the support below which the support is unique.
        off_support: f64 = 1e-3, unit "of the 1-norm", source "set by hand";
    }
}

family! {
    /// The Lasso path of the default solver. Columns and target have length one.
    pub(crate) HOMOTOPY: HomotopyNumbers {
        /// Length of the unexplained part of the target that counts as rounding.
        explained: f64 = 1e-13, unit "of the target", source "set by hand, some hundred roundings";
        /// Correlation with the unexplained part below which a column meets no bound.
        flat: f64 = 1e-10, unit "of the length of that part", source "set by hand";
        /// The same bound where the unexplained part is itself nearly rounding.
        rounding: f64 = 2e-15, unit "of the target", source "set by hand, some ten roundings";
        /// Coefficient of the wrong sign that counts as rounding.
        negligible: f64 = 1e-10, unit "of the largest coefficient", source "set by hand";
        /// Excess over |φᵀλ| ≤ 1 from which a column should have entered.
        violation: f64 = 1e-10, unit "", source "set by hand";
        /// Excess over |φᵀλ| ≤ 1 from which a point of the path is no knot.
        knot_violation: f64 = 1e-9, unit "", source "set by hand";
        /// Work of one path. Longer paths fit noise: an ill-posed problem.
        max_work: f64 = 1e10, unit "multiplications", source "set by hand; exact data and honest ε take tens to thousands of steps";
        /// Steps of one path for each row.
        steps_per_row: usize = 100, unit "steps", source "set by hand; no path was seen that needs more";
        /// Steps that every path may take.
        min_steps: usize = 1500, unit "steps", source "set by hand";
        /// Columns of the first working set.
        initial_columns: usize = 256, unit "columns", source "set by hand";
        /// Correlation with the target above which columns make the first working set, if there are any.
        initial_bound: f64 = 0.03, unit "", source "what correlates less does not begin a path: one in a thousand of the variance";
        /// Columns that enter the working set in one round.
        added_columns: usize = 256, unit "columns", source "set by hand";
        /// Once a bound is broken, correlation from which columns enter too: the path is about to meet them.
        near_bound: f64 = 0.9, unit "", source "set by hand";
        /// Least steps between two pricings of all columns.
        min_stride: usize = 8, unit "steps", source "set by hand";
        /// Most steps between two pricings of all columns.
        max_stride: usize = 64, unit "steps", source "set by hand";
        /// Correlation with the residual below which a column explains none of it.
        unrelated: f64 = 1e-9, unit "", source "set by hand";
        /// Coefficient above which a column belongs to the support that the dual point is centred about.
        support: f64 = 1e-9, unit "of the largest coefficient", source "set by hand";
        /// Distance to a bound that counts as on it.
        on_bound: f64 = 1e-3, unit "", source "set by hand";
        /// Ternary steps of the line search that centres the dual point.
        line_search: usize = 30, unit "steps", source "(2/3)^30 = 5e-6 of the interval is left";
        /// Halvings of that step where columns outside the working set refuse it.
        shorter_steps: i32 = 8, unit "halvings", source "20,000 planted problems: 2 need 1 or 2";
        /// Entries of Φ up to which least squares checks a path that ended short of ε.
        least_squares_entries: usize = 1_000_000, unit "numbers", source "set by hand: about a second";
    }
}

family! {
    /// Several weights of the same columns, solved side by side.
    pub(crate) SIDE_BY_SIDE: SideBySide {
        /// Terms of a sparse answer, at most.
        sparse: f64 = 0.5, unit "of the rows", source "fewer than half as many columns as rows are unique where every set of that many columns is independent (Donoho & Elad 2003)";
        /// Steps that the others may take, once one has ended in a sparse answer.
        patience: usize = 2, unit "times its steps", source "set by hand";
        /// Steps that count at least.
        least_steps: usize = 64, unit "steps", source "one round";
    }
}

family! {
    /// Column generation around solvers that need all columns stored.
    pub(crate) COLUMN_GENERATION: ColumnGeneration {
        /// Entries of Φ up to which it is stored whole.
        stored_entries: usize = 5_000_000, unit "numbers", source "set by hand: 40 MB";
        /// Columns of the first working set for each row.
        initial_columns: usize = 4, unit "columns per row", source "set by hand";
        /// Columns that enter in one round for each row.
        added_columns: usize = 2, unit "columns per row", source "set by hand";
        /// Rounds of solving and pricing.
        max_rounds: usize = 100, unit "rounds", source "set by hand";
        /// Excess over |φ_jᵀλ| ≤ ‖φ_j‖ that a solver's own accuracy may leave.
        violation: f64 = 1e-8, unit "", source "set by hand";
        /// Correlation with the residual below which a column explains none of it.
        unrelated: f64 = 1e-7, unit "", source "set by hand";
    }
}

family! {
    /// Conic programs for Clarabel.
    pub(crate) CONIC: Conic {
        /// Singular value below which a row is left out: Clarabel fails on dependent rows.
        singular_value: f64 = 1e-9, unit "of the largest", source "set by hand";
        /// Residual beyond ε up to which its "solved" is believed.
        residual: f64 = 1e-6, unit "of ε, or of the target where ε = 0", source "set by hand";
    }
}

family! {
    /// The heuristic solvers.
    pub(crate) HEURISTICS: Heuristics {
        /// Columns that orthogonal matching pursuit takes: with more, an answer is not sparse and the basis not cheap.
        omp_columns: usize = 200, unit "columns", source "set by hand";
        /// Entries of Φ that thresholded least squares stores and factorises.
        stlsq_entries: usize = 8_000_000, unit "numbers", source "set by hand: 64 MB";
        /// Thresholds, each twice the one before; the last is one half of the largest contribution.
        stlsq_thresholds: i32 = 20, unit "thresholds", source "set by hand";
        /// Fits at one threshold.
        stlsq_fits: usize = 20, unit "fits", source "set by hand";
    }
}

family! {
    /// The autoregression fitted to residuals.
    pub(crate) AUTOREGRESSION: AutoregressionNumbers {
        /// Largest order, for each factor of ten in the number of rows.
        max_order: f64 = 10.0, unit "lags · log₁₀ of the rows", source "the default of the function ar in R";
        /// Weight before the first row below which a filtered sum is complete.
        negligible_weight: f64 = 1e-3, unit "of the largest weight", source "set by hand";
        /// Rows before the first over which a filtered sum is followed, or as many as there are.
        rows_before: usize = 1000, unit "rows", source "set by hand";
    }
}

/// Lags of the autocorrelations that are looked at: a constant, because arrays have this length.
pub const WHITENESS_LAGS: usize = 8;

family! {
    /// When residuals count as white.
    pub(crate) WHITENESS: Whiteness {
        /// Lags of the autocorrelations that are looked at.
        lags: usize = WHITENESS_LAGS, unit "rows", source "set by hand";
        /// Deviation of their sum of squares that chance may cause.
        deviations: f64 = 5.0, unit "standard deviations", source "set by hand";
    }
}

family! {
    /// Best subsets on a quadratic form. Columns have length one.
    pub QUADRATIC_FORM: QuadraticFormNumbers {
        /// Squared length outside the chosen columns below which a column is dependent on them.
        dependent: f64 = 1e-7, unit "", source "set by hand";
        /// Ridge that keeps the inverse of dependent columns finite.
        ridge: f64 = 1e-12, unit "", source "set by hand";
        /// Steps of steepest descent by single changes.
        max_changes: usize = 60, unit "changes", source "set by hand";
        /// Changes applied one after another before all is computed afresh.
        changes_before_afresh: usize = 16, unit "changes", source "each multiplies rounding errors by at most 1/dependent; properties hold to 1e-5 after 16";
        /// Predicted gain below which the descent ends.
        predicted_gain: f64 = 1e-6, unit "of the penalty, at least of 1", source "set by hand";
        /// Actual gain below which the descent ends.
        gain: f64 = 1e-9, unit "of the criterion, at least of 1", source "set by hand";
    }
}

family! {
    /// Basis pursuit on several blocks under linear constraints.
    pub(crate) CONSTRAINED: Constrained {
        /// Rounds of solving and pricing.
        max_rounds: usize = 40, unit "rounds", source "set by hand";
        /// Columns that enter a block in one round.
        added_columns: usize = 100, unit "columns", source "set by hand";
        /// Columns up to which a block takes part whole.
        whole_block: usize = 200, unit "columns", source "set by hand";
        /// Columns of a block that take part.
        max_columns: usize = 1500, unit "columns", source "set by hand";
        /// Excess of a reduced cost over 1 from which a column enters.
        violation: f64 = 1e-7, unit "", source "set by hand";
        /// Correlation from which a column may shorten the residual, where the least residual is sought.
        correlated: f64 = 1e-6, unit "", source "set by hand";
        /// Residual beyond ε that the conic solver's accuracy may leave.
        reached: f64 = 1e-7, unit "of the target", source "set by hand";
    }
}

family! {
    /// Linear equations and inequalities between coefficients.
    pub(crate) LINEAR_CONSTRAINTS: LinearConstraints {
        /// By how much an inequality may be missed.
        violation: f64 = 1e-10, unit "of its largest summand", source "set by hand";
        /// Multiplier from which an inequality is active.
        active: f64 = 1e-9, unit "of the largest multiplier", source "set by hand";
        /// Right side that is left of a dependent equation above which it is a contradiction.
        contradiction: f64 = 1e-9, unit "of the largest right side", source "set by hand";
        /// By how much strict inequalities are tightened where rows contradict each other.
        strict: f64 = 1e-5, unit "of the largest right side", source "set by hand";
        /// Weight of a free coefficient in an inequality that counts as rounding.
        rounding: f64 = 1e-13, unit "of the largest weight", source "set by hand, some hundred roundings";
        /// Gradient below which a multiplier stays zero.
        gradient: f64 = 1e-12, unit "of the right side", source "set by hand";
        /// Residual of the last row below which no point satisfies the inequalities.
        empty: f64 = 1e-9, unit "of the right side", source "set by hand";
    }
}

family! {
    /// The proof that no fit has fewer terms. Columns and target have length one.
    pub(crate) SPARSEST: SparsestNumbers {
        /// The assumption of the proof: largest |a|‖φ‖ of a term, unless the terms found are themselves large.
        largest_share: f64 = 1e3, unit "of the target", source "set by hand: sums that cancel to a thousandth are no law that data could show";
        /// The same where the terms found are large.
        share_room: f64 = 10.0, unit "of the largest term found", source "set by hand";
        /// What a unit column may be off by: rounding of its length, of the triangle, of its product with a dual point.
        column_rounding: f64 = 1e-15, unit "", source "some roundings of 2⁻⁵³";
        /// Error that the rounding of one column may make, times the largest share.
        share_rounding: f64 = 0.1, unit "of the tolerance", source "set by hand: what is within the tolerance is said to a tenth of it";
        /// Largest support that is looked for; the ridge is chosen for it.
        max_terms: usize = 20, unit "terms", source "set by hand: the search is exponential";
        /// Squared tolerance that the ridge costs.
        ridge_room: f64 = 0.1, unit "of the squared tolerance", source "set by hand";
        /// Largest cut that is looked for.
        cut_size: usize = 32, unit "columns", source "set by hand";
        /// Largest cut that is searched for needless members.
        shrunk_cut: usize = 12, unit "columns", source "set by hand";
        /// Squared length outside the span of others below which a direction is spanned by them.
        spanned: f64 = 1e-10, unit "", source "set by hand; differences of squares keep some 1e-15";
        /// Length that rounding leaves of a direction of the dual basis that is spanned by those excluded.
        lost_direction: f64 = 1e-9, unit "", source "set by hand";
        /// Excess of a dual point over its bound that rounding may cause.
        rounding: f64 = 1e-13, unit "of the target", source "set by hand, some hundred roundings";
        /// Squared residual that rounding of differences may hide.
        screening: f64 = 1e-12, unit "of the squared target", source "set by hand, some thousand roundings";
        /// Rows of the sketch on which the last two columns are sought.
        sketch_rows: usize = 32, unit "rows", source "set by hand: more than any support has terms";
        /// Tolerance up to which a sketch rejects nearly all that does not fit.
        sketch_tolerance: f64 = 1e-3, unit "of the target", source "set by hand";
        /// Coefficient below which the other column of a pair fits nearly alone.
        least_share: f64 = 1e-3, unit "of what is left of the target", source "set by hand";
        /// Angle from which directions of columns no longer tell pairs apart.
        narrow: f64 = 1e-2, unit "radians", source "set by hand";
        /// Work of a new dual basis over that of one pass.
        new_basis: f64 = 3.0, unit "", source "QR takes 4/3 n³ multiplications, the dual basis some n³";
        /// Work between two looks at the clock.
        stretch: f64 = 1e8, unit "multiplications", source "set by hand: some 50 ms";
        /// Nodes explored side by side, on any number of cores.
        round: usize = 4, unit "nodes", source "set by hand";
        /// Supports of the smallest size that are listed.
        most_supports: usize = 1000, unit "supports", source "set by hand";
        /// Terms of the greedy start.
        start_terms: usize = 40, unit "terms", source "set by hand";
        /// Work of one search that nobody ends.
        work: f64 = 2e12, unit "multiplications", source "set by hand: some ten minutes on two cores";
        /// Copies of the columns that are stored at once.
        copies: u64 = 6, unit "copies", source "reading, scaling, QR, the greedy start and what remains";
        /// Square matrices that are stored at once, at most.
        bases: u64 = 40, unit "matrices", source "a round of nodes, each with one basis for each term of a support of ten";
        /// Memory of the search.
        max_memory: u64 = 2_000_000_000, unit "bytes", source "set by hand";
    }
}

/// The families as tables.
pub fn tables() -> Vec<Table> {
    vec![
        NumericalRank::table(),
        Factorisation::table(),
        Parallelism::table(),
        Certificates::table(),
        HomotopyNumbers::table(),
        SideBySide::table(),
        ColumnGeneration::table(),
        Conic::table(),
        Heuristics::table(),
        AutoregressionNumbers::table(),
        Whiteness::table(),
        QuadraticFormNumbers::table(),
        Constrained::table(),
        LinearConstraints::table(),
        SparsestNumbers::table(),
    ]
}
