//! Tasks on several threads, told to one observer as if they were done one after another.
//!
//! In: tasks, an observer, which stays on its thread. Out: answers in the order of tasks. What an observer ends ends on every thread; a
//! task that is done by then stays done.

use std::collections::VecDeque;
use std::mem::discriminant;
use std::ops::ControlFlow;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Mutex, OnceLock};
use std::thread;

use sidc_progress::{Activity, Observer, Stage, Stop};

use super::{in_order, lock};
use crate::thresholds::PARALLELISM;

/// Answers of all tasks in their order, computed on at most `threads` threads, of which the calling one is one.
pub fn map_watched<T: Send, A: Send>(
    threads: usize,
    tasks: Vec<T>,
    observer: &mut dyn Observer,
    work: impl Fn(T, &mut dyn Observer) -> A + Sync,
) -> Vec<A> {
    let threads = threads.min(tasks.len());
    let reports = Reports::new(tasks.len());
    let queue = Mutex::new(tasks.into_iter().enumerate());
    let next = || lock(&queue).next();
    // The first task is taken before other threads start, so that it runs on the calling thread and the observer hears its reports at
    // once.
    let first = next();
    let mut teller = Teller {
        reports: &reports,
        observer,
    };
    // If the observer ends the work now, no task is begun.
    if threads > 1 {
        teller.tell();
    }
    let done = thread::scope(|scope| {
        let (send, answers) = mpsc::channel();
        for _ in 1..threads {
            let (send, next, reports, work) = (send.clone(), &next, &reports, &work);
            scope.spawn(move || {
                while let Some((i, task)) = next() {
                    let mut observer = |activity: Activity| {
                        reports.add(i, activity);
                        reports.flow()
                    };
                    let answer = work(task, &mut observer);
                    reports.end(i);
                    // The channel is open as long as answers are collected.
                    let _ = send.send((i, answer));
                }
            });
        }
        drop(send);
        let mut done = Vec::new();
        for (i, task) in first.into_iter().chain(std::iter::from_fn(next)) {
            let mut observer = |activity: Activity| {
                reports.add(i, activity);
                teller.tell();
                reports.flow()
            };
            done.push((i, work(task, &mut observer)));
            reports.end(i);
        }
        // In a browser there is no other thread to wait for, and no clock.
        let mut waits = threads > 1;
        while waits {
            match answers.recv_timeout(PARALLELISM.ask_every) {
                Ok(answer) => done.push(answer),
                Err(RecvTimeoutError::Timeout) => teller.tell(),
                Err(RecvTimeoutError::Disconnected) => waits = false,
            }
        }
        done
    });
    teller.tell_all();
    in_order(done)
}

/// What tasks reported and the observer has not heard yet.
struct Reports {
    /// Reports of tasks from the first on that is not completely reported.
    open: Mutex<VecDeque<Report>>,
    tasks: usize,
    stop: OnceLock<Stop>,
}

#[derive(Clone, Default)]
struct Report {
    waiting: VecDeque<Activity<'static>>,
    ended: bool,
}

impl Reports {
    fn new(tasks: usize) -> Reports {
        Reports {
            open: Mutex::new(vec![Report::default(); tasks].into()),
            tasks,
            stop: OnceLock::new(),
        }
    }

    fn flow(&self) -> ControlFlow<Stop> {
        let stop = self.stop.get().copied();
        stop.map_or(ControlFlow::Continue(()), ControlFlow::Break)
    }

    fn change(&self, task: usize, change: impl FnOnce(&mut Report)) {
        let mut open = lock(&self.open);
        let told = self.tasks - open.len();
        let place = task.checked_sub(told);
        if let Some(report) = place.and_then(|k| open.get_mut(k)) {
            change(report);
        }
    }

    fn end(&self, task: usize) {
        self.change(task, |report| report.ended = true);
    }

    /// Replaces the last report if that only tells the progress of the same stage.
    fn add(&self, task: usize, activity: Activity) {
        let Some(activity) = kept(activity) else {
            return;
        };
        self.change(task, |report| {
            if report
                .waiting
                .back()
                .is_some_and(|last| goes_on(last, &activity))
            {
                report.waiting.pop_back();
            }
            report.waiting.push_back(activity);
        });
    }

