//! The names that the language takes from outside: its generators.
//!
//! In: what the library says of each. Out: look-ups by name. Knows no generator by itself.

/// What the checker needs to know of a generator.
#[derive(Clone, Copy, Debug)]
pub struct GeneratorSignature {
    pub name: &'static str,
    /// Shown in messages: `poly(atoms; degree)`.
    pub usage: &'static str,
    /// Only for models in discrete time.
    pub discrete_only: bool,
    /// Its atoms become angles: pure numbers.
    pub of_angles: bool,
}

/// The names the language takes from outside.
#[derive(Clone, Debug, Default)]
pub struct Vocabulary {
    pub generators: Vec<GeneratorSignature>,
}

impl Vocabulary {
    pub fn generator(&self, name: &str) -> Option<&GeneratorSignature> {
        self.generators.iter().find(|g| g.name == name)
    }
}
