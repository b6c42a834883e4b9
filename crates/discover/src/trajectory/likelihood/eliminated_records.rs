//! The states of all records eliminated about a point, window by window.
//!
//! In: a problem, a point. Out: rows of the active columns; then, for any coefficients, the states. Takes no steps.
//!
//! The eliminated rows are n (2n + P + 1) numbers a sample. Where those of all records together take much memory, only where the filter stands
//! before each of many windows is kept, and the windows are swept once more, from the last to the first, when states are wanted: memory
//! then grows with a window instead of the records (checkpoints: Griewank & Walther, ACM Transactions on Mathematical Software 2000).

use std::ops::Range;

use super::sweep::Sweep;
use crate::trajectory::integration::{CompiledLaws, Diverged, INTERVALS_AT_ONCE, Workspace};
use crate::trajectory::least_squares::{
    EliminatedStates, FilterState, InformationFilter, NoRows, RowSink,
};
use crate::trajectory::model::{LinearizationPoint, Problem};
use sidc_progress::{Observer, Unwatched};

/// Memory of rows that are kept: ten thousand samples of five states and a hundred terms, so that supports are searched without a second
/// sweep. Two fits at once keep twice as much.
const KEPT_BYTES: usize = 64 << 20;
/// Memory of a window that is swept once more: it stays in the cache of a core.
const WINDOW_BYTES: usize = 1 << 20;

/// All records about a point.
pub(crate) struct EliminatedRecords<'a> {
    problem: &'a Problem,
    code: &'a CompiledLaws,
    at: &'a LinearizationPoint,
    /// Windows of each record, one after another.
    records: Vec<Vec<Window>>,
}

/// Some neighbouring samples of a record.
struct Window {
    samples: Range<usize>,
    filter: FilterState,
    /// First guesses of the integration.
    guess: Vec<f64>,
    /// The eliminated rows, where they are kept.
    rows: Option<EliminatedStates>,
}

impl<'a> EliminatedRecords<'a> {
    /// Eliminates the states about a point; rows of the active columns go to `sink`.
    ///
    /// # Errors
    /// The laws diverge from there, or the work was cancelled.
    pub fn new(
        (problem, code): (&'a Problem, &'a CompiledLaws),
        at: &'a LinearizationPoint,
        sink: &mut impl RowSink,
        observer: &mut dyn Observer,
    ) -> Result<Self, Diverged> {
        let n = problem.states();
        let bytes = n * (2 * n + sink.columns() + 1) * size_of::<f64>();
        let window = match problem.samples().saturating_mul(bytes) <= KEPT_BYTES {
            true => None,
            false => Some((WINDOW_BYTES / bytes.max(1)).next_multiple_of(INTERVALS_AT_ONCE)),
        };
        Self::in_windows((problem, code), at, window, sink, observer)
    }

    /// In windows of so many samples, a multiple of the intervals integrated at once, whose rows are not kept; or of whole records, whose
    /// rows are.
    pub fn in_windows(
        (problem, code): (&'a Problem, &'a CompiledLaws),
        at: &'a LinearizationPoint,
        window: Option<usize>,
        sink: &mut impl RowSink,
        observer: &mut dyn Observer,
    ) -> Result<Self, Diverged> {
        let mut work = Workspace::default();
        let mut records = Vec::new();
        for (r, record) in problem.records.iter().enumerate() {
            let keep = window.is_none().then_some(record.len());
            let sweep = Sweep::new(problem, (code, None), at, (r, 0));
            let mut filter = InformationFilter::new(sweep.stiffness(), sink, keep);
            let mut windows = Vec::new();
            for samples in windows_of(record.len(), window) {
                let intervals = samples.start..samples.end.min(record.len() - 1);
                windows.push(Window {
                    samples,
                    filter: filter.state(),
                    guess: work.first_guess().to_vec(),
                    rows: None,
                });
                sweep.advance(&mut filter, intervals, &mut work, observer)?;
            }
            sweep.read(&mut filter, record.len() - 1);
            if let (Some(_), [whole]) = (keep, &mut windows[..]) {
                whole.rows = Some(filter.end());
            }
            records.push(windows);
        }
        Ok(EliminatedRecords {
            problem,
            code,
            at,
            records,
        })
    }

    /// δz of every sample of each record (samples × n) for coefficients moved by `coefficients`.
    ///
    /// # Errors
    /// The work was cancelled.
    pub fn states(
        &self,
        coefficients: &[f64],
        observer: &mut dyn Observer,
    ) -> Result<Vec<Vec<f64>>, Diverged> {
        let n = self.problem.states();
        let of = |r: usize| {
            let mut out = vec![0.0; self.problem.records[r].len() * n];
            let mut after = vec![0.0; n];
            self.backward(r, observer, &mut |samples, rows| {
                let states = rows.states(coefficients, &after);
                after.copy_from_slice(&states[..n]);
                out[samples.start * n..samples.end * n].copy_from_slice(&states);
            })?;
            Ok(out)
        };
        (0..self.records.len()).map(of).collect()
    }

    /// Calls `take` with the windows of a record and their eliminated rows, the last one first.
    ///
    /// # Errors
    /// The work was cancelled.
    pub fn backward(
        &self,
        record: usize,
        observer: &mut dyn Observer,
        take: &mut dyn FnMut(Range<usize>, &EliminatedStates),
    ) -> Result<(), Diverged> {
        for window in self.records[record].iter().rev() {
            if !observer.go_on() {
                return Err(Diverged);
            }
            match &window.rows {
                Some(rows) => take(window.samples.clone(), rows),
                None => take(window.samples.clone(), &self.rows_again(record, window)?),
            }
        }
        Ok(())
    }

    /// The eliminated rows of a window, swept once more.
    fn rows_again(&self, record: usize, window: &Window) -> Result<EliminatedStates, Diverged> {
        let sweep = Sweep::new(self.problem, (self.code, None), self.at, (record, 0));
        let samples = &window.samples;
        let mut taken = NoRows(self.at.support.len());
        let mut filter = InformationFilter::new(sweep.stiffness(), &mut taken, Some(samples.len()));
        filter.resume(&window.filter);
        let mut work = Workspace::default();
        work.set_first_guess(&window.guess);
        let last = self.problem.records[record].len() - 1;
        let intervals = samples.start..samples.end.min(last);
        sweep.advance(&mut filter, intervals, &mut work, &mut Unwatched)?;
        if samples.end <= last {
            return Ok(filter.eliminated());
        }
        sweep.read(&mut filter, last);
        Ok(filter.end())
    }
}

/// The windows of a record of so many samples: all samples where `window` is `None`. The last sample has no interval and goes with the
/// window before it.
fn windows_of(samples: usize, window: Option<usize>) -> Vec<Range<usize>> {
    let (last, window) = (samples.saturating_sub(1), window.unwrap_or(samples).max(1));
    let starts = (0..last.max(1)).step_by(window);
    let end = |from: usize| match from + window {
        end if end < last => end,
        _ => samples,
    };
    starts.map(|from| from..end(from)).collect()
}
