//! FMUs, validated, compiled and run by fmpy, compared with our evaluator and our runs.

use std::fs;
use std::io::Read;
use std::path::Path;
use std::process::Command;

use super::events;
use super::languages::{cases, list};
use super::reference::{Case, check, check_to, number};
use super::{constants, systems};
use sidc_emit as emit;
use sidc_emit::Written;
use sidc_system::discovery::Discovery;
use sidc_system::result;
use sidc_testing::program::sidc;
use sidc_testing::runtimes::{self, finished};

/// The files in an archive with their contents.
fn unpacked(bytes: &[u8]) -> Vec<(String, String)> {
    let archive = rawzip::ZipArchive::from_slice(bytes).unwrap();
    let mut entries = archive.entries();
    let mut all = Vec::new();
    while let Some(entry) = entries.next_entry().unwrap() {
        let path = String::from_utf8_lossy(entry.file_path().as_ref()).into_owned();
        let content = archive.get_entry(entry.wayfinder()).unwrap();
        let inflated = flate2::bufread::DeflateDecoder::new(content.data());
        let mut text = String::new();
        let mut reader = content.verifying_reader(inflated);
        reader.read_to_string(&mut text).unwrap();
        all.push((path, text));
    }
    all
}

/// The written text; for an archive the text of all its files.
pub fn readable(written: Written) -> String {
    match written {
        Written::Text(text) => text,
        Written::Binary { bytes, .. } => unpacked(&bytes).into_iter().map(|(_, t)| t).collect(),
    }
}

fn fmu(d: &Discovery) -> Vec<u8> {
    emit::target("fmi").unwrap().emit(d).unwrap().into_bytes()
}

/// Functions that compile and open FMUs. cmake is in the interpreter's folder.
const OPENED: &str = "
import ctypes, os, re, sys
os.environ['PATH'] = os.path.dirname(sys.executable) + os.pathsep + os.environ['PATH']
import numpy as np
from math import nan, inf
import fmpy
from fmpy.build import build_platform_binary
from fmpy.fmi3 import FMU3Model
from fmpy.validation import validate_fmu

def compiled(name):
    problems = validate_fmu(name)
    assert not problems, problems
    folder = os.path.abspath(name + '.d')
    os.makedirs(folder)
    fmpy.extract(name, unzipdir=folder)
    out = os.dup(1)
    os.dup2(2, 1)
    build_platform_binary(folder, all_warnings=True, cmake_options={'CMAKE_COMPILE_WARNING_AS_ERROR:BOOL': 'ON'})
    os.dup2(out, 1)
    binary = fmpy.read_model_description(folder).modelExchange.modelIdentifier + fmpy.sharedLibraryExtension
    library = ctypes.CDLL(os.path.join(folder, 'binaries', fmpy.platform_tuple, binary))
    header = open(os.path.join(os.path.dirname(fmpy.__file__), 'c-code', 'fmi3Functions.h')).read()
    functions = re.findall('FMI3_Export +fmi3[A-Za-z0-9]+TYPE +(fmi3[A-Za-z0-9]+);', header)
    lacking = [f for f in functions if not hasattr(library, f)]
    assert len(functions) > 70 and not lacking, (len(functions), lacking)
    return folder

def numbers(values):
    print(*(repr(float(v)) for v in values))

def opened(folder, values, start):
    description = fmpy.read_model_description(folder)
    fmu = FMU3Model(guid=description.guid, unzipDirectory=folder, modelIdentifier=description.modelExchange.modelIdentifier, instanceName='it')
    fmu.instantiate()
    fmu.enterInitializationMode(startTime=start)
    fmu.setFloat64(list(values), list(values.values()))
    fmu.exitInitializationMode()
    fmu.enterContinuousTimeMode()
    return fmu
";

