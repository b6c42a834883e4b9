//! Units: they form a group, texts read back as printed, and coefficients have physical units.

use proptest::prelude::*;
use serde_json::Value;
use sidc::pipeline;
use sidc_lang as lang;
use sidc_lang::source::Sources;
use sidc_lang::units::{Commensurability, Unit, coefficient, parse};
use sidc_system::result;

use sidc_testing::program::{error_codes, sidc, sidc_in};

fn unit(text: &str) -> Unit {
    parse(text).unwrap_or_else(|f| panic!("{text}: {f:?}")).0
}

const WORDS: [&str; 34] = [
    "m", "s", "kg", "A", "K", "mol", "cd", "rad", "deg", "N", "Pa", "J", "W", "C", "V", "Ω", "F",
    "H", "T", "Hz", "g", "L", "bar", "min", "h", "rpm", "%", "°C", "mm", "kN", "µA", "cells",
    "USD", "thousand",
];

fn any_unit() -> impl Strategy<Value = Unit> {
    let factor = (0..WORDS.len(), -6i32..=6, 1i32..=3);
    prop::collection::vec(factor, 0..5).prop_map(|factors| {
        factors.iter().fold(Unit::one(), |u, (word, over, under)| {
            let word = unit(WORDS[*word]);
            u.times(&word.power(f64::from(*over) / f64::from(*under)).unwrap())
                .unwrap()
        })
    })
}

proptest! {
    #[test]
    fn what_is_printed_is_read_back(u in any_unit()) {
        prop_assert_eq!(&unit(&u.to_string()), &u);
    }

    #[test]
    fn units_are_a_commutative_group(a in any_unit(), b in any_unit(), c in any_unit()) {
        let times = |x: &Unit, y: &Unit| x.times(y).unwrap();
        prop_assert_eq!(times(&a, &b), times(&b, &a));
        prop_assert_eq!(times(&times(&a, &b), &c), times(&a, &times(&b, &c)));
        prop_assert_eq!(&times(&a, &b).per(&b).unwrap(), &a);
        prop_assert!(a.per(&a).unwrap().is_one());
        prop_assert_eq!(&times(&a, &Unit::one()), &a);
    }

    #[test]
    fn powers_undo_each_other(a in any_unit(), p in prop::sample::select(vec![-2.0, -1.0, 0.5, 1.5, 2.0, 3.0])) {
        prop_assert_eq!(&a.power(p).unwrap().power(1.0 / p).unwrap(), &a);
    }

    /// The unit of a coefficient times that of its term is the target's, however it is written.
    #[test]
    fn short_units_are_the_same_units(target in any_unit(), term in any_unit()) {
        let k = coefficient(&target, &term).unwrap();
        let product = k.times(&term).unwrap();
        prop_assert_eq!(product.commensurability(&target), Commensurability::Same, "{} = {} * {}", target, k, term);
        let words = |u: &Unit| u.to_string().split(|c: char| "*/^().-0123456789".contains(c)).filter(|w| !w.is_empty()).count();
        prop_assert!(words(&k) <= words(&target.per(&term).unwrap()), "{k}");
    }

    #[test]
    fn any_text_is_a_unit_or_a_fault_inside_it(text in "\\PC{0,60}") {
        match parse(&text) {
            Ok((u, _)) => prop_assert_eq!(unit(&u.to_string()), u),
            Err(f) => prop_assert!(text.get(f.at.clone()).is_some(), "{:?} of {:?}", f.at, text),
        }
    }

    #[test]
    fn soups_of_unit_signs_end(text in "[mskN1-3^*/(). ²⁻°%e·-]{0,60}") {
        match parse(&text) {
            Ok((u, _)) => prop_assert_eq!(unit(&u.to_string()), u),
            Err(f) => prop_assert!(text.get(f.at).is_some()),
        }
    }
}

#[test]
fn the_usual_ways_of_writing_mean_the_same() {
    for (texts, printed) in [
        (["m/s^2", "m/s/s", "m s-2", "m·s⁻²"], "m/s^2"),
        (["N m", "N*m", "Nm", "N.m"], "N*m"),
        (["kg*m^2", "kg m2", "kg·m²", "m**2*kg"], "kg*m^2"),
        (["Ω", "ohm", "Ohm", "\u{2126}"], "Ω"),
        (["µF", "uF", "μF", "(µF)"], "µF"),
        (["1/s", "s^-1", "s⁻¹", "s-1"], "1/s"),
        (["1", "", "  ", "1/1"], "1"),
        (["J/(kg*K)", "J/kg/K", "J kg-1 K-1", "J/(kg K)"], "J/(kg*K)"),
        (["mmol/L", "mmol/l", "mmol*L^-1", "mmol L-1"], "mmol/L"),
        (["m^0.5", "m^(1/2)", "m^2x", "m^(2/4)"], "m^0.5"),
        (["°C", "degC", "\u{2103}", "(°C)"], "°C"),
        (["kWh", "kW*h", "kW h", "h*kW"], "kW*h"),
    ] {
        for text in texts.into_iter().filter(|t| !t.ends_with('x')) {
            assert_eq!(unit(text).to_string(), printed, "{text}");
        }
    }
    assert_eq!(unit("m^(1/3)").to_string(), "m^(1/3)");
}

