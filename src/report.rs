//! The result as HTML: the whole report, and its first part for a notebook.

use sidc_emit::report::{self, RecordRun, Subject};
use sidc_progress::{Activity, Observer};
use sidc_system::simulate::{self, Options};

use crate::data::Data;
use crate::discovery::Discovery;
use crate::error::Error;

/// Stands for the file that the page was written from.
const NAME: &str = "a result in memory";

impl Discovery {
    /// A page of HTML with the verdict, equations, intervals and runs along these data, as `sidc report` writes it. If the observer ends the work, the page
    /// has the records simulated by then.
    ///
    /// # Errors
    /// [`ErrorKind::Data`](crate::ErrorKind): arrays missing that a run needs.
    pub fn report(&self, data: &Data, observer: &mut dyn Observer) -> Result<String, Error> {
        let records = self.records(data, &[])?;
        let document = &self.opened.document;
        let source = records.source();
        let mut ended = false;
        let mut runs = Vec::new();
        for (trajectory, record) in source.dataset.trajectories.iter().enumerate() {
            for (held_out, window) in report::run_windows(document, record) {
                if ended {
                    break;
                }
                let mut observer = |activity: Activity| {
                    let answer = observer.hear(activity);
                    ended |= answer.is_break();
                    answer
                };
                let options = Options {
                    window,
                    ..Options::default()
                };
                let run = simulate::simulate(&source, trajectory, &options, &mut observer);
                runs.push(RecordRun {
                    trajectory,
                    held_out,
                    run: run.map_err(|d| d.message),
                });
            }
        }
        Ok(report::html(&Subject {
            discovery: &self.opened.discovery,
            document,
            name: NAME,
            dataset: &records.dataset,
            runs: &runs,
            files: data.files(),
        }))
    }

    /// A fragment of HTML with the equations, the verdict and the coefficients with their intervals, typeset as in the report.
    pub fn html(&self) -> String {
        report::summary(&self.opened.discovery, &self.opened.document)
    }
}
