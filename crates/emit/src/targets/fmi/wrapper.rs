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
    let decide = match (events, program.has_jumps()) {
        (_, true) => [MOVED, JUMP].concat(),
        (true, false) => [MOVED, DECIDE].concat(),
        (false, false) => "    (void)v;\n    return 0;".into(),
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
        .replace("@DECIDE@", &decide)
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

const MARGINS: &str = "    sidc_margins(v->t, v->state@PASS@, v->side, margin);";

/// Which guards an input moved by a jump to the other side.
const MOVED: &str = "    int crossed[GUARDS], moved[GUARDS], any = 0;
    double margin[GUARDS], guard[GUARDS], unmoved[GUARDS];
    const Values now = *v;
    sidc_guards(v->t, v->state@PASS@, guard);
    memcpy(v->input, v->before, sizeof v->input);
    sidc_guards(v->t, v->state@PASS@, unmoved);
    memcpy(v->input, now.input, sizeof v->input);
    for (int k = 0; k < GUARDS; k++) {
        moved[k] = guard[k] != unmoved[k] && guard[k] != 0.0 && v->side[k] * guard[k] <= 0.0;
    }
";

/// Such a guard is let go; one that the motion took to zero is decided.
const DECIDE: &str = "    for (int k = 0; k < GUARDS; k++) {
        if (moved[k]) {
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
    }
    return 0;";

/// The same where states jump. Impacts whose flights last a millionth of the time since the beginning close a contact.
const JUMP: &str = "    int jumped = 0;
    double full[GUARDS], rate[GUARDS];
    const double h = 1e-2 * (v->t - v->begin);
    for (int k = 0; k < GUARDS; k++) {
        moved[k] = moved[k] && v->side[k] != sidc_waits;
        any = any || moved[k];
    }
    if (any) {
        sidc_pass(v->t, h, v->state@PASS@, v->side, moved, 0);
    }
    /* One event may set off another right where it is, which the importer would not see. */
    for (int round = 0; round < 8; round++) {
        any = 0;
        margins(v, margin);
        sidc_held(v->t, v->state@PASS@, v->side, full);
        sidc_guard_rates(v->t, v->state@PASS@, full, rate);
        for (int k = 0; k < GUARDS; k++) {
            /* The importer may stop a little before a guard is zero. */
            const double speed = v->side[k] * rate[k];
            const int is_near = speed < 0.0 && margin[k] < -1e-9 * h * speed;
            const int is_free = v->side[k] != 0.0 && v->side[k] != sidc_waits;
            crossed[k] = (is_free && is_near) || (margin[k] < 0.0 && !sidc_jumps_at(k, v->side[k]));
            any = any || crossed[k];
        }
        if (!any) {
            break;
        }
        sidc_pass(v->t, h, v->state@PASS@, v->side, crossed, 1);
    }
    for (int i = 0; i < STATES; i++) {
        jumped = jumped || v->state[i] != now.state[i];
    }
    return jumped;";
