//! How terms that jump change with an unknown constant in their guard: by an impulse where the guard is zero.
//!
//! In: a term, a constant. Out: its derivative as a distribution: ∂/∂k step(g) = δ(g) ∂g/∂k and ∂/∂k sign(g) = 2 δ(g) ∂g/∂k. The impulse δ(g)
//! of a guard is a signal that is zero along all records; integration gives it its effect where the guard is crossed.

use super::estimation_problem::Problem;
use super::system::{Impulse, ImpulseSource};
use sidc_lang::term::{Atom, Expr, Signal, Term, VarId};
use sidc_system::switching::Switches;

/// The part of ∂term/∂constant that impulses make; guards that are new are added.
pub(crate) fn impulses_of(term: &Term, constant: Signal, impulses: &mut Vec<Impulse>) -> Expr {
    let mut sum = Expr::zero();
    for (atom, power) in term.factors() {
        let Atom::Call(f, args) = atom else { continue };
        // Powers of a step are the step; even ones of a sign do not jump.
        let height = match f.name {
            "step" => 1.0,
            "sign" if power.rem_euclid(2.0) == 1.0 => 2.0,
            _ => continue,
        };
        let Some((lead, guard)) = args.first().and_then(Switches::canonical) else {
            continue;
        };
        let slope = guard.derivative(constant);
        if slope.as_number() == Some(0.0) {
            continue;
        }
        let signal = impulse_of(ImpulseSource::Guard(guard), impulses);
        let others: Expr = term.part(|other| other != atom).into();
        sum = sum + others * slope * Expr::signal(signal).scale(height * lead.signum());
    }
    sum
}

/// The signal of an impulse, which is added if it is new.
pub(crate) fn impulse_of(source: ImpulseSource, impulses: &mut Vec<Impulse>) -> Signal {
    let known = impulses.iter().find(|i| i.source == source);
    known.map(|i| i.signal).unwrap_or_else(|| {
        // No declared variable lags time.
        let signal = Signal::shifted(VarId::TIME, -1 - impulses.len() as i32);
        impulses.push(Impulse { signal, source });
        signal
    })
}

impl Problem {
    /// The problem with these impulses among its signals.
    pub(crate) fn with_impulses(&self, impulses: Vec<Impulse>) -> Problem {
        let mut problem = self.clone();
        for impulse in &impulses {
            problem.add_constant_signal(impulse.signal, &|_| 0.0);
        }
        problem.system.impulses = impulses;
        problem.compile_columns();
        problem
    }
}
