//! What the functions of a system compute, with their names and descriptions in code.

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// ẋ, or the next x.
    Rates,
    /// Derivatives of the rates by the state.
    Jacobian,
    /// Derivatives of the rates by the inputs.
    InputJacobian,
    Outputs,
    /// An equation jumps where one of these is zero.
    Guards,
    /// ẋ for given sides of all switches.
    RatesBySide,
    /// The rates ġ of the guards for given sides.
    GuardRates,
    /// The state after each jump, as if it happened here.
    Jumps,
}

impl Kind {
    /// The name of the function in code.
    pub fn name(self, discrete: bool) -> &'static str {
        match (self, discrete) {
            (Kind::Rates, false) => "derivatives",
            (Kind::Rates, true) => "next",
            (Kind::Jacobian, _) => "jacobian",
            (Kind::InputJacobian, _) => "jacobian_input",
            (Kind::Outputs, _) => "outputs",
            (Kind::Guards, _) => "guards",
            (Kind::RatesBySide, _) => "rates_by_side",
            (Kind::GuardRates, _) => "guard_rates",
            (Kind::Jumps, _) => "jumps",
        }
    }

    /// A sentence that describes the function.
    pub fn about(self, discrete: bool) -> &'static str {
        match (self, discrete) {
            (Kind::Rates, false) => "The time derivative of the state.",
            (Kind::Rates, true) => "The next state.",
            (Kind::Jacobian, false) => {
                "The partial derivatives of `derivatives` (rows) by the state (columns)."
            }
            (Kind::Jacobian, true) => {
                "The partial derivatives of `next` (rows) by the state (columns)."
            }
            (Kind::InputJacobian, false) => {
                "The partial derivatives of `derivatives` (rows) by the input (columns)."
            }
            (Kind::InputJacobian, true) => {
                "The partial derivatives of `next` (rows) by the input (columns)."
            }
            (Kind::Outputs, _) => "The outputs.",
            (Kind::Guards, _) => "Where each of these is zero, an equation jumps.",
            (Kind::RatesBySide, _) => {
                "The time derivative of the state with the sides of all guards given, -1 to 1."
            }
            (Kind::GuardRates, _) => "The rates of the guards with their sides given.",
            (Kind::Jumps, _) => "The state (columns) after each of its jumps (rows).",
        }
    }

    /// True if it takes the sides of all switches.
    pub fn takes_sides(self) -> bool {
        matches!(self, Kind::RatesBySide | Kind::GuardRates)
    }

    /// True if the result is a matrix.
    pub fn is_matrix(self) -> bool {
        matches!(self, Kind::Jacobian | Kind::InputJacobian | Kind::Jumps)
    }

    /// The name of a matrix in code.
    pub fn matrix_name(self) -> &'static str {
        if self == Kind::Jumps {
            "after"
        } else {
            "slope"
        }
    }
}
