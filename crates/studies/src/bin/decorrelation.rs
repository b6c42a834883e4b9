//! Do columns that are nearly one column hurt the solver, and does it help to take them apart first?
//!
//! ```sh
//! cargo run --release -p sidc-studies --bin decorrelation
//! ```
//!
//! A driven pendulum that stays within an angle, 39 candidate terms among which θ, sin θ, θ³ and tan θ are nearly one for small
//! angles, noise on the acceleration. Four ways, each with the solver that is the default:
//!
//! - plain: Φ as it is; the support is what the solver finds;
//! - orthogonalised: in each group of columns with a cosine above 0.99 every column is made orthogonal to those before it;
//! - grouped: the solver sees the simplest column of each group, and the best member of each group is taken afterwards;
//! - chosen: Φ as it is, and the criterion's search over all columns, which is what `sidc identify` does.
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
