//! Do nearly equal columns hurt the solver, and does it help to decorrelate them first?
//!
//! ```sh
//! cargo run --release -p sidc-studies --bin decorrelation
//! ```
//!
//! The record is a driven pendulum with bounded angle and noise on the acceleration. Among its 39 candidate terms, θ, sin θ, θ³ and tan θ are nearly equal
//! for small angles. Four methods, each with the default solver:
//!
//! - plain: Φ unchanged; the support is what the solver finds;
//! - orthogonalised: in each group of columns with cosines above 0.99, every column is made orthogonal to those before it;
//! - grouped: the solver sees the simplest column of each group, and the best member of each group is chosen afterwards;
//! - chosen: Φ unchanged, and the criterion searches all columns, as in `sidc identify`.
//!
//! Prints how many of twenty draws gave the true support.

use sidc_studies::decorrelation::{ANGLES, NOISES, WAYS, right};

const DRAWS: u64 = 20;

fn main() -> Result<(), String> {
    println!("angle   noise    {}   (of {DRAWS})", WAYS.join("  "));
    for angle in ANGLES {
        for noise in NOISES {
            let [plain, apart, grouped, chosen] = right(angle, noise, DRAWS)?;
            println!("{angle:5}  {noise:6.0e}  {plain:6}  {apart:14}  {grouped:7}  {chosen:6}");
        }
    }
    Ok(())
}
