//! From a model and data to equations and their exports.

use sidc::{HoldOutRange, Options, Target};
use wasm_bindgen::prelude::*;

use crate::data::Data;
use crate::progress::Progress;

/// Memory limit of Φ for one equation: a page has at most 4 GB in total.
const MEMORY: u64 = 1 << 30;

/// Equations with their evidence.
#[wasm_bindgen]
pub struct Discovery {
    inner: sidc::Discovery,
}

/// A checked model.
#[wasm_bindgen]
pub struct Model {
    inner: sidc::Model,
}

#[wasm_bindgen]
impl Model {
    /// Compiles a text.
    ///
    /// # Errors
    /// The faults of the text, as the program prints them.
    #[wasm_bindgen(constructor)]
    pub fn new(name: &str, text: &str) -> Result<Model, String> {
        let inner = sidc::Model::named(name, text).map_err(|e| e.to_string())?;
        Ok(Model { inner })
    }

    /// Finds the equations. The last part `holdout` of every record is held out, and the equations are run on it; 0 for none. `progress` is called with words
    /// for users.
    ///
    /// # Errors
    /// The faults of the data, as the program prints them.
    pub fn identify(
        &self,
        data: &Data,
        holdout: f64,
        progress: js_sys::Function,
    ) -> Result<Discovery, String> {
        let mut options = Options::default().memory(MEMORY);
        if holdout > 0.0 && holdout < 1.0 {
            options = options.hold_out(HoldOutRange::Last(holdout));
        }
        let mut observer = Progress::new(self.inner.targets(), progress);
        let found = self
            .inner
            .identify_watched(&data.inner, &options, &mut observer);
        let inner = found.map_err(|e| e.to_string())?;
        Ok(Discovery { inner })
    }
}

/// The targets of [`Discovery::export`].
#[wasm_bindgen]
pub fn targets() -> Vec<String> {
    Target::ALL.map(|t| t.name().to_string()).to_vec()
}

#[wasm_bindgen]
impl Discovery {
    /// The result document.
    ///
    /// # Errors
    /// A bug in this program.
    pub fn document(&self) -> Result<String, String> {
        self.inner.to_json().map_err(|e| e.to_string())
    }

    /// The answer as the program prints it.
    pub fn answer(&self) -> String {
        self.inner.answer()
    }

    /// True if every equation was found and none has a doubt.
    pub fn passes(&self) -> bool {
        self.inner.passes()
    }

    /// Equations, verdict and coefficients as an HTML fragment.
    pub fn html(&self) -> String {
        self.inner.html()
    }

    /// The report as an HTML page, with runs along the data that the equations were found from.
    ///
    /// # Errors
    /// Data missing that a run needs.
    pub fn report(&self, data: &Data, progress: js_sys::Function) -> Result<String, String> {
        let mut observer = Progress::new(Vec::new(), progress);
        let page = self.inner.report(&data.inner, &mut observer);
        page.map_err(|e| e.to_string())
    }

    /// The equations in another language: a text, or a `Uint8Array` if its files are binary.
    ///
    /// # Errors
    /// An unknown language, or an equation that it cannot express.
    pub fn export(&self, target: &str) -> Result<JsValue, String> {
        let target = Target::named(target).map_err(|e| e.to_string())?;
        match self.inner.export(target) {
            Ok(text) => Ok(text.into()),
            Err(e) if e.codes().contains(&"binary-export") => {
                let bytes = self.inner.export_bytes(target);
                let bytes = bytes.map_err(|e| e.to_string())?;
                Ok(js_sys::Uint8Array::from(bytes.as_slice()).into())
            }
            Err(e) => Err(e.to_string()),
        }
    }
}
