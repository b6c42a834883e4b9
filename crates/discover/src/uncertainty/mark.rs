//! The verdict on a term, by a rule that can be printed.
//!
//! In: equations whose terms have their figures, all doubts said. Out: a mark on every term. Never looks at data.

use sidc_system::discovery::{Discovery, Equation, MARKS, Mark, Status};

/// Marks every term that was found.
pub fn mark(discovery: &mut Discovery) {
    for equation in &mut discovery.equations {
        let most = most(equation);
        for t in equation.terms.iter_mut().filter(|t| !t.fixed) {
            let trust = t.trust.get_or_insert_with(Box::default);
            trust.mark = MARKS.of(trust).min(most);
        }
    }
}

/// The best mark a term of an equation can have.
fn most(equation: &Equation) -> Mark {
    match equation.status {
        Status::Doubt => Mark::Likely,
        _ => Mark::Firm,
    }
}
