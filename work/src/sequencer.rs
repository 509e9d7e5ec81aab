//! Runs independent jobs on all cores and delivers their results in order, so that a run does not
//! depend on the number of cores.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Condvar, Mutex, PoisonError, mpsc};
use std::thread;

/// Whether all jobs were done.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Completion {
    /// Every job was done and delivered.
    All,
    /// The run was cancelled; this many jobs were delivered, the first ones without a gap.
    Cancelled {
        /// Jobs delivered.
        delivered: usize,
    },
}

/// Does `work` for each of `jobs` on `workers` threads and hands the results to `deliver` on this
/// thread, in the order of the jobs. Once `cancel` is set no further job starts, and a job that
/// ends with an error was cancelled by it.
///
/// # Errors
/// The first error in the order of the jobs, from `work` or `deliver`; the rest is abandoned.
pub fn run_in_order<J, R, E>(
    jobs: &[J],
    workers: usize,
    cancel: &AtomicBool,
    work: impl Fn(&J) -> Result<R, E> + Sync,
    mut deliver: impl FnMut(&J, R) -> Result<(), E>,
) -> Result<Completion, E>
where
    J: Sync,
    R: Send,
    E: Send,
{
    let workers = workers.clamp(1, jobs.len().max(1));
    // How far ahead of the delivery a worker may run: results wait for a slow one before them, but
    // do not pile up in memory.
    let window = 4 * workers;
    let next = AtomicUsize::new(0);
    let turn =
        Turn { delivered: Mutex::new(0), moved: Condvar::new(), over: AtomicBool::new(false) };
    thread::scope(|scope| {
        let (sender, receiver) = mpsc::channel::<(usize, Result<R, E>)>();
        for _ in 0..workers {
            let (sender, next, turn, work) = (sender.clone(), &next, &turn, &work);
            scope.spawn(move || {
                while !cancel.load(Ordering::Relaxed) {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    let Some(job) = jobs.get(index) else { break };
                    if !turn.wait_for(index, window) || sender.send((index, work(job))).is_err() {
                        break;
                    }
                }
            });
        }
        drop(sender);
        let mut waiting = BTreeMap::new();
        let mut delivered = 0;
        for (index, result) in receiver {
            waiting.insert(index, result);
            while let Some(result) = waiting.remove(&delivered) {
                if result.is_err() && cancel.load(Ordering::Relaxed) {
                    turn.end();
                    return Ok(Completion::Cancelled { delivered });
                }
                if let Err(error) = result.and_then(|result| deliver(&jobs[delivered], result)) {
                    turn.end();
                    return Err(error);
                }
                delivered += 1;
                turn.advance(delivered);
            }
        }
        Ok(if delivered == jobs.len() {
            Completion::All
        } else {
            Completion::Cancelled { delivered }
        })
    })
}

/// How many jobs are delivered, for workers to wait on.
struct Turn {
    delivered: Mutex<usize>,
    moved: Condvar,
    over: AtomicBool,
}

impl Turn {
    /// Waits until job `index` is less than `window` ahead of the delivery; false if nothing will
    /// be delivered any more.
    ///
    /// The earliest job that is not delivered never waits, so that the delivery always moves on.
    fn wait_for(&self, index: usize, window: usize) -> bool {
        let ahead = |delivered: &mut usize| {
            index >= *delivered + window && !self.over.load(Ordering::Relaxed)
        };
        // A counter is whole even if somebody panicked beside it.
        let delivered = self.delivered.lock().unwrap_or_else(PoisonError::into_inner);
        drop(self.moved.wait_while(delivered, ahead).unwrap_or_else(PoisonError::into_inner));
        !self.over.load(Ordering::Relaxed)
    }

    fn advance(&self, delivered: usize) {
        *self.delivered.lock().unwrap_or_else(PoisonError::into_inner) = delivered;
        self.moved.notify_all();
    }

    fn end(&self) {
        let guard = self.delivered.lock().unwrap_or_else(PoisonError::into_inner);
        self.over.store(true, Ordering::Relaxed);
        drop(guard);
        self.moved.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_come_in_the_order_of_the_jobs() {
        let jobs: Vec<u64> = (0..200).collect();
        for workers in [1, 3, 8] {
            let mut seen = Vec::new();
            let completion = run_in_order(
                &jobs,
                workers,
                &AtomicBool::new(false),
                // Uneven work, so that later jobs overtake earlier ones.
                |job| {
                    std::hint::black_box(
                        (0..(job * 7919) % 5000).fold(0u64, |a, b| a.wrapping_add(b * b)),
                    );
                    Ok::<_, ()>(*job)
                },
                |job, result| {
                    assert_eq!(*job, result);
                    seen.push(result);
                    Ok(())
                },
            );
            assert_eq!(completion, Ok(Completion::All));
            assert_eq!(seen, jobs);
        }
    }

    #[test]
    fn cancelling_keeps_what_was_delivered() {
        let jobs: Vec<usize> = (0..1000).collect();
        let cancel = AtomicBool::new(false);
        let mut seen = 0;
        let completion = run_in_order(
            &jobs,
            2,
            &cancel,
            |job| Ok::<_, ()>(*job),
            |job, _| {
                assert_eq!(*job, seen);
                seen += 1;
                if seen == 10 {
                    cancel.store(true, Ordering::Relaxed);
                }
                Ok(())
            },
        );
        let Ok(Completion::Cancelled { delivered }) = completion else { panic!("{completion:?}") };
        // What was begun is delivered: the window of eight ahead, and the job each of the two
        // workers held or waited with.
        assert!(delivered == seen && (10..=20).contains(&delivered), "{delivered}");
    }

    #[test]
    fn a_job_that_cancelling_ends_is_no_error() {
        let jobs: Vec<usize> = (0..100).collect();
        let cancel = AtomicBool::new(false);
        let work = |job: &usize| {
            if *job == 20 {
                cancel.store(true, Ordering::Relaxed);
            }
            if *job >= 20 { Err("stopped") } else { Ok(()) }
        };
        let completion = run_in_order(&jobs, 1, &cancel, work, |_, ()| Ok(()));
        assert_eq!(completion, Ok(Completion::Cancelled { delivered: 20 }));
    }

    #[test]
    fn the_first_error_ends_the_run() {
        let jobs: Vec<usize> = (0..100).collect();
        let result = run_in_order(
            &jobs,
            4,
            &AtomicBool::new(false),
            |job| if *job >= 20 { Err(*job) } else { Ok(()) },
            |_, ()| Ok(()),
        );
        assert_eq!(result, Err(20));
    }
}
