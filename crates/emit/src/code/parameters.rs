//! The estimated parameters by name: every coefficient of the equations and every unknown constant.
//!
//! In: a discovery. Out: names, values, standard errors, units, covariances, and lines for comments. The emitted functions do not read
//! these; they contain the values as literals.

use crate::code::identifiers::{Identifiers, comment_safe};
use sidc_lang::term::{Language, SignalNames};
use sidc_system::discovery::{Discovery, Equation, FoundTerm};

pub(crate) struct Parameter {
    /// An identifier in every language.
    pub name: String,
    /// The equation and the term, for comments.
    pub about: String,
    pub value: f64,
    /// Standard error; 0 for a value that the model states, NaN if it is not known.
    pub error: f64,
    /// Empty where it is not known.
    pub unit: String,
    place: Place,
}

/// Where the correlations of a parameter are found.
#[derive(Clone, Copy, PartialEq)]
enum Place {
    /// The fit, and the place of the parameter in it.
    Fit(usize, usize),
    Nowhere,
}

pub(crate) struct Parameters<'a> {
    pub all: Vec<Parameter>,
    d: &'a Discovery,
}

impl<'a> Parameters<'a> {
    pub fn new(d: &'a Discovery) -> Parameters<'a> {
        let mut names = Identifiers::new([], []);
        let mut all = Vec::new();
        for equation in &d.equations {
            for term in &equation.terms {
                all.push(coefficient(d, equation, term, &mut names));
            }
        }
        for u in d.unknowns.iter().filter(|u| u.run.is_none()) {
            let variable = d.variables.iter().find(|v| v.name == u.name);
            let unit = variable.and_then(|v| v.unit.as_ref());
            all.push(Parameter {
                name: names.fresh(&u.name),
                about: format!("unknown {}", comment_safe(&u.name)),
                value: u.value,
                error: at_least_rounding(u.value, u.standard_error),
                unit: unit.map_or_else(String::new, |u| comment_safe(&u.to_string())),
                place: place_of(d, "", &u.name),
            });
        }
        Parameters { all, d }
    }

    pub fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// Rows of the covariance matrix; `None` if no correlation is known.
    pub fn covariance(&self) -> Option<Vec<Vec<f64>>> {
        let known = |p: &Parameter| p.place != Place::Nowhere && p.error.is_finite();
        let row = |a: &Parameter| self.all.iter().map(|b| self.entry(a, b)).collect();
        let rows = self.all.iter().map(row).collect();
        self.all.iter().any(known).then_some(rows)
    }

    /// Coefficients of different fits have independent errors; a correlation that no fit gives is NaN.
    fn entry(&self, a: &Parameter, b: &Parameter) -> f64 {
        let correlation = match (a.place, b.place) {
            _ if a.error == 0.0 || b.error == 0.0 => return 0.0,
            _ if a.name == b.name => 1.0,
            (Place::Fit(f, i), Place::Fit(g, j)) if f == g => {
                let fit = self.d.correlations.get(f);
                fit.and_then(|c| c.between(i, j)).unwrap_or(f64::NAN)
            }
            (Place::Fit(..), Place::Fit(..)) => 0.0,
            _ => f64::NAN,
        };
        correlation * (a.error * b.error)
    }

    /// A line for each parameter.
    pub fn lines(&self, line: impl Fn(&Parameter) -> String) -> String {
        self.all.iter().map(line).collect()
    }

    /// An entry for each parameter, separated by commas.
    pub fn list(&self, of: impl Fn(&Parameter) -> String) -> String {
        self.all.iter().map(of).collect::<Vec<String>>().join(", ")
    }
}

/// A number in a language that writes NaN as `nan`.
pub(crate) fn number(x: f64, nan: &str) -> String {
    match x.is_nan() {
        true => nan.into(),
        false => format!("{x:?}"),
    }
}

/// Numbers separated by commas.
pub(crate) fn numbers(all: &[f64], nan: &str) -> String {
    let all: Vec<String> = all.iter().map(|x| number(*x, nan)).collect();
    all.join(", ")
}

/// A standard error, at least as large as the rounding of the value; NaN if it is not known.
fn at_least_rounding(value: f64, error: Option<f64>) -> f64 {
    let rounding = f64::EPSILON * value.abs();
    error.map_or(f64::NAN, |e| e.max(rounding))
}

fn coefficient(
    d: &Discovery,
    equation: &Equation,
    found: &FoundTerm,
    names: &mut Identifiers,
) -> Parameter {
    let (target, term) = (d.name(equation.target), Language(d).term(&found.term));
    let unit = d.coefficient_unit(equation.target, &found.term);
    Parameter {
        name: names.fresh(&format!("{target}_{}", operators_as_words(&term))),
        about: comment_safe(&format!("{target}: {term}")),
        value: found.coefficient,
        error: match (found.fixed, found.standard_error) {
            (true, _) => 0.0,
            (false, error) => at_least_rounding(found.coefficient, error),
        },
        unit: unit.map_or_else(String::new, |u| comment_safe(&u.to_string())),
        place: place_of(d, &target, &term),
    }
}

/// Where the correlations of a coefficient are, or of a constant, whose target is empty.
fn place_of(d: &Discovery, target: &str, term: &str) -> Place {
    let mut fits = d.correlations.iter().enumerate();
    let place = fits.find_map(|(fit, c)| Some(Place::Fit(fit, c.place(target, term)?)));
    place.unwrap_or(Place::Nowhere)
}

/// A term with operators as words, to be made a name: `dtheta^2*sin(theta)` is `dtheta2_sin(theta)`.
fn operators_as_words(term: &str) -> String {
    let words = [
        (" ", ""),
        ("/", "_per_"),
        ("+", "_plus_"),
        ("-", "_minus_"),
        ("^", ""),
        ("*", "_"),
        (".", "p"),
    ];
    let all = words.iter();
    all.fold(term.to_string(), |text, (sign, word)| {
        text.replace(sign, word)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use sidc_lang::term::{Expr, Signal, VarId};
    use sidc_system::discovery::{Correlations, Status, UnknownValue};

    fn term(s: Signal, error: Option<f64>, fixed: bool) -> FoundTerm {
        FoundTerm {
            term: Expr::signal(s).into_term().1,
            coefficient: 2.0,
            fixed,
            standard_error: error,
            evidence: None,
            runs: Vec::new(),
        }
    }

    /// Two equations with a fit each, a stated coefficient, an unknown constant.
    #[test]
    fn covariances_are_those_of_each_fit() {
        let signals = [0, 1, 2].map(|i| Signal::derivative(VarId(0), i));
        let equation = |target: Signal, terms: Vec<FoundTerm>| Equation {
            target,
            terms,
            status: Status::Pass,
            reasons: Vec::new(),
            evidence: None,
            path: Vec::new(),
        };
        let [a, b, c] = signals;
        let mut d = Discovery {
            equations: vec![
                equation(
                    c,
                    vec![
                        term(a, Some(0.1), false),
                        term(b, Some(0.2), false),
                        term(c, None, true),
                    ],
                ),
                equation(b, vec![term(a, Some(0.5), false)]),
            ],
            unknowns: vec![UnknownValue::new("K".into(), 3.0, Some(0.25))],
            ..Discovery::default()
        };
        let named = |d: &Discovery, target: Signal, terms: &[Signal]| Correlations {
            of: (terms.iter())
                .map(|t| (d.name(target), d.name(*t)))
                .collect(),
            below: vec![-0.5; terms.len() * (terms.len() - 1) / 2],
        };
        assert_eq!(Parameters::new(&d).covariance(), None);
        d.correlations = vec![named(&d, c, &[b, a]), named(&d, b, &[a])];
        let parameters = Parameters::new(&d);
        let rows = parameters.covariance().unwrap();
        let expected = [
            [0.01, -0.01, 0.0, 0.0, f64::NAN],
            [-0.01, 0.04, 0.0, 0.0, f64::NAN],
            [0.0, 0.0, 0.0, 0.0, 0.0],
            [0.0, 0.0, 0.0, 0.25, f64::NAN],
            [f64::NAN, f64::NAN, 0.0, f64::NAN, 0.0625],
        ];
        for (row, expected) in rows.iter().zip(&expected) {
            for (x, y) in row.iter().zip(expected) {
                assert!(
                    (x - y).abs() < 1e-15 || (x.is_nan() && y.is_nan()),
                    "{rows:?}"
                );
            }
        }
        assert_eq!(rows.len(), 5);
        // A constant stands in no equation.
        let with_constant = &mut d.correlations[1];
        with_constant.of.push((String::new(), "K".into()));
        with_constant.below = vec![0.5];
        let rows = Parameters::new(&d).covariance().unwrap();
        assert_eq!((rows[3][4], rows[4][0]), (0.0625, 0.0));
    }

    #[test]
    fn terms_become_words() {
        assert_eq!(
            operators_as_words("dtheta^2*sin(theta)"),
            "dtheta2_sin(theta)"
        );
        assert_eq!(operators_as_words("x/(1 + y)"), "x_per_(1_plus_y)");
    }
}