/// Rates, Jacobians and outputs at the points of each case.
const POINTS: &str = "
def show(name, points, functions):
    folder = compiled(name)
    variables = fmpy.read_model_description(folder).modelVariables
    of = lambda causality: [v.valueReference for v in variables if v.causality == causality]
    states = [v.derivative.valueReference for v in variables if v.derivative]
    rates = [v.valueReference for v in variables if v.derivative]
    outputs = [r for r in of('output') if r not in states]
    for t, state, given, parameter, history, constant in points:
        values = dict(zip(states + of('input') + of('parameter'), state + given + parameter + constant))
        fmu = opened(folder, values, t)
        for f in functions:
            if f == 'derivatives':
                numbers(fmu.getFloat64(rates))
            elif f == 'outputs':
                numbers(fmu.getFloat64(outputs))
            else:
                by = states if f == 'jacobian' else of('input')
                rows = [fmu.getDirectionalDerivative(rates, [x], [1.0]) for x in by]
                numbers(np.array(rows).T.reshape(-1))
        fmu.terminate()
        fmu.freeInstance()
";

fn python_points(case: &Case) -> String {
    let point = |p: &super::reference::Point| {
        let groups = p.groups.iter().map(|g| format!("[{}], ", list(g)));
        format!("({:?}, {}), ", p.t, groups.collect::<String>())
    };
    let points: String = case.points.iter().map(point).collect();
    points.replace("NaN", "nan")
}

/// The functions of an FMU; Jacobians only if there are neither outputs nor events.
fn functions(case: &Case, text: &str) -> Vec<&'static str> {
    let slopes = text.contains("providesDirectionalDerivatives=\"true\"");
    let all = case.functions().into_iter();
    all.filter(|f| slopes || !f.starts_with("jacobian"))
        .collect()
}

#[test]
fn an_fmu_agrees_with_the_evaluator() {
    let Some(python) = runtimes::fmpy() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let target = emit::target("fmi").unwrap();
    // Each takes a second to compile: those written by hand, and some random ones.
    let all = cases().into_iter().enumerate();
    let some = all.filter(|(i, c)| !c.discovery.discrete && (*i < 6 || i % 16 == 0));
    let cases: Vec<Case> = some
        .map(|(_, c)| c)
        .chain([Case::new(constants(), 4, 1)])
        .collect();
    let mut script = format!("{OPENED}{POINTS}");
    let mut asked = Vec::new();
    for (k, case) in cases.iter().enumerate() {
        let written = target.emit(&case.discovery).unwrap();
        let functions = functions(case, &readable(written.clone()));
        let name = format!("m{k}.fmu");
        fs::write(folder.path().join(&name), written.into_bytes()).unwrap();
        script.push_str(&format!(
            "show({name:?}, [{}], {functions:?})\n",
            python_points(case)
        ));
        asked.push(functions);
    }
    let slopes = asked.iter().flatten().filter(|f| f.starts_with("jacobian"));
    assert!(cases.len() >= 8 && slopes.count() >= 6, "{asked:?}");
    let printed = run(&python, folder.path(), &script);
    let mut lines = printed.lines();
    for (k, (case, functions)) in cases.iter().zip(&asked).enumerate() {
        for (i, point) in case.points.iter().enumerate() {
            for f in functions {
                let place = || format!("fmi, system {k}, point {i}, {f}");
                let got = lines
                    .next()
                    .unwrap_or_else(|| panic!("{}: nothing", place()));
                let got: Vec<f64> = got.split_whitespace().map(number).collect();
                let expected = case.expected(point, f);
                assert_eq!(got.len(), expected.len(), "{}", place());
                check(&got, expected, !case.form.coupled(), &place);
            }
        }
    }
    assert_eq!(lines.next(), None);
}

fn run(python: &Path, folder: &Path, script: &str) -> String {
    fs::write(folder.join("run_all.py"), script).unwrap();
    finished(
        Command::new(python)
            .args(["-B", "run_all.py"])
            .current_dir(folder),
    )
}

