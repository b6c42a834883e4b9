//! Coupled equations as relations: redundant ones are named and replaced if possible, independent laws are kept.

use std::fmt::Write;

use proptest::prelude::*;
use serde_json::Value;

use sidc_testing::pendulum_regression::Random;
use sidc_testing::program::{Run, record, sidc_in};
use sidc_testing::records::joined;

const STEP: f64 = 0.01;

/// A pendulum on a cart, pushed by a motor whose force lags its command `u`.
#[derive(Clone, Copy, Debug)]
struct CartPole {
    cart: f64,
    bob: f64,
    rod: f64,
    /// Largest command, and the motor's time constant; zero means no lag.
    command: f64,
    lag: f64,
    seed: u64,
}

const SMALL: CartPole = CartPole {
    cart: 0.5,
    bob: 0.275,
    rod: 0.5,
    command: 2.0,
    lag: 0.3,
    seed: 1,
};

/// One sample: x, θ, their rates, their accelerations, u.
type Sample = [f64; 7];

impl CartPole {
    /// (ẍ, θ̈) at (x, θ, ẋ, θ̇, force).
    fn accelerations(&self, z: &[f64; 5], u: f64) -> [f64; 2] {
        let [_, angle, dx, dangle, force] = *z;
        let force = if self.lag > 0.0 { force } else { u };
        let (s, c) = angle.sin_cos();
        // (cart + bob) ẍ + bob rod θ̈ cos θ = f₁, ẍ cos θ/rod + θ̈ = f₂
        let first = force - 0.05 * dx + self.bob * self.rod * dangle * dangle * s;
        let second = -9.81 / self.rod * s - 0.15 * dangle;
        let (a, b) = (self.cart + self.bob, self.bob * self.rod * c);
        let d = c / self.rod;
        let det = a - b * d;
        [(first - b * second) / det, (a * second - d * first) / det]
    }

    fn rates(&self, z: &[f64; 5], u: f64) -> [f64; 5] {
        let [ddx, ddangle] = self.accelerations(z, u);
        let follow = if self.lag > 0.0 {
            (u - z[4]) / self.lag
        } else {
            0.0
        };
        [z[2], z[3], ddx, ddangle, follow]
    }

    /// `rows` samples under a command that jumps four times a second, by Runge–Kutta.
    fn run(&self, rows: usize) -> Vec<Sample> {
        let mut random = Random::new(self.seed);
        let (mut z, mut u) = ([0.0; 5], 0.0);
        let ahead = |z: [f64; 5], k: [f64; 5], h: f64| -> [f64; 5] {
            std::array::from_fn(|i| z[i] + h * k[i])
        };
        let mut out = Vec::new();
        for row in 0..rows {
            if row % 25 == 0 {
                u = self.command * (2.0 * random.uniform() - 1.0);
            }
            let [ddx, ddangle] = self.accelerations(&z, u);
            out.push([z[0], z[1], z[2], z[3], ddx, ddangle, u]);
            let h = STEP / 8.0;
            for _ in 0..8 {
                let a = self.rates(&z, u);
                let b = self.rates(&ahead(z, a, h / 2.0), u);
                let c = self.rates(&ahead(z, b, h / 2.0), u);
                let d = self.rates(&ahead(z, c, h), u);
                for i in 0..5 {
                    z[i] += h / 6.0 * (a[i] + 2.0 * (b[i] + c[i]) + d[i]);
                }
            }
        }
        out
    }
}

/// All signals, measured without error.
fn exact(samples: &[Sample]) -> String {
    let mut text = "t,x,theta,dx,dtheta,ddx,ddtheta,u\n".to_string();
    for (k, s) in samples.iter().enumerate() {
        let cells: Vec<String> = s.iter().map(f64::to_string).collect();
        writeln!(text, "{},{}", STEP * k as f64, cells.join(",")).unwrap();
    }
    text
}

/// Positions alone, with noise relative to their spread.
fn positions(samples: &[Sample], noise: f64) -> String {
    let mut random = Random::new(5);
    let size = |i: usize| {
        let square: f64 = samples.iter().map(|s| s[i] * s[i]).sum();
        noise * (square / samples.len() as f64).sqrt()
    };
    let sizes = [size(0), size(1)];
    let mut text = "t,x,theta,u\n".to_string();
    for (k, s) in samples.iter().enumerate() {
        let [x, angle] = [0, 1].map(|i| s[i] + sizes[i] * random.normal());
        writeln!(text, "{},{x},{angle},{}", STEP * k as f64, s[6]).unwrap();
    }
    text
}

