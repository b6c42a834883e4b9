//! The generators, one file each. To add one: its file, its `mod` line, its entry in [`GENERATORS`].

mod fourier;
pub(crate) mod generator;
mod lags;
mod polynomial;
mod tensor_powers;

use generator::Generator;

/// Every generator; the language, `sidc list` and "did you mean" read this.
pub static GENERATORS: &[&dyn Generator] = &[
    &polynomial::Polynomial,
    &tensor_powers::TensorPowers,
    &fourier::Fourier,
    &lags::Lags,
];

/// Looks a generator up by name.
pub fn generator(name: &str) -> Option<&'static dyn Generator> {
    GENERATORS.iter().copied().find(|g| g.name() == name)
}
