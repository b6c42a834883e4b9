//! Two records of a draining tank, the second held out: how well does the equation generalise?
//! `cargo run --release --example held_out`

use sidc::{Data, Model, Options};

fn record(start: f64) -> [(&'static str, Vec<f64>); 2] {
    // Torricelli: dh = -0.2 sqrt(h), so sqrt(h) decreases linearly.
    let t: Vec<f64> = (0..200).map(|k| 0.05 * f64::from(k)).collect();
    let h = t.iter().map(|t| (f64::sqrt(start) - 0.1 * t).powi(2));
    [("t", t.clone()), ("h", h.collect())]
}

fn main() -> Result<(), sidc::Error> {
    let data = Data::new().run(record(4.0))?.run(record(2.0))?;
    let model = Model::parse("state h\ndh ~ poly(h; 2) + <sqrt h>\n")?;
    let found = model.identify(&data, &Options::default().hold_out_run(1))?;
    println!("{found}");
    for run in &found.simulate(&data)?.runs {
        let fits = run
            .scores
            .iter()
            .map(|s| format!("{} {:.2} %", s.signal, s.fit));
        println!("{}: fit {}", run.name, fits.collect::<Vec<_>>().join(", "));
    }
    Ok(())
}