/// Units, a delayed input, a parameter from the data, an unknown constant, an output, and names that XML does not accept unchanged.
const EVERYTHING: &str = r#"{"sidc_result": 1, "system": "tank", "time": "continuous", "time_unit": "s",
    "variables": [{"name": "θ", "kind": "state", "order": 2, "unit": "rad"}, {"name": "u", "kind": "input", "unit": "N"},
        {"name": "m", "kind": "param", "unit": "kg"}, {"name": "K", "kind": "unknown"}, {"name": "a", "kind": "output"},
        {"name": "b", "kind": "output"}],
    "equations": [
        {"target": "ddθ", "terms": [{"term": "u/m", "coefficient": 3.0}, {"term": "exp(-K*θ^2)", "coefficient": -1.0}], "status": "doubt",
            "reasons": [{"code": "misfit", "text": "a < b & \"c\""}]},
        {"target": "a", "terms": [{"term": "ddθ", "coefficient": 2.0}], "status": "pass"},
        {"target": "b", "terms": [{"term": "dθ*m", "coefficient": 0.5}], "status": "pass"}],
    "delays": [{"signal": "u", "seconds": 0.2}],
    "unknowns": [{"name": "K", "value": 0.8, "standard_error": 0.01}]}"#;

fn everything() -> Discovery {
    result::read("R.json", EVERYTHING).unwrap_or_else(|d| panic!("{}", d.message))
}

#[test]
fn a_model_description_reads_well() {
    let all = unpacked(&fmu(&everything()));
    let names: Vec<&str> = all.iter().map(|(name, _)| name.as_str()).collect();
    let sources = [
        "sources/buildDescription.xml",
        "sources/equations.c",
        "sources/fmi3.c",
    ];
    assert_eq!(names, [&["modelDescription.xml"], &sources[..]].concat());
    // The token changes with the code, the version with every release.
    let lines = all[0].1.lines().chain(all[1].1.lines());
    let changes = |l: &&str| !l.contains("instantiationToken=") && !l.contains("generationTool=");
    let kept: String = lines.filter(changes).map(|l| format!("{l}\n")).collect();
    insta::assert_snapshot!(kept);
}

const EVERYTHING_RUN: &str = "
folder = compiled('m.fmu')
description = fmpy.read_model_description(folder)
named = {v.name: v for v in description.modelVariables}
of = {name: v.valueReference for name, v in named.items()}
print([v.name for v in description.modelVariables if v.causality == 'input'], named['K'].start, named['K'].variability)
told = []

def instance(token=description.guid):
    fmu = FMU3Model(guid=token, unzipDirectory=folder, modelIdentifier='tank', instanceName='it')
    fmu.instantiate(logMessage=lambda environment, status, category, message: told.append(message.decode()))
    return fmu

def refused(call):
    try:
        call()
    except Exception:
        return told.pop() if told else 'without a word'
    return 'done'

print(refused(lambda: instance('{another}')))
fmu = instance()
fmu.enterInitializationMode()
print(refused(fmu.exitInitializationMode))
fmu.setFloat64([of['m']], [2.0])
fmu.exitInitializationMode()
fmu.enterContinuousTimeMode()
fmu.setFloat64([of['θ'], of['delay(u, 0.2)']], [1.0, 4.0])
kept = fmu.getFMUState()
rate = lambda: fmu.getFloat64([of['der(dθ)'], of['a']])
numbers(rate())
fmu.setFloat64([of['K'], of['θ']], [0.0, 0.5])
numbers(rate())
fmu.setFMUState(fmu.deserializeFMUState(fmu.serializeFMUState(kept)))
numbers(rate())
print(refused(lambda: fmu.setFloat64([of['a']], [1.0])))
print(refused(lambda: fmu.getInt32([1])))
print(refused(lambda: fmu.getDirectionalDerivative([of['a']], [of['θ']], [1.0])))
";

