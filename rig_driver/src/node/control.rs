//! The control thread: measures and drives the rig at its period. Between start and end it locks, allocates and publishes nothing.

use std::{
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
    thread::JoinHandle,
    time::{Duration, Instant},
};

use ros_node::{
    deadlines::{Deadlines, now_ns, request_realtime},
    queue::{Receiver, Sender, Waker, queue},
};

use crate::{
    Measurement, Rig, RigError,
    safety::{FaultReport, Request, State, Supervised},
};

/// Commands that wait for their cycle.
const COMMANDS: usize = 64;
/// Requests that wait for their cycle.
const REQUESTS: usize = 8;
/// Longest time in which the thread answers a request.
const ANSWER: Duration = Duration::from_millis(1000);

/// What comes of a request.
type Answer = Result<State, RigError>;

/// A voltage that somebody asks for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct VoltageCommand {
    /// Time of the measurement it answers to [ns since the epoch]; zero if it says none, which counts as now.
    pub(super) stamp_ns: u64,
    /// Volts.
    pub(super) volts: f64,
}

/// One cycle on its way to the publisher.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cycle {
    pub(super) stamp_ns: u64,
    pub(super) measurement: Measurement,
    pub(super) state: State,
    pub(super) fault: Option<FaultReport>,
    /// Age of the measurement behind the voltage of this cycle [ns]; zero without a command.
    pub(super) age_ns: u64,
    pub(super) period_ns: u64,
    pub(super) execution_ns: u64,
}

/// What the thread counts.
#[derive(Debug, Default)]
pub(super) struct Counters {
    pub(super) overruns: AtomicU64,
    /// Commands older than `command_lost` when they came.
    pub(super) stale: AtomicU64,
}

/// The running thread, from outside. Dropped, the motor is at zero volts and the thread has ended.
pub(super) struct RunningRig {
    requests: Mutex<(Sender<Request>, Receiver<Answer>)>,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
    pub(super) counters: Arc<Counters>,
    pub(super) not_published: Arc<AtomicU64>,
}

/// The ends of a running rig's queues that others hold.
pub(super) struct Ends {
    pub(super) rig: RunningRig,
    pub(super) commands: Sender<VoltageCommand>,
    /// What the system said about the thread's priority.
    pub(super) priority: String,
}

/// Starts the thread around `rig`, which is unconfigured. Cycles go to `cycles`; the first is stamped `epoch_ns` [ns since the epoch].
pub(super) fn start(
    rig: Supervised<Box<dyn Rig + Send>>,
    cycles: Sender<Cycle>,
    epoch_ns: u64,
) -> Result<Ends, std::io::Error> {
    let nobody = Waker::default();
    let (commands, for_commands) = queue(COMMANDS, &nobody);
    let (requests, for_requests) = queue(REQUESTS, &nobody);
    let (answers, for_answers) = queue(REQUESTS, &nobody);
    let stop = Arc::new(AtomicBool::new(false));
    let counters = Arc::new(Counters::default());
    let not_published = cycles.dropped();
    let task = Task {
        rig,
        commands: for_commands,
        requests: for_requests,
        answers,
        cycles,
        epoch_ns,
        stop: Arc::clone(&stop),
        counters: Arc::clone(&counters),
    };
    let (tell, told) = std::sync::mpsc::channel();
    let thread = std::thread::Builder::new().name("control".into()).spawn(move || {
        // Nobody listens any more if the start was given up.
        let _ = tell.send(request_realtime());
        task.run();
    })?;
    let priority = told.recv().unwrap_or_default();
    let requests = Mutex::new((requests, for_answers));
    Ok(Ends {
        rig: RunningRig { requests, stop, thread: Some(thread), counters, not_published },
        commands,
        priority,
    })
}

impl RunningRig {
    /// Asks the safety layer for a transition and waits for the answer, which comes within a cycle.
    ///
    /// # Errors
    /// A sentence about why not.
    pub(super) fn ask(&self, request: Request) -> Result<State, String> {
        let mut ends = self.requests.lock().unwrap_or_else(PoisonError::into_inner);
        let (requests, answers) = &mut *ends;
        // An answer that came too late for the one who asked.
        while answers.take().is_some() {}
        requests.send(request);
        let asked = Instant::now();
        while asked.elapsed() < ANSWER {
            if let Some(answer) = answers.take() {
                return answer.map_err(|error| error.to_string());
            }
            std::thread::sleep(Duration::from_micros(200));
        }
        Err("the control thread does not answer: the rig hangs; take its power away if it moves".to_owned())
    }
}

impl Drop for RunningRig {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // A thread that panicked has dropped the rig, which leaves zero volts.
            let _ = thread.join();
        }
    }
}

struct Task {
    rig: Supervised<Box<dyn Rig + Send>>,
    commands: Receiver<VoltageCommand>,
    requests: Receiver<Request>,
    answers: Sender<Answer>,
    cycles: Sender<Cycle>,
    epoch_ns: u64,
    stop: Arc<AtomicBool>,
    counters: Arc<Counters>,
}

impl Task {
    fn run(mut self) {
        let period_ns = (self.rig.period() * 1e9).round() as u64;
        let first = now_ns();
        let mut deadlines = Deadlines::new(first, period_ns);
        let mut before: Option<u64> = None;
        let mut newest = VoltageCommand { stamp_ns: 0, volts: 0.0 };
        while !self.stop.load(Ordering::Relaxed) {
            let (start, late) = if self.rig.keeps_time() {
                // A rig that hangs is found by the supervisor, whose own time goes on.
                if self.rig.wait().is_err() {
                    deadlines.wait();
                }
                let now = now_ns();
                (now, before.is_some_and(|before| now - before >= 2 * period_ns))
            } else {
                deadlines.wait()
            };
            if late {
                self.counters.overruns.fetch_add(1, Ordering::Relaxed);
            }
            let since_first = start.saturating_sub(first);
            let now = since_first as f64 * 1e-9;
            self.rig.tell_time(now);
            let measurement = self.rig.measure();
            while let Some(request) = self.requests.take() {
                let answer = self.rig.request(request);
                self.answers.send(answer);
            }
            let stamp_ns = self.epoch_ns + since_first;
            let lost = self.rig.supervisor().limits().command_lost;
            while let Some(command) = self.commands.take() {
                let stamp_ns = if command.stamp_ns == 0 { stamp_ns } else { command.stamp_ns };
                let made = (stamp_ns as i128 - i128::from(self.epoch_ns)) as f64 * 1e-9;
                // What is too old to count at all is no command; a voltage that is no number is told to the supervisor whatever its age.
                if command.volts.is_finite() && now - made > lost {
                    self.counters.stale.fetch_add(1, Ordering::Relaxed);
                    continue;
                }
                if stamp_ns >= newest.stamp_ns {
                    newest = VoltageCommand { stamp_ns, ..command };
                }
                self.rig.command(made, command.volts);
            }
            // The supervisor holds what the back end refuses as a fault.
            let _ = self.rig.drive();
            let supervisor = self.rig.supervisor();
            let moves = supervisor.state().moves() && newest.stamp_ns > 0;
            let cycle = Cycle {
                stamp_ns,
                measurement,
                state: supervisor.state(),
                fault: supervisor.latched().copied(),
                age_ns: if moves { stamp_ns.saturating_sub(newest.stamp_ns) } else { 0 },
                period_ns: before.map_or(0, |before| start - before),
                execution_ns: now_ns() - start,
            };
            before = Some(start);
            self.cycles.send(cycle);
        }
        // Dropped, the rig leaves zero volts.
    }
}
