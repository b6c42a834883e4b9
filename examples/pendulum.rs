//! A damped pendulum from a noisy angle: equations, doubts, code. `cargo run --release --example pendulum`

use sidc::{Data, Model, Options, Target};

fn main() -> Result<(), sidc::Error> {
    let (step, mut state, mut random) = (0.02, [1.2, 0.0], 1_u32);
    let (mut t, mut theta) = (Vec::new(), Vec::new());
    for k in 0..600 {
        random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        t.push(step * f64::from(k));
        theta.push(state[0] + 0.01 * (f64::from(random) / f64::from(u32::MAX) - 0.5));
        for _ in 0..100 {
            let acceleration = -9.8 * f64::sin(state[0]) - 0.3 * state[1];
            state = [
                state[0] + step / 100.0 * state[1],
                state[1] + step / 100.0 * acceleration,
            ];
        }
    }
    let model = Model::parse(
        "state theta : order 2\nddtheta ~ poly(theta, dtheta; 3) + <sin theta, cos theta>\n",
    )?;
    let data = Data::new().run([("t", t), ("theta", theta)])?;
    let found = model.identify(&data, &Options::default())?;
    println!("{found}\npasses: {}", found.passes());
    found
        .doubts()
        .for_each(|(target, doubt)| println!("{target}: {}", doubt.text));
    println!("{}", found.export(Target::Python)?);
    Ok(())
}
