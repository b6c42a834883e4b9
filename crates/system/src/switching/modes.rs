//! On which side of its guard each switch is; bodies in contact, and apart.

use sidc_lang::term::{Expr, Signal};

/// The side of a switch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// g < 0, σ = −1.
    Below,
    /// g > 0, σ = 1.
    Above,
    /// g = 0 and stays there: σ is whatever keeps it.
    Sliding,
    /// g = 0, and no σ moves it: σ is 0 until it does.
    #[default]
    Level,
    /// The speed of a contact that is closed: g = 0 and stays there, by a σ at or below zero.
    Closed,
    /// σ is 0 and no event ends that: the speed of a contact that is open, the gap of one that is closed.
    Idle,
}

/// The sides of all switches.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Modes(pub Vec<Mode>);

/// A contact of two bodies, or of one and a wall.
#[derive(Clone, Debug, PartialEq)]
pub struct Contact {
    /// The switch whose guard is the gap between them.
    pub gap: usize,
    /// The side on which they are apart.
    pub apart: Mode,
    /// The switch whose guard is the rate at which the gap opens.
    pub speed: usize,
    /// What a unit of that switch's σ adds to the rates of states. σ is zero or below it: the force only pushes apart.
    pub force: Vec<(Signal, Expr)>,
}

impl Mode {
    /// The side on which a guard of this value is.
    pub fn of(guard: f64) -> Mode {
        match guard {
            g if g > 0.0 => Mode::Above,
            g if g < 0.0 => Mode::Below,
            _ => Mode::Level,
        }
    }

    /// Whether σ is what keeps the guard at zero.
    pub fn is_held(self) -> bool {
        matches!(self, Mode::Sliding | Mode::Closed)
    }

    /// σ; where it keeps the guard at zero, before that is solved for.
    pub fn side(self) -> f64 {
        match self {
            Mode::Below => -1.0,
            Mode::Above => 1.0,
            Mode::Sliding | Mode::Level | Mode::Closed | Mode::Idle => 0.0,
        }
    }

    /// What stays at or above zero as long as the mode holds.
    pub fn margin(self, guard: f64, side: f64) -> f64 {
        match self {
            Mode::Below => -guard,
            Mode::Above => guard,
            Mode::Sliding => 1.0 - side.abs(),
            Mode::Level => -guard.abs(),
            Mode::Closed => -side,
            Mode::Idle => 1.0,
        }
    }
}

impl Modes {
    /// Switches whose guards are held at zero.
    pub fn held(&self) -> impl Iterator<Item = usize> {
        let all = self.0.iter().enumerate();
        all.filter(|(_, m)| m.is_held()).map(|(k, _)| k)
    }

    pub fn any_is_held(&self) -> bool {
        self.0.iter().any(|m| m.is_held())
    }

    /// Brings the bodies of a contact together: its force begins, and its gap waits.
    pub fn close(&mut self, contact: &Contact) {
        self.0[contact.gap] = Mode::Idle;
        self.0[contact.speed] = Mode::Closed;
    }

    /// Lets the bodies part.
    pub fn open(&mut self, contact: &Contact) {
        self.0[contact.gap] = contact.apart;
        self.0[contact.speed] = Mode::Idle;
    }

    /// Lets the bodies part where a contact has let go of its speed.
    pub fn open_released(&mut self, contacts: &[Contact]) {
        for contact in contacts {
            let (gap, speed) = (self.0[contact.gap], self.0[contact.speed]);
            if (gap, speed) == (Mode::Idle, Mode::Idle) {
                self.open(contact);
            }
        }
    }
}
