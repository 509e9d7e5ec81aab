//! Observer and controller on the control thread: they answer each measurement within its own
//! cycle.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use controller::node::{Control, Decided, Friction};
use controller::{Command, Reference};
use friction_model::Regime;
use friction_observer::node::{Beside, Estimated, Estimation};
use friction_observer::{Estimate, Source};
use rig_driver::node::{BegunCycle, EndedCycle, InCycle};
use rig_driver::safety::{Fault, State};
use rig_driver::{Measurement, RigError};
use ros_node::queue::Receiver;
use ros_node::queue::Sender;
use rtrb::Producer;

use experiment_runner::cycle::CycleSample;
use experiment_runner::messages::Spoken;

use super::shape::{Course, Shape};

/// What stands where the observer has said nothing yet; it is not written.
const NO_ESTIMATE: Estimate = Estimate {
    source: Source::DisturbanceObserver,
    torque: 0.0,
    deflection: 0.0,
    gamma: 0.0,
    regime: Regime::Stick,
    velocity: 0.0,
    residual: None,
};

/// One cycle on its way to the recorder.
#[derive(Debug, Clone, Copy)]
pub(super) struct LiveCycle {
    pub(super) sample: CycleSample,
    /// Friction torque by the chosen source [N m].
    pub(super) effort: f64,
    /// Who said something in it.
    pub(super) spoken: Spoken,
    /// Time since the start of the cycle before \[ns\]; zero for the first.
    pub(super) period_ns: u64,
    /// Time the step took \[ns\].
    pub(super) execution_ns: u64,
}

/// How the loop ended, for others to see. Written by the control thread.
#[derive(Debug, Default)]
pub(super) struct Ending {
    /// There will be no other cycle.
    pub(super) over: AtomicBool,
    /// The thread took observer and controller with it.
    pub(super) gone: AtomicBool,
    pub(super) not_recorded: AtomicU64,
    error: Mutex<Option<RigError>>,
}

