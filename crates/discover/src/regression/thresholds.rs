//! Numbers that decide in the regression of one equation.
//!
//! In: nothing. Out: families of numbers, and their tables for the documentation. Never computes with them.

use sidc_thresholds::{Table, family};

family! {
    /// How many rows an equation is found from where the table has more.
    pub(crate) ROW_BUDGET: RowBudget {
        /// Rows times terms of a design matrix that is stored.
        stored_entries: usize = 4_000_000, unit "numbers", source "M N = 4e6 doubles are 32 MB, and a second of least squares where rows outnumber terms";
        /// Rows times terms of a design matrix that is only priced, where terms outnumber rows.
        priced_entries: usize = 1_000_000_000, unit "products", source "1e9 products are some 20 ms for one look at all columns";
        /// Most rows where terms outnumber rows: more rows add no information, but every step of a solver takes longer.
        wide_rows: usize = 2000, unit "rows", source "set by hand";
        /// Rows that the limits always leave.
        min_rows: usize = 100, unit "rows", source "set by hand";
    }
}

family! {
    /// The tolerance ε of the fit, where rows outnumber terms.
    pub(crate) TOLERANCE: Tolerance {
        /// Smallest tolerance: below it, rounding decides.
        relative_floor: f64 = 1e-9, unit "of the target", source "set by hand";
        /// Tolerance over the smallest residual that is possible.
        room: f64 = 1.001, unit "", source "of the last digit printed; at the bound itself the programme has one feasible point, and an interior-point method none inside";
        /// Residual of the whole library above which it replaces the estimated error of the data.
        visible_noise: f64 = 1e-2, unit "of the target", source "set by hand";
    }
}

family! {
    /// The path of answers that `--path` shows.
    pub(crate) LASSO_PATH: LassoPath {
        /// Knots shown, counted from the start; the last one is always shown.
        kept_knots: usize = 100, unit "knots", source "set by hand";
        /// Knots after which a path is left: a law with hundreds of terms is not sparse.
        max_knots: usize = 2000, unit "knots", source "set by hand";
        /// Share below which a coefficient is rounding, and no term.
        zero_share: f64 = 1e-12, unit "of the largest |a|‖φ‖", source "set by hand";
    }
}

family! {
    /// The sparsest equations of `--prove-sparsest`.
    pub(crate) SPARSEST_ANSWER: SparsestAnswer {
        /// Other equations of the same number of terms that are listed.
        listed: usize = 20, unit "equations", source "set by hand: more are no list that anybody reads";
    }
}

family! {
    /// Iterated generalised least squares on the weak form.
    pub(crate) WEAK_FORM: WeakForm {
        /// Entries of the design matrix.
        max_entries: usize = 8_000_000, unit "numbers", source "set by hand";
        /// Memory of one entry, with all copies of the matrix.
        bytes_per_entry: u64 = 64, unit "bytes", source "8 bytes for a double, and some eight copies";
        /// Error of every row, beyond the noise, before there is a guess.
        initial_slacks: [f64; 2] = [0.3, 0.03], unit "of the noise of a record", source "set by hand";
        /// The same where there is a guess.
        slack: f64 = 0.01, unit "of the noise of a record", source "set by hand";
        /// The same under constraints, where the rows are weighted once.
        slack_without_guess: f64 = 0.1, unit "of the noise of a record", source "set by hand";
        /// Factors on the cost of a term for the first guesses: a guess with too many terms misleads more than one with too few.
        penalty_factors: [f64; 3] = [1.0, 4.0, 16.0], unit "", source "set by hand";
        /// Iterations from each first guess.
        max_iterations: usize = 4, unit "iterations", source "set by hand";
        /// Times that equations exchange the trajectories of their states.
        max_passes: usize = 3, unit "passes", source "set by hand";
        /// Mean squared whitened residual up to which the trajectory of an equation is handed on.
        shared_misfit: f64 = 1.5, unit "variances", source "set by hand";
        /// Residual of a whitened row that is no evidence: its error is known to a factor only.
        error_floor: f64 = 0.3, unit "standard errors", source "set by hand";
    }
}

family! {
    /// Gradings of the 1-norm: a term of degree d weighs κ^d times the length of its column.
    pub(crate) GRADING: GradingNumbers {
        /// κ of the slight grading.
        slight: f64 = 1.5, unit "", source "study `coupled`: with the plain norm and the steep one it finds as many laws as five gradings do";
        /// κ of the steep grading.
        steep: f64 = 4.0, unit "", source "study `coupled`";
        /// Factors of a library whose terms are made expensive, one factor at a time, where no grading leads to a sparse answer.
        penalized: usize = 24, unit "factors", source "set by hand: a bound on work";
        /// Steps after which a path is given up until all others have been tried.
        steps: usize = 512, unit "steps", source "study `coupled`: nine in ten sparse answers take fewer than 263 steps, 99 in 100 fewer than 841";
        /// Terms of a proposal up to which it takes part in the selection.
        near: usize = 2, unit "times the fewest", source "set by hand";
    }
}

/// The families as tables.
pub(crate) fn tables() -> Vec<Table> {
    vec![
        RowBudget::table(),
        Tolerance::table(),
        LassoPath::table(),
        SparsestAnswer::table(),
        WeakForm::table(),
        GradingNumbers::table(),
    ]
}
