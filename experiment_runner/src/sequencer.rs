//! Runs independent jobs on all cores and delivers their results in order, so that a run does not depend on the number of cores.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc;
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

/// Does `work` for each of `jobs` on `workers` threads and hands the results to `deliver` on this thread, in the order of the
/// jobs. Once `cancel` is set no further job starts.
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
    let next = AtomicUsize::new(0);
    let abandoned = AtomicBool::new(false);
    thread::scope(|scope| {
        // Bounded: results wait for the disk rather than pile up in memory.
        let (sender, receiver) = mpsc::sync_channel::<(usize, Result<R, E>)>(2 * workers);
        for _ in 0..workers {
            let (sender, next, abandoned, work) = (sender.clone(), &next, &abandoned, &work);
            scope.spawn(move || {
                while !cancel.load(Ordering::Relaxed) && !abandoned.load(Ordering::Relaxed) {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    let Some(job) = jobs.get(index) else { break };
                    if sender.send((index, work(job))).is_err() {
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
                if let Err(error) = result.and_then(|result| deliver(&jobs[delivered], result)) {
                    abandoned.store(true, Ordering::Relaxed);
                    return Err(error);
                }
                delivered += 1;
            }
        }
        Ok(if delivered == jobs.len() { Completion::All } else { Completion::Cancelled { delivered } })
    })
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
                    std::hint::black_box((0..(job * 7919) % 5000).fold(0u64, |a, b| a.wrapping_add(b * b)));
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
        assert!(delivered == seen && (10..30).contains(&delivered), "{delivered}");
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
