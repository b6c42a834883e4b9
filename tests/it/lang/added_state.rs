//! Model texts with one more state have the intended meaning and compile.

use sidc_lang::added_state::{AddedState, driven_by_state, input_through_lag, sensor_with_lag};
use sidc_lang::model::Model;
use sidc_lang::term::VarId;

fn compiled(text: &str) -> Model {
    let (model, _, shown) = super::compiled("m.sid", text);
    model.unwrap_or_else(|| panic!("{text}\n{shown}"))
}

fn place(model: &Model, name: &str) -> VarId {
    let found = model.vars.iter().position(|v| v.name == name);
    VarId(found.unwrap() as u16)
}

/// Checks that the longer text compiles and keeps the indices of all variables.
fn sound(before: &str, added: Option<AddedState>) -> AddedState {
    let added = added.unwrap();
    let (before, after) = (compiled(before), compiled(&added.text));
    for (old, new) in before.vars.iter().zip(&after.vars) {
        assert_eq!(old.name, new.name, "{}", added.text);
    }
    let hidden = after.hidden_states().map(|(_, v)| v.name.clone());
    assert_eq!(
        hidden.collect::<Vec<_>>(),
        std::slice::from_ref(&added.state)
    );
    added
}

#[test]
fn an_input_stands_behind_a_lag_wherever_laws_have_it() {
    let text = "state x : unit \"m\"\ninput u : hold, unit \"V\"\nlet drive = <u, u*x> # both\ndx ~ <1, x> + drive\n";
    let model = compiled(text);
    let added = sound(
        text,
        input_through_lag(text, &model, place(&model, "u"), (0.1, 20.0)),
    );
    assert_eq!(
        added.lines,
        [
            "unknown tau in 0.1 .. 20, unit \"s\"",
            "state u_lag : hidden, unit \"V\"",
            "du_lag = (u - u_lag)/tau",
            "let drive = <u_lag, u_lag*x>",
        ]
    );
    assert!(added.text.contains("# both"), "{}", added.text);
}

#[test]
fn names_that_are_taken_are_left_alone() {
    let text =
        "unknown tau in 1..2\nstate x, u_lag\ninput u\ndx ~ <x/tau, u>\ndu_lag ~ <u_lag, u>\n";
    let model = compiled(text);
    let added = input_through_lag(text, &model, place(&model, "u"), (0.1, 20.0)).unwrap();
    assert_eq!(added.state, "u_lag2");
    assert_eq!(added.constant.as_deref(), Some("tau2"));
    compiled(&added.text);
}

#[test]
fn an_input_whose_rate_acts_has_no_lag() {
    let text = "state x\ninput u : order 1\ndx ~ <x, u, du>\n";
    let model = compiled(text);
    assert_eq!(
        input_through_lag(text, &model, place(&model, "u"), (0.1, 20.0)),
        None
    );
}

#[test]
fn what_a_sensor_reads_has_an_order_of_its_own() {
    let text = "state x, y : order 2, noise 0.01\ninput u : hold\nddx ~ poly(x, dx; 2) + <sin x', u>\nddy ~ <y, dy, x>\n";
    let model = compiled(text);
    let added = sound(
        text,
        sensor_with_lag(text, &model, place(&model, "x"), (0.1, 20.0)),
    );
    assert_eq!(
        added.lines,
        [
            "unknown tau in 0.1 .. 20",
            "state x_true : hidden, order 2",
            "dx = (x_true - x)/tau",
            "ddx_true ~ poly(x_true, dx_true; 2) + <sin x_true', u>",
            "ddy ~ <y, dy, x_true>",
            "state x : noise 0.01",
            "state y : order 2, noise 0.01",
        ]
    );
}

#[test]
fn a_sensor_of_which_more_is_said_has_no_lag() {
    for text in [
        "state x : delay 0.1\ndx ~ <x>\n",
        "state x1..x3\ndx1, dx2, dx3 ~ <x1, x2, x3>\n",
        "state x\nstate y : hidden\ndx ~ <x, y>\ndy ~ <x, y>\n",
    ] {
        let model = compiled(text);
        let hidden = model.hidden_states().next().map(|(id, _)| id);
        let place = hidden.unwrap_or(VarId(1));
        assert_eq!(
            sensor_with_lag(text, &model, place, (0.1, 20.0)),
            None,
            "{text}"
        );
    }
}

#[test]
fn a_state_drives_the_laws_that_are_doubted_alone() {
    let text = "state x, y\ndx, dy ~ <1, x, y>\n";
    let model = compiled(text);
    let added = sound(text, driven_by_state(text, &model, &[1]));
    assert_eq!(
        added.lines,
        [
            "state h : hidden",
            "dh ~ <1, x, y> + <h>",
            "dx ~ <1, x, y>",
            "dy ~ <1, x, y> + <h>",
        ]
    );
}
