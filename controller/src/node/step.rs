//! The thread that controls: one command for each joint state. While it runs it locks, allocates and publishes nothing.

use std::time::{Duration, Instant};

use ros_node::queue::{Receiver, Sender, Waker};

use super::{parameters::ControlSettings, reference::ReferenceKeeper};
use crate::{Command, ControlFault, Controller, Feedback, Reference};

/// Time without joint states after which the loop begins anew [s]: the rig driver takes that of commands for a fault.
const SILENCE: f64 = 0.5;

/// One joint state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Joint {
    pub(super) stamp_ns: u64,
    pub(super) position: f64,
    pub(super) velocity: f64,
}

/// One friction estimate.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Friction {
    pub(super) stamp_ns: u64,
    pub(super) torque: f64,
}

/// What people ask of it, taken at the beginning of a cycle.
#[derive(Debug, Clone, Copy)]
#[expect(clippy::large_enum_variant, reason = "settings travel in place: taking them allocates nothing")]
pub(super) enum Order {
    Settings(ControlSettings),
    Reset,
    Run(bool),
}

/// What the thread is told, each by its own queue.
pub(super) struct Inputs {
    pub(super) joints: Receiver<Joint>,
    pub(super) frictions: Receiver<Friction>,
    /// With the moment at which each came.
    pub(super) references: Receiver<(Reference, Instant)>,
    pub(super) orders: Receiver<Order>,
}

/// One command on its way to the publisher.
#[derive(Debug, Clone, Copy)]
pub(super) struct Decided {
    pub(super) stamp_ns: u64,
    pub(super) command: Command,
    pub(super) fault: Option<ControlFault>,
    /// It stands in for a reference that does not come.
    pub(super) stale_reference: bool,
    /// The estimate that belongs to the joint state had come.
    pub(super) fresh_estimate: bool,
}

/// Controls until the joint states' queue has no other end.
pub(super) fn control(
    mut settings: ControlSettings,
    mut controller: Controller,
    mut inputs: Inputs,
    mut out: Sender<Decided>,
) {
    let period = settings.options.period;
    let mut keeper: Option<ReferenceKeeper> = None;
    let mut friction = Friction::default();
    let mut runs = false;
    let mut pending: Option<(Joint, Instant)> = None;
    let mut last_stamp = 0;
    let mut newest_reference = None;
    let mut faulted = false;
    loop {
        while let Some(order) = inputs.orders.take() {
            match order {
                Order::Reset => controller.reset(),
                Order::Run(wanted) => {
                    if wanted && !runs {
                        controller.reset();
                        (keeper, friction) = (None, Friction::default());
                        // What was said before it was active does not count.
                        let _ = inputs.references.take_last();
                        newest_reference = None;
                    }
                    runs = wanted;
                }
                Order::Settings(new) => {
                    // It was built once by the one who sent it: it cannot fail.
                    if new.options == settings.options || controller.change(new.options).is_ok() {
                        settings = new;
                        if let Some(keeper) = &mut keeper {
                            keeper.limit(new.reference_timeout, new.reference_deceleration, new.fastest);
                        }
                    }
                }
            }
        }
        friction = inputs.frictions.take_last().unwrap_or(friction);
        // Also while no joint state comes: a full queue would keep the oldest.
        newest_reference = inputs.references.take_last().or(newest_reference);
        if pending.is_none() {
            pending = inputs.joints.take().map(|joint| (joint, Instant::now()));
        }
        let Some((joint, came)) = pending else {
            if inputs.joints.is_over() {
                return;
            }
            Waker::sleep(Duration::from_millis(100));
            continue;
        };
        // A joint state that comes twice, or late, is no news.
        if !runs || joint.stamp_ns <= last_stamp && last_stamp - joint.stamp_ns < 1_000_000_000 {
            pending = None;
            last_stamp = last_stamp.max(joint.stamp_ns);
            continue;
        }
        let fresh = friction.stamp_ns >= joint.stamp_ns;
        let needed = settings.options.compensation.enabled && friction.stamp_ns > 0;
        let wait = Duration::from_secs_f64(settings.estimate_wait);
        if needed && !fresh && came.elapsed() < wait {
            Waker::sleep(wait.saturating_sub(came.elapsed()));
            continue;
        }
        pending = None;
        // After a silence it begins anew: the shaft may be elsewhere, and what was asked for before is old.
        let silence = joint.stamp_ns.saturating_sub(last_stamp) as f64 * 1e-9;
        if silence > SILENCE {
            keeper = None;
            if !faulted {
                controller.reset();
            }
        }
        last_stamp = joint.stamp_ns;
        let keeper = keeper.get_or_insert_with(|| {
            let mut keeper = ReferenceKeeper::new(joint.position);
            keeper.limit(settings.reference_timeout, settings.reference_deceleration, settings.fastest);
            keeper
        });
        if let Some((reference, came)) = newest_reference.take() {
            keeper.take(reference, came.elapsed().as_secs_f64());
        }
        let reference = keeper.next(period);
        // One from the future belongs to another clock.
        let age = joint.stamp_ns.abs_diff(friction.stamp_ns) as f64 * 1e-9;
        // More than the motor can overcome is no friction that it could compensate: it would be full voltage.
        let volts = friction.torque.abs() * settings.options.compensation.volts_per_newton_metre;
        let counts = age <= settings.estimate_timeout && volts <= settings.options.voltage_limit;
        let torque = if counts { friction.torque } else { 0.0 };
        let feedback =
            Feedback { position: joint.position, velocity: joint.velocity, friction: torque, cycle: None };
        let command = controller.step(&reference, &feedback);
        faulted = command.fault.is_some();
        out.send(Decided {
            stamp_ns: joint.stamp_ns,
            command,
            fault: command.fault,
            stale_reference: keeper.is_stale(),
            fresh_estimate: fresh && counts,
        });
    }
}
