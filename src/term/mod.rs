//! Candidate terms: expressions of signals in one normal form.
//!
//! In: names already resolved to [`Signal`]s. Out: [`Expr`]s and [`Term`]s that compare, merge, print, differentiate and evaluate.
//! Knows nothing of files, data tables or solvers.

mod derivative;
mod expr;
mod function;
mod graph;
mod order;
mod parity;
mod print;
mod signal;
mod tape;

pub(crate) use expr::power;
pub use expr::{Atom, Expr, Term};
pub use function::{FUNCTIONS, Func, Function, Symmetry, UnitRule};
pub use graph::{Graph, Node};
pub use parity::Parity;
pub use print::{Language, Notation, Precedence, write_expr, write_term};
pub use signal::{Signal, SignalNames, VarId};
pub use tape::Tape;