#[test]
fn units_of_one_quantity_are_known_to_be() {
    for (a, b) in [
        ("N", "kg*m/s^2"),
        ("J", "W*s"),
        ("V", "W/A"),
        ("Ω", "V/A"),
        ("F", "C/V"),
        ("H", "V*s/A"),
        ("T", "V*s/m^2"),
        ("Pa", "N/m^2"),
        ("Hz", "1/s"),
        ("rad", "1"),
        ("mrad", "rad/thousand"),
        ("L", "m^3/thousand"),
        ("M", "mol/L"),
        ("mg", "kg/million"),
        ("rad/s", "1/s"),
    ] {
        assert_eq!(
            unit(a).commensurability(&unit(b)),
            Commensurability::Same,
            "{a} {b}"
        );
    }
    for (a, b, factor) in [
        ("km", "m", 1e3),
        ("h", "min", 60.0),
        ("bar", "Pa", 1e5),
        ("deg", "rad", std::f64::consts::PI / 180.0),
        ("rpm", "rad/s", std::f64::consts::TAU / 60.0),
        ("%", "1", 0.01),
        ("kWh", "J", 3.6e6),
    ] {
        match unit(a).commensurability(&unit(b)) {
            Commensurability::Scaled(k) => assert!((k / factor - 1.0).abs() < 1e-9, "{a} {b} {k}"),
            other => panic!("{a} {b}: {other:?}"),
        }
    }
    for (a, b) in [
        ("m", "m/s"),
        ("cells", "1"),
        ("cells", "hares"),
        ("N", "J"),
        ("kg", "m"),
    ] {
        assert_eq!(
            unit(a).commensurability(&unit(b)),
            Commensurability::Different,
            "{a} {b}"
        );
    }
}

#[test]
fn coefficients_are_said_in_few_words() {
    for (target, term, expected) in [
        ("m/s^2", "N", "1/kg"),
        ("m/s^2", "m/s", "1/s"),
        ("m/s^2", "m", "1/s^2"),
        ("m/s^2", "m^3", "1/(m^2*s^2)"),
        ("m/s^2", "m^2/s^2", "1/m"),
        ("m/s^2", "rad/s^2", "m"),
        ("m/s^2", "1", "m/s^2"),
        ("rad/s^2", "rad/s", "1/s"),
        ("rad/s^2", "1", "rad/s^2"),
        ("rad/s^2", "V", "1/(V*s^2)"),
        ("rad/s^2", "N*m", "1/(kg*m^2)"),
        ("A/s", "V", "1/H"),
        ("V/s", "A", "1/F"),
        ("V", "A", "Ω"),
        ("V/s^2", "A/s", "1/F"),
        ("N", "m", "N/m"),
        ("N*m", "rad", "N*m"),
        ("m^2/s^2", "rad", "m^2/s^2"),
        ("K/s", "W", "K/J"),
        ("°C/s", "kW", "°C/(kW*s)"),
        ("mm/s^2", "N", "mm/(N*s^2)"),
        ("mmol/(L*s)", "mmol^2/L^2", "L/(mmol*s)"),
        (
            "thousand pelts/year",
            "thousand^2*pelts^2",
            "1/(thousand*pelts*year)",
        ),
        ("deg/s^2", "1", "deg/s^2"),
        ("cells/h", "cells", "1/h"),
    ] {
        let k = coefficient(&unit(target), &unit(term)).unwrap();
        assert_eq!(k.to_string(), expected, "{target} per {term}");
    }
}

/// The unit of each term in an equation of a result.
fn units_of(document: &Value, target: &str) -> Vec<(String, String)> {
    let equations = document["equations"].as_array().unwrap();
    let equation = equations.iter().find(|e| e["target"] == target).unwrap();
    let text = |v: &Value| v.as_str().unwrap_or("none").to_string();
    let terms = equation["terms"].as_array().unwrap().iter();
    terms
        .map(|t| (text(&t["term"]), text(&t["unit"])))
        .collect()
}

