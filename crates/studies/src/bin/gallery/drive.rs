//! A positioning drive of one axis that reverses and rests: force, viscous and dry friction, an offset. Position with noise.

use sidc_testing::integrate::grid;
use sidc_testing::random::{Random, decimals};
use sidc_testing::switched::Switched;
use sidc_testing::table::Table;

pub fn tables() -> Vec<(&'static str, Table)> {
    let times = grid(2000, 0.01);
    let mut random = Random::new(72);
    let levels = random.square(times.len(), (20, 80), 60.0);
    // Every third stretch is too weak to move it.
    let mut force = Vec::new();
    let (mut stretch, mut before) = (0, f64::NAN);
    for level in levels {
        stretch += usize::from(level != before);
        before = level;
        force.push(if stretch % 3 == 0 {
            decimals(0.2 * level, 1)
        } else {
            decimals(level, 1)
        });
    }
    let held = force.clone();
    let drive = Switched {
        rates: Box::new(move |t, [_, v], side| {
            let u = held[((t / 0.01 + 1e-11) as usize).min(held.len() - 1)];
            [*v, 0.05 * u - 2.0 * v - side + 0.15]
        }),
        guard: Box::new(|_, [_, v]| *v),
        step: 0.0025,
    };
    let mut table = Table::new(&["t", "q", "u"]);
    for ((t, [q, _]), u) in times.iter().zip(drive.run(&times, [0.0, 0.0])).zip(&force) {
        table.push(&[*t, decimals(q + 0.0005 * random.normal(), 6), *u]);
    }
    vec![("drive.csv", table)]
}
