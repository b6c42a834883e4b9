//! Forms by the sides of their switches.
//!
//! In: a form. Out: the same without switches, and these; with the forces of contacts. Never decides a side.

use super::contacts::Kinematics;
use super::switches::Switches;
use crate::discovery::{Form, Rate};
use sidc_lang::term::Expr;

impl Switches {
    /// The form with its switches as signals, and these. In discrete time there are no events, and nothing changes. Outputs keep what
    /// switches in them alone.
    pub fn of(form: &Form) -> (Form, Switches) {
        let mut switches = Switches::default();
        let mut smooth = form.clone();
        if form.unknowns.iter().any(|q| q.shift != 0) {
            return (smooth, switches);
        }
        for (row, target) in smooth.rows.iter_mut().zip(&form.unknowns) {
            let right = switches.rewritten(&row.right, &form.unknowns);
            if right != row.right {
                *row = form.row(right, *target);
            }
        }
        let laws = switches.len();
        switches.add_resets(&form.resets);
        switches.add_contact_forces(laws, form, &mut smooth);
        if !switches.is_empty() {
            for (_, e) in &mut smooth.outputs {
                let mut more = switches.clone();
                let new = more.rewritten(e, &form.unknowns);
                if more.len() == switches.len() {
                    *e = new;
                }
            }
        }
        (smooth, switches)
    }

    /// Adds the contacts among the resets, and their forces to the rows.
    fn add_contact_forces(&mut self, laws: usize, form: &Form, smooth: &mut Form) {
        if !form.linear {
            return;
        }
        let rate_of = |i: usize| match form.rates[i] {
            Rate::State(next) => Some(next),
            Rate::Unknown(_) => None,
        };
        self.add_contacts(
            laws,
            &Kinematics {
                states: &form.state,
                rate_of: &rate_of,
                is_constant: &|s| form.params.contains(&s) || form.constants.contains(&s),
            },
        );
        for contact in &self.contacts {
            let side = Expr::signal(Switches::signal(contact.speed));
            for (row, target) in smooth.rows.iter_mut().zip(&form.unknowns) {
                // M times the force, so that it is added to the solved rates.
                let pushed = contact.force.iter().map(|(signal, force)| {
                    let place = form.state.iter().position(|s| s == signal);
                    match place.map(|i| form.rates[i]) {
                        Some(Rate::Unknown(q)) => row.mass[q].clone() * force.clone(),
                        _ => Expr::zero(),
                    }
                });
                let pushed: Expr = pushed.sum();
                if pushed.as_number() != Some(0.0) {
                    *row = form.row(row.right.clone() + pushed * side.clone(), *target);
                }
            }
        }
    }
}
