//! Words as people read them.

/// `a, b and c`
pub fn listed<S: AsRef<str>>(all: &[S]) -> String {
    let all: Vec<&str> = all.iter().map(AsRef::as_ref).collect();
    match all.as_slice() {
        [] => String::new(),
        [one] => (*one).into(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

/// `a, b, c`; with more than `most`, `a, b and 4 more`.
pub fn beginning<S: AsRef<str>>(all: &[S], most: usize) -> String {
    let (shown, more) = all.split_at(all.len().min(most));
    let shown: Vec<&str> = shown.iter().map(AsRef::as_ref).collect();
    match more.len() {
        0 => shown.join(", "),
        more => format!("{} and {more} more", shown.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::{beginning, listed};

    #[test]
    fn the_beginning_of_a_list_says_how_many_follow() {
        assert_eq!(beginning(&["a", "b"], 2), "a, b");
        assert_eq!(beginning(&["a", "b", "c", "d"], 2), "a, b and 2 more");
        assert_eq!(beginning::<&str>(&[], 2), "");
    }

    #[test]
    fn lists_end_in_and() {
        assert_eq!(listed(&["a", "b", "c"]), "a, b and c");
        assert_eq!(listed(&["a"]), "a");
    }
}
