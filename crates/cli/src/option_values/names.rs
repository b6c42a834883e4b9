//! Options whose value is one of several names, such as methods and solvers, and hints for unknown names.

use sidc::Method;
use sidc_discover::METHODS;
use sidc_lang::diagnostic::did_you_mean;
use sidc_solve::SOLVERS;

/// The value that belongs to a known name.
pub fn one_of<T>(
    name: &str,
    all: impl Iterator<Item = (&'static str, T)> + Clone,
) -> Result<T, String> {
    let names = all.clone().map(|(n, _)| n);
    let mut all = all;
    all.find(|(n, _)| *n == name)
        .map(|(_, found)| found)
        .ok_or_else(|| {
            let known: Vec<&str> = names.clone().collect();
            match did_you_mean(name, names) {
                Some(n) => format!("did you mean `{n}`? known: {}", known.join(", ")),
                None => format!("known: {}", known.join(", ")),
            }
        })
}

/// `identify --method`
pub fn method(name: &str) -> Result<Method, String> {
    one_of(name, METHODS.iter().copied())
}

/// `identify --solver`
pub fn solver(name: &str) -> Result<&'static str, String> {
    one_of(name, SOLVERS.iter().map(|s| (s.name(), s.name())))
}

/// A suggestion to append to the message about an unknown name, if a known one is similar.
pub fn hint<'a>(wrong: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    did_you_mean(wrong, known).map_or_else(String::new, |n| format!("; did you mean `{n}`?"))
}