fn identify(model: &str, table: &str, more: &[&str]) -> Run {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("m.sid"), model).unwrap();
    std::fs::write(folder.path().join("d.csv"), table).unwrap();
    sidc_in(
        folder.path(),
        &[&["identify", "m.sid", "d.csv", "-q"], more].concat(),
    )
}

fn document(run: &Run) -> Value {
    serde_json::from_str(&run.stdout).unwrap_or_else(|_| panic!("{}{}", run.stdout, run.stderr))
}

/// The text of the reason `same-relation`, if the equation has it.
fn reason(document: &Value, equation: usize) -> Option<&str> {
    let reasons = document["equations"][equation]["reasons"].as_array()?;
    let own = reasons.iter().find(|r| r["code"] == "same-relation")?;
    own["text"].as_str()
}

fn says(document: &Value, equation: usize, wanted: &[&str]) {
    let text = reason(document, equation).unwrap_or_else(|| panic!("no reason in {document:#}"));
    for w in wanted {
        assert!(text.contains(w), "no {w} in {text}");
    }
}

fn coefficient(document: &Value, equation: usize, term: &str) -> f64 {
    let terms = document["equations"][equation]["terms"].as_array().unwrap();
    let found = terms.iter().find(|t| t["term"] == term);
    let found = found.unwrap_or_else(|| panic!("no {term} in {document:#}"));
    found["coefficient"].as_f64().unwrap()
}

/// Libraries for both laws; only the input is missing.
const NO_MOTOR: &str = "state x, theta : order 2
ddx     ~ <1, dx, x> + <1, sin theta, cos theta>*<ddtheta, sin theta, dtheta, dtheta^2>
ddtheta ~ <1, dtheta, dx> + <1, sin theta, cos theta>*<ddx, sin theta, dtheta, dtheta^2>\n";

fn with_command() -> String {
    NO_MOTOR
        .replace("order 2\n", "order 2\ninput u : hold\n")
        .replace("<1, dx, x>", "<1, dx, x, u>")
}

#[test]
fn a_cart_whose_motor_is_not_in_its_library_is_named() {
    let run = identify(NO_MOTOR, &exact(&SMALL.run(1000)), &["--json"]);
    assert_eq!(run.status, 3, "{}", run.stdout);
    let found = document(&run);
    says(
        &found,
        0,
        &[
            "the equation of ddx is that of ddtheta solved for ddx (divided by 2*cos(theta), 1.",
            "a law of its own would be ddx = ",
            "physics of ddx is missing from its library",
        ],
    );
    says(
        &found,
        1,
        &["the equation of ddx is this one solved for ddx"],
    );
    assert!((coefficient(&found, 1, "sin(theta)") + 19.62).abs() < 1e-6);
    let relation = &found["equations"][0]["evidence"]["relation"];
    assert_eq!(relation["of"], serde_json::json!(["ddtheta"]));
    assert_eq!(relation["independent"], false);
    assert!(relation["apart"].as_f64().unwrap() < 0.01, "{relation}");
    assert!(relation["condition"].as_f64().unwrap() > 1e3, "{relation}");
    assert!(
        relation["other"]["residual"].as_f64().unwrap() > 0.3,
        "{relation}"
    );
    assert!(found["equations"][1]["evidence"]["relation"].is_null());
}

/// The condition number of the mass matrix would not show this: it is only some hundreds.
#[test]
fn rough_copies_are_seen_from_what_they_leave_open() {
    let table = positions(&SMALL.run(1000), 1e-3);
    let run = identify(NO_MOTOR, &table, &["--json", "--method", "regression"]);
    let found = document(&run);
    says(
        &found,
        0,
        &["solved for ddx", "a law of its own would be ddx = "],
    );
    let relation = &found["equations"][0]["evidence"]["relation"];
    let condition = relation["condition"].as_f64().unwrap();
    assert!((10.0..1000.0).contains(&condition), "{relation}");
}

#[test]
fn integrals_show_the_copy_as_well() {
    let table = positions(&SMALL.run(1000), 1e-3);
    let run = identify(NO_MOTOR, &table, &["--json", "--method", "weak"]);
    let found = document(&run);
    says(
        &found,
        0,
        &["solved for ddx", "a law of its own would be ddx = "],
    );
    says(&found, 1, &["the equation of ddx is this one"]);
}

