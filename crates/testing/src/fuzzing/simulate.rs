//! Systems and records that nobody measured: a result document from bytes, and a short run of it.
//!
//! Promises: the document is opened or refused; a run or one refusal; a run ends soon after it is told to; every value is finite, and a run
//! that ends early says why.

use std::ops::ControlFlow;

use super::bytes::Bytes;
use sidc_data as data;
use sidc_data::Limits;
use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::render;
use sidc_lang::source::Sources;
use sidc_lang::term::Signal;
use sidc_progress::{Activity, Stop};
use sidc_system::discovery::Form;
use sidc_system::result;
use sidc_system::simulate;
use sidc_system::simulate::{FaultKind, Method, Options, Run, Source};

/// Factors of terms; those of signals that a system lacks are left out.
const FACTORS: [&str; 24] = [
    "x",
    "y",
    "dx",
    "dy",
    "u",
    "v",
    "m",
    "t",
    "ddx",
    "x^2",
    "x^3",
    "y^2",
    "1/x",
    "1/(1 + x^2)",
    "sin(x)",
    "cos(y)",
    "exp(x)",
    "log(x)",
    "sqrt(y)",
    "abs(x)",
    "sign(x)",
    "min(x, u)",
    "x^0.5",
    "exp(-x*y)",
];
const DISCRETE: [&str; 12] = [
    "x",
    "y",
    "u",
    "lag(x, 1)",
    "lag(u, 2)",
    "lag(y, 3)",
    "m",
    "x^2",
    "sin(x)",
    "1/x",
    "exp(y)",
    "t",
];

/// Activities after which a run is told to stop, and how many more it may report: trials of the start, the run itself, and each leg.
const PATIENCE: (usize, usize) = (12, 200);

pub fn simulate(data: &[u8]) {
    let mut bytes = Bytes::new(data);
    let system = System::of(&mut bytes);
    let document = system.document(&mut bytes);
    let opened = match result::open("fuzz.json", &document) {
        Ok(opened) => opened,
        Err(d) => return assert!(!d.message.is_empty()),
    };
    let form = Form::new(&opened.discovery);
    let outputs: Vec<Signal> = form.outputs.iter().map(|(s, _)| *s).collect();
    let options = options(&mut bytes, &form);
    let table = system.table(&mut bytes);
    let mut sources = Sources::default();
    let table = data::read(
        "fuzz.csv",
        table.as_bytes(),
        &Limits::default(),
        &mut sources,
    );
    let table = table.unwrap_or_else(|d| panic!("{}", render(&d, &sources, false)));
    let model = simulate::reads(&opened.discovery, &opened.model, &options.start);
    let (dataset, said) = data::bind(&model, &[table], &[], &mut sources);
    if said.iter().any(Diagnostic::is_error) {
        return;
    }
    let source = Source {
        discovery: &opened.discovery,
        model: &model,
        dataset: &dataset,
    };
    let mut asked = 0;
    let run = simulate::simulate(&source, 0, &options, &mut |_: Activity| {
        asked += 1;
        assert!(
            asked < PATIENCE.0 + PATIENCE.1,
            "it does not stop\n{document}"
        );
        match asked < PATIENCE.0 {
            true => ControlFlow::Continue(()),
            false => ControlFlow::Break(Stop::Interrupted),
        }
    });
    match run {
        Ok(run) => is_sound(&run, &outputs, &document),
        Err(d) => assert!(!d.message.is_empty()),
    }
}

fn is_sound(run: &Run, outputs: &[Signal], document: &str) {
    let rows = run.time.len();
    let said = |code: &str| run.notes.iter().any(|n| n.code == code);
    for leg in &run.legs {
        assert!(
            leg.rows.start <= leg.rows.end && leg.rows.end <= rows,
            "{leg:?} of {rows}"
        );
        for (signal, values) in run.simulated.iter().chain(&run.inputs) {
            assert_eq!(values.len(), rows);
            let bad = values[leg.rows.clone()].iter().position(|x| !x.is_finite());
            // A run does not depend on its outputs: it goes on if one is undefined, and says so.
            let is_said = outputs.contains(signal) && said("output-undefined");
            assert!(
                bad.is_none() || is_said,
                "{signal:?} is no number in row {bad:?} of {leg:?}\n{document}"
            );
        }
        let fault = leg.fault.as_ref().map(|f| f.kind.code());
        assert!(fault.is_none_or(|code| !code.is_empty()));
    }
    let stopped = |k: &FaultKind| matches!(k, FaultKind::Stopped);
    assert!(
        run.legs
            .iter()
            .rev()
            .skip(1)
            .all(|l| !l.fault.as_ref().is_some_and(|f| stopped(&f.kind)))
    );
    for s in &run.scores {
        assert!(
            s.rows > 0 && !s.mse.is_nan() && !s.mae.is_nan(),
            "{s:?}\n{document}"
        );
        assert!(s.follows.is_none_or(f64::is_finite), "{s:?}\n{document}");
    }
}

/// The signals of a system.
struct System {
    discrete: bool,
    /// Orders of x and, if there is one, y.
    states: Vec<usize>,
    inputs: Vec<&'static str>,
    param: bool,
    output: bool,
}

