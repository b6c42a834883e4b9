//! `sidc-web-bindings COMPILED.wasm FOLDER`: the WebAssembly of crate `sidc-web` as a JavaScript module, `sidc.js` and `sidc_bg.wasm`.
//!
//! The command `wasm-bindgen` does the same, but takes six times as long to build, and its version no longer matches as soon as Cargo.lock changes.

use std::process::ExitCode;

use wasm_bindgen_cli_support::Bindgen;

fn main() -> ExitCode {
    let mut args = std::env::args_os().skip(1);
    let (Some(compiled), Some(folder)) = (args.next(), args.next()) else {
        eprintln!("usage: sidc-web-bindings COMPILED.wasm FOLDER");
        return ExitCode::FAILURE;
    };
    let mut bindings = Bindgen::new();
    bindings
        .input_path(compiled)
        .out_name("sidc")
        .typescript(false)
        .remove_name_section(true);
    let written = bindings.web(true).and_then(|b| b.generate(folder));
    match written {
        Ok(()) => ExitCode::SUCCESS,
        Err(why) => {
            eprintln!("{why:?}");
            ExitCode::FAILURE
        }
    }
}
