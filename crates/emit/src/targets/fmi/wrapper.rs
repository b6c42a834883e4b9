//! `fmi3.c`: the functions of FMI around those of the equations.
//!
//! In: a program and its variables. Out: C without any name that a user chose.

use super::variables::{Role, Variables};
use crate::code::c_sources::with_prefix;
use crate::code::program::{Kind, Program};

const COMMON: &str = include_str!("fmi3.c");
const CALLS: &str = include_str!("calls.c");
const SLOPES: &str = include_str!("directional_derivatives.c");
const NO_SLOPES: &str = include_str!("no_directional_derivatives.c");
const UNUSED: &str = include_str!("unused.c");

/// True if the FMU gives directional derivatives; outputs and events have no Jacobians.
pub(super) fn has_directional_derivatives(program: &Program) -> bool {
    program.get(Kind::Jacobian).is_some()
        && program.form.outputs.is_empty()
        && program.switches.is_empty()
}

pub(super) fn text(program: &Program, variables: &Variables) -> String {
    let slopes = match has_directional_derivatives(program) {
        true => SLOPES.replace("@JACOBIANS@", &jacobians(program)),
        false => NO_SLOPES.into(),
    };
    let calls = calls(program);
    let text = [
        COMMON.replace("@CALLS@\n", &calls).as_str(),
        &slopes,
        UNUSED,
    ]
    .concat();
    let count = |role: Role| variables.count(role).to_string();
    let starts = |role: Role| {
        let all = variables.starts(role);
        let all: Vec<String> = all.iter().map(|x| number(*x)).collect();
        match all.is_empty() {
            true => "0.0".into(),
            false => all.join(", "),
        }
    };
    let text = text
        .replace("@STATES@", &starts(Role::State))
        .replace("@INPUTS@", &starts(Role::Input))
        .replace("@PARAMETERS@", &starts(Role::Parameter))
        .replace("@N@", &count(Role::State))
        .replace("@U@", &count(Role::Input))
        .replace("@P@", &count(Role::Parameter))
        .replace("@Y@", &count(Role::Output))
        .replace("@K@", &count(Role::Guard))
        .replace("@PASS@", &passed(program));
    with_prefix(program, text)
}

fn number(x: f64) -> String {
    match x.is_nan() {
        true => "NAN".into(),
        false => format!("{x:?}"),
    }
}

/// The arguments after the state; constants are stored after the parameters.
fn passed(program: &Program) -> String {
    let given = program.form.params.len();
    let argument = |name: &str| match name {
        "constant" => format!(", v->parameter + {given}"),
        name => format!(", v->{name}"),
    };
    let others = program.arguments.iter().skip(1);
    others.map(|a| argument(a.name)).collect()
}

fn calls(program: &Program) -> String {
    let events = !program.switches.is_empty();
    let has = |kind: Kind| program.get(kind).is_some();
    let rates = match (events, has(Kind::Rates)) {
        (true, _) => RATES_BY_SIDE,
        (false, true) => "    sidc_derivatives(v->t, v->state@PASS@, rate);",
        (false, false) => "    (void)v, (void)rate;",
    };
    let outputs = match has(Kind::Outputs) {
        true => "    sidc_outputs(v->t, v->state@PASS@, output);",
        false => "    (void)v, (void)output;",
    };
    let on_events = |text: &'static str, without: &'static str| if events { text } else { without };
    CALLS
        .replace("@RATES@", rates)
        .replace("@OUTPUTS@", outputs)
        .replace(
            "@MARGINS@",
            on_events(MARGINS, "    (void)v, (void)margin;"),
        )
        .replace(
            "@SETTLE@",
            on_events(
                "    sidc_settle(v->t, v->state@PASS@, v->side);",
                "    (void)v;",
            ),
        )
        .replace("@DECIDE@", on_events(DECIDE, "    (void)v;"))
}

fn jacobians(program: &Program) -> String {
    let mut out = String::from("    sidc_jacobian(v->t, v->state@PASS@, by_state);\n");
    out.push_str(match program.get(Kind::InputJacobian) {
        Some(_) => "    sidc_jacobian_input(v->t, v->state@PASS@, by_input);",
        None => "    by_input[0] = 0.0;",
    });
    out
}

const RATES_BY_SIDE: &str = "    double full[GUARDS];
    sidc_held(v->t, v->state@PASS@, v->side, full);
    sidc_rates_by_side(v->t, v->state@PASS@, full, rate);";

const MARGINS: &str = "    double full[GUARDS], guard[GUARDS];
    sidc_held(v->t, v->state@PASS@, v->side, full);
    sidc_guards(v->t, v->state@PASS@, guard);
    for (int k = 0; k < GUARDS; k++) {
        margin[k] = v->side[k] == 0.0 ? 1.0 - fabs(full[k]) : v->side[k] * guard[k];
    }";

/// A guard that an input moved by a jump is let go; one that the motion took to zero is decided.
const DECIDE: &str = "    int crossed[GUARDS], any = 0;
    double margin[GUARDS], guard[GUARDS], unmoved[GUARDS];
    const Values now = *v;
    sidc_guards(v->t, v->state@PASS@, guard);
    memcpy(v->input, v->before, sizeof v->input);
    sidc_guards(v->t, v->state@PASS@, unmoved);
    memcpy(v->input, now.input, sizeof v->input);
    for (int k = 0; k < GUARDS; k++) {
        if (guard[k] != unmoved[k] && guard[k] != 0.0 && v->side[k] * guard[k] <= 0.0) {
            v->side[k] = guard[k] < 0.0 ? -1.0 : 1.0;
        }
    }
    margins(v, margin);
    for (int k = 0; k < GUARDS; k++) {
        crossed[k] = margin[k] < 0.0;
        any = any || crossed[k];
    }
    if (any) {
        sidc_decide(v->t, v->state@PASS@, v->side, crossed);
    }";