impl System {
    fn of(bytes: &mut Bytes) -> System {
        let flags = bytes.byte();
        let on = |bit: u8| flags & (1 << bit) != 0;
        let order = |two: bool| if two && !on(0) { 2 } else { 1 };
        let mut states = vec![order(on(1))];
        if on(2) {
            states.push(order(on(3)));
        }
        System {
            discrete: on(0),
            states,
            inputs: ["u", "v"]
                .into_iter()
                .take(usize::from(on(4)) + usize::from(on(5) && on(4)))
                .collect(),
            param: on(6),
            output: on(7),
        }
    }

    fn has(&self, factor: &str) -> bool {
        let mut names = factor
            .split(|c: char| !c.is_ascii_alphabetic())
            .filter(|n| !n.is_empty());
        let absent = |n: &str| match n {
            "y" => self.states.len() < 2,
            "dx" => self.discrete,
            "ddx" => self.discrete || self.states[0] < 2,
            "dy" => self.discrete || self.states.len() < 2,
            "u" => self.inputs.is_empty(),
            "v" => self.inputs.len() < 2,
            "m" => !self.param,
            _ => false,
        };
        !names.any(absent)
    }

    fn target(&self, state: usize) -> String {
        let name = ["x", "y"][state];
        match (self.discrete, self.states[state]) {
            (true, _) => format!("next({name})"),
            (false, order) => "d".repeat(order) + name,
        }
    }

    fn document(&self, bytes: &mut Bytes) -> String {
        let mut variables: Vec<String> = Vec::new();
        let mut declare = |name: &str, kind: &str, order: usize| {
            variables.push(format!(
                r#"{{"name": "{name}", "kind": "{kind}", "order": {order}}}"#
            ));
        };
        for (name, order) in ["x", "y"].iter().zip(&self.states) {
            declare(name, "state", *order);
        }
        self.inputs.iter().for_each(|u| declare(u, "input", 0));
        if self.param {
            declare("m", "param", 0);
        }
        if self.output {
            declare("w", "output", 0);
        }
        let targets = (0..self.states.len()).map(|s| self.target(s));
        let targets = targets.chain(self.output.then(|| "w".to_string()));
        let equations: Vec<String> = targets.map(|t| self.equation(&t, bytes)).collect();
        let between = match self.inputs.first().filter(|_| bytes.rarely(2)) {
            Some(u) => format!(r#""between": {{"{u}": "linear"}}"#),
            None => String::new(),
        };
        format!(
            r#"{{"sidc_result": 1, "time": "{}", "variables": [{}], "equations": [{}], "settings": {{"reading": {{{between}}}}}}}"#,
            if self.discrete {
                "discrete"
            } else {
                "continuous"
            },
            variables.join(", "),
            equations.join(", ")
        )
    }

    fn equation(&self, target: &str, bytes: &mut Bytes) -> String {
        let factors: &[&str] = if self.discrete { &DISCRETE } else { &FACTORS };
        let mut terms = Vec::new();
        for _ in 0..bytes.below(5) {
            let chosen: Vec<&str> = (0..bytes.within(0, 2))
                .map(|_| bytes.pick(factors))
                .collect();
            let known: Vec<&str> = chosen.into_iter().filter(|f| self.has(f)).collect();
            let term = if known.is_empty() {
                "1".into()
            } else {
                known.join("*")
            };
            terms.push(format!(
                r#"{{"term": "{term}", "coefficient": {:?}}}"#,
                bytes.number()
            ));
        }
        format!(
            r#"{{"target": "{target}", "status": "pass", "terms": [{}]}}"#,
            terms.join(", ")
        )
    }

    /// Times that mostly rise evenly, and a column for every signal.
    fn table(&self, bytes: &mut Bytes) -> String {
        let mut names = vec!["t", "x"];
        names.extend((self.states.len() > 1).then_some("y"));
        names.extend(&self.inputs);
        names.extend(self.param.then_some("m"));
        names.extend(self.output.then_some("w"));
        if !self.discrete && bytes.rarely(2) {
            names.push("dx");
        }
        let step = bytes.pick(&[0.1, 0.01, 1.0, 1e-6, 50.0, 1e5, 1e-300, 1e200]);
        let rows = bytes.within(1, 24);
        let constant = bytes.number();
        let mut text = names.join(",") + "\n";
        let mut time = bytes.pick(&[0.0, 0.0, 0.0, -1.0, 1e6]);
        for _ in 0..rows {
            let mut cells = vec![format!("{time:?}")];
            for name in &names[1..] {
                let held = !self.discrete && bytes.is_empty();
                cells.push(match name {
                    _ if bytes.rarely(32) => "NaN".into(),
                    &"m" => format!("{constant:?}"),
                    _ if held => "0.5".into(),
                    _ => format!("{:?}", bytes.number()),
                });
            }
            text += &(cells.join(",") + "\n");
            let stretched = bytes.pick(&[1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 7.0, 0.5]);
            time += if self.discrete { 1.0 } else { step * stretched };
        }
        text
    }
}

fn options(bytes: &mut Bytes, form: &Form) -> Options {
    let method = bytes.pick(&[Method::Auto, Method::Explicit, Method::Stiff]);
    let step = bytes
        .rarely(4)
        .then(|| bytes.pick(&[0.1, 0.01, 1.0, 1e-3, 10.0]));
    let given = bytes.rarely(4).then(|| bytes.number());
    let start = form.state.first().zip(given).map(|(s, x)| (*s, x));
    let window = match bytes.rarely(8) {
        true => (Some(bytes.tame()), None),
        false => (None, None),
    };
    Options {
        start: start.into_iter().collect(),
        window,
        method,
        step,
        ..Options::default()
    }
}
