//! Answers to models of the gallery, each found once for all tests: some take seconds.

use std::collections::HashMap;
use std::sync::{Arc, LazyLock, Mutex, OnceLock};

use sidc_testing::program::{Run, sidc};

/// What `sidc identify MODEL DATA… -o result.json` says and writes.
pub struct Answer {
    pub run: Run,
    pub document: String,
}

/// The answer to `models/{name}.sid` on these tables.
pub fn answer(name: &str, data: &[&str]) -> Arc<Answer> {
    type Answers = HashMap<Vec<String>, Arc<OnceLock<Arc<Answer>>>>;
    static KNOWN: LazyLock<Mutex<Answers>> = LazyLock::new(Mutex::default);
    let words = [&[name], data].concat();
    let key = words.into_iter().map(String::from).collect();
    let own = KNOWN.lock().unwrap().entry(key).or_default().clone();
    own.get_or_init(|| Arc::new(identified(name, data))).clone()
}

fn identified(name: &str, data: &[&str]) -> Answer {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("result.json").display().to_string();
    let model = format!("models/{name}.sid");
    let args = [&["identify", &model], data, &["-o", &out]].concat();
    let run = sidc(&args);
    let document = std::fs::read_to_string(&out);
    let document = document.unwrap_or_else(|_| panic!("{name}: {}", run.stderr));
    let run = Run {
        stdout: run.stdout.replace(&out, "result.json"),
        ..run
    };
    Answer { run, document }
}
