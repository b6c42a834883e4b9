//! Limits of the language: how large a model, a library or a message may become.
//!
//! Out: one family for each subject, and all of them as tables for the documentation. Sizes of buffers are not here: they stay
//! beside their loops.

use sidc_thresholds::{Table, family};

family! {
    /// Limits of a model's text. They are checked before the work they bound, so that no input takes the machine's memory or stack.
    pub(crate) MODEL: ModelLimits {
        /// Brackets inside brackets, and minus signs in a row: the recursive parser must survive them.
        nesting: usize = 128, unit "levels", source "set by hand; deeper texts are refused unread: cargo test -p sidc-cli --test it hostile";
        /// Depth of an expression with every `let` written out: recursive passes must survive it.
        depth: usize = 300, unit "levels", source "set by hand; deeper texts are refused unread: cargo test -p sidc-cli --test it hostile";
        /// Nodes of one statement with every `let` written out.
        statement_nodes: usize = 500_000, unit "nodes", source "a library of 10^5 listed terms of five nodes fits";
        /// Nodes of a whole model, ranges and copies for several targets included.
        model_nodes: usize = 2_000_000, unit "nodes", source "four of the largest statements, some 500 MB; without it 1,134 bytes took 1.9 GB: cargo +nightly fuzz run language (docs/robustness.md)";
        /// Reach of an unknown constant without a range, on each side of 1.
        decades: f64 = 4.5, unit "decades", source "set by hand: constants in the units of their plants; a range says more";
        /// Variables that a model declares.
        variables: usize = 10_000, unit "variables", source "set by hand; at most 65,535, the range of a variable's number";
        /// Highest derivative of a variable.
        order: u8 = 9, unit "", source "set by hand";
        /// Names that one range `x1..xN` stands for.
        range: usize = 10_000, unit "names", source "set by hand: one range can declare every variable of a model";
        /// Files that one model includes.
        included: usize = 64, unit "files", source "set by hand";
        /// Factors of one product: its normal form is sorted at each factor.
        factors: usize = 1_000, unit "factors", source "set by hand";
        /// Differences of libraries in one sum, and libraries in one product: each nests the result one level deeper.
        chain: usize = 200, unit "operators", source "set by hand, below the limit of depth";
        /// Single terms and libraries in one product.
        chain_terms: usize = 1_000, unit "factors", source "set by hand: as many as factors of one product";
        /// Operands of one sum or product in a data block: each nests the result one level deeper.
        column_chain: usize = 200, unit "operands", source "set by hand, below the limit of depth";
        /// Samples that `lag` looks back.
        lag: f64 = 1e6, unit "samples", source "set by hand";
        /// Symmetries of a model.
        symmetries: usize = 64, unit "symmetries", source "each is one bit of a 64-bit word";
        /// Conditions at which states jump: each is a guard that every step is searched for.
        resets: usize = 100, unit "conditions", source "set by hand: a plant has a few";
        /// Constraints of a model: they are compared with each other before any data are read.
        constraints: usize = 1_000, unit "relations", source "set by hand; 4,990 judged together took more than 200 s (docs/robustness.md)";
        /// Largest bound that `limit degree` takes.
        degree: f64 = 1e6, unit "", source "set by hand; sums of such degrees in millionths fit 64 bits";
    }
}

family! {
    /// How much is shown when a model has mistakes.
    pub(crate) MESSAGES: MessageLimits {
        /// Width at which notes and help are wrapped.
        width: usize = 110, unit "characters", source "set by hand";
        /// Findings of one severity that are shown; the others are counted.
        findings: usize = 50, unit "findings", source "set by hand: a file with more has one mistake made many times";
        /// Longest text of a message that is shown whole; names from files have any length.
        text: usize = 4_000, unit "characters", source "set by hand";
        /// Longest source line that is shown whole.
        line: usize = 300, unit "bytes", source "three lines of a terminal";
        /// What is shown of a long line before a marked place.
        before_place: usize = 60, unit "bytes", source "set by hand";
        /// What is shown of a long marked place itself.
        place: usize = 100, unit "bytes", source "a line of a terminal";
        /// What is shown of a long line behind a marked place.
        after_place: usize = 40, unit "bytes", source "with what stands before, the place is in the middle of two lines";
        /// Unknown names that are reported: each costs a search among all names.
        unknown_names: usize = 40, unit "names", source "set by hand: beyond, the model has one mistake and not hundreds";
        /// Sums and arguments with wrong units that are reported.
        unit_faults: usize = 20, unit "findings", source "set by hand: beyond, one unit is wrong and not all of these sums";
        /// Operands that are repeated in a suggested unit fix, together.
        unit_fix: usize = 40, unit "bytes", source "set by hand";
        /// Names in scope that are listed for an unknown name.
        scope_names: usize = 24, unit "names", source "set by hand";
        /// Names of states or of a symmetry that are listed in a note.
        listed_names: usize = 8, unit "names", source "set by hand";
        /// Names that an example equation mentions.
        example_names: usize = 6, unit "names", source "set by hand";
        /// Characters of an index in brackets that is recognised as one, as in `x[k+1]`.
        index: usize = 40, unit "characters", source "set by hand: no line is read again and again";
    }
}

