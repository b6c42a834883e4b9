//! Doubts about equations found from a rate that contradicts the samples of its own state.
//!
//! In: faults of rate columns, the [`Discovery`]. Out: the doubt `rate-disagrees`. Never changes a term or a coefficient.

use sidc_data::{RateFault, RateMend};
use sidc_lang::term::Signal;
use sidc_system::discovery::{Change, Discovery, Equation, Reason, ReasonCode, Status};

/// Doubts every equation of the same variable, and every equation with the rate among its terms.
pub(super) fn doubt(discovery: &mut Discovery, faults: &[RateFault]) {
    for fault in faults {
        let from_it = |e: &&mut Equation| uses(e, fault.signal);
        for equation in discovery.equations.iter_mut().filter(from_it) {
            equation.doubt(reason(fault));
        }
    }
}

fn reason(fault: &RateFault) -> Reason {
    let entry = &fault.entry;
    let remedy = match fault.mend {
        RateMend::LeaveOut => ReasonCode::RateDisagrees.usual_remedy(),
        RateMend::Scale => "scale the column",
    };
    Reason::new(ReasonCode::RateDisagrees, fault.text.clone())
        .change(remedy, Change::Model(vec![format!("data {{ {entry} }}")]))
}

fn uses(equation: &Equation, rate: Signal) -> bool {
    let among_terms = |e: &Equation| e.terms.iter().any(|t| t.term.mentions(rate));
    let sought = equation.status != Status::Known;
    sought && (equation.target.var == rate.var || among_terms(equation))
}
