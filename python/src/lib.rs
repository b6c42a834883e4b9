//! Crate `sidc` as the native half of the Python module `sidc`: one class per type of the library, NumPy arrays for its slices.
//!
//! In: texts, names, arrays. Out: documents, pages, arrays. What Python can do itself is in `sidc/*.py`: tables, reprs, plots, the conventions of other
//! packages.

mod discovery;
mod inputs;
mod model;
mod raised;
mod reduced;
mod right_side;
mod watching;

use pyo3::prelude::*;

/// The compiler for equation discovery, as compiled code.
#[pymodule]
fn _sidc(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<inputs::Data>()?;
    module.add_class::<inputs::Options>()?;
    module.add_class::<model::Model>()?;
    module.add_class::<reduced::Reduced>()?;
    module.add_class::<discovery::Discovery>()?;
    module.add_class::<right_side::RightSide>()?;
    Ok(())
}
