//! The likelihood linearised about a point: states eliminated, rows in the coefficients left.
//!
//! In: a problem and a point. Out: the quadratic form of all columns, or their rows. Chooses no terms.

use sidc_progress::Observer;
use std::ops::Range;

use super::sweep::Sweep;
use crate::trajectory::integration::{CompiledLaws, Diverged, Workspace};
use crate::trajectory::least_squares::{InformationFilter, NormalEquations, RowSink};
use crate::trajectory::model::{LinearizationPoint, Problem, Record, segments};
use sidc_solve::QuadraticForm;

impl Problem {
    /// The quadratic form of all columns about a point, on all samples. On a part of them, scaled up, gains by chance would be scaled up too,
    /// and supports fitted for nothing.
    ///
    /// # Errors
    /// The laws diverge from there, or the work was cancelled.
    pub(crate) fn quadratic_form(
        &self,
        at: &LinearizationPoint,
        observer: &mut dyn Observer,
    ) -> Result<QuadraticForm, Diverged> {
        let products = self.products(at, &self.whole(), observer)?;
        Ok(QuadraticForm::new(&products, self.all.outputs()))
    }

    /// The same on segments of long records, with its normal equations, the right side last.
    ///
    /// # Errors
    /// As above.
    pub(crate) fn quadratic_and_products(
        &self,
        at: &LinearizationPoint,
        observer: &mut dyn Observer,
    ) -> Result<(QuadraticForm, Vec<f64>), Diverged> {
        let lengths: Vec<usize> = self.records.iter().map(Record::len).collect();
        let parts = segments(&lengths);
        let mut products = self.products(at, &parts, observer)?;
        let used: usize = parts.iter().map(|(_, s)| s.len()).sum();
        let share = self.samples() as f64 / used as f64;
        // Segments stand for all samples.
        products.iter_mut().for_each(|x| *x *= share);
        Ok((QuadraticForm::new(&products, self.all.outputs()), products))
    }

    /// Products of all columns and of the right side about a point, on parts of the records.
    fn products(
        &self,
        at: &LinearizationPoint,
        parts: &[(usize, Range<usize>)],
        observer: &mut dyn Observer,
    ) -> Result<Vec<f64>, Diverged> {
        let mut normal_equations = NormalEquations::new(self.all.outputs());
        self.linearise(at, parts, &mut normal_equations, observer)?;
        Ok(normal_equations.shifted(&at.active()))
    }

    /// All samples of all records.
    pub(super) fn whole(&self) -> Vec<(usize, Range<usize>)> {
        let whole = self.records.iter().map(|r| 0..r.len());
        whole.enumerate().collect()
    }

    /// Rows of all columns about a point, on parts of the records. The unknowns are corrections of the coefficients.
    ///
    /// # Errors
    /// As above.
    pub(crate) fn linearise(
        &self,
        at: &LinearizationPoint,
        parts: &[(usize, Range<usize>)],
        sink: &mut impl RowSink,
        observer: &mut dyn Observer,
    ) -> Result<(), Diverged> {
        let code = CompiledLaws::new(&self.system, &at.support);
        let columns = code.columns(&self.system, &self.all);
        let all = Some((&*columns, &self.ranges[..]));
        if at.process.is_some() {
            self.filter_parts((&code, all), at, parts, (sink, &mut |_| {}), observer)?;
            return Ok(());
        }
        let mut work = Workspace::default();
        for (r, samples) in parts {
            let sweep = Sweep::new(self, (&code, all), at, (*r, samples.start));
            let mut filter = InformationFilter::new(sweep.stiffness(), sink, None);
            let last = samples.end - 1;
            sweep.advance(&mut filter, samples.start..last, &mut work, observer)?;
            sweep.read(&mut filter, last);
        }
        Ok(())
    }
}