family! {
    /// How near a wrong name is to the one that is offered for it.
    pub(crate) SPELLING: SpellingTolerance {
        /// Edits (insertion, deletion, substitution, transposition: Damerau 1964) forgiven in a name of any length.
        edits: usize = 1, unit "edits", source "Damerau 1964: four of five misspellings are one edit";
        /// Characters for which one more edit is forgiven.
        characters_per_edit: usize = 4, unit "characters", source "set by hand";
        /// Shortest written-out unit name in which one edit is forgiven.
        unit_name: usize = 5, unit "letters", source "set by hand";
    }
}

/// Bytes that the libraries of a model may take by default. A `const`, so that callers may use it in constants.
pub const MEMORY: u64 = 4_000_000_000;

family! {
    /// Sizes at which sets of terms are refused, listed or kept as products.
    pub(crate) LIBRARY: LibraryLimits {
        /// Terms of one list: of factors that share atoms, or of a generator that does not factor.
        listed_terms: u128 = 200_000, unit "terms", source "set by hand";
        /// Weight of each power of a factor that `prefer degree` and graded norms penalize.
        penalty: f64 = 1e5, unit "", source "more than coefficients of laws differ, little enough for the arithmetic of the solver";
        /// Products that a set may fall into.
        products: usize = 10_000, unit "products", source "set by hand";
        /// Memory of all libraries of a model, if nothing else is said.
        memory: u64 = MEMORY, unit "bytes", source "set by hand";
        /// Sets up to this size become one list, in order of degree. Tests take the ways of large sets with small ones.
        small_set: u128 = if cfg!(test) { 12 } else { 1_000 }, unit "terms", source "set by hand: a dictionary of a thousand columns costs little to store";
        /// Blocks with fewer slots are listed term by term: calling them would cost more than storing their columns.
        small_block: usize = if cfg!(test) { 6 } else { 256 }, unit "slots", source "set by hand";
        /// Intersections that inclusion and exclusion looks at, about a tenth of a second.
        intersections: usize = 50_000, unit "steps", source "set by hand for its time; not measured again";
        /// Terms among which an intersection of two products is searched.
        search: u128 = 2_000_000, unit "terms", source "set by hand";
        /// Pairs of degrees that one histogram adds up, about half a second.
        degree_pairs: usize = 30_000_000, unit "pairs", source "set by hand for its time; not measured again";
        /// Pairs of products that are searched for cos² + sin² = 1, about a tenth of a second.
        identity_pairs: usize = 50_000, unit "pairs", source "set by hand for its time; not measured again";
        /// Terms of lists that are searched for cos² + sin² = 1, about a second.
        identity_terms: usize = 1_000_000, unit "terms", source "set by hand for its time; not measured again";
        /// Terms of an equation that are required.
        required_terms: usize = 100, unit "terms", source "set by hand: a search with so many fixed terms has little left to find";
        /// Largest whole number that a generator takes.
        generator_number: f64 = 1e6, unit "", source "set by hand: far beyond any use, far below overflow";
    }
}

family! {
    /// Which texts are units, and which units are the same.
    pub(crate) UNITS: UnitLimits {
        /// Longest text of a unit.
        text: usize = 200, unit "bytes", source "all base units with exponents take some 40";
        /// Brackets inside brackets.
        nesting: usize = 16, unit "levels", source "no unit is written with more than two or three; the parser is recursive";
        /// Largest exponent and largest denominator of one.
        exponent: i32 = 100, unit "", source "set by hand: no law of physics comes near";
        /// Distance from a fraction within which a float stands for it, times the largest exponent.
        fraction: f64 = 1e-12, unit "", source "set by hand, above the rounding of one division and one product";
        /// Difference of decimal logarithms within which two scales are one.
        scale: f64 = 1e-9, unit "decades", source "set by hand, above the rounding of sums of logarithms";
    }
}

/// Every family of this crate, for the documentation.
pub fn tables() -> Vec<Table> {
    vec![
        ModelLimits::table(),
        MessageLimits::table(),
        SpellingTolerance::table(),
        LibraryLimits::table(),
        UnitLimits::table(),
    ]
}
