//! Signals that were logged each at its own rate.
//!
//! In: topics, whose signals share their times. Out: the values of a topic in rows of other times. Knows no table.

/// Signals that were logged together.
#[derive(Clone, Debug, PartialEq)]
pub struct Topic {
    pub name: String,
    /// In seconds.
    pub times: Vec<f64>,
    /// As many values as times; NaN where one is missing.
    pub columns: Vec<(String, Vec<f64>)>,
}

/// All topics of a log, in the order of their times.
#[derive(Debug)]
pub(super) struct Log {
    pub topics: Vec<Topic>,
    /// Most memory of a table made of it.
    pub most: u64,
}

/// A table that would take more memory than there is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TooLarge {
    pub(super) log: String,
    pub(super) columns: usize,
    pub(super) rows: usize,
    pub(super) needed: u64,
    pub(super) most: u64,
    pub(super) topics: Vec<String>,
}

impl Topic {
    /// Sorted by time; of two messages at one instant the later one holds.
    pub(super) fn sorted(self) -> Topic {
        if self.times.is_sorted_by(|a, b| a < b) {
            return self;
        }
        let mut order: Vec<usize> = (0..self.times.len()).collect();
        let time = |place: usize| self.times.get(place).copied().unwrap_or(f64::NAN);
        order.sort_by(|a, b| time(*a).total_cmp(&time(*b)));
        let mut kept: Vec<usize> = Vec::new();
        for place in order {
            match kept.last_mut() {
                Some(last) if time(*last) == time(place) => *last = place,
                _ => kept.push(place),
            }
        }
        let pick = |values: &[f64]| -> Vec<f64> {
            let chosen = kept.iter();
            chosen
                .filter_map(|place| values.get(*place))
                .copied()
                .collect()
        };
        let columns = self.columns.iter();
        Topic {
            times: pick(&self.times),
            columns: columns
                .map(|(name, values)| (name.clone(), pick(values)))
                .collect(),
            name: self.name,
        }
    }

    fn has(&self, wanted: &dyn Fn(&str) -> bool) -> bool {
        self.columns.iter().any(|(name, _)| wanted(name))
    }

    /// Its values in rows of these times, which contain its own.
    pub(super) fn spread(&self, values: &[f64], times: &[f64]) -> Vec<f64> {
        let mut own = self.times.iter().zip(values).peekable();
        let mut out = Vec::with_capacity(times.len());
        for time in times {
            let here = own.next_if(|(at, _)| *at == time);
            out.push(here.map_or(f64::NAN, |(_, value)| *value));
        }
        out
    }
}

impl Log {
    /// Memory of the values.
    pub(super) fn bytes(&self) -> u64 {
        let of = |topic: &Topic| (topic.times.len() * (topic.columns.len() + 1) * 8) as u64;
        self.topics.iter().map(of).sum()
    }

    pub(super) fn chosen<'a>(
        &'a self,
        wanted: &'a dyn Fn(&str) -> bool,
    ) -> impl Iterator<Item = &'a Topic> {
        self.topics.iter().filter(move |topic| topic.has(wanted))
    }
}
