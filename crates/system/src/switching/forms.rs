//! Forms by the sides of their switches.
//!
//! In: a form. Out: the same without switches, and these. Never decides a side.

use super::switches::Switches;
use crate::discovery::Form;

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
        switches.add_resets(&form.resets);
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
}