#[test]
fn the_pendulum_has_the_units_of_its_physics() {
    let run = sidc(&[
        "identify",
        "models/pendulum.sid",
        "models/data/pendulum.csv",
        "--json",
    ]);
    let document: Value = serde_json::from_str(&run.stdout).unwrap();
    let expected = |pairs: &[(&str, &str)]| -> Vec<(String, String)> {
        pairs
            .iter()
            .map(|(a, b)| (a.to_string(), b.to_string()))
            .collect()
    };
    assert_eq!(
        units_of(&document, "ddy"),
        expected(&[
            ("dy", "1/s"),
            ("F", "1/kg"),
            ("ddtheta*cos(theta)", "m"),
            ("dtheta^2*sin(theta)", "m"),
        ])
    );
    assert_eq!(
        units_of(&document, "ddtheta"),
        expected(&[
            ("dtheta", "1/s"),
            ("sin(theta)", "rad/s^2"),
            ("ddy*cos(theta)", "1/m")
        ])
    );
    assert_eq!(document["time_unit"], "s");
    assert_eq!(document["variables"][0]["unit"], "m");
    let d = result::read("r.json", &run.stdout).unwrap();
    let again = d.equations[0].terms.iter();
    let units: Vec<String> = again
        .map(|t| {
            d.coefficient_unit(d.equations[0].target, &t.term)
                .unwrap()
                .to_string()
        })
        .collect();
    assert_eq!(units, ["1/s", "1/kg", "m", "m"]);
}

#[test]
fn half_declared_models_print_what_is_known() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    let rows: String = (0..200)
        .map(|i| {
            let t = f64::from(i) * 0.01;
            let (x, v) = ((3.0 * t).cos(), -3.0 * (3.0 * t).sin());
            let u = (1.7 * t).sin();
            format!("{t},{x},{v},{},{u}\n", -9.0 * x + 2.0 * u)
        })
        .collect();
    write("d.csv", &format!("t,x,v,dv,u\n{rows}"));
    write(
        "m.sid",
        "state x\nstate v : unit \"m/s\"\ninput u : linear\ndx = v\ndv ~ <1, x, v, u>\n",
    );
    let run = sidc_in(folder.path(), &["identify", "m.sid", "d.csv", "--json"]);
    let document: Value = serde_json::from_str(&run.stdout).unwrap();
    assert!(
        units_of(&document, "dv")
            .iter()
            .all(|(t, u)| (t == "v") == (u != "none"))
    );
    write(
        "m.sid",
        "state x : unit \"m\"\nstate v : unit \"m/s\"\ninput u : linear, unit \"kN\"\ndx = v\ndv ~ <1, x, v, u>\n",
    );
    let run = sidc_in(folder.path(), &["identify", "m.sid", "d.csv", "--evidence"]);
    assert!(
        run.stdout.contains("    units: x 1/s^2, u m/(kN*s^2)\n"),
        "{}",
        run.stdout
    );
    assert!(run.stdout.contains("    units: v 1\n"), "{}", run.stdout);
    let run = sidc_in(folder.path(), &["check", "m.sid"]);
    assert!(
        run.stdout
            .contains("units: x m, v m/s, u kN, t s; targets dx m/s, dv m/s^2\n"),
        "{}",
        run.stdout
    );
}

#[test]
fn units_in_result_documents_are_read_as_units_only() {
    let read = |unit: &str| {
        let text = format!(
            r#"{{"sidc_result": 1, "variables": [{{"name": "x", "kind": "state", "order": 1, "unit": {}}}],
            "equations": [{{"target": "dx", "terms": [{{"term": "x", "coefficient": 2.0}}], "status": "pass"}}]}}"#,
            Value::from(unit)
        );
        result::read("r.json", &text).map_err(|d| d.code)
    };
    assert_eq!(read("m").unwrap().variables[1].unit, Some(unit("m")));
    let long = "m".repeat(100_000);
    let deep = format!("{}m{}", "(".repeat(100), ")".repeat(100));
    for text in [
        "m\"\nstate y",
        "m\nstate y",
        "m^1e300",
        "m^-1e300",
        "2 m",
        &long,
        &deep,
        "\u{1b}[31m",
    ] {
        assert_eq!(read(text).err(), Some("result-damaged"), "{text:?}");
    }
}

/// The codes of errors in a model.
fn codes(text: &str) -> Vec<&'static str> {
    let mut sources = Sources::default();
    let file = sources.add("m.sid", text);
    let (_, found) = lang::compile(file, &sources, &pipeline::vocabulary());
    error_codes(&found)
}

