//! The answer of a joint search, with what was corrected in the data.
//!
//! In: a problem, what was found. Out: how answers compare, and whether one leaves more than noise. Searches nothing.

use std::borrow::Cow;

use crate::doubts::trajectory_rules;
use crate::trajectory;
use crate::trajectory::{DelayedInputs, Fit, Found, InputLag, Problem, SensorOffset};

/// The corrected problem and the answer to it.
pub(crate) struct JointFit<'a> {
    pub problem: Cow<'a, Problem>,
    pub found: Found,
    /// Inputs that act later than recorded; in `problem` they are shifted.
    pub late: Option<DelayedInputs>,
    /// A lag of inputs that explains as much as their delay.
    pub lag: Option<InputLag>,
    /// An offset of a sensor that would explain terms.
    pub offset: Option<SensorOffset>,
    /// The answer to white noise, where one to noise that lasts was found to be better.
    pub white_noise_answer: Option<Box<JointFit<'a>>>,
}

impl<'a> JointFit<'a> {
    /// The same with a problem of its own.
    pub fn into_owned<'b>(self) -> JointFit<'b> {
        JointFit {
            problem: Cow::Owned(self.problem.into_owned()),
            found: self.found,
            late: self.late,
            lag: self.lag,
            offset: self.offset,
            white_noise_answer: self
                .white_noise_answer
                .map(|white| Box::new(white.into_owned())),
        }
    }

    pub fn new(
        problem: Cow<'a, Problem>,
        found: Found,
        late: Option<DelayedInputs>,
    ) -> JointFit<'a> {
        JointFit {
            problem,
            found,
            late,
            lag: None,
            offset: None,
            white_noise_answer: None,
        }
    }

    /// By how much the criterion prefers this to the answer for white noise on the same readings; each time constant of the noise is paid
    /// for as a term is.
    pub fn gain_over(&self, white: &JointFit) -> f64 {
        let value = |fit: &JointFit| fit.found.value_of_all_readings(&fit.problem);
        let constants = self.problem.estimated_memories() as f64;
        value(white)
            - value(self)
            - constants * trajectory::term_price(self.problem.measurements() as f64)
    }

    /// −2 log likelihood, without the price of its terms.
    pub fn misfit(&self) -> f64 {
        self.found.misfit(&self.problem)
    }
}

/// Whether a fit leaves more than the noise of a sensor.
pub(crate) fn unexplained(problem: &Problem, fit: &Fit) -> bool {
    let channels = trajectory::channels(problem, fit);
    channels.iter().any(trajectory_rules::unexplained)
}
