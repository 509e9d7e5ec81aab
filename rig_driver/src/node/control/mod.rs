//! The control thread: measures and drives the rig at its period. Between start and end it locks,
//! allocates and publishes nothing.
//!
//! It needs no priority inheritance, because it never waits for another thread of this process:
//! requests, commands and cycles go through queues of one writer and one reader, which never wait,
//! and stop, permission and counters are atomic. What it waits for is a deadline, or the rig's next
//! cycle from the serial reader.

use std::{
    ops::ControlFlow,
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
    thread::JoinHandle,
};

use ros_node::{
    deadlines::{Deadlines, now_ns, request_realtime},
    queue::{Receiver, Sender, Waker, queue},
    stamps::Given,
};

use super::{
    in_cycle::{BegunCycle, EndedCycle, InCycle},
    torque_estimate::TorqueEstimate,
    zero::Zero,
};
use crate::{
    Measurement, Rig, RigError,
    safety::{FaultReport, Request, State, Supervised},
    station::{Presence, Station},
};

mod commands;

use commands::{Fate, Moment, fate};
pub(super) use commands::{VoltageCommand, WAITED};

/// Commands that wait for their cycle.
const COMMANDS: usize = 64;
/// Requests that wait for their cycle.
const REQUESTS: usize = 8;

/// What comes of a request.
type Answer = Result<State, RigError>;

/// What the thread is asked for between two cycles.
#[derive(Debug, Clone, Copy)]
pub(super) enum Asked {
    /// A transition of the safety layer.
    Safety(Request),
    /// Zeros found anew.
    Zero,
}

/// One cycle on its way to the publisher.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cycle {
    pub(super) stamp_ns: u64,
    /// Zeros taken off.
    pub(super) measurement: Measurement,
    /// Friction torque by the chosen source [N m].
    pub(super) effort: f64,
    pub(super) zero: Zero,
    pub(super) state: State,
    pub(super) fault: Option<FaultReport>,
    /// The winding above ambient by its model \[K\].
    pub(super) rise: Option<f64>,
    /// Age of the measurement behind the voltage of this cycle \[ns\]; zero without a command.
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
    /// Commands with a stamp later than that of every measurement.
    pub(super) future: AtomicU64,
    /// Commands with a stamp of no measurement.
    pub(super) unknown: AtomicU64,
    /// Commands that came over the network while they come in memory.
    pub(super) outside: AtomicU64,
}

/// The ends of the queues by which the thread is asked, by number.
type Requests = (Sender<(u64, Asked)>, Receiver<(u64, Answer)>);

