//! Data files that were dropped on the page.

use wasm_bindgen::prelude::*;

/// Records in the order in which their files were added.
#[wasm_bindgen]
#[derive(Default)]
pub struct Data {
    pub(crate) inner: sidc::Data,
}

#[wasm_bindgen]
impl Data {
    #[wasm_bindgen(constructor)]
    pub fn new() -> Data {
        Data::default()
    }

    /// Adds a file by its name and bytes.
    ///
    /// # Errors
    /// What is wrong with it, as the program prints it; the data are as before.
    pub fn add(&mut self, name: &str, bytes: &[u8]) -> Result<(), String> {
        let more = self.inner.clone().file(name, bytes);
        self.inner = more.map_err(|e| e.to_string())?;
        Ok(())
    }

    /// A first model of the first file.
    ///
    /// # Errors
    /// Nothing in it moves.
    pub fn draft(&self) -> Result<String, String> {
        self.inner.draft().map_err(|e| e.to_string())
    }
}
