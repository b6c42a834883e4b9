//! Targets for other modelling systems, run or parsed there: JAX, CasADi, SBML, Modelica and Julia.

use std::fs;
use std::process::Command;

use super::languages::{cases, emitted, list};
use super::reference::{Case, check_to, compare, number};
use sidc_emit as emit;
use sidc_testing::runtimes::{self, finished};

/// Runs a Python script on a file for each case, with the points of each: `[t, groups…]`.
fn run_all(
    modules: &str,
    target: &str,
    suffix: &str,
    cases: &[Case],
    script: &str,
) -> Option<String> {
    let python = runtimes::python(modules)?;
    let folder = tempfile::tempdir().unwrap();
    let mut calls = String::from(script);
    for (k, case) in cases.iter().enumerate() {
        let name = format!("m{k}.{suffix}");
        fs::write(folder.path().join(&name), emitted(target, case)).unwrap();
        let point = |p: &super::reference::Point| {
            let groups: String = p
                .groups
                .iter()
                .map(|g| format!("[{}], ", list(g)))
                .collect();
            format!("({:?}, {groups}), ", p.t)
        };
        let points: String = case.points.iter().map(point).collect();
        let functions: Vec<String> = case.functions().iter().map(|f| format!("'{f}'")).collect();
        let functions = functions.join(", ");
        let points = points.replace("NaN", "nan");
        calls.push_str(&format!("show({name:?}, [{points}], [{functions}])\n"));
    }
    let path = folder.path().join("run_all.py");
    fs::write(&path, calls).unwrap();
    let mut command = Command::new(python);
    let command = command.arg("-B").arg(path).current_dir(folder.path());
    Some(finished(command.env("JAX_PLATFORMS", "cpu")))
}

/// The cases that a target supports.
fn taken(target: &str) -> Vec<Case> {
    let target = emit::target(target).unwrap();
    let all = cases().into_iter();
    all.filter(|case| target.emit(&case.discovery).is_ok())
        .collect()
}

const SHOWN: &str = "
import importlib
from math import nan, inf

def numbers(values):
    print(*(repr(float(v)) for v in values))
";

const JAX: &str = "
import jax
import numpy as np
jax.config.update('jax_enable_x64', True)

def show(name, points, functions):
    m = importlib.import_module(name[:-3])
    rates = m.next if hasattr(m, 'next') else getattr(m, 'derivatives', None)
    slopes = {'jacobian': 1, 'jacobian_input': 2}
    each = [jax.jacfwd(rates, slopes[f]) if f in slopes else getattr(m, f) for f in functions]
    compiled = jax.jit(lambda t, *groups: [f(t, *groups).reshape(-1) for f in each])
    for t, *groups in points:
        groups = [np.array(g) for i, g in enumerate(groups) if i == 0 or len(g)]
        for values in compiled(t, *groups):
            numbers(np.asarray(values))
";

#[test]
fn jax_agrees_with_the_evaluator() {
    // JAX takes a second to compile each case.
    let cases: Vec<Case> = cases().into_iter().step_by(5).collect();
    let script = format!("{SHOWN}{JAX}");
    if let Some(printed) = run_all("jax", "jax", "py", &cases, &script) {
        compare("jax", &cases, &printed);
    }
}

const CASADI: &str = "
import casadi as ca

def show(name, points, functions):
    m = importlib.import_module(name[:-3])
    made = {}
    for f in functions:
        rates = 'next' if hasattr(m, 'next') else 'derivatives'
        own = getattr(m, (f if f == 'outputs' else rates) + '_function')()
        if f.startswith('jacobian'):
            symbols = own.sx_in()
            by = symbols[1 if f == 'jacobian' else 2]
            own = ca.Function(f, symbols, [ca.jacobian(own(*symbols), by)])
        made[f] = own
    for t, *groups in points:
        groups = [g for i, g in enumerate(groups) if i == 0 or len(g)]
        for f in functions:
            numbers(ca.DM(made[f](t, *groups)).full().reshape(-1))
";

#[test]
fn casadi_agrees_with_the_evaluator() {
    let cases = taken("casadi");
    assert!(cases.len() > 70, "{}", cases.len());
    let script = format!("{SHOWN}{CASADI}");
    if let Some(printed) = run_all("casadi", "casadi", "py", &cases, &script) {
        compare("casadi", &cases, &printed);
    }
}

const SBML: &str = "
import re
import roadrunner

