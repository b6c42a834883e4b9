//! Writes the tables that the models in `models/` are identified from.
//!
//! ```sh
//! cargo run --release -p sidc-studies --bin gallery                  # all of them, into models/data
//! cargo run --release -p sidc-studies --bin gallery -- lorenz sir    # these only
//! cargo run --release -p sidc-studies --bin gallery -- --dir /tmp    # elsewhere
//! ```
//!
//! The study `plant` writes the cart-pendulum's tables. A new system needs one file and one line in SYSTEMS.

mod allee;
mod bouncing_ball;
mod brusselator;
mod coil;
mod dc_motor;
mod diode;
mod drive;
mod dry_pendulum;
mod duffing;
mod falling_ball;
mod fan;
mod fitzhugh_nagumo;
mod forced_pendulum;
mod gene;
mod glycolysis;
mod heater;
mod inhibition;
mod logistic_map;
mod lorenz;
mod lorenz96;
mod lorenz_hidden;
mod lotka_volterra;
mod michaelis_menten;
mod motor_current;
mod narx;
mod neuron;
mod pendulum_lengths;
mod predator;
mod reactor;
mod relay;
mod rigid_ball;
mod rlc;
mod seir;
mod sir;
mod stick_slip;
mod stribeck;
mod tanks_overflow;
mod thermostat;
mod two_carts;
mod two_mass;
mod van_der_pol;

use clap::Parser;
use sidc_testing::plants::double_pendulum;
use sidc_testing::table::Table;
use std::error::Error;
use std::path::PathBuf;

/// File names and tables of one system.
type Tables = fn() -> Vec<(&'static str, Table)>;

#[rustfmt::skip]
const SYSTEMS: &[(&str, Tables)] = &[
    ("allee",            allee::tables),
    ("bouncing_ball",    bouncing_ball::tables),
    ("brusselator",      brusselator::tables),
    ("coil",             coil::tables),
    ("dc_motor",         dc_motor::tables),
    ("diode",            diode::tables),
    ("double_pendulum",  double_pendulum::tables),
    ("drive",            drive::tables),
    ("dry_pendulum",     dry_pendulum::tables),
    ("duffing",          duffing::tables),
    ("falling_ball",     falling_ball::tables),
    ("fan",              fan::tables),
    ("fitzhugh_nagumo",  fitzhugh_nagumo::tables),
    ("forced_pendulum",  forced_pendulum::tables),
    ("gene",             gene::tables),
    ("glycolysis",       glycolysis::tables),
    ("heater",           heater::tables),
    ("inhibition",       inhibition::tables),
    ("logistic_map",     logistic_map::tables),
    ("lorenz",           lorenz::tables),
    ("lorenz96",         lorenz96::tables),
    ("lorenz_hidden",    lorenz_hidden::tables),
    ("lotka_volterra",   lotka_volterra::tables),
    ("michaelis_menten", michaelis_menten::tables),
    ("motor_current",    motor_current::tables),
    ("narx",             narx::tables),
    ("neuron",           neuron::tables),
    ("pendulum_lengths", pendulum_lengths::tables),
    ("predator",         predator::tables),
    ("reactor",          reactor::tables),
    ("relay",            relay::tables),
    ("rigid_ball",       rigid_ball::tables),
    ("rlc",              rlc::tables),
    ("seir",             seir::tables),
    ("sir",              sir::tables),
    ("stick_slip",       stick_slip::tables),
    ("stribeck",         stribeck::tables),
    ("tanks_overflow",   tanks_overflow::tables),
    ("thermostat",       thermostat::tables),
    ("two_carts",        two_carts::tables),
    ("two_mass",         two_mass::tables),
    ("van_der_pol",      van_der_pol::tables),
];

/// Writes the tables of the model gallery.
#[derive(Parser, Debug)]
struct Options {
    /// Systems to write; all if none is named
    systems: Vec<String>,
    /// Folder to write to
    #[arg(long, default_value = "models/data")]
    dir: PathBuf,
}

fn main() -> Result<(), Box<dyn Error>> {
    let options = Options::parse();
    for name in &options.systems {
        if !SYSTEMS.iter().any(|(known, _)| known == name) {
            let known: Vec<&str> = SYSTEMS.iter().map(|(known, _)| *known).collect();
            return Err(format!("no system {name}; there are {}", known.join(", ")).into());
        }
    }
    for (name, tables) in SYSTEMS {
        if !options.systems.is_empty() && !options.systems.iter().any(|wanted| wanted == name) {
            continue;
        }
        for (file, mut table) in tables() {
            let made_by =
                format!("made by: cargo run --release -p sidc-studies --bin gallery -- {name}");
            table.comments.insert(0, made_by);
            let path = options.dir.join(file);
            std::fs::write(&path, table.csv())
                .map_err(|e| format!("cannot write {}: {e}", path.display()))?;
            println!("{} ({} rows)", path.display(), table.rows.len());
        }
    }
    Ok(())
}
