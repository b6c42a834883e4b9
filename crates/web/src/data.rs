//! Data files dropped on the page.

use wasm_bindgen::prelude::*;

/// Records in the order in which files were added.
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

    /// Adds a file by name and content.
    ///
    /// # Errors
    /// The faults of the file, as the program prints them; the data are unchanged.
    pub fn add(&mut self, name: &str, bytes: &[u8]) -> Result<(), String> {
        let more = self.inner.clone().file(name, bytes);
        self.inner = more.map_err(|e| e.to_string())?;
        Ok(())
    }

    /// A first model of the first file.
    ///
    /// # Errors
    /// Nothing in it varies.
    pub fn draft(&self) -> Result<String, String> {
        self.inner.draft().map_err(|e| e.to_string())
    }
}
