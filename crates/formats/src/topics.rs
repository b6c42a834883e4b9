//! Messages of several topics, each at its own rate → the table of a log.
//!
//! In: what the messages of each topic hold, one after another. Out: the table, and what was left out of it. Shared by all readers of logs.

use std::collections::{BTreeMap, HashMap, HashSet};

use sidc_data::{Table, Topic};

use crate::budget::Budget;
use crate::fault::Fault;
use crate::timestamps::scaled;
use crate::variables::Assembled;

/// What a log holds: topics, and what was left out.
pub(crate) type Logged = (Vec<Topic>, Vec<String>);

/// Longest list whose values are columns: joints and motors, not images and point clouds.
pub(crate) const LONGEST_LIST: usize = 64;

/// The path of a value in a message: names of fields and places in lists, joined by `_`.
#[derive(Debug, Default)]
pub(crate) struct Path {
    text: String,
}

impl Path {
    /// Enters a field. Returns what [`Path::leave`] needs.
    pub(crate) fn enter(&mut self, name: &str) -> usize {
        let before = self.text.len();
        if before > 0 {
            self.text.push('_');
        }
        self.text.push_str(name);
        before
    }

    pub(crate) fn enter_place(&mut self, place: usize) -> usize {
        self.enter(&place.to_string())
    }

    pub(crate) fn leave(&mut self, before: usize) {
        self.text.truncate(before);
    }
}

/// The messages of a topic whose fields become known only as they are read.
#[derive(Debug, Default)]
pub(crate) struct Messages {
    /// Nanoseconds from the start of the log.
    times: Vec<i128>,
    /// Columns by path; shorter than the times if the last values are missing.
    columns: Vec<(String, Vec<f64>)>,
    places: HashMap<String, usize>,
    /// The column that comes next if this message has the fields of the one before.
    next: usize,
    left_out: BTreeMap<String, &'static str>,
}

impl Messages {
    /// Begins a message.
    ///
    /// # Errors
    /// More memory than is left, as for the other methods.
    pub(crate) fn begin(&mut self, time: i128, budget: &mut Budget) -> Result<(), Fault> {
        budget.take(1, 48)?;
        self.times.push(time);
        self.next = 0;
        Ok(())
    }

    pub(crate) fn value(
        &mut self,
        path: &Path,
        value: f64,
        budget: &mut Budget,
    ) -> Result<(), Fault> {
        let place = self.place(&path.text, budget)?;
        self.next = place + 1;
        let messages = self.times.len();
        if let Some((_, values)) = self.columns.get_mut(place)
            && values.len() < messages
        {
            budget.take((messages - values.len()) as u64, 16)?;
            values.resize(messages - 1, f64::NAN);
            values.push(value);
        }
        Ok(())
    }

    fn place(&mut self, path: &str, budget: &mut Budget) -> Result<usize, Fault> {
        if self
            .columns
            .get(self.next)
            .is_some_and(|(name, _)| name == path)
        {
            return Ok(self.next);
        }
        if let Some(place) = self.places.get(path) {
            return Ok(*place);
        }
        budget.take(1, 200 + 3 * path.len() as u64)?;
        let place = self.columns.len();
        self.columns.push((path.to_string(), Vec::new()));
        self.places.insert(path.to_string(), place);
        Ok(place)
    }

    /// Notes once what a field holds, if not numbers.
    pub(crate) fn leave_out(
        &mut self,
        path: &Path,
        what: &'static str,
        budget: &mut Budget,
    ) -> Result<(), Fault> {
        if !self.left_out.contains_key(&path.text) {
            budget.take(1, 200 + path.text.len() as u64)?;
            self.left_out.insert(path.text.clone(), what);
        }
        Ok(())
    }

    /// The topic with its columns named.
    pub(crate) fn topic(
        self,
        name: &str,
        left_out: &mut Vec<String>,
        budget: &mut Budget,
    ) -> Result<Topic, Fault> {
        let all = self.left_out.into_iter();
        left_out.extend(all.map(|(path, what)| format!("{} ({what})", joined(&[name, &path]))));
        let count = self.times.len();
        let mut columns = self.columns;
        for (path, values) in &mut columns {
            budget.take((count - values.len()) as u64, 16)?;
            values.resize(count, f64::NAN);
            *path = joined(&[name, path]);
        }
        let times = self.times.into_iter();
        Ok(Topic {
            name: name.to_string(),
            times: times
                .map(|nanoseconds| scaled(nanoseconds as f64, 1e-9))
                .collect(),
            columns,
        })
    }
}

/// The table of topics, whose columns are already named; it may take the memory that the budget leaves.
///
/// # Errors
/// No message holds a number.
pub(crate) fn assemble(
    file: &str,
    (topics, mut left_out): Logged,
    budget: &Budget,
) -> Result<Assembled, Fault> {
    let mut seen = HashSet::from(["t".to_string()]);
    let mut kept = Vec::new();
    for mut topic in topics {
        topic.columns.retain(|(name, _)| {
            let new = seen.insert(name.clone());
            if !new {
                left_out.push(format!("a second {name}"));
            }
            new
        });
        if !topic.times.is_empty() && !topic.columns.is_empty() {
            kept.push(topic);
        }
    }
    let log = Table::from_topics(file, kept, budget.left());
    let table = log.map_err(|_| Fault::no_columns(": no message in it holds a number"))?;
    Ok(Assembled {
        table,
        left_out,
        step: None,
    })
}

/// A name that a model can contain: characters other than letters and digits become underscores, and none are left at the ends of a part.
pub(crate) fn joined(parts: &[&str]) -> String {
    let plain = |c: char| if c.is_alphanumeric() { c } else { '_' };
    let part = |part: &&str| part.chars().map(plain).collect::<String>();
    let parts: Vec<String> = parts.iter().map(part).collect();
    let parts = parts.iter().map(|part| part.trim_matches('_'));
    parts
        .filter(|p| !p.is_empty())
        .collect::<Vec<_>>()
        .join("_")
}
