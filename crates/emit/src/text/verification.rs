//! The outcome of verification as text.

use sidc_lang::number::significant;
use sidc_system::discovery::Verification;

/// Lines for one equation; none if it was not verified. Claims that do not hold are among the doubts.
pub fn lines(verified: Option<&Verification>) -> Vec<String> {
    let Some(v) = verified else {
        return Vec::new();
    };
    let mut lines = Vec::new();
    lines.extend(confirmed(v).map(|text| {
        let failed = if v.holds { "verified" } else { "checked" };
        format!("{failed} by separate code in 106 bits: {text}")
    }));
    if !v.open.is_empty() {
        lines.push(format!("not verified: {}", v.open.join("; ")));
    }
    lines
}

/// What was checked, with figures; `None` if nothing was.
fn confirmed(v: &Verification) -> Option<String> {
    let mut parts = Vec::new();
    if let Some(p) = &v.proof {
        parts.push(format!(
            "all {} columns on {} rows give gap ≤ {}, max |φᵀλ| ≤ {:.6}{}, rounding ≤ {}",
            v.columns,
            v.rows,
            significant(p.gap.abs(), 2),
            p.max_correlation,
            match p.unique {
                true => format!(", ≤ {:.4} off the support", 1.0 - p.margin),
                false => String::new(),
            },
            significant(p.rounding, 1)
        ));
    }
    if let Some(along) = v.along {
        parts.push(format!(
            "the equation holds to {} along its trajectory of {} samples, which leaves as much of the readings as is stated",
            significant(along, 1),
            v.rows
        ));
    }
    if let Some(residual) = v.residual {
        parts.push(format!("residual {}", significant(residual, 2)));
    }
    if let Some(digits) = v.digits {
        parts.push(format!(
            "coefficients within {} of those of least squares",
            significant(10f64.powf(-digits), 1)
        ));
    }
    (!parts.is_empty()).then(|| parts.join("; "))
}
