//! Dates and clock times of loggers as seconds (ISO 8601).
//!
//! In: the text of a cell. Out: seconds since 1970, or since midnight where there is no date. Dates in other orders are ambiguous, and no
//! dates here.

/// `2026-11-25T12:30:01.5`, with a blank for the `T`, `Z` or an offset behind it; `2026-11-25`; `12:30:01.5`.
pub(super) fn seconds(cell: &str) -> Option<f64> {
    let Some((date, clock)) = cell.split_once(['T', ' ']) else {
        return match cell.contains(':') {
            true => clock_seconds(cell),
            false => days(cell).map(|d| 86_400.0 * d),
        };
    };
    let (clock, offset) = match clock.strip_suffix('Z') {
        Some(clock) => (clock, 0.0),
        None => match clock.rfind(['+', '-']) {
            Some(at) => (clock.get(..at)?, offset(clock.get(at..)?)?),
            None => (clock, 0.0),
        },
    };
    Some(86_400.0 * days(date)? + (clock_seconds(clock.trim_end())? - offset))
}

/// Digits, as many as these.
fn digits(text: &str, count: usize) -> Option<u32> {
    let all = text.len() == count && text.bytes().all(|b| b.is_ascii_digit());
    all.then(|| text.parse().ok()).flatten()
}

/// `2026-11-25` as days since 1970 (Gregorian, also before 1582).
fn days(date: &str) -> Option<f64> {
    let (year, rest) = date.split_once('-')?;
    let (month, day) = rest.split_once('-')?;
    let (year, month, day) = (digits(year, 4)?, digits(month, 2)?, digits(day, 2)?);
    let leap = year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
    let lengths = [
        31,
        if leap { 29 } else { 28 },
        31,
        30,
        31,
        30,
        31,
        31,
        30,
        31,
        30,
        31,
    ];
    let length = *lengths.get(month.checked_sub(1)? as usize)?;
    if day == 0 || day > length || year == 0 {
        return None;
    }
    let before = year - 1;
    let leap_days = before / 4 - before / 100 + before / 400;
    let months: u32 = lengths.iter().take(month as usize - 1).sum();
    // 719,162 days are before 1970.
    Some(f64::from(365 * before + leap_days + months + day - 1) - 719_162.0)
}

/// `12:30`, `12:30:01.5`
fn clock_seconds(clock: &str) -> Option<f64> {
    let mut parts = clock.split(':');
    let (hours, minutes) = (parts.next()?, parts.next()?);
    let (hours, minutes) = (digits(hours, 2)?, digits(minutes, 2)?);
    let seconds: f64 = match parts.next() {
        Some(text) => {
            digits(text.get(..2)?, 2)?;
            text.parse().ok()?
        }
        None => 0.0,
    };
    let fits = hours < 24 && minutes < 60 && seconds < 61.0 && parts.next().is_none();
    fits.then(|| f64::from(3600 * hours + 60 * minutes) + seconds)
}

/// `+02:00`, `-0530`, `+01` in seconds.
fn offset(text: &str) -> Option<f64> {
    let sign = if text.starts_with('-') { -1.0 } else { 1.0 };
    let all: String = text.chars().skip(1).filter(|c| *c != ':').collect();
    let (hours, minutes) = (all.get(..2)?, all.get(2..)?);
    let minutes = if minutes.is_empty() {
        0
    } else {
        digits(minutes, 2)?
    };
    Some(sign * f64::from(3600 * digits(hours, 2)? + 60 * minutes))
}

#[cfg(test)]
mod tests {
    use super::seconds;

    #[test]
    fn dates_and_clocks_are_seconds() {
        for (text, expected) in [
            ("1970-01-01T00:00:00Z", 0.0),
            ("1970-01-01", 0.0),
            ("2000-02-29 12:00", 951_825_600.0),
            ("2026-11-25T12:30:01.5", 1_795_609_801.5),
            ("2026-11-25T12:30:01+02:00", 1_795_602_601.0),
            ("2026-11-25 12:30:01 -0530", 1_795_629_601.0),
            ("1969-12-31T23:59:59Z", -1.0),
            ("12:30:01.25", 45_001.25),
        ] {
            assert_eq!(seconds(text), Some(expected), "{text}");
        }
    }

    #[test]
    fn what_may_mean_two_dates_means_none() {
        for text in [
            "01.02.2024",
            "02/01/2024",
            "2024-13-01",
            "2023-02-29",
            "2024-1-1",
            "24:00:00",
            "12:60",
            "T",
            "2024-05-01T",
            "1:2:3",
            "",
            "2024-05-01T12:00:00+",
            "äö-12-30",
        ] {
            assert_eq!(seconds(text), None, "{text}");
        }
    }
}
