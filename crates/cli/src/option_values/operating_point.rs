//! Reads an operating point such as `theta=pi/2,dtheta=0` from the command line.
//!
//! In: texts, and the names that may be given. Out: values by name. Rejects any text that is not a name with a number.

use super::assignments::given_twice;
use super::names::hint;
use crate::failure::Failure;
use crate::thresholds::INPUT_LIMITS;
use sidc_lang as lang;
use sidc_lang::Vocabulary;
use sidc_lang::model::RightSide;
use sidc_lang::parse::normalise;
use sidc_lang::source::Sources;

/// `name=value` pairs, in order.
///
/// # Errors
/// A pair without `=`, or a value that is not a finite number.
fn pairs(option: &str, texts: &[String]) -> Result<Vec<(String, f64)>, Failure> {
    let pieces = texts.iter().flat_map(|t| pieces(t));
    pieces.map(|piece| pair(option, &piece)).collect()
}

fn pair(option: &str, piece: &str) -> Result<(String, f64), Failure> {
    let refuse = |why: String| {
        let piece = shown(piece);
        Failure::new(format!(
            "error[point-value]: {option} {piece}: {why}\n  = help: {option} theta=pi/2,dtheta=-0.1"
        ))
    };
    let Some((name, value)) = piece.split_once('=') else {
        return Err(refuse("this is not name=value".into()));
    };
    let name: String = name.chars().filter(|c| !c.is_whitespace()).collect();
    if name.is_empty() {
        return Err(refuse("there is no name before the `=`".into()));
    }
    match number(value.trim()) {
        Some(x) => Ok((normalise(&name), x)),
        None => Err(refuse(format!(
            "`{}` is not a finite number",
            shown(value.trim())
        ))),
    }
}

/// A text as a message shows it: on one line, shortened if it is long.
fn shown(text: &str) -> String {
    let escaped = text.escape_debug().to_string();
    match escaped.char_indices().nth(INPUT_LIMITS.point_value) {
        Some((end, _)) => format!("{}…", escaped.get(..end).unwrap_or_default()),
        None => escaped,
    }
}

/// The pieces between commas outside brackets: `lag(y, 1)=2` is one piece.
fn pieces(text: &str) -> Vec<String> {
    let mut out = vec![String::new()];
    let mut depth = 0usize;
    for c in text.chars() {
        match c {
            '(' => depth += 1,
            ')' => depth = depth.saturating_sub(1),
            _ => {}
        }
        match (c, depth, out.last_mut()) {
            (',', 0, _) => out.push(String::new()),
            (c, _, Some(last)) => last.push(c),
            _ => {}
        }
    }
    out.iter().map(|p| p.trim().to_string()).collect()
}

/// A number, or arithmetic on numbers and `pi`, in the syntax of the language.
fn number(text: &str) -> Option<f64> {
    let sound = |c: char| c.is_ascii_alphanumeric() || "+-*/^(). ".contains(c);
    if text.is_empty() || text.len() > INPUT_LIMITS.point_value || !text.chars().all(sound) {
        return None;
    }
    let digits = text.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c));
    if let (true, Ok(x)) = (digits, text.parse::<f64>()) {
        return Some(x).filter(|x| x.is_finite());
    }
    let mut sources = Sources::default();
    let file = sources.add("--at", format!("state x : order 1\ndx = {text}\n"));
    let (model, _) = lang::compile(file, &sources, &Vocabulary { generators: vec![] });
    match &model?.equations.first()?.right {
        RightSide::Known(e) => e.as_number().filter(|x| x.is_finite()),
        RightSide::Search { .. } => None,
    }
}

/// An option that assigns values to names.
pub struct PointOption<'a> {
    /// `--at`
    pub name: &'a str,
    /// Code of the error for an unknown name.
    pub unknown: &'a str,
    /// The names that may be given.
    pub known: &'a [String],
    /// Why a name is not allowed; `None` for the usual message, which suggests the nearest one.
    pub explain: &'a dyn Fn(&str) -> Option<String>,
}

impl PointOption<'_> {
    /// Values, each with the index of its name among the known ones.
    ///
    /// # Errors
    /// A text that is not name=value, an unknown name, a name given twice.
    pub fn read(&self, texts: &[String]) -> Result<Vec<(usize, f64)>, Failure> {
        let pairs = pairs(self.name, texts)?;
        resolve(self, &pairs)
    }
}

fn resolve(option: &PointOption, pairs: &[(String, f64)]) -> Result<Vec<(usize, f64)>, Failure> {
    let known = option.known;
    let plain = |s: &str| -> String { s.chars().filter(|c| !c.is_whitespace()).collect() };
    let mut out: Vec<(usize, f64)> = Vec::new();
    for (name, value) in pairs {
        let Some(place) = known.iter().position(|k| plain(k) == *name) else {
            let why = (option.explain)(name).unwrap_or_else(|| {
                let hint = hint(name, known.iter().map(String::as_str));
                format!("the equations have no such name{hint}")
            });
            return Err(Failure::new(format!(
                "error[{}]: {} {}: {why}\n  = known: {}",
                option.unknown,
                option.name,
                shown(name),
                known.join(", ")
            )));
        };
        if out.iter().any(|(p, _)| *p == place) {
            return Err(given_twice(option.name, name));
        }
        out.push((place, *value));
    }
    Ok(out)
}
