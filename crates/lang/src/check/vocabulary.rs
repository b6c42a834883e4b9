//! Names that the language gets from outside: generators.
//!
//! In: signatures from the library. Out: look-up by name. No generator is built in.

/// What the checker needs to know about a generator.
#[derive(Clone, Copy, Debug)]
pub struct GeneratorSignature {
    pub name: &'static str,
    /// Shown in messages: `poly(atoms; degree)`.
    pub usage: &'static str,
    /// Only for models in discrete time.
    pub discrete_only: bool,
    /// Its atoms are angles, and so must be pure numbers.
    pub of_angles: bool,
}

/// The generators that a model may call.
#[derive(Clone, Debug, Default)]
pub struct Vocabulary {
    pub generators: Vec<GeneratorSignature>,
}

impl Vocabulary {
    pub fn generator(&self, name: &str) -> Option<&GeneratorSignature> {
        self.generators.iter().find(|g| g.name == name)
    }
}
