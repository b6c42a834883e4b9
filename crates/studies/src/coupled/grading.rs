//! Weights that grow with a term's grade: κ to the sum of its factors' grades.
//!
//! In: factors, and their values on the rows. Out: weights; the weight of a product is the product of the weights.

use sidc_testing::plants::coupled::Factor;

/// What a factor's grade is based on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Measure {
    /// Its kind alone
    Kind,
    /// Standard deviation over root mean square, to a power: 0 of a factor that stays the same, 1 of one about zero
    Deviation(f64),
    /// The logarithm of the largest magnitude over the root mean square
    Crest,
}

/// How much the factors of a term count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grading {
    pub measure: Measure,
    /// κ; 1 is the plain norm.
    pub base: f64,
    /// The grade of a sine or cosine.
    pub wave: f64,
    /// The grade of an acceleration.
    pub acceleration: f64,
    /// The grade of a factor's second power beyond the first: with 1 the grade is the degree, with 0 it counts distinct factors.
    pub square: f64,
}

/// The grade is the degree.
pub const fn degree(base: f64) -> Grading {
    Grading {
        measure: Measure::Kind,
        base,
        wave: 1.0,
        acceleration: 1.0,
        square: 1.0,
    }
}

const fn waves(base: f64, wave: f64) -> Grading {
    Grading {
        wave,
        ..degree(base)
    }
}

/// The grade measures how much factors vary, as in `sidc identify`.
pub const fn variation(base: f64) -> Grading {
    of(Measure::Deviation(1.0), base)
}

const fn of(measure: Measure, base: f64) -> Grading {
    Grading {
        measure,
        ..degree(base)
    }
}

const fn accelerations(base: f64, acceleration: f64) -> Grading {
    Grading {
        acceleration,
        ..variation(base)
    }
}

const fn distinct(base: f64) -> Grading {
    Grading {
        square: 0.0,
        ..variation(base)
    }
}

/// The gradings that are compared, with names.
pub const GRADINGS: &[(&str, Grading)] = &[
    ("plain", degree(1.0)),
    ("degree 1.2", degree(1.2)),
    ("degree 1.5", degree(1.5)),
    ("waves half 1.5", waves(1.5, 0.5)),
    ("waves nothing 1.2", waves(1.2, 0.0)),
    ("variation 1.25", variation(1.25)),
    ("variation 1.5", variation(1.5)),
    ("variation 1.75", variation(1.75)),
    ("variation 2", variation(2.0)),
    ("variation 3", variation(3.0)),
    ("variation 4", variation(4.0)),
    ("variation squared 1.5", of(Measure::Deviation(2.0), 1.5)),
    (
        "variation, accelerations double 1.5",
        accelerations(1.5, 2.0),
    ),
    ("variation, distinct factors 1.5", distinct(1.5)),
    // κ = e^0.5: the crest factor to the power of a half.
    ("crest 1.649", of(Measure::Crest, 1.649)),
];

impl Grading {
    /// κ to the grade of a factor's power.
    pub fn weight(&self, factor: Factor, power: usize, values: &[f64]) -> f64 {
        let kind = match factor {
            Factor::Sin(_) | Factor::Cos(_) => self.wave,
            Factor::Acceleration(_) => self.acceleration,
            _ => 1.0,
        };
        let times = match power {
            0 => 0.0,
            n => 1.0 + self.square * (n - 1) as f64,
        };
        self.base.powf(kind * times * self.measure.of(values))
    }
}

impl Measure {
    fn of(self, values: &[f64]) -> f64 {
        let count = values.len().max(1) as f64;
        let mean = values.iter().sum::<f64>() / count;
        let square = values.iter().map(|x| x * x).sum::<f64>() / count;
        if square == 0.0 {
            return 0.0;
        }
        let variance = (1.0 - mean * mean / square).max(0.0);
        let largest = values.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        match self {
            Measure::Kind => 1.0,
            Measure::Deviation(power) => variance.sqrt().powf(power),
            Measure::Crest => (largest / square.sqrt()).ln(),
        }
    }
}
