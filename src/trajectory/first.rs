//! The first linearisation as a problem of least squares: all columns about the smooth curves, before anything is fitted.
//!
//! In: a problem, the noise of its sensors. Out: a quadratic form of all columns, or a sketch of it where they are too many. Chooses
//! nothing.

use super::chain::links;
use super::flow::BLOCK;
use super::guide::GoOn;
use super::moments::Moments;
use super::problem::Problem;
use super::sketch::{Sketch, Sketched};
use super::sweep::{Gather, Sweep};
use crate::solve::quadratic::Quadratic;

impl Problem {
    /// The quadratic form of all columns about the smooth curves, laws taken to answer to nothing but their chains; `slack` is
    /// their noise a sample in units of the sensors'.
    ///
    /// `None` if it was given up.
    pub(super) fn first_form(&self, sigma: &[f64], slack: f64, go_on: GoOn) -> Option<Quadratic> {
        let mut moments = Moments::new(self.all.outputs());
        self.first_rows((sigma, slack), &mut moments, go_on)?;
        Some(Quadratic::new(&moments.shifted(&[]), self.all.outputs()))
    }

    fn first_rows(
        &self,
        (sigma, slack): (&[f64], f64),
        gather: &mut impl Gather,
        go_on: GoOn,
    ) -> Option<()> {
        for (r, (record, curve)) in self.records.iter().zip(&self.curves).enumerate() {
            let sigma = &sigma[self.sensors.of(r)];
            let stiffness: Vec<f64> = sigma.iter().map(|s| 1.0 / (slack * s)).collect();
            let mut sweep = Sweep::new(&stiffness, gather, false);
            links(self, record, curve, &mut |k, link| {
                sweep.measure(&self.readings_at(record, &curve.states, sigma, k));
                if let Some(link) = link {
                    sweep.advance(&link);
                }
                k % BLOCK > 0 || go_on()
            })?;
            sweep.end();
        }
        Some(())
    }

    /// A sketch of the first linearisation: `rows` rows on all columns, whitened, for libraries too large for a form. `None` if it
    /// was given up.
    pub fn sketch(
        &self,
        slack: f64,
        rows: usize,
        go_on: &mut dyn FnMut() -> bool,
    ) -> Option<Sketched> {
        let mut sketch = Sketch::new(self.all.outputs(), rows);
        self.first_rows((&self.noise, slack), &mut sketch, go_on)?;
        Some(sketch.end())
    }
}
