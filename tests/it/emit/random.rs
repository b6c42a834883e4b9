//! Random systems with all functions, mixed orders, coupled and implicit laws, and names that look like code.

use sidc_lang::model::VarKind;
use sidc_lang::term::{Expr, FUNCTIONS, Func, Function, Signal, VarId};
use sidc_system::discovery::{Discovery, Equation, FoundTerm, Status, UnknownValue, Variable};

/// A linear congruential generator, so that every machine draws the same systems.
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Random {
        Random(seed.wrapping_mul(2).wrapping_add(1))
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * ((self.0 >> 11) as f64 / (1u64 << 53) as f64)
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.between(0.0, n as f64) as usize).min(n - 1)
    }

    fn pick<T: Clone>(&mut self, all: &[T]) -> T {
        all[self.below(all.len())].clone()
    }
}

/// Names as users choose them, and names that nobody should choose.
#[rustfmt::skip]
pub const NAMES: &[&str] = &[
    "x", "y", "theta", "omega_m", "x1", "θ", "Ω", "é", "速度", "x́", "type", "fn", "self", "match", "state", "input", "parameter",
    "history", "t", "solve", "newton", "slope", "rate", "derivatives", "jacobian", "next", "outputs", "f64", "w1", "w2", "sin", "cos",
    "sin_x", "abs", "double", "int", "struct", "return", "I", "NAN", "INFINITY", "M_PI", "linux", "mass", "right", "unknown", "settled",
    "sidc_solve", "sidc_sign", "lambda", "None", "def", "np", "sp", "pass", "in", "is", "E", "S", "N", "Q", "oo", "zoo", "end", "function",
    "ans", "nargout", "endfunction", "NaN", "Inf", "pi", "i", "1x", "42", "", "_", "__", "a b", "a_b", "a(b", "x*/", "/*", "*/ #error */",
    "//", "\\", "x\\", "\\end{document}", "\\input{/etc/passwd}", "$", "%", "%{", "#", "&", "~", "^", "{", "}", "\"", "\"\"\"", "'", "`",
    "new\nline", "\r", "\nimport os\n", "\0", "\u{202e}rtl", "??/", "...", "x;", "x);", "x' or '1", "\u{2028}", "🚀",
    "a_very_long_name_that_goes_on_and_on_and_on_beyond_what_matlab_reads_at_all_1",
    "a_very_long_name_that_goes_on_and_on_and_on_beyond_what_matlab_reads_at_all_2",
];

/// The kind of laws in a system.
#[derive(Clone, Copy, PartialEq)]
pub enum Laws {
    Explicit,
    /// Factors are targets of others, with a regular mass matrix.
    Coupled,
    /// Each law may use the targets of those before it.
    Chained,
    /// Targets inside functions; the laws are contractions.
    Implicit,
    /// Next samples of states, and lagged inputs.
    Discrete,
}

const LAWS: [Laws; 5] = [
    Laws::Explicit,
    Laws::Coupled,
    Laws::Chained,
    Laws::Implicit,
    Laws::Discrete,
];

/// A system for a seed.
pub fn system(seed: u64) -> Discovery {
    let mut draw = Draw {
        random: Random::new(seed),
        leaves: vec![Signal::TIME],
        constants: Vec::new(),
        variables: Vec::new(),
        laws: LAWS[seed as usize % LAWS.len()],
    };
    // Constants in one system of four.
    let constants = [2, 0, 0, 1, 0, 0, 0, 0][seed as usize % 8];
    let targets = draw.declare(constants);
    let equations = draw.equations(&targets);
    Discovery {
        system: Some(draw.random.pick(NAMES).to_string()),
        discrete: draw.laws == Laws::Discrete,
        variables: draw.variables,
        equations,
        failed: Vec::new(),
        runs_left: Vec::new(),
        rests: Vec::new(),
        relations: None,
        delays: Vec::new(),
        unknowns: draw.constants,
        correlations: Vec::new(),
        hidden: Vec::new(),
        resets: Vec::new(),
    }
}

struct Draw {
    random: Random,
    /// Signals that right sides may mention.
    leaves: Vec<Signal>,
    constants: Vec<UnknownValue>,
    variables: Vec<Variable>,
    laws: Laws,
}

impl Draw {
    fn variable(&mut self, kind: VarKind, order: u8) -> VarId {
        let free: Vec<&str> = NAMES
            .iter()
            .copied()
            .filter(|n| self.variables.iter().all(|v| v.name != *n))
            .collect();
        let name = self.random.pick(&free).to_string();
        self.variables.push(Variable {
            name,
            kind,
            order,
            unit: None,
        });
        VarId(self.variables.len() as u16 - 1)
    }

    /// Declares the variables. Returns the targets of the states.
    fn declare(&mut self, constants: usize) -> Vec<Signal> {
        self.variables.push(Variable {
            name: "t".into(),
            kind: VarKind::Input,
            order: 0,
            unit: None,
        });
        let discrete = self.laws == Laws::Discrete;
        let mut targets = Vec::new();
        for _ in 0..1 + self.random.below(4) {
            let order = if discrete {
                0
            } else {
                1 + self.random.below(3) as u8
            };
            let id = self.variable(VarKind::State, order);
            self.leaves.push(Signal::new(id));
            self.leaves
                .extend((1..order).map(|d| Signal::derivative(id, d)));
            if discrete {
                self.leaves.push(Signal::shifted(id, -1));
            }
            targets.push(match discrete {
                true => Signal::shifted(id, 1),
                false => Signal::derivative(id, order),
            });
        }
        for _ in 0..self.random.below(3) {
            let id = self.variable(VarKind::Input, 1);
            self.leaves.push(Signal::new(id));
            self.leaves.push(match discrete {
                true => Signal::shifted(id, -2),
                false => Signal::derivative(id, 1),
            });
        }
        for _ in 0..self.random.below(2) {
            let id = self.variable(VarKind::Param, 0);
            self.leaves.push(Signal::new(id));
        }
        for _ in 0..constants {
            let id = self.variable(VarKind::Unknown, 0);
            self.leaves.push(Signal::new(id));
            let name = self.variables.last().map(|v| v.name.clone());
            let value = self.random.between(0.5, 2.5);
            self.constants
                .extend(name.map(|n| UnknownValue::new(n, value, Some(0.1))));
        }
        targets
    }

