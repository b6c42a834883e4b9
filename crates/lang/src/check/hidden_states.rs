//! Hidden states: what a model may say about them.
//!
//! In: the checked model. Out: errors where a hidden state has a sensor, or no equation.

use crate::check::checker::Checker;
use crate::check::errors;
use crate::diagnostic::Diagnostic;
use crate::model::{Model, Var};
use crate::source::Span;
use crate::term::VarId;

impl Checker<'_> {
    pub fn hidden_states(&mut self, model: &Model) {
        let hidden: Vec<(VarId, &Var)> = model.hidden_states().collect();
        for (id, var) in &hidden {
            let Some(at) = var.span else { continue };
            for d in self.sensor(model, *id, var, at) {
                self.say(d);
            }
            if model.discrete {
                self.say(errors::hidden_in_discrete(at, &var.name));
            }
        }
        // An equation that could not be read may be one of theirs.
        if !self.file.broken.is_empty() || self.found.iter().any(Diagnostic::is_error) {
            return;
        }
        for (id, var) in &hidden {
            if let (Some(at), false) = (var.span, model.has_equation(*id)) {
                self.say(errors::hidden_without_equation(at, var));
            }
        }
        let first = hidden.first().and_then(|(_, var)| var.span);
        if let Some(at) = first
            && model
                .equations
                .iter()
                .all(|e| model.is_hidden(e.target.var))
        {
            self.say(errors::all_hidden(at));
        }
    }

    /// Errors where the model describes a sensor of a hidden state.
    fn sensor(&self, model: &Model, id: VarId, var: &Var, at: Span) -> Vec<Diagnostic> {
        let said = [
            (!var.noise.is_empty(), "the noise", "noise"),
            (var.noise_time_constant.is_some(), "the memory", "memory"),
            (var.delay.is_some(), "the delay", "delay"),
        ];
        let said = said
            .into_iter()
            .filter(|(is, ..)| *is)
            .map(|(_, what, key)| (at, what, Some(key)));
        let own = model.data.entries.iter().filter(|e| e.signal.var == id);
        let read = own
            .filter(|e| e.source.is_some())
            .map(|e| (e.span, "the column", None));
        let all = said.chain(read);
        all.map(|(at, what, key)| errors::hidden_sensor((at, var.span), &var.name, what, key))
            .collect()
    }
}
