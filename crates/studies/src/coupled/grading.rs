//! Weights that grow with a term's grade: κ to the sum of its factors' grades.
//!
//! In: factors. Out: weights, of which that of a product is the product. Reads no data.

use sidc_testing::plants::coupled::Factor;

/// How much the factors of a term count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grading {
    /// κ; 1 is the plain norm.
    pub base: f64,
    /// Of a sine or cosine.
    pub wave: f64,
    /// Of an acceleration.
    pub acceleration: f64,
    /// Of a factor's second power beyond that of its first: 1 is the degree, 0 counts distinct factors.
    pub square: f64,
}

const fn degree(base: f64) -> Grading {
    Grading {
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

const fn accelerations(base: f64, acceleration: f64) -> Grading {
    Grading {
        acceleration,
        ..degree(base)
    }
}

/// What is compared.
pub const GRADINGS: &[Grading] = &[
    degree(1.0),
    degree(1.05),
    degree(1.1),
    degree(1.2),
    degree(1.5),
    degree(2.0),
    degree(3.0),
    waves(1.2, 0.25),
    waves(1.5, 0.25),
    waves(2.0, 0.25),
    waves(1.2, 0.5),
    waves(1.5, 0.5),
    waves(2.0, 0.5),
    waves(3.0, 0.5),
    waves(1.2, 0.0),
    waves(1.5, 0.0),
    waves(2.0, 0.0),
    waves(1.2, 2.0),
    accelerations(1.2, 0.0),
    accelerations(1.5, 0.0),
    accelerations(1.2, 2.0),
    accelerations(1.5, 2.0),
    Grading {
        square: 0.0,
        ..degree(1.2)
    },
    Grading {
        square: 0.0,
        ..degree(1.5)
    },
    Grading {
        square: 2.0,
        ..degree(1.2)
    },
    Grading {
        wave: 0.5,
        acceleration: 0.5,
        ..degree(1.5)
    },
    Grading {
        wave: 0.5,
        acceleration: 0.0,
        ..degree(1.5)
    },
];

impl Grading {
    /// κ to the grade of a factor's power.
    pub fn weight(&self, factor: Factor, power: usize) -> f64 {
        let grade = match factor {
            Factor::Sin(_) | Factor::Cos(_) => self.wave,
            Factor::Acceleration(_) => self.acceleration,
            _ => 1.0,
        };
        let times = match power {
            0 => 0.0,
            n => 1.0 + self.square * (n - 1) as f64,
        };
        self.base.powf(grade * times)
    }

    pub fn name(&self) -> String {
        format!(
            "k{} w{} a{} s{}",
            self.base, self.wave, self.acceleration, self.square
        )
    }
}
