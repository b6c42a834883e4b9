//! Languages that equations are exported to.

use sidc_emit::TARGETS;

use crate::error::{Error, ErrorKind};

/// A language to export to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Target {
    /// As the terminal shows the equations.
    Text,
    Latex,
    Rust,
    C,
    CHeader,
    /// C in single precision.
    CFloat,
    CFloatHeader,
    /// Functions for `scipy.integrate.solve_ivp`.
    Python,
    Sympy,
    /// MATLAB and Octave.
    Matlab,
    Jax,
    Casadi,
    /// A ModelingToolkit system.
    Julia,
    Modelica,
    Sbml,
    /// An FMU of FMI 3.0, a binary file.
    Fmi,
}

impl Target {
    /// Every target, in the order of `sidc list`.
    pub const ALL: [Target; 16] = [
        Target::Text,
        Target::Latex,
        Target::Rust,
        Target::C,
        Target::CHeader,
        Target::CFloat,
        Target::CFloatHeader,
        Target::Python,
        Target::Sympy,
        Target::Matlab,
        Target::Jax,
        Target::Casadi,
        Target::Julia,
        Target::Modelica,
        Target::Sbml,
        Target::Fmi,
    ];

    /// The name that `sidc export --to` takes.
    pub fn name(self) -> &'static str {
        self.emitter().name()
    }

    /// The target with this name.
    ///
    /// # Errors
    /// [`ErrorKind::Options`]: no target of this name.
    pub fn named(name: &str) -> Result<Target, Error> {
        let found = Target::ALL.into_iter().find(|t| t.name() == name);
        found.ok_or_else(|| {
            let known = Target::ALL.map(Target::name).join(", ");
            let text = format!("no target is called {name}; there are {known}");
            Error::new(ErrorKind::Options, "unknown-target", text)
        })
    }

    pub(crate) fn emitter(self) -> &'static dyn sidc_emit::Target {
        let place = Target::ALL.iter().position(|t| *t == self);
        TARGETS[place.unwrap_or_default()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_target_is_its_own_emitter() {
        let names: Vec<&str> = TARGETS.iter().map(|t| t.name()).collect();
        for target in Target::ALL {
            let name = target.name().replace('-', "");
            assert_eq!(format!("{target:?}").to_lowercase(), name);
        }
        assert_eq!(names, Target::ALL.map(Target::name));
    }
}
