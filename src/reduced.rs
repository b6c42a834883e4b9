//! Tables larger than memory: rows are reduced part by part, and equations fitted to all of them.

use serde::{Deserialize, Serialize};
use sidc_discover::Factor;
use sidc_progress::{Observer, Unwatched};

use crate::data::Data;
use crate::discovery::Discovery;
use crate::error::{Error, ErrorKind};
use crate::model::Model;
use crate::options::Options;
use crate::pipeline;

/// The rows of some parts of a table, reduced to what least squares needs: for each equation with N candidate terms the triangle R of [Φ y] = Q R, (N + 1)(N
/// + 2)/2 numbers. Parts may be reduced on different machines, in any order, and merged.
///
/// ```
/// use sidc::{Data, Model, Options};
///
/// let model = Model::parse("state x\ndx ~ powers(x; 3)\n")?;
/// let part = |from: i32| {
///     let t: Vec<f64> = (from..from + 500).map(|k| 0.01 * f64::from(k)).collect();
///     let x: Vec<f64> = t.iter().map(|t| 2.0 * (-0.5 * t).exp()).collect();
///     let dx: Vec<f64> = x.iter().map(|x| -0.5 * x).collect();
///     Data::new().run([("t", t), ("x", x), ("dx", dx)])
/// };
/// let mut all = model.reduce(&part(0)?, &Options::default())?;
/// all.merge(&model.reduce(&part(500)?, &Options::default())?)?;
/// let found = model.identify_reduced(&all, &part(0)?, &Options::default())?;
/// assert_eq!(all.rows(), 1000);
/// assert!((found.equations()[0].terms[0].coefficient + 0.5).abs() < 1e-12);
/// # Ok::<(), sidc::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Reduced {
    /// One per equation of the model; `None` if the model states it.
    factors: Vec<Option<Factor>>,
    parts: usize,
}

/// The form for transfer between machines.
#[derive(Serialize, Deserialize)]
struct Packed {
    parts: usize,
    factors: Vec<Option<PackedFactor>>,
}

#[derive(Serialize, Deserialize)]
struct PackedFactor {
    rows: usize,
    estimated: usize,
    terms: usize,
    upper: Vec<f64>,
}

impl Reduced {
    /// Adds the rows of other parts.
    ///
    /// # Errors
    /// [`ErrorKind::Data`]: the others were reduced under another model.
    pub fn merge(&mut self, other: &Reduced) -> Result<(), Error> {
        if !self.terms().eq(other.terms()) {
            return Err(other_model());
        }
        for (own, others) in self.factors.iter_mut().zip(&other.factors) {
            if let (Some(own), Some(others)) = (own, others) {
                own.merge(others);
            }
        }
        self.parts += other.parts;
        Ok(())
    }

    /// The largest number of rows of an equation.
    pub fn rows(&self) -> usize {
        let rows = self.factors.iter().flatten().map(Factor::rows);
        rows.max().unwrap_or(0)
    }

    /// The number of parts merged.
    pub fn parts(&self) -> usize {
        self.parts
    }

    /// As JSON text.
    ///
    /// # Errors
    /// [`ErrorKind::Internal`]: a bug in this program.
    pub fn to_json(&self) -> Result<String, Error> {
        let packed = |factor: &Factor| PackedFactor {
            rows: factor.rows(),
            estimated: factor.estimated(),
            terms: factor.terms(),
            upper: factor.packed(),
        };
        let factors = self.factors.iter().map(|f| f.as_ref().map(packed));
        let packed = Packed {
            parts: self.parts,
            factors: factors.collect(),
        };
        serde_json::to_string(&packed).map_err(|e| Error::new(ErrorKind::Internal, "internal", e))
    }

