//! The library as other programs use it, apart from the search.

use std::collections::BTreeSet;

use sidc::{Data, Discovery, ErrorKind, Model, Options, Target, Unwatched};
use sidc_testing::program::{file, sidc};

/// The pendulum on a cart, identified from the arrays of its record.
fn pendulum() -> (Data, Discovery) {
    let text = file("models/data/pendulum.csv");
    let mut lines = text.lines().filter(|l| !l.starts_with('#'));
    let mut columns: Vec<(String, Vec<f64>)> = lines
        .next()
        .map(|head| head.split(',').map(|n| (n.into(), Vec::new())).collect())
        .unwrap_or_default();
    for line in lines {
        for ((_, values), cell) in columns.iter_mut().zip(line.split(',')) {
            values.push(cell.parse().unwrap());
        }
    }
    let data = Data::new().run(columns).unwrap();
    let model = Model::named("pendulum.sid", &file("models/pendulum.sid")).unwrap();
    let found = model.identify(&data, &Options::default()).unwrap();
    (data, found)
}

#[test]
fn runs_start_where_they_are_told() {
    let (_, found) = pendulum();
    let t: Vec<f64> = (0..40).map(|k| 0.02 * f64::from(k)).collect();
    let force = vec![0.0; t.len()];
    let data = Data::new().run([("t", t), ("F", force)]).unwrap();
    let hanging = [("y", 0.0), ("dy", 0.0), ("theta", 0.1), ("dtheta", 0.0)];
    let run = found
        .simulate_from(&hanging, &data, &mut Unwatched)
        .unwrap();
    let theta = run.runs[0].signal("theta").unwrap();
    assert_eq!(theta[0], 0.1);
    assert!(theta[20] < theta[0] && run.runs[0].measured.is_empty());
    // State components without an initial value must be measured.
    let lacking = found.simulate_from(&hanging[..3], &data, &mut Unwatched);
    assert_eq!(lacking.unwrap_err().kind(), ErrorKind::Data);
    let unknown = found.simulate_from(&[("phi", 0.0)], &data, &mut Unwatched);
    let error = unknown.unwrap_err();
    assert_eq!(
        (error.kind(), error.codes()),
        (ErrorKind::Options, vec!["unknown-start"])
    );
    assert!(
        error.to_string().contains("state: y, dy, theta, dtheta"),
        "{error}"
    );
}

/// Solves M q = f at a point: the plant in the header of the model, with both accelerations computed by hand.
#[test]
fn the_right_side_is_the_plant_and_its_slopes_are_differences() {
    let (_, found) = pendulum();
    let mut right_side = found.right_side().unwrap();
    assert_eq!(right_side.states(), ["y", "dy", "theta", "dtheta"]);
    assert_eq!(
        (right_side.inputs(), right_side.input_delays()),
        (&["F".to_string()][..], &[0.0][..])
    );
    let (x, u) = ([0.1, -0.3, 0.7, 1.1], [2.0]);
    let mut rates = [0.0; 4];
    right_side.rates(0.0, &x, &u, &mut rates);
    let (sin, cos) = (x[2].sin(), x[2].cos());
    let cart = -0.0645161 * x[1] + 1.290323 * u[0] + 0.177419 * x[3] * x[3] * sin;
    let rod = -0.145455 * x[3] - 19.6 * sin;
    let ddy = (cart - 0.177419 * cos * rod) / (1.0 - 2.0 * 0.177419 * cos * cos);
    let expected = [x[1], ddy, x[3], rod - 2.0 * cos * ddy];
    for (rate, expected) in rates.iter().zip(expected) {
        assert!((rate - expected).abs() < 1e-4, "{rates:?} {expected}");
    }
    let mut slopes = [0.0; 16];
    right_side.jacobian(0.0, &x, &u, &mut slopes);
    for column in 0..4 {
        let step = 1e-6;
        let (mut ahead, mut behind) = ([0.0; 4], [0.0; 4]);
        let at = |by: f64| {
            let mut moved = x;
            moved[column] += by;
            moved
        };
        right_side.rates(0.0, &at(step), &u, &mut ahead);
        right_side.rates(0.0, &at(-step), &u, &mut behind);
        for row in 0..4 {
            let difference = (ahead[row] - behind[row]) / (2.0 * step);
            assert!((slopes[4 * row + column] - difference).abs() < 1e-6);
        }
    }
    // Slices of the wrong length give NaN.
    for (x, u) in [(&x[..3], &u[..]), (&x[..], &[][..])] {
        right_side.rates(0.0, x, u, &mut rates);
        assert!(rates.iter().all(|r| r.is_nan()));
    }
}

