//! The table of some signals of a log.
//!
//! In: topics, and which columns are wanted. Out: a table with a row for each instant at which one of them was logged, and empty cells
//! elsewhere. What nobody asks for takes no row. All of a long log in one table would fit into no memory: what is asked for is known only
//! when a model is there.

use std::borrow::Cow;
use std::collections::{BTreeMap, HashSet};
use std::sync::Arc;

use sidc_lang::diagnostic::Diagnostic;

use super::arrays::ArrayFault;
use super::log::{Log, TooLarge, Topic};
use super::read_errors::size;
use super::rows::Rows;
use super::table::{Origin, Table};

/// Header of the times of a log.
const TIME: &str = "t";

impl Table {
    /// The table of a log. It has no rows until columns are asked of it with [`Table::of_columns`], and then those of the times at which they
    /// were logged. A table of columns may take `most` bytes.
    ///
    /// # Errors
    /// The first of: no value, a name twice, another length.
    pub fn from_topics(name: &str, topics: Vec<Topic>, most: u64) -> Result<Table, ArrayFault> {
        let mut headers = vec![TIME.to_string()];
        let mut seen = HashSet::from([TIME]);
        for topic in &topics {
            for (name, values) in &topic.columns {
                if !seen.insert(name) {
                    return Err(ArrayFault::Twice(name.clone()));
                }
                if values.len() != topic.times.len() {
                    return Err(ArrayFault::Ragged {
                        first: topic.times.len(),
                        name: name.clone(),
                        length: values.len(),
                    });
                }
                headers.push(name.clone());
            }
        }
        if topics
            .iter()
            .all(|t| t.times.is_empty() || t.columns.is_empty())
        {
            return Err(ArrayFault::Empty);
        }
        let topics = topics.into_iter().map(Topic::sorted).collect();
        Ok(Table {
            name: name.to_string(),
            headers,
            rows: Rows::default(),
            origin: Origin::Log(Arc::new(Log { topics, most })),
        })
    }

    /// The rows in which one of the wanted columns was logged, with these columns and the times; a table that is no log as it is.
    ///
    /// # Errors
    /// More memory than the limits left when the log was read.
    pub fn of_columns(&self, wanted: &dyn Fn(&str) -> bool) -> Result<Cow<'_, Table>, TooLarge> {
        let Origin::Log(log) = &self.origin else {
            return Ok(Cow::Borrowed(self));
        };
        let columns = self.headers.iter().filter(|h| wanted(h)).count();
        let readings: usize = log.chosen(wanted).map(|topic| topic.times.len()).sum();
        let fault = |rows: usize, needed: u64| TooLarge {
            log: self.name.clone(),
            columns,
            rows,
            needed,
            most: log.most,
            topics: log.topics.iter().map(|topic| topic.name.clone()).collect(),
        };
        // The times of all these topics, of which the rows are found.
        let gathered = 8 * readings as u64;
        if gathered > log.most {
            return Err(fault(readings, gathered));
        }
        let mut times: Vec<f64> = log
            .chosen(wanted)
            .flat_map(|t| t.times.iter().copied())
            .collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        let needed = gathered.saturating_add(times.len() as u64 * (8 * columns as u64 + 24));
        if needed > log.most {
            return Err(fault(times.len(), needed));
        }
        Ok(Cow::Owned(self.filled(log, &times, wanted)))
    }

    fn filled(&self, log: &Log, times: &[f64], wanted: &dyn Fn(&str) -> bool) -> Table {
        let mut rows = Rows::numbered(times.len());
        rows.add_numbers(times.to_vec());
        let mut headers = vec![TIME.to_string()];
        for topic in log.chosen(wanted) {
            for (name, values) in topic.columns.iter().filter(|(name, _)| wanted(name)) {
                headers.push(name.clone());
                rows.add_numbers(topic.spread(values, times));
            }
        }
        let unread = |h: &&String| *h != TIME && !wanted(h);
        Table {
            name: self.name.clone(),
            origin: Origin::Arrays {
                words: BTreeMap::new(),
                unread: self.headers.iter().filter(unread).cloned().collect(),
            },
            headers,
            rows,
        }
    }
}

impl TooLarge {
    /// As it is reported where a model asked for the columns.
    pub(crate) fn diagnostic(&self) -> Diagnostic {
        Diagnostic::error("table-too-large", self.text()).help("set a higher --memory-limit")
    }

    /// What is too large.
    pub fn text(&self) -> String {
        format!(
            "{}: {} columns of {} rows take {}, more than what the memory limit leaves, {}",
            self.log,
            self.columns,
            self.rows,
            size(self.needed),
            size(self.most)
        )
    }

    /// Names of the topics of the log.
    pub fn topics(&self) -> &[String] {
        &self.topics
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn topic(name: &str, times: &[f64]) -> Topic {
        let values = times.iter().map(|t| 10.0 * t).collect();
        Topic {
            name: name.into(),
            times: times.to_vec(),
            columns: vec![(format!("{name}_x"), values)],
        }
    }

    fn log(most: u64) -> Table {
        let topics = vec![
            topic("fast", &[0.0, 1.0, 2.0, 3.0]),
            topic("slow", &[2.5, 1.0, 0.5, 1.0]),
            topic("other", &[0.1, 0.2]),
        ];
        Table::from_topics("flight.ulg", topics, most).unwrap()
    }

    #[test]
    fn only_what_is_asked_for_takes_rows() {
        let log = log(1 << 20);
        assert_eq!(log.headers(), ["t", "fast_x", "slow_x", "other_x"]);
        let table = log.of_columns(&|name| name != "other_x").unwrap();
        assert_eq!(table.headers(), ["t", "fast_x", "slow_x"]);
        assert_eq!(table.values(0), [0.0, 0.5, 1.0, 2.0, 2.5, 3.0]);
        let empty = |column: usize| -> Vec<usize> {
            let values = table.values(column).iter().enumerate();
            values.filter(|(_, x)| x.is_nan()).map(|(k, _)| k).collect()
        };
        assert_eq!((empty(1), empty(2)), (vec![1, 4], vec![0, 3, 5]));
        assert_eq!(table.values(2)[2], 10.0);
        let all: Vec<&String> = table.known_headers().collect();
        assert_eq!(all, ["t", "fast_x", "slow_x", "other_x"]);
    }

    #[test]
    fn memory_is_asked_for_before_it_is_taken() {
        let text = log(100).of_columns(&|_| true).unwrap_err().text();
        assert!(
            text.starts_with("flight.ulg: 4 columns of 8 rows take"),
            "{text}"
        );
        assert!(log(200).of_columns(&|name| name == "slow_x").is_ok());
    }

    #[test]
    fn what_is_no_log_is_refused() {
        let refused = |topics| Table::from_topics("log", topics, 1 << 20).unwrap_err();
        assert_eq!(refused(vec![topic("a", &[])]), ArrayFault::Empty);
        let twice = vec![topic("a", &[0.0]), topic("a", &[1.0])];
        assert_eq!(refused(twice), ArrayFault::Twice("a_x".into()));
    }
}