    /// Reads the text of [`Reduced::to_json`].
    ///
    /// # Errors
    /// [`ErrorKind::Data`]: not such a text.
    pub fn from_json(text: &str) -> Result<Reduced, Error> {
        let refuse = |why: String| {
            let text = format!(
                "these are no reduced rows: {why}\n  = help: give the text that sidc wrote, unchanged"
            );
            Error::new(ErrorKind::Data, "no-reduced-rows", text)
        };
        let packed: Packed = serde_json::from_str(text).map_err(|e| refuse(e.to_string()))?;
        let unpack = |packed: PackedFactor| {
            let factor =
                Factor::unpacked((packed.rows, packed.estimated), packed.terms, &packed.upper);
            factor.ok_or_else(|| refuse("a factor has numbers too many or too few".into()))
        };
        let factors = packed
            .factors
            .into_iter()
            .map(|f| f.map(unpack).transpose());
        Ok(Reduced {
            factors: factors.collect::<Result<_, _>>()?,
            parts: packed.parts,
        })
    }

    /// The number of candidate terms of each equation; `None` if the model states it.
    fn terms(&self) -> impl Iterator<Item = Option<usize>> {
        self.factors.iter().map(|f| f.as_ref().map(Factor::terms))
    }

    pub(crate) fn factors(&self) -> &[Option<Factor>] {
        &self.factors
    }
}

impl Model {
    /// Reduces the rows of one part of a table. Targets that were not measured are estimated from this part alone, so some rows at its ends are lost. Rows
    /// held out by the options are not reduced.
    ///
    /// # Errors
    /// [`ErrorKind::Model`]: hidden states, unknown constants, constraints, coefficients by run, or more than 400 terms for an equation, all of which need
    /// all rows at once. [`ErrorKind::Data`]: arrays that the model cannot read.
    pub fn reduce(&self, part: &Data, options: &Options) -> Result<Reduced, Error> {
        self.check_reducible()?;
        let mut sources = self.sources.clone();
        let options = regression(options);
        let program = &self.with_noise(&options.noise)?;
        let (measured, found) =
            pipeline::measure(program, part, &options, &mut sources, &mut Unwatched);
        let Some(measured) = measured else {
            return Err(Error::of(ErrorKind::Data, &found, &sources));
        };
        let factors = pipeline::reduce(program, &measured)
            .map_err(|found| Error::of(ErrorKind::Data, &found, &sources))?;
        Ok(Reduced { factors, parts: 1 })
    }

    /// Finds the equations of a table with reduced rows, by regression. Terms, doubts, predictions and runs come from the rows in `looked_at`, some stretches
    /// of the table; coefficients and standard errors come from all rows. It is a doubt if all rows prefer other terms, or coefficients outside their
    /// intervals. [`Options::verify`] has no effect, since the rows are no longer there.
    ///
    /// # Errors
    /// As [`Model::reduce`] and [`Model::identify`].
    pub fn identify_reduced(
        &self,
        reduced: &Reduced,
        looked_at: &Data,
        options: &Options,
    ) -> Result<Discovery, Error> {
        self.identify_reduced_watched(reduced, looked_at, options, &mut Unwatched)
    }

    /// Like [`Model::identify_reduced`], with an observer that may end the work.
    ///
    /// # Errors
    /// As [`Model::identify_reduced`].
    pub fn identify_reduced_watched(
        &self,
        reduced: &Reduced,
        looked_at: &Data,
        options: &Options,
        observer: &mut dyn Observer,
    ) -> Result<Discovery, Error> {
        self.check_reducible()?;
        let libraries = self.program.libraries.iter();
        if !libraries
            .map(|l| l.as_ref().map(|l| l.slots()))
            .eq(reduced.terms())
        {
            return Err(other_model());
        }
        self.searched(looked_at, &regression(options), Some(reduced), observer)
    }

    fn check_reducible(&self) -> Result<(), Error> {
        let program = &self.program;
        let checked = sidc_discover::check_reducible(&program.model, &program.libraries);
        checked.map_err(|why| {
            let text = format!(
                "the rows of a large table are reduced part by part, and here they cannot be: {why}\n  = help: identify a stretch of the table in memory"
            );
            Error::new(ErrorKind::Model, "not-reducible", text)
        })
    }
}

/// Reduced rows serve only regression.
fn regression(options: &Options) -> Options {
    options.clone().method(sidc_discover::Method::Regression)
}

fn other_model() -> Error {
    let text = "the rows were reduced under another model\n  = help: reduce every part under the model that is identified";
    Error::new(ErrorKind::Data, "other-model", text)
}