#[test]
fn only_sums_that_cannot_be_are_refused() {
    let base = "state x : order 2, unit \"m\"\nstate th : order 2, unit \"rad\"\ninput u\ninput w : unit \"1\"\nparam L : unit \"m\"\n";
    for right in [
        "~ <x, dx> + <x> + dx",
        "~ <x - 2*dx, x + 1, 1 - x^2, u + x + dx, x + u*dx>",
        "~ <sin(x/L), exp(-t/2), exp(-t*dx/x), sin(2*x), sin(1.2*t), log(x/L)>",
        "~ <th + w, sin(th + w), sin th, exp(w), sign(x), sqrt(x^2 + L^2)>",
        "~ <abs(x) + x, max(x, L, 0), min(x, 2*dx), (x*dx)^0.5 + sqrt(x*dx)>",
        "~ known(-9.8/L*sin th) + poly(x, dx, th; 3)",
        "~ fourier(x/L; 2) + fourier(th; 2) + fourier(1.2*t; 2)",
        "= -9.8/L*sin th - 0.1*dth",
        "~ <x^0.123456789 + dx, x^1000 + dx>",
        "~ <x^(1/2) + sqrt(x), x^(3/2)/x + sqrt(x), x^(2*3/6) + x, x^(2/1/2) + x>",
    ] {
        assert_eq!(codes(&format!("{base}ddx {right}\n")), [""; 0], "{right}");
    }
    for (right, code) in [
        ("~ <x + dx>", "unit-sum"),
        ("~ <1 + x + dx>", "unit-sum"),
        ("~ known(x - dx) + <u>", "unit-sum"),
        ("= x + dx", "unit-sum"),
        ("~ <sin(x + dx)>", "unit-sum"),
        ("~ <x*(x - L^2)>", "unit-sum"),
        ("~ <max(x, dx)>", "unit-sum"),
        ("~ <x^0.5 + x>", "unit-sum"),
        ("~ <x^(1/2) + x>", "unit-sum"),
        ("~ <x^(3/2) + x>", "unit-sum"),
        ("~ <sqrt(x) + x>", "unit-sum"),
        ("~ <sin x>", "unit-argument"),
        ("~ <exp(t)>", "unit-argument"),
        ("~ sin(x) * <1, u>", "unit-argument"),
        ("~ poly(x, exp(-x); 2)", "unit-argument"),
        ("~ fourier(t; 2)", "unit-argument"),
        ("~ fourier(x; 2)", "unit-argument"),
    ] {
        assert_eq!(codes(&format!("{base}ddx {right}\n")), [code], "{right}");
    }
    // If nothing has a unit, time has none either.
    assert_eq!(codes("state x\ndx ~ <x, exp(t), sin x, x + t>\n"), [""; 0]);
}

#[test]
fn discrete_models_have_units_without_rates() {
    let text = "state x : unit \"m\"\ninput u : unit \"N\"\nnext x ~ <x, u, x - lag(x, 1)>\n";
    assert_eq!(codes(text), [""; 0]);
    assert_eq!(codes(&text.replace("lag(x, 1)", "lag(u, 1)")), ["unit-sum"]);
}

#[test]
fn hostile_units_are_harmless() {
    let model = |unit: &str| format!("state x : unit \"{unit}\"\ndx ~ <x>\n");
    for unit in [
        "m".repeat(100_000),
        "(".repeat(100_000),
        format!("{}m{}", "(".repeat(150), ")".repeat(40)),
        "m^1e300".into(),
        "m^99999999999999999999999".into(),
        "m^(1/0)".into(),
        "m⁹⁹⁹⁹⁹⁹⁹⁹⁹⁹⁹⁹⁹⁹⁹⁹⁹⁹⁹⁹⁹⁹".into(),
        "((((m^100)^100)^100)^100)^100".into(),
        "m^100/m^-100".into(),
        "///".into(),
        "\u{1b}[31m".into(),
    ] {
        let found = codes(&model(&unit));
        assert!(!found.is_empty(), "{unit:.80}");
    }
    // Large powers of terms have no unit, which is not an error.
    let text = "state x : unit \"mm\"\ninput u : unit \"N\"\ndx ~ powers(x, u; 60) - <x^60*u^60>\n";
    assert_eq!(codes(text), [""; 0]);
    let many: Vec<String> = (0..3000).map(|i| format!("sin(x) + {i}*x + dx")).collect();
    let text = format!(
        "state x : order 2, unit \"m\"\nddx ~ <{}>\n",
        many.join(", ")
    );
    assert!(codes(&text).len() <= 20);
}