    /// The next report to pass on, in the order of tasks.
    fn next(&self) -> Option<Activity<'static>> {
        let mut open = lock(&self.open);
        loop {
            let first = open.front_mut()?;
            match first.waiting.pop_front() {
                None if first.ended => drop(open.pop_front()),
                report => return report,
            }
        }
    }
}

/// The activity in a form that can be stored and reported later; `None` if it cannot.
fn kept(activity: Activity) -> Option<Activity<'static>> {
    match activity {
        Activity::Equation { place, stage } => Some(Activity::Equation { place, stage }),
        Activity::Stage(stage) => Some(Activity::Stage(stage)),
        Activity::Running { time } => Some(Activity::Running { time }),
        _ => None,
    }
}

/// Whether one activity is the same stage of the same work as the one before.
fn goes_on(before: &Activity, after: &Activity) -> bool {
    let same = |a: &Stage, b: &Stage| discriminant(a) == discriminant(b);
    match (before, after) {
        (Activity::Stage(a), Activity::Stage(b)) => same(a, b),
        (Activity::Equation { place: p, stage: a }, Activity::Equation { place: q, stage: b }) => {
            p == q && same(a, b)
        }
        (Activity::Running { .. }, Activity::Running { .. }) => true,
        _ => false,
    }
}

/// The observer, on its thread.
struct Teller<'a> {
    reports: &'a Reports,
    observer: &'a mut dyn Observer,
}

impl Teller<'_> {
    fn tell_all(&mut self) -> bool {
        let mut told = false;
        while self.reports.flow().is_continue()
            && let Some(activity) = self.reports.next()
        {
            told = true;
            self.hear(activity);
        }
        told
    }

    /// Passes on all reports received so far; if there are none, asks the observer whether to go on.
    fn tell(&mut self) {
        if !self.tell_all() && self.reports.flow().is_continue() {
            self.hear(Activity::Working);
        }
    }

    fn hear(&mut self, activity: Activity) {
        if let ControlFlow::Break(why) = self.observer.hear(activity) {
            self.reports.stop.get_or_init(|| why);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sidc_progress::Unwatched;

    #[test]
    fn answers_are_in_the_order_of_their_tasks() {
        let tasks: Vec<usize> = (0..50).collect();
        for threads in [1, 2, 5] {
            let found = map_watched(threads, tasks.clone(), &mut Unwatched, |t, _| t + 1);
            assert_eq!(found, (1..51).collect::<Vec<_>>());
        }
    }

    #[test]
    fn stages_are_told_as_if_tasks_followed_each_other() {
        let stages = [Stage::Evaluating, Stage::Choosing, Stage::Weighing];
        for threads in [1, 2, 5] {
            let mut told = Vec::new();
            let mut observer = |activity: Activity| {
                if let Activity::Equation { place, stage } = activity {
                    told.push((place, stage));
                }
                ControlFlow::Continue(())
            };
            let work = |place: usize, observer: &mut dyn Observer| {
                for stage in stages {
                    thread::yield_now();
                    assert!(
                        observer
                            .hear(Activity::Equation { place, stage })
                            .is_continue()
                    );
                }
            };
            map_watched(threads, (0..20).collect(), &mut observer, work);
            let all = (0..20).flat_map(|place| stages.map(|stage| (place, stage)));
            assert_eq!(told, all.collect::<Vec<_>>());
        }
    }

    /// Every task works until it is told to stop; the observer is not asked again.
    #[test]
    fn what_the_observer_ends_ends_on_every_thread() {
        for threads in [1, 2, 5] {
            let mut left = 100;
            let mut observer = |_: Activity| {
                left -= 1;
                match left {
                    1.. => ControlFlow::Continue(()),
                    _ => ControlFlow::Break(Stop::Interrupted),
                }
            };
            let work = |_: usize, observer: &mut dyn Observer| {
                while observer.go_on() {
                    thread::yield_now();
                }
                true
            };
            let ended = map_watched(threads, (0..8).collect(), &mut observer, work);
            assert_eq!((ended, left), (vec![true; 8], 0));
        }
    }

    #[test]
    #[should_panic(expected = "scoped thread panicked")]
    fn a_panic_on_a_thread_is_one_here() {
        let here = thread::current().id();
        let work = |_: usize, _: &mut dyn Observer| {
            thread::sleep(PARALLELISM.ask_every);
            assert_eq!(thread::current().id(), here);
        };
        map_watched(4, (0..8).collect(), &mut Unwatched, work);
    }
}
