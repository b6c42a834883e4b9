//! Candidate terms: expressions of signals in one normal form.
//!
//! In: names already resolved to [`Signal`]s. Out: [`Expr`]s and [`Term`]s that can be compared, merged, printed, differentiated and
//! evaluated. Knows nothing of files, data tables or solvers. `expr.rs` and `function.rs` use each other, because the derivative of a
//! function is an expression and an expression calls functions; no other files depend on each other in circles.

mod derivative;
mod evaluate;
mod expr;
mod function;
mod parity;
mod pretty_print;
mod signal;
mod substitute;
mod symbolic_power;
mod total_order;

pub use evaluate::{Graph, Node, PointTape, Tape};
pub use expr::power;
pub use expr::{Atom, Expr, Term};
pub use function::{FUNCTIONS, Func, Function, Smoothness, Symmetry, UnitRule};
pub use parity::Parity;
pub use pretty_print::{Language, Notation, Precedence, write_expr, write_term};
pub use signal::{Signal, SignalNames, VarId};
