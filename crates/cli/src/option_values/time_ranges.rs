//! Options that select rows: ranges of time, parts of every record, whole files.

use std::path::{Path, PathBuf};

use sidc::HoldOutRange;
use sidc_lang::number::significant;

/// `2..10`, `..5`, `3..`
pub fn window(text: &str) -> Result<(Option<f64>, Option<f64>), String> {
    let (from, to) = text
        .split_once("..")
        .ok_or("write a stretch of time as A..B")?;
    let end = |t: &str| -> Result<Option<f64>, String> {
        if t.trim().is_empty() {
            return Ok(None);
        }
        match t.trim().parse::<f64>() {
            Ok(x) if x.is_finite() => Ok(Some(x)),
            _ => Err(format!("`{t}` is not a time in seconds")),
        }
    };
    let (from, to) = (end(from)?, end(to)?);
    match (from, to) {
        (Some(a), Some(b)) if a >= b => Err(format!("{a} is not before {b}")),
        ends => Ok(ends),
    }
}

/// What `--holdout` takes: a part of every record, or a file.
#[derive(Clone, Debug)]
pub enum HeldOut {
    Stretch(HoldOutRange),
    File(PathBuf),
}

impl HeldOut {
    pub fn file(&self) -> Option<&PathBuf> {
        match self {
            HeldOut::File(path) => Some(path),
            HeldOut::Stretch(_) => None,
        }
    }
}

/// `30..40`, `25%`, `test.csv`
pub fn held_out(text: &str) -> Result<HeldOut, String> {
    if let Some(part) = text.strip_suffix('%') {
        return match part.trim().parse::<f64>() {
            Ok(p) if p > 0.0 && p < 100.0 => Ok(HeldOut::Stretch(HoldOutRange::Last(p / 100.0))),
            _ => Err("a part is above 0 % and below 100 %".into()),
        };
    }
    let path = Path::new(text);
    if path.is_file() {
        return Ok(HeldOut::File(path.into()));
    }
    let part = text.parse::<f64>().ok().filter(|p| *p > 0.0 && *p < 100.0);
    if let Some(part) = part {
        let percent = if part < 1.0 { 100.0 * part } else { part };
        return Err(format!("did you mean {}%?", significant(percent, 6)));
    }
    if !text.contains("..") {
        return Err(
            "there is no data file of this name; a stretch of time is written A..B, a part of every record 25%"
                .into(),
        );
    }
    let (from, to) = window(text)?;
    Ok(HeldOut::Stretch(HoldOutRange::Times(from, to)))
}