/// The pendulum's library lacks gravity, so it repeats the cart's law as nearly as possible without a division.
#[test]
fn the_one_that_lacks_physics_is_the_copy() {
    let model = "state x, theta : order 2
input u : hold
ddx     ~ <dx, u, ddtheta*cos(theta), dtheta^2*sin(theta), sin(theta)>
ddtheta ~ <1, cos(theta)>*<1, dtheta, ddx, u, dx, dtheta^2*sin(theta)>\n";
    let samples = CartPole { lag: 0.0, ..SMALL }.run(1000);
    let found = document(&identify(model, &exact(&samples), &["--json"]));
    says(
        &found,
        1,
        &[
            "the equation of ddtheta is that of ddx solved for ddtheta (divided by 0.1774*cos(theta)",
        ],
    );
    says(
        &found,
        0,
        &["the equation of ddtheta is this one solved for ddtheta"],
    );
}

/// The copy has fewer terms than the law: x and y are coupled by inertia, and only x is pushed.
#[test]
fn a_law_of_its_own_takes_the_place_of_a_shorter_copy() {
    let table = joined(0.3, [4.0, 9.0, 0.0], 3);
    let model = "state x, y : order 2\ninput u : hold
ddx ~ <x, y, dx, dy, x^2, y^2, ddy, u>\nddy ~ <x, y, dx, dy, x^2, y^2, ddx>\n";
    let run = identify(model, &table, &["--json"]);
    let found = document(&run);
    assert_eq!(run.status, 0, "{found:#}");
    let wanted = [("x", -4.0), ("dx", -0.2), ("u", 1.0), ("ddy", -0.3)];
    for (term, value) in wanted {
        let a = coefficient(&found, 0, term);
        assert!((a - value).abs() < 1e-9, "{term}: {a}");
    }
    let relation = &found["equations"][0]["evidence"]["relation"];
    assert_eq!(relation["independent"], true, "{found:#}");
    let run = identify(model, &table, &["--evidence"]);
    let line = run.stdout.lines().find(|l| l.contains("independent of"));
    let wanted = "chosen to be independent of the equation of ddy: {y, dy, ddy} leaves ";
    assert!(line.is_some_and(|l| l.contains(wanted)), "{}", run.stdout);
}

/// A motor that lags by three samples: the copy fits slightly better than the cart's law without the lag.
#[test]
fn a_bearable_law_takes_the_place_of_a_copy_and_says_so() {
    let cart = CartPole {
        command: 1.5,
        lag: 0.03,
        ..SMALL
    };
    let table = positions(&cart.run(600), 3e-3);
    let run = identify(
        &with_command(),
        &table,
        &["--json", "--method", "regression"],
    );
    let found = document(&run);
    says(
        &found,
        0,
        &[
            "by themselves these rows prefer that of ddtheta solved for ddx",
            "the best law of its own",
        ],
    );
    assert!(coefficient(&found, 0, "u") > 1.0);
    assert_eq!(reason(&found, 1), None);
}

/// Three laws, the third of which combines the first two; no two of them are equivalent.
#[test]
fn a_law_that_follows_from_two_others_is_named() {
    let mut random = Random::new(3);
    let mut wave = || {
        let parts: Vec<[f64; 3]> = (0..4)
            .map(|_| {
                [
                    random.uniform(),
                    1.0 + 5.0 * random.uniform(),
                    6.0 * random.uniform(),
                ]
            })
            .collect();
        move |t: f64| {
            parts
                .iter()
                .map(|[a, w, p]| a * (w * t + p).sin())
                .sum::<f64>()
        }
    };
    let (x, y, ddy) = (wave(), wave(), wave());
    let mut text = "t,x,y,z,ddx,ddy,ddz\n".to_string();
    for k in 0..400 {
        let t = STEP * f64::from(k);
        let (x, y, ddy) = (x(t), y(t), ddy(t));
        let (ddx, ddz) = (-4.0 * x + 0.3 * ddy, (ddy + 9.0 * y) / 0.2);
        writeln!(text, "{t},{x},{y},{},{ddx},{ddy},{ddz}", t * t).unwrap();
    }
    let model = "state x, y, z : order 2
ddx ~ <x, ddy, 1>\nddy ~ <y, ddz, 1>\nddz ~ <x, y, ddx, 1>\n";
    let found = document(&identify(model, &text, &["--json"]));
    let all: Vec<&str> = (0..3).filter_map(|i| reason(&found, i)).collect();
    assert_eq!(all.len(), 3, "{found:#}");
    assert!(
        all.iter().any(|r| r.contains(" follows from those of ")),
        "{all:?}"
    );
}