/// Parameters can be set, states can be saved, and misuse is rejected with a message.
#[test]
fn an_fmu_has_parameters_and_says_what_is_missing() {
    let Some(python) = runtimes::fmpy() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("m.fmu"), fmu(&everything())).unwrap();
    let printed = run(&python, folder.path(), &format!("{OPENED}{EVERYTHING_RUN}"));
    let lines: Vec<&str> = printed.lines().collect();
    let first = 6.0 - (-0.8_f64).exp();
    let rates = [first, 5.0, first].map(|x| [x, 2.0 * x]);
    for (line, expected) in lines[3..6].iter().zip(&rates) {
        let got: Vec<f64> = line.split_whitespace().map(number).collect();
        check_to(1e-12, &got, expected, &|| (*line).into());
    }
    insta::assert_snapshot!([&lines[..3], &lines[6..]].concat().join("\n"));
}

#[test]
fn an_fmu_is_of_continuous_time_and_the_same_each_time() {
    let target = emit::target("fmi").unwrap();
    assert_eq!(target.emit(&everything()), target.emit(&everything()));
    let (_, discrete) = systems().remove(3);
    let why = target.emit(&discrete).unwrap_err();
    assert!(why.starts_with("FMI is for continuous time here"), "{why}");
}

#[test]
fn a_binary_file_is_not_printed() {
    let run = sidc(&["export", "benches/emitted/pendulum.json", "--to", "fmi"]);
    assert_eq!((run.status, run.stdout.as_str()), (1, ""));
    assert_eq!(
        run.stderr,
        "error[binary-export]: a file of `fmi` is binary and is not printed\n  = help: name one: -o pendulum.fmu\n"
    );
}

/// Times of the inputs; every jump has two.
const RUN: &str = "
def course(name, step, given, start):
    folder = compiled(name)
    rows = [(0.0, given[0])]
    for k, (before, after) in enumerate(zip(given, given[1:]), 1):
        rows += [(k * step, before), (k * step, after)] if before != after else []
    rows.append((len(given) * step, given[-1]))
    signals = np.array(rows, dtype=[('time', float), ('u', float)])
    found = fmpy.simulate_fmu(
        folder, start_values=start, input=signals, stop_time=step * (len(given) - 1), output_interval=10 * step, relative_tolerance=1e-10,
        record_events=False)
    for row in found:
        numbers(list(row)[1:])
";

/// Sticking and slipping friction, with events found by CVODE, under a stepwise force.
#[test]
fn an_fmu_runs_from_event_to_event() {
    let Some(python) = runtimes::fmpy() else {
        return;
    };
    for system in events::systems() {
        let folder = tempfile::tempdir().unwrap();
        let ours = events::ours(&system, folder.path());
        let path = |name: &str| folder.path().join(name).display().to_string();
        let args = [
            "export",
            &path("R.json"),
            "--to",
            "fmi",
            "-o",
            &path("m.fmu"),
        ];
        let exported = sidc(&args);
        assert_eq!(
            (exported.status, exported.stdout.as_str()),
            (0, ""),
            "{}",
            exported.stderr
        );
        let forces = list(&events::forces());
        let script = format!(
            "{OPENED}{RUN}course('m.fmu', {}, [{forces}], {{}})\n",
            events::STEP
        );
        let printed = run(&python, folder.path(), &script);
        let rows: Vec<&str> = printed.lines().collect();
        assert_eq!(rows.len(), ours.len().div_ceil(10), "{printed}");
        for (k, (row, expected)) in rows.iter().zip(ours.iter().step_by(10)).enumerate() {
            let got: Vec<f64> = row.split_whitespace().map(number).collect();
            assert_eq!(got.len(), expected.len());
            for (a, b) in got.iter().zip(expected) {
                let near = (a - b).abs() < 1e-5;
                assert!(near, "{} at {k}: {got:?} is not {expected:?}", system.name);
            }
        }
    }
}
