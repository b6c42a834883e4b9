//! Signals, the variables of terms: a declared variable, one of its derivatives, or a shifted sample of it.
//!
//! In: indices of variables. Out: signals with an order and a spelling. Knows no model.

/// Index of a declared variable in the model; 0 is always time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct VarId(pub u16);

impl VarId {
    pub const TIME: VarId = VarId(0);
}

/// A measurable or derived time series.
///
/// `x` is `{der: 0, shift: 0}`, `ddx` is `{der: 2}`, `next(x)` is `{shift: 1}`, `lag(u, 3)` is `{shift: -3}`.
/// The order (variable, derivative, shift) is the order of factors in a printed term.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Signal {
    pub var: VarId,
    /// Order of the time derivative.
    pub der: u8,
    /// Samples ahead (positive) or back (negative); discrete time only.
    pub shift: i32,
}

impl Signal {
    pub const TIME: Signal = Signal::new(VarId::TIME);

    /// All fields in one integer that has their lexicographic order.
    fn packed(&self) -> u64 {
        let shift = (self.shift as u32) ^ (1 << 31);
        (u64::from(self.var.0) << 40) | (u64::from(self.der) << 32) | u64::from(shift)
    }

    pub const fn new(var: VarId) -> Self {
        Signal {
            var,
            der: 0,
            shift: 0,
        }
    }

    pub const fn derivative(var: VarId, der: u8) -> Self {
        Signal { var, der, shift: 0 }
    }

    pub const fn shifted(var: VarId, shift: i32) -> Self {
        Signal { var, der: 0, shift }
    }
}

// Sorting a library is mostly this comparison, so it is one of packed integers.
impl Ord for Signal {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.packed().cmp(&other.packed())
    }
}

impl std::hash::Hash for Signal {
    fn hash<H: std::hash::Hasher>(&self, state: &mut H) {
        state.write_u64(self.packed());
    }
}

impl PartialOrd for Signal {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

/// Gives a signal its canonical spelling (`x`, `ddtheta`, `next(x)`, `lag(u, 2)`).
pub trait SignalNames {
    /// The name of the declared variable.
    fn variable(&self, var: VarId) -> &str;

    /// True for unknown constants, which alone may stand in exponents.
    fn is_constant(&self, _: VarId) -> bool {
        false
    }

    fn name(&self, s: Signal) -> String {
        let base = self.variable(s.var);
        match (s.der, s.shift) {
            (0, 0) => base.to_string(),
            (0, 1) => format!("next({base})"),
            (0, k) if k < 0 => format!("lag({base}, {})", -k),
            (0, k) => format!("lead({base}, {k})"),
            (d, _) => format!("{}{base}", "d".repeat(d as usize)),
        }
    }
}