    fn equations(&mut self, targets: &[Signal]) -> Vec<Equation> {
        let mut all = Vec::new();
        for (i, target) in targets.iter().enumerate() {
            let mut terms = self.terms();
            for (j, other) in targets.iter().enumerate() {
                terms.extend(self.through(i, j, *other));
            }
            all.push(equation(*target, terms));
        }
        if self.random.below(3) == 0 {
            let id = self.variable(VarKind::Output, 0);
            let mut terms = self.terms();
            let measured = self.random.pick(targets);
            terms.push((self.random.between(-2.0, 2.0), Expr::signal(measured)));
            all.push(equation(Signal::new(id), terms));
        }
        all
    }

    fn terms(&mut self) -> Vec<(f64, Expr)> {
        let count = 1 + self.random.below(4);
        (0..count)
            .map(|_| {
                let depth = 1 + self.random.below(3);
                (self.random.between(-2.0, 2.0), self.expr(depth))
            })
            .collect()
    }

    /// How the law of target i depends on target j.
    fn through(&mut self, i: usize, j: usize, other: Signal) -> Option<(f64, Expr)> {
        let weight = self.random.between(-0.2, 0.2);
        let q = Expr::signal(other);
        let bounded = call(
            if self.random.below(2) == 0 {
                "sin"
            } else {
                "tanh"
            },
            self.expr(1),
        );
        match self.laws {
            Laws::Coupled if self.random.below(3) > 0 => Some((weight, bounded * q)),
            Laws::Chained if j < i => Some((10.0 * weight, bounded * q)),
            Laws::Implicit if self.random.below(2) == 0 => Some((weight, call("sin", q + bounded))),
            _ => None,
        }
    }

    fn expr(&mut self, depth: usize) -> Expr {
        if depth == 0 {
            let leaf = self.random.pick(&self.leaves.clone());
            return match self.random.below(6) {
                0 => Expr::number(self.random.between(-2.0, 2.0)),
                _ => Expr::signal(leaf),
            };
        }
        let a = self.expr(depth - 1);
        if !self.constants.is_empty() && self.random.below(6) == 0 {
            return self.raised(a);
        }
        match self.random.below(9) {
            0 => a + self.expr(depth - 1),
            1 | 2 => a * self.expr(depth - 1),
            3 => a.pow(2.0 + self.random.below(4) as f64),
            4 => (Expr::number(2.0) + a.pow(2.0)).pow(-1.0),
            5 => {
                let p = self.random.pick(&[0.5, -0.5, 1.5, 2.25, -3.0, -1.0]);
                (Expr::number(0.5) + call("abs", a)).pow(p)
            }
            _ => self.function(a, depth - 1),
        }
    }

    /// Raises an expression to an unknown constant, if there is one.
    fn raised(&mut self, a: Expr) -> Expr {
        let unknown = |s: &&Signal| self.variables[usize::from(s.var.0)].kind == VarKind::Unknown;
        let exponent = self.leaves.iter().find(unknown).copied();
        let base = Expr::number(0.5) + call("abs", a);
        match exponent {
            Some(n) => base.raised_to(Expr::signal(n)).unwrap_or_default(),
            None => base,
        }
    }

    /// A random function; its arguments are mostly in its domain.
    fn function(&mut self, a: Expr, depth: usize) -> Expr {
        // A target refuses a function that it has no word for.
        let spelled = |f: &&Function| {
            let s = f.spelling;
            ![s.rust, s.c, s.numpy, s.sympy, s.matlab].contains(&"")
        };
        let all: Vec<&Function> = FUNCTIONS.iter().filter(spelled).collect();
        let f = all[self.random.below(all.len())];
        if f.arity.1 > 1 {
            let more = 1 + self.random.below(3);
            let others = (0..more).map(|_| self.expr(depth));
            let all = std::iter::once(a)
                .chain(others.collect::<Vec<_>>())
                .collect();
            return Func::named(f.name).map_or_else(Expr::zero, |f| Expr::call(f, all));
        }
        let bold = self.random.below(12) == 0;
        let inside = match f.name {
            _ if bold => a,
            "asin" | "acos" => call("sin", a).scale(0.9),
            "log" | "sqrt" => Expr::number(0.5) + a.pow(2.0),
            "tan" | "exp" | "sinh" | "cosh" => call("tanh", a),
            _ => a,
        };
        call(f.name, inside)
    }
}

fn call(name: &str, e: Expr) -> Expr {
    Func::named(name).map_or_else(Expr::zero, |f| Expr::call(f, vec![e]))
}

/// Merges terms with the same column, and numbers into the constant term.
fn equation(target: Signal, terms: Vec<(f64, Expr)>) -> Equation {
    let sum: Expr = terms.into_iter().map(|(c, e)| e.scale(c)).sum();
    let terms = sum.terms().map(|(coefficient, term)| FoundTerm {
        term: term.clone(),
        coefficient,
        fixed: false,
        standard_error: None,
        evidence: None,
        runs: Vec::new(),
    });
    Equation {
        target,
        terms: terms.collect(),
        status: Status::Pass,
        reasons: Vec::new(),
        evidence: None,
        path: Vec::new(),
    }
}
