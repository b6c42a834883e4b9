//! A search with an observer that ends it after ten seconds; its result as JSON, read back.
//! `cargo run --release --example watched`

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use sidc::{Activity, Data, Discovery, Model, Options, Stop};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let t: Vec<f64> = (0..400).map(|k| 0.05 * f64::from(k)).collect();
    let x: Vec<f64> = t.iter().map(|t| f64::cos(2.0 * t)).collect();
    let model = Model::parse("state x : order 2\nddx ~ poly(x, dx; 5)\n")?;
    let data = Data::new().run([("t", t), ("x", x)])?;
    let (began, limit) = (Instant::now(), Duration::from_secs(10));
    let mut observer = |activity: Activity| {
        eprintln!("{activity:?}");
        match began.elapsed() > limit {
            true => ControlFlow::Break(Stop::TimeLimit(limit)),
            false => ControlFlow::Continue(()),
        }
    };
    let found = model.identify_watched(&data, &Options::default(), &mut observer)?;
    let text = serde_json::to_string(&found)?;
    let again: Discovery = serde_json::from_str(&text)?;
    println!("{again}\n{} bytes of JSON", text.len());
    Ok(())
}
