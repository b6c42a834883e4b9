//! How to look for equations: the method, the solver, the rows and the limits.
//!
//! In: nothing. Out: the options of a discovery and their defaults. Never acts on them.

use sidc_lang::library;
use sidc_solve::{SOLVERS, Solver};

/// How equations are found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// The program's choice.
    #[default]
    Auto,
    /// Maximum likelihood of all equations together with their trajectory.
    Joint,
    /// Regression of derivatives, measured or estimated, at every instant.
    Regression,
    /// Regression of integrals against test functions, which never differentiates noise.
    Weak,
}

/// The values of `--method`.
pub const METHODS: &[(&str, Method)] = &[
    ("auto", Method::Auto),
    ("joint", Method::Joint),
    ("regression", Method::Regression),
    ("weak", Method::Weak),
];

impl Method {
    /// The name of the method; empty for [`Method::Auto`].
    pub fn chosen(self) -> &'static str {
        let chosen = METHODS.iter().filter(|_| self != Method::Auto);
        chosen
            .into_iter()
            .find(|(_, m)| *m == self)
            .map_or("", |(n, _)| n)
    }
}

/// Options of a discovery.
#[derive(Clone, Copy)]
pub struct Options {
    pub method: Method,
    pub solver: &'static dyn Solver,
    /// How many rows are drawn at random; the others are held out.
    pub samples: Option<usize>,
    /// Seed of that draw.
    pub seed: u64,
    /// Memory limit of the design matrix of one equation, in bytes.
    pub memory: u64,
    /// Whether the Lasso path of each equation is reported.
    pub path: bool,
    /// Whether outlying readings are left out.
    pub robust: bool,
    /// Whether the rank of each library is wanted: of a thousand columns it takes as long as all other evidence.
    pub ranks: bool,
    /// Whether the sparsest equation within ε is looked for and proved.
    pub sparsest: bool,
}

impl Options {
    /// Whether the program chooses the way: the user named none, and asked for nothing that only one of them has.
    pub fn chooses_way(&self) -> bool {
        self.method == Method::Auto && self.samples.is_none() && !self.path
    }
}

impl Default for Options {
    fn default() -> Self {
        Options {
            method: Method::Auto,
            solver: SOLVERS[0],
            samples: None,
            seed: 0,
            memory: library::MEMORY,
            path: false,
            robust: false,
            ranks: true,
            sparsest: false,
        }
    }
}
