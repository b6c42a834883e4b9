//! Equation discovery as a library: a model's text and arrays in memory → differential equations with evidence.
//!
//! ```
//! use sidc::{Data, Model, Options};
//!
//! // A decay, ẋ = −0.5 x, measured every tenth of a second.
//! let t: Vec<f64> = (0..60).map(|k| 0.1 * f64::from(k)).collect();
//! let x: Vec<f64> = t.iter().map(|t| 2.0 * (-0.5 * t).exp()).collect();
//!
//! let model = Model::parse("state x\ndx ~ poly(x; 3)\n")?;
//! let data = Data::new().run([("t", &t[..]), ("x", &x[..])])?;
//! let discovery = model.identify(&data, &Options::default())?;
//!
//! let terms = &discovery.equations()[0].terms;
//! assert_eq!((terms.len(), terms[0].term.as_str()), (1, "x"));
//! assert!((terms[0].coefficient + 0.5).abs() < 1e-6);
//! # Ok::<(), sidc::Error>(())
//! ```
//!
//! [`Model`] is what you know, [`Data`] what you measured, [`Options`] how to search, and [`Discovery`] what was found: the equations, whether they pass,
//! free runs along other data, code in several languages, and the result document through serde. [`Error`] is the only error type. An [`Observer`] follows
//! the work and may end it. docs/stability.md says which parts of this interface are stable.
//!
//! [`pipeline`] holds the single stages, for the command line and for studies; it may change with every version.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

mod budget;
mod data;
mod discovery;
mod error;
mod identify;
mod model;
mod options;
pub mod pipeline;
mod prediction;
mod records;
mod reduced;
mod report;
mod right_side;
mod simulation;
mod target;

pub use budget::Budget;
pub use data::Data;
pub use discovery::Discovery;
pub use error::{Error, ErrorKind};
pub use model::Model;
pub use options::Options;
pub use reduced::Reduced;
pub use right_side::RightSide;
pub use simulation::{Score, SimulatedRun, Simulation};
pub use target::Target;

pub use sidc_data::HoldOutRange;
pub use sidc_discover::Method;
pub use sidc_progress::{Activity, Observer, SolverProgress, Stage, Stop, Unwatched};
pub use sidc_system::discovery::{Evidence, Mark, Notice, Reason, ReasonCode, RowOrigin, Status};
pub use sidc_system::predict::{AheadFigures, ErrorFigures, Prediction, SignalPrediction};
pub use sidc_system::result::{
    EquationEntry as Equation, FailedEntry as Failed, TermEntry as Term,
};
pub use sidc_system::validate::Validation;
pub use sidc_system::verdict::{LawVerdict, RunStatus, RunVerdict, Verdict};
