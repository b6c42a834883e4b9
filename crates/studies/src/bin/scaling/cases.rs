//! The problems that are timed: a plant, a library with a number of atoms, a number of rows.
//!
//! In: a case. Out: its compiled model, its samples, and the true law. Times nothing.

use std::fmt;

use sidc::pipeline;
use sidc::pipeline::Program;
use sidc_data::{Column, Origin, Samples};
use sidc_lang::source::Sources;
use sidc_lang::term::{Signal, SignalNames};

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Plant {
    /// A pendulum on a cart, target ddy.
    Cart,
    /// A double pendulum on a cart, target ddx.
    Double,
}

impl fmt::Display for Plant {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Plant::Cart => "cart",
            Plant::Double => "double",
        })
    }
}

/// Numbers of atoms, each with the numbers of rows to run.
type Libraries = &'static [(usize, &'static [usize])];

/// Every case of the table.
pub static ALL: &[(Plant, &str, Libraries)] = &[
    (
        Plant::Double,
        "### N: a double pendulum on a cart, ddx",
        &[
            (9, &[100, 200, 400, 600]),
            (10, &[100, 200, 400, 600]),
            (11, &[100, 200, 400, 600]),
            (12, &[100, 200, 400, 600]),
            (13, &[100, 200, 400, 600]),
            (14, &[100, 200, 400, 600]),
            (15, &[100, 200, 400, 600]),
        ],
    ),
    (
        Plant::Cart,
        "### M: a pendulum on a cart, ddy",
        &[(8, &[50, 100, 200, 400, 800, 1600, 3200])],
    ),
];

/// The double pendulum's atoms, those of its law first. Each one after the tenth triples the number of terms.
const DOUBLE: [&str; 15] = [
    "dth1", "dth2", "F", "dx", "ddth1", "ddth2", "sin th1", "cos th1", "sin th2", "cos th2", "th1",
    "th2", "x", "sin F", "cos F",
];
const LAW_ATOMS: usize = 10;
const CART: [&str; 8] = [
    "y",
    "dy",
    "ddtheta",
    "theta",
    "dtheta",
    "sin theta",
    "cos theta",
    "F",
];
const DOUBLE_CSV: &str = include_str!("../../../../../models/data/double_pendulum.csv");
/// Samples of the cart-pendulum at 100 Hz.
const MOTION: usize = 4000;

pub struct Case {
    plant: Plant,
    rows: usize,
    library: String,
}

impl Case {
    /// `None` if the plant has no library with this number of atoms.
    ///
    /// With fewer than ten atoms the double pendulum's law would not be in the library. So the case of nine keeps all ten, and all except the two speeds have
    /// only exponents 0 and 1.
    pub fn new(plant: Plant, atoms: usize, rows: usize) -> Option<Case> {
        let library = match (plant, atoms) {
            (Plant::Cart, 8) => format!("powers({}; 2)", CART.join(", ")),
            (Plant::Double, 9) => {
                let (squared, once) = DOUBLE[..LAW_ATOMS].split_at(2);
                let (squared, once) = (squared.join(", "), once.join(", "));
                format!("powers({squared}; 2) * powers({once}; 1)")
            }
            (Plant::Double, LAW_ATOMS..=15) => {
                format!("powers({}; 2)", DOUBLE[..atoms].join(", "))
            }
            _ => return None,
        };
        Some(Case {
            plant,
            rows,
            library,
        })
    }

    pub fn program(&self) -> Result<Program, String> {
        let text = match self.plant {
            Plant::Cart => format!(
                "state y, theta : order 2\ninput F : hold\nddy ~ {}\n",
                self.library
            ),
            Plant::Double => format!(
                "state x, th1, th2 : order 2\ninput F : hold\nddx ~ {}\n",
                self.library
            ),
        };
        let mut sources = Sources::default();
        let file = sources.add("scaling.sid", &text);
        let (program, found) = pipeline::compile(file, &sources, pipeline::MEMORY);
        program.ok_or_else(|| format!("the model does not compile: {found:?}"))
    }

    /// The program's signals on random rows, and the target.
    pub fn samples(&self, program: &Program) -> Result<(Samples, Vec<f64>), String> {
        let (names, table) = match self.plant {
            Plant::Cart => cart(),
            Plant::Double => double()?,
        };
        let chosen = sidc_testing::pendulum_regression::Random::new(1000)
            .choose(self.rows.min(table.len()), table.len());
        let values = |signal: Signal| -> Result<Vec<f64>, String> {
            let name = program.model.name(signal);
            let at = names.iter().position(|n| *n == name);
            let at = at.ok_or_else(|| format!("no column {name}"))?;
            Ok(chosen.iter().map(|&r| table[r][at]).collect())
        };
        let column = |signal| {
            Ok(Column {
                signal,
                values: values(signal)?,
                origin: Origin::Measured { noise: None },
            })
        };
        let columns: Result<Vec<Column>, String> =
            pipeline::needed(program).into_iter().map(column).collect();
        let target = program.model.equations.first().ok_or("no equation")?.target;
        let samples = Samples {
            trajectory: vec![0; chosen.len()],
            time: chosen.iter().map(|&r| r as f64).collect(),
            columns: columns?,
        };
        Ok((samples, values(target)?))
    }

    /// The terms of the true equation.
    pub fn law(&self) -> &'static [(&'static str, f64)] {
        match self.plant {
            Plant::Cart => &[
                ("F", 1.0 / 0.775),
                ("dy", -0.05 / 0.775),
                ("ddtheta*cos(theta)", -0.1375 / 0.775),
                ("dtheta^2*sin(theta)", 0.1375 / 0.775),
            ],
            Plant::Double => &[
                ("F", 1.0 / 1.1),
                ("dx", -0.05 / 1.1),
                ("ddth1*cos(th1)", -0.25 / 1.1),
                ("ddth2*cos(th2)", -0.08 / 1.1),
                ("dth1^2*sin(th1)", 0.25 / 1.1),
                ("dth2^2*sin(th2)", 0.08 / 1.1),
            ],
        }
    }
}

type Table = (Vec<&'static str>, Vec<Vec<f64>>);

fn cart() -> Table {
    let names = vec!["y", "dy", "ddy", "theta", "dtheta", "ddtheta", "F"];
    let row = |s: sidc_testing::pendulum_regression::Sample| {
        vec![s.y, s.dy, s.ddy, s.angle, s.dangle, s.ddangle, s.force]
    };
    let motion = sidc_testing::pendulum_regression::simulate(MOTION, 3);
    (names, motion.into_iter().map(row).collect())
}

fn double() -> Result<Table, String> {
    let mut lines = DOUBLE_CSV.lines().filter(|l| !l.starts_with('#'));
    let names = lines.next().ok_or("an empty table")?.split(',').collect();
    let numbers = |line: &str| -> Result<Vec<f64>, String> {
        let cells = line.split(',').map(|c| c.parse::<f64>());
        cells.collect::<Result<_, _>>().map_err(|e| e.to_string())
    };
    Ok((names, lines.map(numbers).collect::<Result<_, _>>()?))
}
