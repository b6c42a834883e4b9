//! How often the sparsest equation is proved within a minute, for the gallery's models and ODEBench.
//!
//! ```sh
//! cargo run --release -p sidc-studies --bin sparsest -- --odebench ../shared/data/odebench > docs/sparsest.csv
//! ```
//!
//! In: `models/*.sid` with their data; a folder with `equations.json` and the tables that it names. Out: a CSV row per equation; on standard error how many
//! were proved. The whole program runs on each model. Equations that were not found by regression with a tolerance have the reason in their last column.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::error::Error;
use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use clap::Parser;
use serde_json::Value;
use sidc::pipeline;
use sidc::{Activity, Options, Stage, Stop};
use sidc_lang::source::Sources;
use sidc_lang::term::SignalNames;
use sidc_system::discovery::{Discovery, Evidence, SparsestProof};

/// Measures how often the sparsest equation is proved.
#[derive(Parser)]
struct Args {
    /// Folder of ODEBench, with `equations.json`; the gallery alone if not given
    #[arg(long)]
    odebench: Option<PathBuf>,
    /// Folder of the gallery
    #[arg(long, default_value = "models")]
    models: PathBuf,
    /// Seconds for all equations of a model
    #[arg(long, default_value_t = 60.0)]
    seconds: f64,
    /// Only cases whose name holds this
    #[arg(long)]
    only: Option<String>,
}

struct Case {
    set: &'static str,
    name: String,
    model: String,
    tables: Vec<PathBuf>,
}

/// A line of the table, and whether the equation is proved; `None` if no proof was attempted.
type Row = (String, Option<bool>);

/// Time of each equation's proof, by index.
#[derive(Default)]
struct Times {
    taken: BTreeMap<usize, Duration>,
    last: Option<(usize, Instant)>,
}

fn main() -> Result<(), Box<dyn Error>> {
    let args = Args::parse();
    let mut cases = gallery(&args.models)?;
    if let Some(folder) = &args.odebench {
        cases.extend(odebench(folder)?);
    }
    println!(
        "set,case,target,rows,candidates,tolerance,terms,sparsest,lower,proved,others,all_others,nodes,seconds,not_looked_for"
    );
    let mut counts: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
    for case in &cases {
        if args.only.as_ref().is_some_and(|w| !case.name.contains(w)) {
            continue;
        }
        for (line, proved) in rows(case, args.seconds)? {
            println!("{line}");
            let count = counts.entry(case.set).or_default();
            count.1 += usize::from(proved.is_some());
            count.0 += usize::from(proved == Some(true));
        }
    }
    for (set, (proved, all)) in counts {
        eprintln!("{set}: {proved} of {all} equations found from rows are proved");
    }
    Ok(())
}

/// Every model of the gallery with its tables.
fn gallery(folder: &Path) -> Result<Vec<Case>, Box<dyn Error>> {
    let mut cases = Vec::new();
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        let name = path
            .file_stem()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        if path.extension().is_none_or(|e| e != "sid") {
            continue;
        }
        let tables: &[&str] = match name.as_str() {
            "pendulum_768" | "pendulum_symmetry" => &["pendulum"],
            "sir" => &["sir_a", "sir_b"],
            own => &[own],
        };
        let table = |t: &&str| folder.join("data").join(format!("{t}.csv"));
        cases.push(Case {
            set: "gallery",
            model: fs::read_to_string(&path)?,
            tables: tables.iter().map(table).collect(),
            name,
        });
    }
    cases.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(cases)
}

/// Every ODEBench system that is linear in its coefficients, with the library of its class.
fn odebench(folder: &Path) -> Result<Vec<Case>, Box<dyn Error>> {
    let document: Value =
        serde_json::from_str(&fs::read_to_string(folder.join("equations.json"))?)?;
    let systems = document["systems"].as_array().ok_or("no systems")?;
    let case = |system: &Value| {
        let (id, states) = (system["id"].as_u64()?, system["dim"].as_u64()?);
        let names: Vec<String> = (0..states).map(|i| format!("x{i}")).collect();
        let library = library(system["class"].as_str()?, id, &names)?;
        let rates: Vec<String> = names.iter().map(|x| format!("d{x}")).collect();
        let files = system["files"].as_array()?.iter();
        Some(Case {
            set: "odebench",
            name: format!("ode{id:02}"),
            model: format!(
                "state {}\n{} ~ {library}\n",
                names.join(", "),
                rates.join(", ")
            ),
            tables: files
                .filter_map(|f| Some(folder.join(f.as_str()?)))
                .collect(),
        })
    };
    Ok(systems.iter().filter_map(case).collect())
}