#[test]
fn what_is_shown_reads_well() {
    let run = identify(NO_MOTOR, &exact(&SMALL.run(1000)), &[]);
    let doubts = run.stdout.lines().skip_while(|l| !l.starts_with("doubt["));
    let text: Vec<&str> = doubts.take_while(|l| !l.is_empty()).collect();
    insta::assert_snapshot!(text.join("\n"));
}

/// Real couplings, with light and heavy bodies: with a heavy bob on a light cart the mass matrix is nearly singular, but well determined.
#[test]
fn a_heavy_bob_on_a_light_cart_is_no_copy() {
    for (cart, bob) in [(1.0, 0.1), (0.1, 1.0), (0.01, 10.0)] {
        let free = CartPole {
            cart,
            bob,
            lag: 0.0,
            ..SMALL
        };
        let run = identify(&with_command(), &exact(&free.run(600)), &["--json"]);
        let found = document(&run);
        assert_eq!(reason(&found, 0), None, "{cart} {bob}");
        assert_eq!(reason(&found, 1), None, "{cart} {bob}");
    }
}

/// A real double pendulum, coupled by its accelerations.
#[test]
fn a_measured_double_pendulum_is_no_copy() {
    let table = std::fs::read_to_string(record("pendulum_double_free.csv")).unwrap();
    let model = "state theta1, theta2 : order 2
data {
  dtheta1 = \"omega1\"
  dtheta2 = \"omega2\"
}
let near = <sin theta1, sin theta2, dtheta1, dtheta2>
ddtheta1 ~ near + cos(theta1 - theta2)*ddtheta2 + sin(theta1 - theta2)*<dtheta2^2, dtheta1^2>
ddtheta2 ~ near + cos(theta1 - theta2)*ddtheta1 + sin(theta1 - theta2)*<dtheta2^2, dtheta1^2>\n";
    for method in ["regression", "weak"] {
        let run = identify(
            model,
            &table,
            &["--json", "--window=..2", "--method", method],
        );
        let found = document(&run);
        assert_eq!(
            (reason(&found, 0), reason(&found, 1)),
            (None, None),
            "{method}"
        );
    }
}

prop_compose! {
    fn any_cart()(
        ratio in 0.05..0.95f64,
        rod in 0.2..2.0f64,
        command in 0.2..5.0f64,
        seed in 1u64..10_000,
    ) -> CartPole {
        CartPole { cart: 1.0 - ratio, bob: ratio, rod, command, lag: 0.0, seed }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    #[test]
    fn laws_of_well_posed_systems_are_never_taken_for_copies(cart in any_cart()) {
        let run = identify(&with_command(), &exact(&cart.run(500)), &["--json"]);
        let found = document(&run);
        prop_assert_eq!(reason(&found, 0), None);
        prop_assert_eq!(reason(&found, 1), None);
    }

    #[test]
    fn linear_laws_are_taken_for_copies_only_where_the_force_is_missing(
        joint in 0.1..0.9f64,
        springs in (1.0..30.0f64, 1.0..30.0f64, -0.8..0.8f64),
        seed in 1u64..10_000,
    ) {
        let (k1, k2, k12) = (springs.0, springs.1, springs.2 * (springs.0 * springs.1).sqrt());
        let text = joined(joint, [k1, k2, k12], seed);
        let own = "<x, y, dx, dy, x^2, y^2>";
        let model = |first: &str| format!(
            "state x, y : order 2\ninput u : hold\nddx ~ {own} + <ddy{first}>\nddy ~ {own} + <ddx>\n"
        );
        let found = document(&identify(&model(", u"), &text, &["--json"]));
        prop_assert_eq!(reason(&found, 0), None);
        prop_assert_eq!(reason(&found, 1), None);
        let found = document(&identify(&model(""), &text, &["--json"]));
        // Both are exact, so the data cannot show that the first lacks its force.
        let told = [0, 1].map(|i| reason(&found, i).unwrap_or_default());
        let copies = ["that of ddy solved for ddx", "that of ddx solved for ddy"];
        let named = told.iter().zip(copies).filter(|(t, c)| t.contains(c)).count();
        prop_assert_eq!(named, 1, "{:?}", told);
        prop_assert!(told.iter().all(|t| !t.is_empty()));
        prop_assert!(told.iter().any(|t| t.contains(" or of dd")), "{:?}", told);
    }
}
