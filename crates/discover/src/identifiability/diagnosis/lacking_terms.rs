//! Standard terms that a library lacks, and how much of a residual each explains.
//!
//! In: the residual of a fit on weighted rows. Out: terms with their gains, the simplest first. Judges nothing.

use crate::dictionary::evaluate;
use crate::identifiability::thresholds::MISSPECIFICATION;
use crate::scaled_design::OrthonormalBasis;
use crate::standard_terms::{calls, has_unit, standard_terms};
use crate::statistics::norm;
use sidc_data::Samples;
use sidc_lang::library::Library;
use sidc_lang::model::Model;
use sidc_lang::term::{Signal, Term, VarId};
use sidc_solve::simd::dot;

/// What a fit leaves of its target.
pub(super) struct Residual<'a> {
    pub model: &'a Model,
    pub target: Signal,
    pub library: &'a Library,
    pub samples: &'a Samples,
    pub weights: &'a [f64],
    /// Of the columns that were fitted.
    pub basis: &'a OrthonormalBasis,
    /// Weighted.
    pub values: &'a [f64],
}

impl Residual<'_> {
    /// Each standard term that the library lacks, with the square that it takes off the residual's. Terms of which less than
    /// `dependent` of the squared length is off the span of the fitted columns are left out.
    pub fn gains(&self, dependent: f64) -> impl Iterator<Item = (f64, Term)> {
        let all = standard_terms_of(self.model, self.target, self.samples).into_iter();
        let lacking = all.filter(|t| self.library.contains(t).is_none());
        lacking.filter_map(move |term| Some((self.gain(&term, dependent)?, term)))
    }

    fn gain(&self, term: &Term, dependent: f64) -> Option<f64> {
        let values = evaluate(term, self.samples);
        let weighted: Vec<f64> = values
            .iter()
            .zip(self.weights)
            .map(|(v, w)| v * w)
            .collect();
        let length = norm(&weighted);
        if !length.is_finite() || length == 0.0 {
            return None;
        }
        // Of unit length, so that no square overflows.
        let unit: Vec<f64> = weighted.iter().map(|v| v / length).collect();
        let outside = self.basis.residual(&unit);
        let room = dot(&outside, &outside);
        (room >= dependent).then(|| dot(&outside, self.values).powi(2) / room)
    }
}

/// Standard terms of the measured signals, the simplest first.
fn standard_terms_of(model: &Model, target: Signal, samples: &Samples) -> Vec<Term> {
    let usable = |s: &Signal| {
        let of_target = s.var == target.var && s.der >= target.der && s.shift >= target.shift;
        // The rate of another state is what its own equation is for.
        let other_rate = s.der > 0 && s.der == target.der && s.var != target.var;
        s.var != VarId::TIME && !of_target && !other_rate && s.shift <= 0 && s.der < 2
    };
    let measured = samples.columns.iter().map(|c| c.signal).filter(usable);
    let measured: Vec<Signal> = measured.take(MISSPECIFICATION.signals).collect();
    let mut all = standard_terms(&measured, &|s| has_unit(model, s));
    all.extend(inertia(model, target, samples, &measured));
    all
}

/// The accelerations of other coordinates, by which coupled bodies act on each other, alone and times the sine or cosine of a coordinate.
fn inertia(model: &Model, target: Signal, samples: &Samples, signals: &[Signal]) -> Vec<Term> {
    let of_another = |s: &Signal| s.der == 2 && target.der == 2 && s.var != target.var;
    let measured = samples.columns.iter().map(|c| c.signal);
    let coordinates: Vec<Signal> = signals.iter().copied().filter(|s| s.der == 0).collect();
    let mut factors = vec![Term::one()];
    factors.extend(calls(&["sin", "cos"], &coordinates, &|s| {
        has_unit(model, s)
    }));
    let products = |s: Signal| factors.iter().map(move |f| Term::signal(s).mul(f));
    measured.filter(of_another).flat_map(products).collect()
}