/// The running thread, from outside. Dropped, the motor is at zero volts and the thread has ended.
pub(super) struct RunningRig {
    /// By number: see [`Desk`](crate::station::Desk).
    requests: Mutex<Requests>,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<Option<Box<dyn InCycle>>>>,
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

/// What the thread drives, and what it does with it.
pub(super) struct Work {
    /// Unconfigured.
    pub(super) rig: Supervised<Box<dyn Rig + Send>>,
    pub(super) torque: TorqueEstimate,
    /// Answers within the cycle, where it does not go over the network.
    pub(super) in_cycle: Option<Box<dyn InCycle>>,
    /// What people ask for, and the emergency stop.
    pub(super) station: Arc<Station>,
}

/// Notes, when the thread is gone and its rig with it, that nothing drives a motor any more.
struct Gone(Arc<Station>);

impl Drop for Gone {
    fn drop(&mut self) {
        self.0.enter(Presence::Absent);
    }
}

/// Starts the thread. Cycles go to `cycles`; `clock` says what time the first one is
/// [ns since the epoch].
pub(super) fn start(
    work: Work,
    cycles: Sender<Cycle>,
    clock: impl FnOnce() -> u64 + Send + 'static,
) -> Result<Ends, std::io::Error> {
    let nobody = Waker::default();
    let (commands, for_commands) = queue(COMMANDS, &nobody);
    let (requests, for_requests) = queue(REQUESTS, &nobody);
    let (answers, for_answers) = queue(REQUESTS, &nobody);
    let stop = Arc::new(AtomicBool::new(false));
    let counters = Arc::new(Counters::default());
    let not_published = cycles.dropped();
    let given = Given::new(remembered(&work.rig));
    let task = Task {
        work,
        given,
        in_memory: false,
        commands: for_commands,
        requests: for_requests,
        answers,
        cycles,
        stop: Arc::clone(&stop),
        counters: Arc::clone(&counters),
    };
    let (tell, told) = std::sync::mpsc::channel();
    let gone = Gone(Arc::clone(&task.work.station));
    let thread = std::thread::Builder::new().name("control".into()).spawn(move || {
        // Dropped last, after the rig, whether the task ends or panics.
        let _gone = gone;
        // Nobody listens any more if the start was given up.
        let _ = tell.send(request_realtime());
        task.run(clock())
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
    /// Sends the thread a request; [`answer`](Self::answer) has what comes of it, within a cycle.
    pub(super) fn send(&self, number: u64, asked: Asked) {
        let mut ends = self.requests.lock().unwrap_or_else(PoisonError::into_inner);
        // A queue that is full is that of a thread that hangs: whoever waits for the answer gives
        // it up.
        ends.0.send((number, asked));
    }

    /// The answer to a request, once it is there.
    pub(super) fn answer(&self, number: u64) -> Option<Result<State, String>> {
        let mut ends = self.requests.lock().unwrap_or_else(PoisonError::into_inner);
        while let Some((of, answer)) = ends.1.take() {
            // Others came too late for the one who asked.
            if of == number {
                return Some(answer.map_err(|error| error.to_string()));
            }
        }
        (self.is_over() && ends.1.is_over()).then(|| {
            Err("the control thread has ended, the motor at zero volts; clean the node up and configure it again"
                .to_owned())
        })
    }

    /// Whether the thread has come to its end by itself.
    pub(super) fn is_over(&self) -> bool {
        self.thread.as_ref().is_none_or(JoinHandle::is_finished)
    }

    /// Ends the thread, the motor at zero volts. Returns what answered within the cycle, unless the
    /// thread panicked.
    pub(super) fn end(mut self) -> Option<Box<dyn InCycle>> {
        self.stop.store(true, Ordering::Relaxed);
        self.thread.take().and_then(|thread| thread.join().ok().flatten())
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
    work: Work,
    /// Stamps of the measurements that a command can answer to.
    given: Given,
    /// Since the last activation the commands came within the cycle: what comes over the network
    /// does not count until the next.
    in_memory: bool,
    commands: Receiver<VoltageCommand>,
    requests: Receiver<(u64, Asked)>,
    answers: Sender<(u64, Answer)>,
    cycles: Sender<Cycle>,
    stop: Arc<AtomicBool>,
    counters: Arc<Counters>,
}

impl Task {
    fn run(mut self, epoch_ns: u64) -> Option<Box<dyn InCycle>> {
        let period_ns = (self.work.rig.period() * 1e9).round() as u64;
        let first = now_ns();
        let mut deadlines = Deadlines::new(first, period_ns);
        let mut before: Option<u64> = None;
        // When the newest command was made [ns since the epoch]; zero for none.
        let mut newest = 0;
        let mut zero = Zero::default();
        let mut heard = 0;
        while !self.stop.load(Ordering::Relaxed) {
            let mut refused = None;
            let (start, late) = if self.work.rig.keeps_time() {
                // A rig that hangs is found by the supervisor, whose own time goes on.
                if let Err(error) = self.work.rig.wait() {
                    refused = Some(error);
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
            self.work.rig.tell_time(now);
            let raw = self.work.rig.measure();
            self.take_requests(&mut zero);
            let measurement = zero.apply(&raw);
            let effort = self.work.torque.torque(&measurement);
            let stamp_ns = epoch_ns + since_first;
            self.given.note(stamp_ns);
            let state = self.work.rig.supervisor().state();
            let begun = BegunCycle { stamp_ns, measurement, effort, state };
            // Before what came over the network, which does not count beside it.
            if let Some(volts) = self.work.in_cycle.as_mut().and_then(|inner| inner.answer(&begun))
            {
                self.work.rig.command(now, volts);
                newest = stamp_ns;
                self.in_memory = true;
            }
            self.take_commands(&mut newest, Moment { start_ns: start, stamp_ns, now });
            // Stop and permission come last before the voltage, and count above everything before.
            let mut checked = self.work.station.check(&mut self.work.rig, &mut heard);
            if let Some(error) = checked.refused.take() {
                refused.get_or_insert(error);
            }
            // The supervisor holds what the back end refuses as a fault.
            let driven = self.work.rig.drive();
            self.work.station.note(&checked, driven.is_ok());
            if let Err(error) = driven {
                refused.get_or_insert(error);
            }
            let supervisor = self.work.rig.supervisor();
            let (state, fault) = (supervisor.state(), supervisor.latched().copied());
            let moves = state.moves() && newest > 0;
            let cycle = Cycle {
                stamp_ns,
                measurement,
                effort,
                zero,
                state,
                fault,
                rise: supervisor.rise(),
                age_ns: if moves { stamp_ns.saturating_sub(newest) } else { 0 },
                period_ns: before.map_or(0, |before| start - before),
                execution_ns: now_ns() - start,
            };
            before = Some(start);
            self.cycles.send(cycle);
            if let Some(inner) = &mut self.work.in_cycle {
                let Cycle { period_ns, execution_ns, .. } = cycle;
                let ended = EndedCycle { state, fault, period_ns, execution_ns, refused };
                if inner.end(ended) == ControlFlow::Break(()) {
                    break;
                }
            }
        }
        // Dropped, the rig leaves zero volts.
        self.work.in_cycle.take()
    }

    fn take_requests(&mut self, zero: &mut Zero) {
        while let Some((number, asked)) = self.requests.take() {
            // Whoever asked may have given it up: then it is not done any more.
            if !self.work.station.desk.begin(number) {
                continue;
            }
            let answer = match asked {
                Asked::Safety(request) => {
                    // Who commands is found anew with each activation.
                    self.in_memory &= request != Request::Activate;
                    self.work.station.carry_out(&mut self.work.rig, request)
                }
                Asked::Zero => {
                    zero.find();
                    Ok(self.work.rig.supervisor().state())
                }
            };
            self.answers.send((number, answer));
        }
    }

    /// Commands that came over the network, in the cycle of that moment.
    fn take_commands(&mut self, newest: &mut u64, moment: Moment) {
        let lost = self.work.rig.supervisor().limits().command_lost;
        let oldest = moment.stamp_ns.saturating_sub((lost * 1e9) as u64);
        while let Some(command) = self.commands.take() {
            let fate = if self.in_memory {
                Fate::Outside
            } else {
                fate(&command, &self.given, moment, oldest)
            };
            let counter = match fate {
                Fate::Counts { made_ns } => {
                    *newest = made_ns.max(*newest);
                    self.work.rig.command(moment.since_start(made_ns), command.volts);
                    continue;
                }
                // The supervisor makes a fault of it.
                Fate::NoNumber => {
                    self.work.rig.command(moment.now, command.volts);
                    continue;
                }
                Fate::Stale => &self.counters.stale,
                Fate::Future => &self.counters.future,
                Fate::Unknown => &self.counters.unknown,
                Fate::Outside => &self.counters.outside,
            };
            counter.fetch_add(1, Ordering::Relaxed);
        }
    }
}

/// Stamps to be remembered at most: beyond, a `command_lost` of many seconds would cost memory for
/// commands that nobody takes for new.
const REMEMBERED: f64 = 65_536.0;

/// How many measurements a command can answer to before it is lost.
fn remembered(rig: &Supervised<Box<dyn Rig + Send>>) -> usize {
    (rig.supervisor().limits().command_lost / rig.period() + 2.0).clamp(2.0, REMEMBERED) as usize
}

#[cfg(test)]
mod hostile;
