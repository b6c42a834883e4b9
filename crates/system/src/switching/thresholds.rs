//! The numbers of switches and their events.

use sidc_thresholds::{Table, family};

family! {
    /// Where laws switch, stick and let go.
    pub SWITCHING: Switching {
        /// Rate of a guard that is zero, of the rates it is the difference of.
        rounding: f64 = 1e-13, unit "relative", source "rounding of some hundred operations";
        /// Share of the greatest friction that is missing where a contact is let go.
        limit: f64 = 1e-9, unit "of the greatest friction", source "set by hand: far above rounding, far below what a run shows";
        /// Pivot below which contacts hold the same motion together.
        dependent: f64 = 1e-10, unit "of the largest", source "set by hand: rounding of the differences of rates is a thousand times smaller";
        /// Length of the bracket in which an event is left.
        located: f64 = 1e-14, unit "of a step", source "rounding; events are within 1e-10 of closed forms: crates/system/src/simulate/event_tests.rs";
        /// Steps of the search for an event.
        root_steps: usize = 80, unit "steps", source "bisection alone takes 47 to the last digit";
        /// Contacts that are decided one after another until all agree.
        pivots: usize = 200, unit "pivots", source "set by hand: mostly one a contact";
        /// Events at one instant after which they are said to accumulate.
        at_once: usize = 64, unit "events", source "set by hand: contacts that decide each other take two or three each";
        /// A guard that counts as zero where its switch slid before.
        drift: f64 = 1e-7, unit "of the guard's size", source "set by hand: a hundred times the error of a step, below any jump of an input that shows";
        /// Points at which two expressions are compared.
        same_points: usize = 8, unit "points", source "one tells two polynomials apart but for a chance in 10^9; some may lie outside a domain";
        /// Values of two expressions that count as the same.
        same: f64 = 1e-9, unit "relative", source "rounding of some hundred operations, with room for cancellation";
        /// A guard that counts as zero at the start of a stretch.
        zero: f64 = 1e-13, unit "of the guard's size", source "rounding of a state that was set to the guard";
    }
}

/// Every family of this module.
pub fn tables() -> Vec<Table> {
    vec![Switching::table()]
}