def show(name, points, functions):
    text = open(name).read()
    ids = re.findall('<parameter id=\"([^\"]+)\"', text)
    states = re.findall('<rateRule variable=\"([^\"]+)\"', text)
    # A parameter of the data has no value of its own, without which nothing is loaded.
    r = roadrunner.RoadRunner(re.sub('(<parameter id=\"[^\"]+\") constant=\"true\"', r'\\1 value=\"1\" constant=\"true\"', text))
    for t, state, given, parameter, history, constant in points:
        r.model.setTime(t)
        for i, value in zip(ids, state + given + history + parameter + constant):
            r[i] = value
        numbers([r[x + \"'\"] for x in states])
";

/// Compares only rates, since a simulator computes its own Jacobian. libroadrunner treats NaN in `min` and `max` in its own way.
#[test]
fn sbml_agrees_with_the_evaluator() {
    let dynamic = |c: &Case| !c.form.rows.is_empty();
    let cases: Vec<Case> = taken("sbml").into_iter().filter(dynamic).collect();
    assert!(cases.len() > 15, "{}", cases.len());
    let script = format!("{SHOWN}{SBML}");
    if let Some(printed) = run_all("roadrunner", "sbml", "xml", &cases, &script) {
        compare_rates("sbml", &cases, &printed);
    }
}

const MODELICA: &str = "
import logging
import casadi as ca
from pymoca.backends.casadi.api import transfer_model
from pymoca.backends.casadi import generator
logging.disable(logging.CRITICAL)
# Its name in Python 2.
generator.OP_MAP['/'] = '__truediv__'

def show(name, points, functions):
    text = open(name).read()
    try:
        model = transfer_model('.', [l.split()[1] for l in text.splitlines() if l.startswith('model ')][0], {})
    except Exception as error:
        raise SystemExit(f'{error!r} in {text}') from None
    residual = model.dae_residual_function
    sizes = [residual.numel_in(i) for i in range(7)]
    rates, others = ca.MX.sym('r', sizes[2]), ca.MX.sym('a', sizes[3])
    known = [ca.MX.sym('k', sizes[i]) for i in (0, 1, 4, 5, 6)]
    t, x, u, c, p = known
    equations = residual(t, x, rates, others, u, c, p)
    # From the right sides of the right sides: explicit equations are solved by that.
    left = ca.vertcat(rates, others)
    once = ca.Function('once', [left, ca.vertcat(*known)], [left - equations, equations])
    solve = ca.rootfinder('solve', 'newton', {'x': ca.vertcat(rates, others), 'p': ca.vertcat(*known), 'g': equations}, {'error_on_fail': False})
    for t, state, given, parameter, history, constant in points:
        given = [t] + state + given + constant + parameter
        start = ca.DM([0.1] * (sizes[2] + sizes[3]))
        for _ in range(sizes[3] + 2):
            after = once(start, given)[0]
            start = after if after.is_regular() else start
        found = solve(x0=start, p=given)['x']
        solved = ca.norm_inf(once(found, given)[1]) < 1e-9 * (1 + ca.norm_inf(found))
        numbers(found.full().reshape(-1)[:len(state)] if solved else [nan] * len(state))
";

/// The equations as Modelica parses them, solved for the rates.
#[test]
fn modelica_agrees_with_the_evaluator() {
    // pymoca has no inverse trigonometric functions.
    let known = |c: &Case| {
        ["asin(", "acos(", "atan("]
            .iter()
            .all(|f| !emitted("modelica", c).contains(f))
    };
    let whole = |c: &Case| c.form.linear && !c.form.rows.is_empty() && known(c);
    let mut cases: Vec<Case> = taken("modelica").into_iter().filter(whole).collect();
    for (k, case) in cases.iter_mut().enumerate() {
        case.discovery.system = Some(format!("m{k}"));
    }
    assert!(cases.len() > 15, "{}", cases.len());
    let script = format!("{SHOWN}{MODELICA}");
    if let Some(printed) = run_all("pymoca, casadi", "modelica", "mo", &cases, &script) {
        compare_rates("modelica", &cases, &printed);
    }
}

/// Compares lines of rates, one per case and point, if they are finite.
fn compare_rates(language: &str, cases: &[Case], printed: &str) {
    let mut lines = printed.lines();
    let mut compared = 0;
    for (k, case) in cases.iter().enumerate() {
        for (i, point) in case.points.iter().enumerate() {
            let line = lines.next().unwrap_or_default();
            let place = || format!("{language}, system {k}, point {i}: {line}");
            let got: Vec<f64> = line.split_whitespace().map(number).collect();
            assert_eq!(got.len(), point.rates.len(), "{}", place());
            if got.iter().chain(&point.rates).all(|x| x.is_finite()) {
                check_to(1e-9, &got, &point.rates, &place);
                compared += 1;
            }
        }
    }
    assert_eq!(lines.next(), None);
    assert!(compared > 40, "{compared}");
}

const JULIA: &str = "
import tree_sitter
import tree_sitter_julia

parser = tree_sitter.Parser(tree_sitter.Language(tree_sitter_julia.language()))

def wrong(node):
    inner = next((found for child in node.children if (found := wrong(child))), None)
    return inner or (node.parent.text[:200] if node.is_error or node.is_missing else None)

def show(name, points, functions):
    root = parser.parse(open(name, 'rb').read()).root_node
    print(name, wrong(root) if root.has_error else False)
";

/// Julia is not run, but its grammar must parse every file.
#[test]
fn julia_is_well_formed() {
    let cases = taken("julia");
    let script = format!("{SHOWN}{JULIA}");
    if let Some(printed) = run_all(
        "tree_sitter, tree_sitter_julia",
        "julia",
        "jl",
        &cases,
        &script,
    ) {
        let wrong: Vec<&str> = printed.lines().filter(|l| !l.ends_with(" False")).collect();
        assert_eq!(wrong, [] as [&str; 0]);
        assert!(printed.lines().count() > 70);
    }
}
