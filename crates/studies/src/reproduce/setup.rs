//! A library for a plant with known law, and the comparison of answers with the law.
//!
//! In: a model's text and the law. Out: regressions on rows, and judged answers. Uses only the public interface of the compiler.

use sidc::pipeline::{Program, Regression};
use sidc_discover::split;
use sidc_progress::Unwatched;
use sidc_solve::{SOLVERS, Solution};

use super::Fault;
use super::record::Record;
use sidc_testing::plants::cart_pendulum::{self, Plant};

/// Largest relative error of a coefficient, and largest share of a false term, in an exact answer.
pub const EXACT: f64 = 1e-8;

const DECLARED: &str = "state y, theta : order 2\ninput F : hold\n";

/// One equation to find.
pub struct Law {
    pub target: &'static str,
    /// Number of terms in the library, without empty slots.
    pub terms: usize,
    pub truth: Vec<True>,
}

/// A term of the law; no column if the library lacks it.
pub struct True {
    pub name: &'static str,
    pub column: Option<usize>,
    pub coefficient: f64,
}

pub struct Setup {
    pub program: Program,
    pub laws: Vec<Law>,
}

impl Setup {
    /// # Errors
    /// A model that does not compile, or a law with a term that its library lacks.
    pub fn new(
        model: &str,
        laws: impl IntoIterator<Item = cart_pendulum::Law>,
    ) -> Result<Setup, Fault> {
        let setup = Setup::incomplete(model, laws)?;
        for law in &setup.laws {
            if let Some(t) = law.truth.iter().find(|t| t.column.is_none()) {
                return Err(format!("the library of {} has no {}", law.target, t.name).into());
            }
        }
        Ok(setup)
    }

    /// As [`Setup::new`], for a library that may lack some of the law's terms.
    pub fn incomplete(
        model: &str,
        laws: impl IntoIterator<Item = cart_pendulum::Law>,
    ) -> Result<Setup, Fault> {
        let program = Program::compile("reproduce.sid", model)?;
        let law = |(target, terms): cart_pendulum::Law| {
            let library = program.library(target)?;
            let names: Vec<&str> = terms.iter().map(|(name, _)| *name).collect();
            let columns = program.slots(target, &names);
            let named = terms.into_iter().zip(columns);
            let truth = named.map(|((name, coefficient), column)| True {
                name,
                column,
                coefficient,
            });
            Some(Law {
                target,
                terms: library.len(),
                truth: truth.collect(),
            })
        };
        let laws = laws.into_iter().filter_map(law).collect();
        Ok(Setup { program, laws })
    }

    /// The cart-pendulum with these libraries for ÿ and θ̈, which may lack terms.
    pub fn cart(ddy: &str, ddtheta: &str) -> Result<Setup, Fault> {
        let model = format!("{DECLARED}ddy ~ {ddy}\nddtheta ~ {ddtheta}\n");
        Setup::incomplete(&model, Plant::default().laws())
    }

    /// The models of the gallery, with 768 or 6,561 terms.
    pub fn thesis(terms: usize) -> Result<Setup, Fault> {
        let model = match terms {
            768 => include_str!("../../../../models/pendulum_768.sid"),
            _ => include_str!("../../../../models/pendulum.sid"),
        };
        Setup::new(model, Plant::default().laws())
    }

    pub fn regression(&self, law: &Law, record: &Record) -> Result<Regression, Fault> {
        let columns: Vec<(&str, &[f64])> =
            record.columns.iter().map(|(n, v)| (*n, &v[..])).collect();
        let samples = self.program.samples(&record.time, &columns)?;
        Ok(self.program.regression(law.target, &samples)?)
    }

    /// Basis pursuit on the rows of a record, without a refit.
    pub fn pursue(&self, law: &Law, record: &Record) -> Result<Answer, Fault> {
        let regression = self.regression(law, record)?;
        let solution = SOLVERS[0].solve(&regression.problem(0.0), &mut Unwatched);
        Ok(Answer::of(law, &regression, &solution))
    }

    /// As [`Setup::pursue`], in the norms that `sidc identify` tries: the answer with fewest terms.
    pub fn pursue_graded(&self, law: &Law, record: &Record) -> Result<Answer, Fault> {
        let regression = self.regression(law, record)?;
        let library = self.program.library(law.target).ok_or("no library")?;
        let found = regression.proposals(library, 0.0, &mut Unwatched);
        let first = found.first().ok_or("no norm")?;
        Ok(Answer::of(law, &regression, &first.solution))
    }
}

/// Rows drawn at random.
pub fn draw(record: &Record, rows: usize, seed: u64) -> Record {
    record.pick(&split(record.len(), 1, Some(rows), seed).used)
}

/// A solution compared with the law.
#[derive(Clone, Debug)]
pub struct Answer {
    /// Those of the true terms, in the order of the law.
    pub coefficients: Vec<f64>,
    /// Their largest relative error.
    pub error: f64,
    /// Largest contribution |a|‖φ‖ of a false term, relative to the largest of a true one.
    pub wrong: f64,
    /// Squared error of the coefficients, averaged over all terms of the library.
    pub mean_square: f64,
    /// Whether the true terms have the largest contributions.
    pub ranked: bool,
}

impl Answer {
    pub fn of(law: &Law, regression: &Regression, solution: &Solution) -> Answer {
        let columns: Vec<usize> = law.truth.iter().filter_map(|t| t.column).collect();
        let found = |t: &True| t.column.map_or(0.0, |j| solution.coefficient(j));
        let coefficients: Vec<f64> = law.truth.iter().map(found).collect();
        let pairs = || law.truth.iter().zip(&coefficients);
        let error = pairs().map(|(t, a)| ((a - t.coefficient) / t.coefficient).abs());
        let shares: Vec<f64> = columns
            .iter()
            .map(|j| solution.coefficient(*j).abs() * regression.dictionary.norm(*j))
            .collect();
        let largest = shares.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        let least = shares.iter().copied().fold(f64::INFINITY, f64::min);
        let others = || {
            solution
                .coefficients
                .iter()
                .filter(|(j, _)| !columns.contains(j))
        };
        let wrong = others()
            .map(|(j, a)| a.abs() * regression.dictionary.norm(*j))
            .fold(0.0, f64::max);
        let squares = pairs()
            .map(|(t, a)| (a - t.coefficient).powi(2))
            .sum::<f64>();
        Answer {
            error: error.fold(0.0, f64::max),
            wrong: wrong / largest,
            mean_square: (squares + others().map(|(_, a)| a * a).sum::<f64>()) / law.terms as f64,
            ranked: columns.len() == law.truth.len() && least > wrong,
            coefficients,
        }
    }

    /// Whether it is the law and nothing else, with every coefficient to 1e-8.
    pub fn exact(&self) -> bool {
        self.error <= EXACT && self.wrong <= EXACT
    }
}
