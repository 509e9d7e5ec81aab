//! The control thread.

use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering},
};

use rig_driver::RigError;
use ros_node::{
    deadlines::{Deadlines, now_ns, request_realtime},
    timing::{Stopwatch, Timing},
};
use rtrb::Producer;

use super::{Counters, LiveCycle};
use crate::control_loop::ControlLoop;
use crate::cycle::CycleSample;

/// Everything the thread needs, made before it starts.
pub(super) struct Task {
    pub(super) control_loop: ControlLoop,
    /// How many cycles to run; `None` until stopped.
    pub(super) cycles: Option<u64>,
    /// Deadline of the first cycle [ns on the monotonic clock].
    pub(super) first_deadline: u64,
    pub(super) to_publisher: Producer<LiveCycle>,
    pub(super) to_recorder: Producer<LiveCycle>,
    pub(super) counters: Arc<Counters>,
    pub(super) stop: Arc<AtomicBool>,
}

/// What the thread leaves behind.
#[derive(Debug)]
pub(super) struct Done {
    pub(super) timing: Timing,
    /// What the control thread was told about its priority.
    pub(super) priority: String,
    /// Stopped before its last cycle.
    pub(super) stopped: bool,
    pub(super) rig_error: Option<RigError>,
}

impl Task {
    /// Runs the loop. Between the call of `tell`, with what came of the priority, and the return, nothing here locks,
    /// allocates or writes.
    pub(super) fn run(mut self, tell: impl FnOnce(String)) -> Done {
        let priority = request_realtime();
        let mut stopwatch = Stopwatch::new();
        tell(priority.clone());
        let period_ns = (self.control_loop.period() * 1e9).round() as u64;
        let mut deadlines = Deadlines::new(self.first_deadline, period_ns);
        let mut rig_error = None;
        let mut stopped = false;
        let mut done = 0;
        let mut before: Option<u64> = None;
        // A rig with a clock of its own is waited for; the deadlines are for the others.
        let paced_by_rig = self.control_loop.keeps_time();
        if paced_by_rig {
            // The first cycle's stamp is told already.
            deadlines.wait();
        }
        if let Err(error) = self.control_loop.activate() {
            return Done { timing: stopwatch.timing(0), priority, stopped, rig_error: Some(error) };
        }
        let mut last: Option<CycleSample> = None;
        while self.cycles.is_none_or(|cycles| done < cycles) {
            if self.stop.load(Ordering::Relaxed) {
                stopped = true;
                break;
            }
            let (start, late) = if paced_by_rig {
                if let Err(error) = self.control_loop.wait() {
                    rig_error = Some(error);
                    break;
                }
                let now = now_ns();
                (now, before.is_some_and(|before| now - before >= 2 * period_ns))
            } else {
                deadlines.wait()
            };
            if late {
                self.counters.overruns.fetch_add(1, Ordering::Relaxed);
            }
            self.control_loop.tell_time(start as f64 * 1e-9);
            let (sample, refused) = match self.control_loop.step() {
                Ok(sample) => (sample, None),
                Err(error) => {
                    // The flags of the fault still go out, with what was last decided.
                    let measurement = self.control_loop.look();
                    let Some(sample) = last.map(|last| last.followed_by(measurement)) else {
                        rig_error = Some(error);
                        break;
                    };
                    (sample, Some(error))
                }
            };
            last = Some(sample);
            let period_ns = before.map_or(0, |before| start - before);
            before = Some(start);
            let execution_ns = now_ns() - start;
            stopwatch.note(period_ns, execution_ns);
            let cycle = LiveCycle { sample, period_ns, execution_ns };
            if self.to_publisher.push(cycle).is_err() {
                self.counters.not_published.fetch_add(1, Ordering::Relaxed);
            }
            if self.to_recorder.push(cycle).is_err() {
                self.counters.not_recorded.fetch_add(1, Ordering::Relaxed);
            }
            done += 1;
            if let Some(error) = refused {
                rig_error = Some(error);
                break;
            }
        }
        // However the loop ended, the motor does not keep its last voltage.
        if let Err(error) = self.control_loop.stop() {
            rig_error.get_or_insert(error);
        }
        let timing = stopwatch.timing(self.counters.overruns.load(Ordering::Relaxed));
        Done { timing, priority, stopped, rig_error }
    }
}