/// The candidates that the benchmark's score assigns to a class; `None` if no library is linear in the coefficients.
fn library(class: &str, id: u64, names: &[String]) -> Option<String> {
    let poly = |degree: usize| format!("poly({}; {degree})", names.join(", "));
    let all = names.join(", ");
    let of = |f: &str| -> String {
        let each: Vec<String> = names.iter().map(|x| format!("{f}({x})")).collect();
        each.join(", ")
    };
    let (sines, cosines) = (of("sin"), of("cos"));
    match class {
        "poly3" => Some(poly(3)),
        "poly_high" => Some(poly(if id == 16 { 5 } else { 4 })),
        "poly_trig" | "poly_logabs" => {
            let more = match id {
                21 => format!(" + <{}, exp(-x0)>", of("exp")),
                44 => " + <x0*abs(x0), x1*abs(x1)>".into(),
                _ => String::new(),
            };
            let trig = format!("<{sines}, {cosines}> + <{sines}> * <{sines}, {cosines}>");
            let mixed = format!("<{all}> * <{sines}, {cosines}>");
            let cosines = match names {
                [a, b] => format!(" + <cos({a})*cos({b})>"),
                _ => String::new(),
            };
            Some(format!("{} + {trig} + {mixed}{cosines}{more}", poly(2)))
        }
        _ => None,
    }
}

/// One row per equation.
fn rows(case: &Case, seconds: f64) -> Result<Vec<Row>, Box<dyn Error>> {
    let mut sources = Sources::default();
    let file = sources.add(format!("{}.sid", case.name), case.model.as_str());
    let program = pipeline::compile(file, &sources, pipeline::MEMORY).0;
    let program = program.ok_or_else(|| format!("{} does not compile", case.name))?;
    let limits = sidc_data::Limits::default();
    let mut tables = Vec::new();
    for path in &case.tables {
        let bytes = fs::read(path).map_err(|e| format!("{}: {e}", path.display()))?;
        let table = sidc_data::read(&path.to_string_lossy(), &bytes[..], &limits, &mut sources);
        tables.push(table.map_err(|_| format!("{} is no table", path.display()))?);
    }
    let data = pipeline::from_tables(tables, Vec::new());
    let options = Options::default().prove_sparsest();
    let times = RefCell::new(Times::default());
    let equations = program.model.equations.len().max(1);
    let mut observer = |activity: Activity| times.borrow_mut().hear(activity, seconds, equations);
    let measured = pipeline::measure(&program, &data, &options, &mut sources, &mut observer);
    let measured = measured
        .0
        .ok_or_else(|| format!("{}: no signals", case.name))?;
    let found = pipeline::identify(&program, &measured, &options, &mut observer);
    let found = found.map_err(|_| format!("{}: a term has no value", case.name))?;
    let taken = &times.borrow().taken;
    let mut out = Vec::new();
    for equation in &found.equations {
        let place = program
            .model
            .equations
            .iter()
            .position(|e| e.target == equation.target);
        let took = place
            .and_then(|p| taken.get(&p))
            .copied()
            .unwrap_or_default();
        let own = equation.terms.iter().filter(|t| !t.fixed).count();
        let Some((evidence, sparsest)) = looked_at(equation.evidence.as_ref()) else {
            continue;
        };
        let head = format!(
            "{},{},{}",
            case.set,
            case.name,
            target(&found, equation.target)
        );
        out.push(line(&head, evidence, sparsest, (own, took)));
    }
    Ok(out)
}

fn target(found: &Discovery, signal: sidc_lang::term::Signal) -> String {
    found.name(signal)
}

fn looked_at(evidence: Option<&Evidence>) -> Option<(&Evidence, &SparsestProof)> {
    let evidence = evidence?;
    Some((evidence, evidence.sparsest.as_deref()?))
}

fn line(head: &str, evidence: &Evidence, s: &SparsestProof, (own, took): (usize, Duration)) -> Row {
    let (rows, candidates) = (evidence.rows, evidence.candidates);
    if let Some(reason) = &s.refused {
        let reason = reason.replace(',', ";");
        return (
            format!("{head},{rows},{candidates},,{own},,,,,,,,{reason}"),
            None,
        );
    }
    let text = format!(
        "{head},{rows},{candidates},{:.2e},{own},{},{},{},{},{},{},{:.3},",
        s.tolerance,
        s.terms.map_or_else(String::new, |n| n.to_string()),
        s.lower,
        s.proved,
        s.other_count,
        s.all_others,
        s.nodes,
        took.as_secs_f64()
    );
    (text, Some(s.proved))
}

impl Times {
    /// Adds up the time of the proofs, and ends a proof that has used its share.
    fn hear(&mut self, activity: Activity, seconds: f64, equations: usize) -> ControlFlow<Stop> {
        let Activity::Equation {
            place,
            stage: Stage::Proving { .. },
        } = activity
        else {
            // Any other activity marks the end of the proof.
            if let Some((place, since)) = self.last.take() {
                *self.taken.entry(place).or_default() += since.elapsed();
            }
            return ControlFlow::Continue(());
        };
        let now = Instant::now();
        if let Some((last, since)) = self.last.replace((place, now)) {
            *self.taken.entry(last).or_default() += now - since;
        }
        let all: f64 = self.taken.values().map(Duration::as_secs_f64).sum();
        let part = (place + 1) as f64 / equations as f64;
        match all < seconds * part {
            true => ControlFlow::Continue(()),
            false => ControlFlow::Break(Stop::TimeLimit(Duration::from_secs_f64(seconds))),
        }
    }
}
