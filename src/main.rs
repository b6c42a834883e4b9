//! argv → exit code.

use std::process::ExitCode;

fn main() -> ExitCode {
    sidc::cli::run()
}
