//! Names of files in messages and results.

use std::path::Path;

use sidc_lang::source::printable;

/// The file's name without folders, as messages and results show it.
pub fn short_name(path: &Path) -> String {
    path.file_name().map_or_else(
        || path.display().to_string(),
        |n| n.to_string_lossy().into_owned(),
    )
}

/// A path as messages show it; it may hold arbitrary bytes.
pub fn shown(path: &Path) -> String {
    printable(&path.display().to_string())
}

/// A word quoted for a shell.
pub fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_=./,:%+@".contains(c);
    match !word.is_empty() && word.chars().all(plain) {
        true => word.into(),
        false => format!("'{}'", word.replace('\'', "'\\''")),
    }
}

#[cfg(test)]
mod tests {
    use super::quoted;

    #[test]
    fn words_with_spaces_and_quotes_are_quoted() {
        assert_eq!(quoted("models/a.sid"), "models/a.sid");
        assert_eq!(quoted("my data's.csv"), "'my data'\\''s.csv'");
        assert_eq!(quoted("$HOME"), "'$HOME'");
    }
}
