//! The cases whose answers are compared: command lines on the gallery, on records of the tests and on wrong models.
//!
//! Only quick ones, since each number costs two runs of every case that reads it. `@name` is a file in the study's own folder: from files.rs, or a result
//! document.

use super::answer::Form::{self, Messages, Result, Table, Text, Words};

pub struct Case {
    pub name: &'static str,
    pub form: Form,
    /// Arguments of `sidc`.
    pub command: &'static str,
}

/// Result documents that cases start from, and the commands that write them.
pub const DOCUMENTS: &[(&str, &str)] = &[
    ("rlc.json", "identify models/rlc.sid models/data/rlc.csv"),
    (
        "pendulum.json",
        "identify models/pendulum_768.sid models/data/pendulum.csv",
    ),
    (
        "duffing.json",
        "identify models/duffing.sid models/data/duffing.csv",
    ),
    (
        "michaelis.json",
        "identify models/michaelis_menten.sid models/data/michaelis_menten.csv",
    ),
    (
        "motor.json",
        "identify models/dc_motor.sid models/data/dc_motor.csv",
    ),
];

const fn case(name: &'static str, form: Form, command: &'static str) -> Case {
    Case {
        name,
        form,
        command,
    }
}

#[rustfmt::skip]
pub const CASES: &[Case] = &[
    case("brusselator", Result, "identify models/brusselator.sid models/data/brusselator.csv --json"),
    case("dc_motor", Result, "identify models/dc_motor.sid models/data/dc_motor.csv --json"),
    case("duffing", Result, "identify models/duffing.sid models/data/duffing.csv --json"),
    case("falling_ball", Result, "identify models/falling_ball.sid models/data/falling_ball.csv --json"),
    case("fitzhugh_nagumo", Result, "identify models/fitzhugh_nagumo.sid models/data/fitzhugh_nagumo.csv --json"),
    case("forced_pendulum", Result, "identify models/forced_pendulum.sid models/data/forced_pendulum.csv --json"),
    case("logistic_map", Result, "identify models/logistic_map.sid models/data/logistic_map.csv --json"),
    case("lorenz", Result, "identify models/lorenz.sid models/data/lorenz.csv --json"),
    case("lotka_volterra", Result, "identify models/lotka_volterra.sid models/data/lotka_volterra.csv --json"),
    case("michaelis_menten", Result, "identify models/michaelis_menten.sid models/data/michaelis_menten.csv --json"),
    case("narx", Result, "identify models/narx.sid models/data/narx.csv --json"),
    case("pendulum", Result, "identify models/pendulum.sid models/data/pendulum.csv --json"),
    case("pendulum_lengths", Result, "identify models/pendulum_lengths.sid models/data/pendulum_lengths.csv --json"),
    case("pendulum_positions", Result, "identify models/pendulum_positions.sid models/data/pendulum_positions.csv --json"),
    case("rlc", Result, "identify models/rlc.sid models/data/rlc.csv --json"),
    case("sir", Result, "identify models/sir.sid models/data/sir_a.csv models/data/sir_b.csv --json"),
    case("two_carts", Result, "identify models/two_carts.sid models/data/two_carts.csv --json"),
    case("two_mass", Result, "identify models/two_mass.sid models/data/two_mass.csv --json"),
    case("van_der_pol", Result, "identify models/van_der_pol.sid models/data/van_der_pol.csv --json"),
    // Other methods, and less informative data.
    case("short nerve", Result, "identify models/fitzhugh_nagumo.sid models/data/fitzhugh_nagumo.csv --window=0..25 --json"),
    case("short springs", Result, "identify models/two_mass.sid models/data/two_mass.csv --window=0..1 --json"),
    case("few rows", Result, "identify models/brusselator.sid models/data/brusselator.csv --samples 30 --seed 1 --json"),
    case("weak", Result, "identify models/van_der_pol.sid models/data/van_der_pol.csv --method weak --json"),
    case("weak with noise", Result, "identify models/fitzhugh_nagumo.sid models/data/fitzhugh_nagumo.csv --method weak --window=0..25 --json"),
    case("regression with noise", Result, "identify models/fitzhugh_nagumo.sid models/data/fitzhugh_nagumo.csv --method regression --window=0..25 --json"),
    case("joint on clean data", Result, "identify models/van_der_pol.sid models/data/van_der_pol.csv --method joint --json"),
    case("delays", Result, "identify models/duffing.sid models/data/duffing.csv --method joint --window=..5 --json"),
    case("robust", Result, "identify @outliers.sid @outliers.csv --robust --json"),
    case("outliers", Result, "identify @outliers.sid @outliers.csv --json"),
    case("encoder", Result, "identify @encoder.sid @encoder.csv --json"),
    case("copies", Result, "identify @copies.sid @copies.csv --json"),
    case("alias", Result, "identify @alias_1.sid @alias_1.csv --json"),
    case("conserved sum", Result, "identify @conserved_sum_1.sid @conserved_sum_1.csv --json"),
    case("small angle", Result, "identify @small_angle_1.sid @small_angle_1.csv --json"),
    case("constant input", Result, "identify @constant_input_1.sid @constant_input_1.csv --json"),
    case("too few rows", Result, "identify @too_few_rows_1.sid @too_few_rows_1.csv --json"),
    case("missing term", Result, "identify @missing_term_1.sid @missing_term_1.csv --json"),
    case("wrong order", Result, "identify @wrong_order_1.sid @wrong_order_1.csv --json"),
    case("conserved sum in noise", Result, "identify @conserved_sum_3.sid @conserved_sum_3.csv --json"),
    case("small angle in noise", Result, "identify @small_angle_3.sid @small_angle_3.csv --json"),
    case("constant input in noise", Result, "identify @constant_input_3.sid @constant_input_3.csv --json"),
    case("held out", Result, "identify models/duffing.sid models/data/duffing.csv --holdout=25% --json"),
    case("two models", Result, "identify @spring.sid @encoder.sid @spring.csv --json"),
    case("verify", Result, "identify models/narx.sid models/data/narx.csv --verify --json"),
    case("clarabel", Result, "identify models/brusselator.sid models/data/brusselator.csv --solver clarabel --json"),
    case("omp", Result, "identify models/brusselator.sid models/data/brusselator.csv --solver omp --json"),
    case("stlsq", Result, "identify models/brusselator.sid models/data/brusselator.csv --solver stlsq --json"),
    case("path", Words, "identify models/brusselator.sid models/data/brusselator.csv --path"),
    case("evidence", Words, "identify models/two_mass.sid models/data/two_mass.csv --window=0..1 --evidence"),
    // The other commands.
    case("simulate", Table, "simulate @rlc.json models/data/rlc.csv -o @out"),
    case("simulate stiff", Table, "simulate @rlc.json models/data/rlc.csv --method stiff -o @out"),
    case("simulate cart", Table, "simulate @pendulum.json models/data/pendulum_positions.csv -o @out"),
    case("simulate implicit", Table, "simulate @michaelis.json models/data/michaelis_menten.csv -o @out"),
    case("simulate kinks", Table, "simulate @motor.json models/data/dc_motor.csv -o @out"),
    case("scores", Text, "simulate @duffing.json models/data/duffing.csv"),
    case("smooth", Table, "smooth models/fitzhugh_nagumo.sid models/data/fitzhugh_nagumo.csv -o @out"),
    case("smooth pelts", Table, "smooth models/lotka_volterra.sid models/data/lotka_volterra.csv -o @out"),
    case("smooth spring", Table, "smooth models/duffing.sid models/data/duffing.csv -o @out"),
    case("linearize", Text, "linearize @pendulum.json --at theta=pi"),
    case("linearize at a kink", Text, "linearize @motor.json --at omega=0"),
    case("export", Text, "export @pendulum.json --to text"),
    case("export C", Text, "export @michaelis.json --to c"),
    case("report", Words, "report @duffing.json models/data/duffing.csv -o @out"),
    case("new nerve", Text, "new models/data/fitzhugh_nagumo.csv"),
    case("new cart", Text, "new models/data/pendulum_positions.csv"),
    case("new motor", Text, "new models/data/dc_motor.csv"),
    case("new lengths", Text, "new models/data/pendulum_lengths.csv"),
    case("check", Text, "check models/double_pendulum.sid"),
    case("check terms", Text, "check --terms models/pendulum_symmetry.sid"),
    case("check data", Words, "check models/pendulum_positions.sid models/data/pendulum_positions.csv"),
    case("turns", Messages, "check @turns.sid @turns.csv"),
    case("rates", Messages, "check @rates.sid @rates.csv"),
    case("clock", Messages, "check @clock.sid @clock.csv"),
    case("steps", Messages, "check @steps.sid @steps.csv"),
    case("numbers", Messages, "check @numbers.sid @numbers.csv"),
    case("restart", Messages, "check @restart.sid @restart.csv"),
    case("bad: name", Messages, "check tests/bad/unknown_name.sid"),
    case("bad: far name", Messages, "check tests/bad/unknown_far.sid"),
    case("bad: keyword", Messages, "check tests/bad/misspelt_keyword.sid"),
    case("bad: unit", Messages, "check tests/bad/unit_typo.sid"),
    case("bad: long unit", Messages, "check tests/bad/unit_long.sid"),
    case("bad: unit sum", Messages, "check tests/bad/unit_sum.sid"),
    case("bad: depth", Messages, "check tests/bad/too_deep.sid"),
    case("bad: lets", Messages, "check tests/bad/lets_grow.sid"),
    case("bad: range", Messages, "check tests/bad/range_undeclared.sid"),
    case("bad: symmetries", Messages, "check tests/bad/symmetries_many.sid"),
    case("bad: index", Messages, "check tests/bad/square_brackets.sid"),
    case("bad: many", Messages, "check tests/bad/several_at_once.sid"),
    case("bad: lag", Messages, "check tests/bad/lag_values.sid"),
    case("bad: numbers", Messages, "check tests/bad/generator_numbers.sid"),
];