impl Ending {
    /// What the rig refused, or the fault that ended the loop.
    pub(super) fn error(&self) -> Option<RigError> {
        self.error.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

/// Observer and controller with what goes into them and out of them.
pub(super) struct InProcess {
    pub(super) estimation: Estimation,
    pub(super) control: Control,
    /// Where the axis should be; none if `/reference` says it.
    pub(super) course: Option<Course>,
    /// What it becomes.
    pub(super) shapes: Option<Receiver<Shape>>,
    /// How many cycles there are to be; `None` until stopped.
    pub(super) cycles: Option<u64>,
    pub(super) to_observer: Sender<Estimated>,
    pub(super) to_controller: Sender<Decided>,
    pub(super) to_reference: Option<Sender<(u64, Reference)>>,
    pub(super) to_recorder: Producer<LiveCycle>,
    pub(super) ending: Arc<Ending>,
    pub(super) memory: Memory,
}

/// What is kept from cycle to cycle.
#[derive(Default)]
pub(super) struct Memory {
    friction: Friction,
    estimate: Option<Estimate>,
    /// The motor might move in the cycle before.
    moved: bool,
    /// Time of the rig at which the motor might move first \[s\].
    origin: Option<f64>,
    done: u64,
    /// What ended the loop, while the flags of the fault still go out.
    failed: Option<RigError>,
    /// The cycle under way, and whether a fault held the motor when it began.
    under_way: Option<(LiveCycle, bool)>,
}

impl InCycle for InProcess {
    fn answer(&mut self, begun: &BegunCycle) -> Option<f64> {
        let &BegunCycle { stamp_ns, measurement, effort, state } = begun;
        let memory = &mut self.memory;
        self.estimation.take_orders();
        let ran = self.control.runs();
        self.control.take_orders();
        if state.moves() && !memory.moved {
            // What was integrated while the motor could not move does not count.
            self.estimation.reset();
            self.control.reset();
            memory.origin.get_or_insert(measurement.time);
        }
        memory.moved = state.moves();
        if self.control.runs() && !ran {
            memory.friction = Friction::default();
        }
        let position = measurement.encoder_position;
        if let Some((course, shapes)) = self.course.as_mut().zip(self.shapes.as_mut()) {
            while let Some(shape) = shapes.take() {
                course.change(shape);
            }
        }
        let reference = match &mut self.course {
            Some(course) => {
                course.at(memory.origin.map_or(0.0, |origin| measurement.time - origin))
            }
            None if self.control.runs() => self.control.next_reference(position),
            None => Reference { position, ..Reference::default() },
        };
        let estimated = self.estimation.step(
            &observed(begun),
            &Beside {
                volts: measurement.voltage_applied,
                reference_position: reference.position,
                reference_velocity: reference.velocity,
            },
        );
        if let Some(Estimated { estimate, .. }) = estimated {
            memory.friction = Friction { stamp_ns, torque: estimate.torque };
            memory.estimate = Some(estimate);
        }
        let joint = controller::node::Joint {
            stamp_ns,
            position,
            velocity: measurement.tachometer_velocity,
            cycle: Some(measurement.cycle),
        };
        let decided = self.control.step(&joint, &reference, &memory.friction);
        let command = decided.map_or_else(Command::default, |decided| decided.command);
        let spoken = Spoken {
            reference: self.course.is_some() || decided.is_some(),
            estimate: estimated.is_some(),
            command: decided.is_some(),
        };
        let sample = CycleSample {
            stamp_ns,
            measurement,
            reference,
            estimate: memory.estimate.unwrap_or(NO_ESTIMATE),
            command,
            truth: None,
        };
        let cycle = LiveCycle { sample, effort, spoken, period_ns: 0, execution_ns: 0 };
        memory.under_way = Some((cycle, state == State::Faulted));
        if let Some(estimated) = estimated {
            self.to_observer.send(estimated);
        }
        if let Some(queue) = &mut self.to_reference {
            queue.send((stamp_ns, reference));
        }
        decided.map(|decided| {
            self.to_controller.send(decided);
            decided.command.total
        })
    }

    fn end(&mut self, ended: EndedCycle) -> ControlFlow<()> {
        let memory = &mut self.memory;
        let Some((cycle, faulted)) = memory.under_way.take() else {
            return ControlFlow::Continue(());
        };
        let EndedCycle { fault, period_ns, execution_ns, refused, .. } = ended;
        if self.to_recorder.push(LiveCycle { period_ns, execution_ns, ..cycle }).is_err() {
            self.ending.not_recorded.fetch_add(1, Ordering::Relaxed);
        }
        memory.done += 1;
        let failed_before = memory.failed.is_some();
        if memory.failed.is_none() {
            let own = fault.filter(|report| !comes_from_outside(report.fault));
            memory.failed = refused.or(own.map(RigError::Safety));
        }
        // A cycle with the flags of the fault goes out before the end.
        let failed = failed_before || faulted && memory.failed.is_some();
        if failed {
            *self.ending.error.lock().unwrap_or_else(PoisonError::into_inner) =
                memory.failed.take();
        }
        if failed || self.cycles.is_some_and(|cycles| memory.done >= cycles) {
            self.ending.over.store(true, Ordering::Release);
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    }
}

impl Drop for InProcess {
    fn drop(&mut self) {
        self.ending.gone.store(true, Ordering::Release);
    }
}

/// Faults that only somebody else's commands can cause, as the loop's own come in every cycle: they
/// hold the motor until they are cleared, and end nothing.
const fn comes_from_outside(fault: Fault) -> bool {
    matches!(fault, Fault::CommandLost | Fault::CommandNotFinite)
}

fn observed(begun: &BegunCycle) -> friction_observer::node::Joint {
    let Measurement { encoder_position, tachometer_velocity, .. } = begun.measurement;
    friction_observer::node::Joint {
        stamp_ns: begun.stamp_ns,
        position: encoder_position,
        velocity: tachometer_velocity,
        effort: Some(begun.effort),
    }
}
