//! The language: messages, the reference, the formatter, and meaningless texts.
//!
//! This file has the vocabulary and the helpers shared by the tests.

mod added_state;
mod bad;
mod corners;
mod docs;
mod edges;
mod families;
mod fixes;
mod foreign;
mod formatting;
mod functions;
mod hostile;
mod includes;
mod meaning;

use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::model::Model;
use sidc_lang::source::Sources;
use sidc_lang::{GeneratorSignature, Vocabulary, compile, render};

/// The generators known to these tests.
pub fn vocabulary() -> Vocabulary {
    let signature = |name, usage, discrete_only| GeneratorSignature {
        name,
        usage,
        discrete_only,
        of_angles: name == "fourier",
    };
    Vocabulary {
        generators: vec![
            signature("poly", "poly(atoms; degree)", false),
            signature("powers", "powers(atoms; power)", false),
            signature("fourier", "fourier(atom; harmonics)", false),
            signature("lags", "lags(signals; from..to)", true),
        ],
    }
}

pub fn compiled(name: &str, text: &str) -> (Option<Model>, Vec<Diagnostic>, String) {
    let mut sources = Sources::default();
    let id = sources.add(name, text);
    let (model, found) = compile(id, &sources, &vocabulary());
    let shown = render(&found, &sources, false);
    (model, found, shown)
}

/// All messages about a text.
pub fn said(text: &str) -> String {
    compiled("m.sid", text).2
}

/// The model of a valid text.
pub fn model(text: &str) -> Model {
    let (model, _, shown) = compiled("model.sid", text);
    model.unwrap_or_else(|| panic!("{text}\n{shown}"))
}

/// Every `.sid` text under a folder of the repository, with its name.
pub fn texts_in(folder: &str) -> Vec<(String, String)> {
    let root = sidc_testing::program::root().join(folder);
    let Ok(entries) = std::fs::read_dir(root) else {
        return Vec::new();
    };
    let mut out: Vec<(String, String)> = entries
        .map(|e| e.unwrap().path())
        .filter(|p| p.extension().is_some_and(|x| x == "sid"))
        .map(|p| {
            let name = p.file_stem().unwrap().to_string_lossy().into_owned();
            (name, std::fs::read_to_string(&p).unwrap())
        })
        .collect();
    out.sort();
    out
}
