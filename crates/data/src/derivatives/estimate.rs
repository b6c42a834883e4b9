//! What differentiation returns: a derivative with its standard error.

/// The caller asked the work to end; there is no estimate.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stopped;

/// A derivative at every sample; NaN outside the segments, and where a segment has too few samples.
#[derive(Clone, Debug)]
pub(crate) struct Estimate {
    pub values: Vec<f64>,
    /// Standard error of each value, for noise and truncation together.
    pub error: Vec<f64>,
    /// The local polynomial used most.
    pub points: usize,
    pub degree: usize,
}

impl Estimate {
    /// Rows over which errors are alike. Interpolating windows share nearly all samples and their truncation error; wider ones
    /// average the noise over about half a window per coefficient.
    pub(crate) fn correlation(&self) -> f64 {
        if self.points <= self.degree + 1 {
            self.points.clamp(1, 9) as f64
        } else {
            2.0 * self.points as f64 / (self.degree + 1) as f64
        }
    }
}