#[test]
fn predictions_along_given_data_are_those_of_the_verdict() {
    let (data, found) = pendulum();
    let same = found.predict(&data, None, &mut Unwatched).unwrap();
    assert_eq!(same, found.verdict().unwrap().prediction);
    let asked = found.predict(&data, Some(0.2), &mut Unwatched).unwrap();
    assert_eq!((asked.horizon, asked.signals.len()), (0.2, 4));
}

/// Verdict, equations and figures are those of the program; only statements about files differ.
#[test]
fn the_page_is_that_of_the_program() {
    let (data, found) = pendulum();
    let page = found.report(&data, &mut Unwatched).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let result = folder.path().join("R.json").display().to_string();
    let record = "models/data/pendulum.csv";
    assert_eq!(
        sidc(&["identify", "models/pendulum.sid", record, "-o", &result]).status,
        0
    );
    let theirs = sidc(&["report", &result, record])
        .stdout
        .replace("pendulum.csv", "run 1");
    let sections = ["equations", "coefficients", "prediction", "series"];
    for id in sections {
        let of = |page: &str| {
            let from = page
                .find(&format!("<section id=\"{id}\""))
                .unwrap_or_else(|| panic!("no {id}"));
            let to = page[from..].find("</section>").unwrap();
            page[from..from + to].to_string()
        };
        assert_eq!(of(&page), of(&theirs), "{id}");
    }
}

#[test]
fn a_part_of_a_page_stands_by_itself() {
    let (_, found) = pendulum();
    let part = found.html();
    assert!(part.starts_with("<div class=\"sidc\">") && part.ends_with("</div>\n"));
    for element in ["div", "p", "table", "math", "style", "span"] {
        let opened = part.matches(&format!("<{element}>")).count()
            + part.matches(&format!("<{element} ")).count();
        assert_eq!(
            opened,
            part.matches(&format!("</{element}>")).count(),
            "{element}"
        );
    }
    assert!(part.contains("law: passes, every term is firm"));
    assert!(found.answer().contains("law: passes, every term is firm"));
}

#[test]
fn names_are_looked_up() {
    assert_eq!(Target::named("c").unwrap(), Target::C);
    let error = Target::named("cobol").unwrap_err();
    assert_eq!(
        (error.kind(), error.codes()),
        (ErrorKind::Options, vec!["unknown-target"])
    );
    assert!(Options::default().method_named("weak").is_ok());
    let error = Options::default().method_named("magic").err().unwrap();
    assert!(
        error
            .to_string()
            .contains("there are auto, joint, regression, weak"),
        "{error}"
    );
    let words = Model::vocabulary();
    assert!(words.contains(&"sin") && words.contains(&"poly"));
    let still = Data::new()
        .run([("t", vec![0.0, 1.0]), ("x", vec![1.0, 1.0])])
        .unwrap();
    assert_eq!(still.draft().unwrap_err().codes(), ["no-state"]);
}

/// With new lists of terms, the other libraries of the statement and the known parts are kept, also in families.
#[test]
fn libraries_are_listed_anew() {
    let model = Model::parse(
        "state x1..x3\ninput u\ndx[i] ~ known(2*u - x[i]) + poly(x[i-1], x[i]; 2), i = 1..3 cyclic\n",
    )
    .unwrap();
    let narrow = model.with_terms(&[("dx2", vec!["x1*x2", "1"])]).unwrap();
    assert_eq!(narrow.targets(), model.targets());
    let terms = |m: &Model, target: &str| -> BTreeSet<String> {
        m.candidate_terms(target).into_iter().flatten().collect()
    };
    for target in ["dx1", "dx3"] {
        assert_eq!(terms(&narrow, target), terms(&model, target));
    }
    assert_eq!(
        terms(&narrow, "dx2"),
        ["1", "x1*x2"].map(String::from).into()
    );
    assert!(narrow.text().contains("dx2 ~ known("), "{}", narrow.text());
    let refused = model.with_terms(&[("dx4", vec!["1"])]).unwrap_err();
    assert_eq!(refused.codes(), ["unknown-target"]);
    assert!(model.with_terms(&[("dx2", vec!["x1*("])]).is_err());
}

#[test]
fn only_a_record_that_is_there_is_held_out() {
    let (data, _) = pendulum();
    let model = Model::named("pendulum.sid", &file("models/pendulum.sid")).unwrap();
    let error = model.identify(&data, &Options::default().hold_out_run(1));
    let error = error.unwrap_err();
    assert_eq!(
        (error.kind(), error.codes()),
        (ErrorKind::Options, vec!["unknown-record"])
    );
    assert!(error.to_string().contains("the data have 1"), "{error}");
}
