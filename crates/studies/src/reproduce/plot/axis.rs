//! One axis: its range, its ticks and their labels.

/// A label with its unit, a range, and a scale.
#[derive(Clone)]
pub struct Axis {
    pub label: String,
    from: f64,
    to: f64,
    log: bool,
    /// Positions with words, if the ticks are not numbers.
    words: Vec<(f64, String)>,
    /// Whether ticks are in per cent.
    percent: bool,
}

impl Axis {
    pub fn linear(label: &str, from: f64, to: f64) -> Axis {
        Axis {
            label: label.to_string(),
            from,
            to,
            log: false,
            words: Vec::new(),
            percent: false,
        }
    }

    pub fn log(label: &str, from: f64, to: f64) -> Axis {
        Axis {
            log: true,
            ..Axis::linear(label, from, to)
        }
    }

    /// An axis for the share of successes.
    pub fn share(label: &str) -> Axis {
        Axis {
            percent: true,
            ..Axis::linear(label, 0.0, 1.0)
        }
    }

    pub fn percent(self) -> Axis {
        Axis {
            percent: true,
            ..self
        }
    }

    pub fn words(self, words: Vec<(f64, String)>) -> Axis {
        Axis { words, ..self }
    }

    /// The position of a value, from 0 at the start to 1 at the end, clamped.
    pub fn at(&self, value: f64) -> f64 {
        let place = |v: f64| match self.log {
            true => v.max(f64::MIN_POSITIVE).ln(),
            false => v,
        };
        let (a, b) = (place(self.from), place(self.to));
        ((place(value) - a) / (b - a)).clamp(0.0, 1.0)
    }

    /// Positions and texts of the ticks.
    pub fn ticks(&self) -> Vec<(f64, String)> {
        if !self.words.is_empty() {
            return self.words.clone();
        }
        let values = if self.log {
            self.decades()
        } else {
            self.round()
        };
        let texts = values.into_iter().map(|v| (v, self.text(v)));
        texts.collect()
    }

    /// At most eight powers of ten; if there are few, also 2 and 5 times these.
    fn decades(&self) -> Vec<f64> {
        let (a, b) = (self.from.log10(), self.to.log10());
        let wide = |every: &i32| (b - a) / f64::from(*every) <= 7.0;
        let every = [1, 2, 5, 10, 20].into_iter().find(wide).unwrap_or(50);
        let mut out = Vec::new();
        for e in (a.floor() as i32)..=(b.ceil() as i32) {
            let steps: &[f64] = match b - a {
                s if s < 1.6 => &[1.0, 2.0, 3.0, 5.0],
                s if s < 2.6 => &[1.0, 2.0, 5.0],
                _ => &[1.0],
            };
            if e.rem_euclid(every) == 0 {
                out.extend(steps.iter().map(|s| s * 10_f64.powi(e)));
            }
        }
        let inside = |v: &f64| *v >= self.from * 0.999 && *v <= self.to * 1.001;
        out.into_iter().filter(inside).collect()
    }

    /// About five round values: multiples of 1, 2, 2.5 or 5 times a power of ten.
    fn round(&self) -> Vec<f64> {
        let rough = (self.to - self.from) / 5.0;
        let power = 10_f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 2.5, 5.0, 10.0]
            .into_iter()
            .map(|s| s * power)
            .find(|s| *s >= 0.999 * rough)
            .unwrap_or(power);
        let first = (self.from / step - 1e-6).ceil() as i64;
        let last = (self.to / step + 1e-6).floor() as i64;
        (first..=last).map(|k| k as f64 * step).collect()
    }

    fn text(&self, value: f64) -> String {
        if self.percent {
            return format!("{} %", short(100.0 * value));
        }
        let exponent = value.abs().log10();
        match self.log && (self.to / self.from > 1e5 || exponent.abs() > 4.5) {
            true => format!("10{}", raised(exponent.round() as i32)),
            false => short(value),
        }
    }
}

/// A number with few digits and separated thousands.
pub fn short(value: f64) -> String {
    let rounded = format!("{value:.6}");
    let text = rounded.trim_end_matches('0').trim_end_matches('.');
    let (sign, digits) = match text.strip_prefix('-') {
        Some(rest) => ("−", rest),
        None => ("", text),
    };
    let (whole, part) = digits.split_once('.').unwrap_or((digits, ""));
    let mut grouped = String::new();
    for (i, c) in whole.chars().enumerate() {
        if i > 0 && (whole.len() - i) % 3 == 0 {
            grouped.push(',');
        }
        grouped.push(c);
    }
    match part {
        "" => format!("{sign}{grouped}"),
        _ => format!("{sign}{grouped}.{part}"),
    }
}

/// An exponent in superscript digits.
fn raised(exponent: i32) -> String {
    let raise = |c: char| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '4' => '⁴',
        '5' => '⁵',
        '6' => '⁶',
        '7' => '⁷',
        '8' => '⁸',
        '9' => '⁹',
        _ => '⁰',
    };
    exponent.to_string().chars().map(raise).collect()
}
